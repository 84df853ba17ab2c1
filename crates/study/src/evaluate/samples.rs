//! The evaluation of a block of samples in one scene: growing modes and their names sector by sector, then net work.

use std::borrow::Cow;

use cea::{CeaError, Gain, Growing, ranks_together};
use linsys::{OperatingPoint, SecondOrder};
use nalgebra::DMatrix;

use super::{OpenMode, Outcome, Study, UnstableMode};
use crate::Error;
use crate::band::BandNames;
use crate::net_work::work_with;
use crate::scratch::{Scratch, timed};
use crate::sector_modes::{NamedSectorMode, SectorModes, SecularAnswer};
use crate::secular_equations::growing_modes;
use crate::{BandMode, ModeLabel, ModeSource, UncertainBrake};

/// Memory of the matrices of the samples of a block that are solved together, bytes; chosen: all of a block where they are small.
const BYTES_TOGETHER: usize = 16_000_000;

/// Number of samples of a block solved together by spectra: a multiple of the lanes of the solver, on which no result depends.
pub(super) fn samples_together(order: usize) -> usize {
    let bytes = 3 * size_of::<f64>() * order * order;
    (BYTES_TOGETHER / bytes.max(1)).next_multiple_of(8).max(8)
}

impl<B: UncertainBrake> Study<'_, B> {
    /// The outcomes at operating points of a scene of a brake that finds its modes itself.
    pub(super) fn band_samples(
        &self,
        source: &dyn ModeSource,
        scene: usize,
        points: &[OperatingPoint],
        scratch: &mut Scratch,
    ) -> Vec<Result<Outcome, Error>> {
        let memory = &mut scratch.memory;
        let names = BandNames {
            solver: &self.solver,
            plan: self.plan(),
            reference: &self.references[scene],
            likeness_too: self.options.likeness_too,
        };
        let reference = &self.reference_points[scene];
        let of_scene = &self.plan().scenes[scene];
        let model = &self.plan().brake(of_scene).system;
        let found = timed(&mut memory.spent.search, || source.band_modes(of_scene, points));
        let outcome = |(at, found): (&OperatingPoint, Result<Vec<BandMode>, Error>)| {
            let found = found?;
            if found.is_empty() {
                return Ok(Outcome::default());
            }
            let mass = self.mass(scene, at)?;
            let coarse = || source.coarse(of_scene, [at, reference]);
            let modes = names.sector_modes(found, &mass, coarse, || Ok(model.assemble(at)?), memory)?;
            timed(&mut memory.spent.outcomes, || self.outcome(scene, at, &[modes]))
        };
        points.iter().zip(found).map(outcome).collect()
    }

    /// The outcomes at operating points of a scene that no certificate covers.
    pub(super) fn open_samples(
        &self,
        scene: usize,
        points: &[OperatingPoint],
        scratch: &mut Scratch,
    ) -> Vec<Result<Outcome, Error>> {
        let Scratch { systems, memory } = scratch;
        let (equations, solvers) = (self.equations(scene), self.solvers(scene));
        let mut outcomes: Vec<Result<Outcome, Error>> = points.iter().map(|_| Ok(Outcome::default())).collect();

        let mut found =
            timed(&mut memory.spent.search, || growing_modes(equations, &solvers, points, &mut memory.work));
        let (growing, open) = growing_and_open(&found, points.len());
        let mut of_sectors = Vec::with_capacity(solvers.len());
        for (solver, found) in solvers.iter().zip(&mut found) {
            let found: Vec<(Gain, Growing)> = growing.iter().filter_map(|&at| found[at].take()).collect();
            of_sectors.push(solver.name_growing(&found, memory));
        }
        timed(&mut memory.spent.outcomes, || self.enter(scene, points, &growing, of_sectors, &mut outcomes));

        for open in open.chunks(samples_together(self.plan().brake(&self.plan().scenes[scene]).system.order())) {
            let assembled = timed(&mut memory.spent.assembly, || self.assemble(scene, points, open, systems));
            // A sample whose matrices cannot be assembled takes no lane of the solver.
            let (mut lanes, mut of_sectors) = (Vec::with_capacity(open.len()), Vec::with_capacity(solvers.len()));
            for (&at, made) in open.iter().zip(assembled) {
                match made {
                    Ok(()) => lanes.push(at),
                    Err(error) => outcomes[at] = Err(error),
                }
            }
            for (systems, solver) in systems.iter().zip(&solvers) {
                of_sectors.push(solver.solve(&systems[..lanes.len()], memory));
            }
            timed(&mut memory.spent.outcomes, || self.enter(scene, points, &lanes, of_sectors, &mut outcomes));
        }
        outcomes
    }

    /// Puts the modes of all sectors of each of `samples` together and enters the outcomes.
    fn enter(
        &self,
        scene: usize,
        points: &[OperatingPoint],
        samples: &[usize],
        of_sectors: Vec<Vec<Result<SectorModes, CeaError>>>,
        outcomes: &mut [Result<Outcome, Error>],
    ) {
        let mut of_sectors: Vec<_> = of_sectors.into_iter().map(Vec::into_iter).collect();
        for &at in samples {
            let of_sample =
                of_sectors.iter_mut().filter_map(Iterator::next).collect::<Result<Vec<SectorModes>, CeaError>>();
            outcomes[at] =
                of_sample.map_err(Error::from).and_then(|of_sectors| self.outcome(scene, &points[at], &of_sectors));
        }
    }

    /// Writes the systems of each sector at the points of `points` that are `open`, by sector and sample. A sample that cannot be
    /// assembled is left out: the next is written in its stead.
    pub(super) fn assemble(
        &self,
        scene: usize,
        points: &[OperatingPoint],
        open: &[usize],
        systems: &mut Vec<Vec<SecondOrder>>,
    ) -> Vec<Result<(), Error>> {
        let osc_model::Brake { system, sectors, .. } = self.plan().brake(&self.plan().scenes[scene]);
        systems.resize_with(systems.len().max(sectors.iter().len()), Vec::new);
        for of_sector in &mut *systems {
            of_sector.resize_with(of_sector.len().max(open.len()), || SecondOrder::zeros(1, 0));
        }
        let (mut lane, mut whole) = (0, SecondOrder::zeros(1, 0));
        let mut assembled = Vec::with_capacity(open.len());
        for &at in open {
            let of_lane = systems.iter_mut().map(|of_sector| &mut of_sector[lane]);
            let made = sectors.assemble_into(system, &points[at], &mut whole, of_lane);
            lane += usize::from(made.is_ok());
            assembled.push(made.map_err(Error::from));
        }
        assembled
    }

    /// The mass matrix at an operating point of a scene: the mass matrix of the scene's reference where both have the same coefficients.
    fn mass(&self, scene: usize, at: &OperatingPoint) -> Result<Cow<'_, DMatrix<f64>>, Error> {
        if at.coefficients == self.reference_points[scene].coefficients {
            return Ok(Cow::Borrowed(&self.references[scene].system.m));
        }
        let brake = self.plan().brake(&self.plan().scenes[scene]);
        Ok(Cow::Owned(brake.system.mass(&at.coefficients)?))
    }

    /// The outcome of one sample from the modes of all its sectors.
    fn outcome(&self, scene: usize, at: &OperatingPoint, of_sectors: &[SectorModes]) -> Result<Outcome, Error> {
        let of_scene = &self.plan().scenes[scene];
        let (mut outcome, brake) = (Outcome::default(), self.plan().brake(of_scene));
        let wants_work = of_scene.wants_work && of_sectors.iter().any(|of_sector| !of_sector.unstable.is_empty());
        let mass = if wants_work { Some(self.mass(scene, at)?) } else { None };
        let ranks = ranks_together(&of_sectors.iter().map(|of_sector| &of_sector.modes).collect::<Vec<_>>());
        for ((of_sector, ranks), sector) in of_sectors.iter().zip(ranks).zip(brake.sectors.iter()) {
            for NamedSectorMode { index, mode, names, names_by_likeness, residual } in &of_sector.unstable {
                let of_mode = |mass| work_with(mass, brake, at, mode.lambda, &sector.expand(&mode.shape));
                let work = mass.as_deref().map(of_mode).transpose()?;
                outcome.growth = outcome.growth.max(mode.lambda.re);
                outcome.unstable.push(UnstableMode {
                    rank: ModeLabel::of_rank(ranks[*index]),
                    lambda: mode.lambda,
                    names: names.clone(),
                    names_by_likeness: names_by_likeness.clone(),
                    work,
                    residual: *residual,
                });
            }
            outcome.open.extend(of_sector.undecided.iter().map(|mode| OpenMode {
                rank: ModeLabel::of_rank(ranks[mode.index]),
                omega: mode.mode.lambda.im,
                names: mode.names.clone(),
                names_by_likeness: mode.names_by_likeness.clone(),
            }));
            for &growth in &of_sector.divergent {
                outcome.divergent += 1;
                outcome.divergence = outcome.divergence.max(growth);
                outcome.growth = outcome.growth.max(growth);
            }
            outcome.undecided += of_sector.undecided.len() as u32 + of_sector.undecided_real;
            outcome.undecided_real += of_sector.undecided_real;
            outcome.marginal += of_sector.marginal;
        }
        outcome.unstable.sort_by_key(|mode| mode.rank);
        Ok(outcome)
    }
}

/// Indices of the samples that have growing modes, and of those that are open, by the answers of all sectors: a sample that one sector
/// leaves open needs the spectra of all. Samples in neither list are stable.
fn growing_and_open(found: &[Vec<SecularAnswer>], samples: usize) -> (Vec<usize>, Vec<usize>) {
    let (mut growing, mut open) = (Vec::new(), Vec::new());
    for at in 0..samples {
        let answers: Option<Vec<&(Gain, Growing)>> = found.iter().map(|of_sector| of_sector[at].as_ref()).collect();
        match answers {
            None => open.push(at),
            Some(answers) if answers.iter().any(|(_, growing)| growing.frequencies().next().is_some()) => {
                growing.push(at)
            }
            Some(_) => {}
        }
    }
    (growing, open)
}
