//! Modes near the imaginary axis at chosen operating points of a scene, with derivatives and names: the sample points of the
//! control variate are made from these.

use cea::{Gain, LeftOpen};
use linsys::OperatingPoint;
use num_complex::Complex;

use super::sector_modes::SectorEquation;
use super::{ModeLabel, Scratch, Study, UncertainBrake};
use crate::Error;

/// A mode near the imaginary axis, under friction that is the same in all contacts.
#[derive(Debug, Clone)]
pub(crate) struct NearAxis {
    /// Eigenvalue, rad/s.
    pub lambda: Complex<f64>,
    /// Derivative d lambda / d mu at a constant slope, rad/s.
    pub by_mu: Complex<f64>,
    /// Derivative d lambda / d (N0 h) at constant mu, rad/s per Ns/m.
    pub by_slope: Complex<f64>,
    /// The names that an unstable mode, beyond the threshold of the plan, may have; empty for another one.
    pub names: Vec<ModeLabel>,
}

impl<B: UncertainBrake> Study<'_, B> {
    /// The modes that grow, or decay at less than the fraction `part` of |lambda|, at each operating point of a scene; `None` at a point where the secular
    /// equations leave a doubt, and at all points of a scene without secular equations.
    ///
    /// # Errors
    /// Those of the model and of the names.
    pub(crate) fn near_axis(
        &self,
        scene: usize,
        points: &[OperatingPoint],
        part: f64,
        scratch: &mut Scratch,
    ) -> Result<Vec<Option<Vec<NearAxis>>>, Error> {
        let (solvers, memory) = (self.solvers(scene), &mut scratch.memory);
        let gains = points.iter().map(|at| self.equations(scene).gain(at)).collect::<Option<Vec<Gain>>>();
        let equations = solvers.iter().map(|solver| solver.equation).collect::<Option<Vec<_>>>();
        let grows = |lambda: Complex<f64>| self.plan().threshold.margin(lambda) > 0.0;
        let (Some(gains), Some(equations)) = (gains, equations) else { return Ok(vec![None; points.len()]) };
        let mut found = vec![Some(Vec::new()); points.len()];
        for (solver, SectorEquation { secular, anchors, .. }) in solvers.iter().zip(equations) {
            let near = secular.near_axis(anchors, &gains, part, &mut memory.work);
            let growing_of = |near: &Result<Vec<Complex<f64>>, LeftOpen>| -> Vec<Complex<f64>> {
                near.iter().flatten().copied().filter(|lambda| grows(*lambda)).collect()
            };
            let growing: Vec<(Gain, Vec<Complex<f64>>)> =
                gains.iter().zip(&near).map(|(gain, near)| (*gain, growing_of(near))).collect();
            let named = solver.named_at(&growing, memory);
            for (((near, named), gain), found) in near.into_iter().zip(named).zip(&gains).zip(&mut found) {
                let (Ok(near), Some(of_point)) = (near, found.as_mut()) else {
                    *found = None;
                    continue;
                };
                let asked: Vec<(Gain, Complex<f64>)> = near.iter().map(|&lambda| (*gain, lambda)).collect();
                let mut names = named?.into_iter().map(|mode| mode.names);
                for (lambda, [by_mu, by_slope]) in near.into_iter().zip(secular.rates(&asked, &mut memory.work)) {
                    let names = if grows(lambda) { names.next().unwrap_or_default() } else { Vec::new() };
                    of_point.push(NearAxis { lambda, by_mu, by_slope, names });
                }
            }
        }
        Ok(found)
    }
}
