//! Names of the modes that a brake finds itself, in order of cost: MAC with the modes of the reference; where a mode is in doubt, MAC with
//! modes at known points near by, which are followed to the reference once for all samples; continuation of the mode itself where that is
//! in doubt too. Most samples need no matrices.

use cea::{EigenSolver, Mode, Modes, Workspace, real_count};
use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use tracking::{OwnedPath, Path, PathEnd, PathStart, clear_matches};

use super::known_names::KnownNames;
use super::scratch::{Memory, timed};
use super::sector_modes::{SectorModes, UnstableSectorMode};
use super::{BandMode, KnownMode, ModeIdentity, ModeLabel, Plan, Reference};
use crate::Error;

/// Data by which the modes of a scene are named.
pub(super) struct BandNames<'a> {
    pub solver: &'a dyn EigenSolver,
    pub plan: &'a Plan,
    pub reference: &'a Reference,
    /// Names of modes at known points.
    pub known: &'a KnownNames,
    /// Modes are named by MAC with those of the origin too.
    pub likeness_too: bool,
}

/// Start of the path on which modes in doubt are followed.
pub(super) enum BandStart<'a> {
    System(Box<SecondOrder>),
    /// Path from the system to the reference, which the brake evaluates.
    Owned(Box<dyn OwnedPath + 'a>),
}

impl<'a> BandNames<'a> {
    /// The modes found in one sample, the unstable ones with names. `mass` is its mass matrix; `start` makes its system, or a cheaper way
    /// to follow modes from there, and `from_known` a path from a known point, where they are needed.
    ///
    /// # Errors
    /// A system that cannot be made; those of the solver.
    pub fn sector_modes(
        &self,
        found: Vec<BandMode>,
        mass: &DMatrix<f64>,
        start: impl FnOnce() -> Result<BandStart<'a>, Error>,
        from_known: impl Fn(&KnownMode) -> Option<Box<dyn OwnedPath + 'a>>,
        memory: &mut Memory,
    ) -> Result<SectorModes, Error> {
        let margin = |mode: &BandMode| self.plan.threshold.margin(mode.lambda);
        let studied = found.into_iter().filter(|mode| self.plan.is_studied(mode.lambda));
        let (real, studied): (Vec<BandMode>, Vec<BandMode>) = studied.partition(|mode| real_count(mode.lambda) > 0);
        let is_open = |mode: &&BandMode| margin(mode).abs() <= mode.bound || mode.bound.is_nan();
        let undecided_real = real.iter().filter(is_open).count() as u32;
        let undecided = studied.iter().filter(is_open).count() as u32 + undecided_real;
        let divergent = real.iter().filter(|mode| margin(mode) > mode.bound).map(|mode| mode.lambda.re).collect();
        let unstable: Vec<usize> = (0..studied.len()).filter(|&at| margin(&studied[at]) > studied[at].bound).collect();
        let mode = |&at: &usize| Mode::weighted(mass, studied[at].lambda, studied[at].shape.clone());
        let (modes, weighted): (Vec<Mode>, Vec<_>) = unstable.iter().map(mode).unzip();
        let Memory { work, spent, .. } = memory;
        let like: Vec<Option<KnownMode>> = unstable.iter().map(|&at| studied[at].like).collect();
        let names = timed(&mut spent.names, || self.names((&modes, &weighted), &like, mass, start, from_known, work))?;
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
        Ok(SectorModes { modes, unstable, divergent, undecided, undecided_real, marginal: 0 })
    }

    /// The names of some modes of a system, with M phi of each; `like` is the known mode that each resembles, if any.
    fn names(
        &self,
        (modes, weighted): (&[Mode], &[DVector<Complex<f64>>]),
        like: &[Option<KnownMode>],
        mass: &DMatrix<f64>,
        start: impl FnOnce() -> Result<BandStart<'a>, Error>,
        from_known: impl Fn(&KnownMode) -> Option<Box<dyn OwnedPath + 'a>>,
        work: &mut Workspace,
    ) -> Result<Vec<Vec<ModeLabel>>, Error> {
        if self.plan.mode_identity == ModeIdentity::Mac {
            return Ok(self.reference.names_by_likeness(modes).unwrap_or_default());
        }
        let clear: Option<Vec<usize>> = clear_matches(modes, weighted, &self.reference.modes).into_iter().collect();
        if let Some(clear) = clear {
            return Ok(clear.into_iter().map(|to| self.reference.names_of([to])).collect());
        }
        let mut by_known = |like: &Option<KnownMode>| match like {
            Some(known) => self.known_names(known, mass, &from_known, work),
            None => Ok(None),
        };
        let mut names = like.iter().map(&mut by_known).collect::<Result<Vec<_>, Error>>()?;
        // Each was followed by itself, perhaps from another point: two modes of one sample that have a name in common are followed together.
        for at in shared(&names) {
            names[at] = None;
        }
        let open = modes.iter().zip(&names).filter(|(_, names)| names.is_none());
        let open: Vec<Mode> = open.map(|(mode, _)| mode.clone()).collect();
        let followed = if open.is_empty() { Vec::new() } else { self.followed(&open, mass, start()?, work)? };
        let mut followed = followed.into_iter();
        Ok(names.into_iter().map(|names| names.or_else(|| followed.next()).unwrap_or_default()).collect())
    }

    /// The names of a mode at a known point, followed to the reference once for all samples; `None` where the brake cannot follow it.
    fn known_names(
        &self,
        known: &KnownMode,
        mass: &DMatrix<f64>,
        path: &impl Fn(&KnownMode) -> Option<Box<dyn OwnedPath + 'a>>,
        work: &mut Workspace,
    ) -> Result<Option<Vec<ModeLabel>>, Error> {
        self.known.of(known, || {
            let Some(path) = path(known) else { return Ok(None) };
            let Some((step, shape)) = path.correct(0.0, known.lambda) else { return Ok(None) };
            let mode = Mode::normalised(mass, step.lambda, shape);
            let names = self.followed(&[mode], mass, BandStart::Owned(path), work)?;
            Ok(Some(names.concat()))
        })
    }

    /// The names of some modes of a system, followed from there to the reference.
    fn followed(
        &self,
        modes: &[Mode],
        mass: &DMatrix<f64>,
        start: BandStart<'a>,
        work: &mut Workspace,
    ) -> Result<Vec<Vec<ModeLabel>>, Error> {
        let known = self.reference;
        let end = PathEnd { system: &known.system, modes: &known.modes };
        let start = match &start {
            BandStart::System(system) => PathStart::System(system),
            BandStart::Owned(path) => PathStart::Owned(mass, path.as_ref()),
        };
        let path = Path { start, start_modes: modes, end };
        Ok(known.names_of_all(self.solver, &[path], self.plan.mode_identity, work).remove(0)?)
    }
}

/// Indices of the modes that have a name in common with another one.
fn shared(names: &[Option<Vec<ModeLabel>>]) -> Vec<usize> {
    let have = |other: usize, name: &ModeLabel| names[other].as_ref().is_some_and(|names| names.contains(name));
    let is_shared = |at: &usize| {
        let others = || (0..names.len()).filter(|other| other != at);
        names[*at].iter().flatten().any(|name| others().any(|other| have(other, name)))
    };
    (0..names.len()).filter(is_shared).collect()
}
