//! Names of the modes that a brake finds itself: by MAC with the modes of the reference and, where one is in doubt, by continuation of all, in fewer
//! coordinates where the brake has some. Most samples need no matrices.

use cea::{EigenSolver, Mode, Modes, Verdict, Workspace, real_count};
use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use tracking::{Path, PathEnd, PathStart, clear_matches};

use super::reference::on_basis;
use super::scratch::{Memory, timed};
use super::sector_modes::{NamedSectorMode, SectorModes};
use super::{BandMode, CoarsePath, ModeIdentity, ModeLabel, Plan, Reference};
use crate::Error;

/// Data by which the modes of a scene are named.
pub(super) struct BandNames<'a> {
    pub solver: &'a dyn EigenSolver,
    pub plan: &'a Plan,
    pub reference: &'a Reference,
    /// True if modes are also named by MAC with the modes of the origin.
    pub likeness_too: bool,
}

impl BandNames<'_> {
    /// The modes found in one sample; modes that are unstable, or may be, have names. `mass` is its mass matrix; `coarse` and `system` make the
    /// paths to the reference, where they are needed.
    ///
    /// # Errors
    /// A system that cannot be made; errors of the solver.
    pub fn sector_modes<'p>(
        &self,
        found: Vec<BandMode>,
        mass: &DMatrix<f64>,
        coarse: impl FnOnce() -> Result<Option<CoarsePath<'p>>, Error>,
        system: impl FnOnce() -> Result<SecondOrder, Error>,
        memory: &mut Memory,
    ) -> Result<SectorModes, Error> {
        let verdict = |mode: &BandMode| mode.verdict(&self.plan.threshold);
        let studied = found.into_iter().filter(|mode| self.plan.is_studied(mode.lambda));
        let (real, studied): (Vec<BandMode>, Vec<BandMode>) = studied.partition(|mode| real_count(mode.lambda) > 0);
        let grows = |mode: &&BandMode| verdict(mode) == Verdict::Unstable;
        let is_open = |mode: &&BandMode| matches!(verdict(mode), Verdict::Undecided { .. });
        let marginal = studied.iter().filter(|mode| matches!(verdict(mode), Verdict::Marginal { .. })).count() as u32;
        let undecided_real = real.iter().filter(is_open).count() as u32;
        let divergent = real.iter().filter(grows).map(|mode| mode.lambda.re).collect();
        let mut to_name: Vec<usize> = (0..studied.len()).filter(|&at| grows(&&studied[at])).collect();
        let unstable = to_name.len();
        to_name.extend((0..studied.len()).filter(|&at| is_open(&&studied[at])));
        let mode = |&at: &usize| Mode::weighted(mass, studied[at].lambda, studied[at].shape.clone());
        let (modes, weighted): (Vec<Mode>, Vec<_>) = to_name.iter().map(mode).unzip();
        let Memory { work, spent, .. } = memory;
        let names = timed(&mut spent.names, || self.names((&modes, &weighted), coarse, system, work))?;
        let by_likeness = if self.likeness_too { self.reference.names_by_likeness(&modes) } else { None };
        let mut by_likeness = by_likeness.into_iter().flatten();
        let named = to_name.iter().zip(modes).zip(names);
        let mut named = named.map(|((&index, mode), names)| {
            let (names_by_likeness, residual) = (by_likeness.next(), studied[index].residual);
            NamedSectorMode { index, mode, names, names_by_likeness, residual }
        });
        let unstable = named.by_ref().take(unstable).collect();
        let undecided = named.collect();
        let oscillatory = studied.iter().map(|mode| mode.lambda).collect();
        let modes = Modes { oscillatory, real: Vec::new(), internal: Vec::new() };
        Ok(SectorModes { modes, unstable, divergent, undecided, undecided_real, marginal })
    }

    /// The names of `modes` of a system, given with M phi of each.
    fn names<'p>(
        &self,
        (modes, weighted): (&[Mode], &[DVector<Complex<f64>>]),
        coarse: impl FnOnce() -> Result<Option<CoarsePath<'p>>, Error>,
        system: impl FnOnce() -> Result<SecondOrder, Error>,
        work: &mut Workspace,
    ) -> Result<Vec<Vec<ModeLabel>>, Error> {
        if self.plan.mode_identity == ModeIdentity::Mac {
            return Ok(self.reference.names_by_likeness(modes).unwrap_or_default());
        }
        let known = self.reference;
        let clear: Option<Vec<usize>> = clear_matches(modes, weighted, &known.modes).into_iter().collect();
        if let Some(clear) = clear {
            return Ok(clear.into_iter().map(|to| known.names_of([to])).collect());
        }
        let named = |from: &SecondOrder, modes: &[Mode], to: &Reference, work: &mut Workspace| {
            let end = PathEnd { system: &to.system, modes: &to.modes };
            let path = Path { start: PathStart::System(from), start_modes: modes, end };
            Ok(to.names_of_all(self.solver, &[path], self.plan.mode_identity, work).remove(0)?)
        };
        if let Some(CoarsePath { systems: [from, to], basis }) = coarse()? {
            let projected = modes.iter().map(|mode| on_basis(mode, &from, basis)).collect::<Option<Vec<Mode>>>();
            if let Some(modes) = projected {
                return named(&from, &modes, &known.on_basis(to, basis), work);
            }
        }
        named(&system()?, modes, known, work)
    }
}
