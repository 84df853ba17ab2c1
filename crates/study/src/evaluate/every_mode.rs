//! Every mode of a sample, stable ones too: what a surrogate of the growth of a mode is made from.

use cea::grows_too_fast;
use num_complex::Complex;

use super::Study;
use super::samples::samples_together;
use crate::scratch::{Scratch, timed};
use crate::{Error, ModeLabel, UncertainBrake};

/// Mode of a sample, stable or not.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledMode {
    /// Candidate names: one; several near a coalescence; empty where no name is known.
    pub names: Vec<ModeLabel>,
    /// Eigenvalue lambda, rad/s.
    pub lambda: Complex<f64>,
}

impl<B: UncertainBrake> Study<'_, B> {
    /// Modes of each of `samples` in a scene that oscillate and that the plan studies, ascending in frequency. Each sample takes the whole spectrum of its
    /// system: nothing is searched and nothing certified.
    pub fn every_mode(
        &self,
        scene: usize,
        samples: &[&B::Sample],
        scratch: &mut Scratch,
    ) -> Vec<Result<Vec<SampledMode>, Error>> {
        let order = self.plan().brake(&self.plan().scenes[scene]).system.order();
        let blocks = samples.chunks(samples_together(order));
        blocks.flat_map(|block| self.every_mode_of_block(scene, block, scratch)).collect()
    }

    /// Modes of samples whose matrices are in memory together.
    fn every_mode_of_block(
        &self,
        scene: usize,
        samples: &[&B::Sample],
        scratch: &mut Scratch,
    ) -> Vec<Result<Vec<SampledMode>, Error>> {
        let (plan, solvers) = (self.plan(), self.solvers(scene));
        let mut modes: Vec<Result<Vec<SampledMode>, Error>> = Vec::with_capacity(samples.len());
        let (mut points, mut solved) = (Vec::with_capacity(samples.len()), Vec::with_capacity(samples.len()));
        for (at, point) in self.brake().operating_points(&plan.scenes[scene], samples).into_iter().enumerate() {
            modes.push(point.map(|point| {
                points.push(point);
                solved.push(at);
                Vec::new()
            }));
        }
        let Scratch { systems, memory } = scratch;
        let all: Vec<usize> = (0..points.len()).collect();
        let assembled = timed(&mut memory.spent.assembly, || self.assemble(scene, &points, &all, systems));
        let mut lanes = Vec::with_capacity(points.len());
        for (at, made) in solved.into_iter().zip(assembled) {
            match made {
                Ok(()) => lanes.push(at),
                Err(error) => modes[at] = Err(error),
            }
        }
        for (systems, solver) in systems.iter().zip(&solvers) {
            let found = solver.every_mode(&systems[..lanes.len()], memory);
            for (&at, found) in lanes.iter().zip(found) {
                match (&mut modes[at], found) {
                    (Ok(of_sample), Ok(found)) => of_sample.extend(
                        found.into_iter().map(|named| SampledMode { names: named.names, lambda: named.mode.lambda }),
                    ),
                    (of_sample, Err(error)) => *of_sample = Err(error.into()),
                    (Err(_), Ok(_)) => {}
                }
            }
        }
        // Of a reduced brake a pair that grows faster than it oscillates is no mode: no basis of the modes of a band contains its shape, and the full model
        // need not have it.
        let is_reduced = self.brake().mode_source().is_some();
        for modes in modes.iter_mut().flatten() {
            modes.retain(|mode| !(is_reduced && grows_too_fast(mode.lambda)));
            modes.sort_by(|a, b| a.lambda.im.total_cmp(&b.lambda.im));
        }
        modes
    }
}
