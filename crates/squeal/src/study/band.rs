//! The modes of a brake that finds them itself, with their names: by likeness to those of the reference, and followed to these only where
//! that is in doubt, so that most samples need no matrices.

use cea::{EigenSolver, Mode, Modes, Workspace};
use linsys::SecondOrder;
use nalgebra::DMatrix;
use tracking::{OwnedPath, Path, PathEnd, PathStart, clear_matches};

use super::memory::{Memory, timed};
use super::sector_modes::{SectorModes, UnstableSectorMode};
use super::{BandMode, ModeIdentity, ModeLabel, Plan, Reference};
use crate::Error;

/// What the modes of a scene are named by.
pub(super) struct BandNames<'a> {
    pub solver: &'a dyn EigenSolver,
    pub plan: &'a Plan,
    pub reference: &'a Reference,
    /// Whether modes are named by likeness to those of the origin too.
    pub likeness_too: bool,
}

/// Where modes in doubt are followed from.
pub(super) enum BandStart<'a> {
    System(Box<SecondOrder>),
    /// The brake evaluates the path from there to the reference.
    Owned(Box<dyn OwnedPath + 'a>),
}

impl<'a> BandNames<'a> {
    /// The modes found in one sample, the unstable ones with names. Its mass matrix is given, its system and a cheaper way to follow modes
    /// from there are made where they are needed.
    ///
    /// # Errors
    /// A system that cannot be made; those of the solver.
    pub fn sector_modes(
        &self,
        found: Vec<BandMode>,
        mass: &DMatrix<f64>,
        start: impl FnOnce() -> Result<BandStart<'a>, Error>,
        memory: &mut Memory,
    ) -> Result<SectorModes, Error> {
        let margin = |mode: &BandMode| self.plan.threshold.margin(mode.lambda);
        let studied: Vec<BandMode> = found.into_iter().filter(|mode| self.plan.is_studied(mode.lambda)).collect();
        let is_open = |mode: &&BandMode| margin(mode).abs() <= mode.bound || mode.bound.is_nan();
        let undecided = studied.iter().filter(is_open).count() as u32;
        let unstable: Vec<usize> = (0..studied.len()).filter(|&at| margin(&studied[at]) > studied[at].bound).collect();
        let mode = |&at: &usize| Mode::normalised(mass, studied[at].lambda, studied[at].shape.clone());
        let modes: Vec<Mode> = unstable.iter().map(mode).collect();
        let Memory { work, spent, .. } = memory;
        let names = timed(&mut spent.names, || self.names(&modes, mass, start, work))?;
        let by_likeness = if self.likeness_too { self.reference.names_by_likeness(&modes) } else { None };
        let mut by_likeness = by_likeness.into_iter().flatten();
        let named = unstable.iter().zip(modes).zip(names);
        let unstable = named.map(|((&index, mode), names)| {
            let (names_by_likeness, residual) = (by_likeness.next(), studied[index].residual);
            UnstableSectorMode { index, mode, names, names_by_likeness, residual }
        });
        let unstable = unstable.collect();
        let oscillatory = studied.iter().map(|mode| mode.lambda).collect();
        let modes = Modes { oscillatory, real: Vec::new(), internal: Vec::new() };
        Ok(SectorModes { modes, unstable, undecided })
    }

    /// The names of some modes of a system.
    fn names(
        &self,
        modes: &[Mode],
        mass: &DMatrix<f64>,
        start: impl FnOnce() -> Result<BandStart<'a>, Error>,
        work: &mut Workspace,
    ) -> Result<Vec<Vec<ModeLabel>>, Error> {
        if self.plan.mode_identity == ModeIdentity::Mac {
            return Ok(self.reference.names_by_likeness(modes).unwrap_or_default());
        }
        let known = self.reference;
        let clear: Option<Vec<usize>> = clear_matches(modes, &known.modes, mass).into_iter().collect();
        if let Some(clear) = clear {
            return Ok(clear.into_iter().map(|to| known.names_of([to])).collect());
        }
        let (start, end) = (start()?, PathEnd { system: &known.system, modes: &known.modes });
        let start = match &start {
            BandStart::System(system) => PathStart::System(system),
            BandStart::Owned(path) => PathStart::Owned(mass, path.as_ref()),
        };
        let path = Path { start, start_modes: modes, end };
        Ok(known.names_of_all(self.solver, &[path], self.plan.mode_identity, work).remove(0)?)
    }
}
