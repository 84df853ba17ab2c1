//! The modes of one sector for a block of samples: verdicts on all of them, shapes and names of the unstable ones.

use cea::{
    Anchors, CeaError, CertifiedError, EigenSolver, Gain, GainPath, Growing, Mode, Modes, Secular, Spectrum, Verdict,
    Workspace, is_alone, verdicts_beyond,
};
use linsys::SecondOrder;
use num_complex::Complex;
use tracking::{Path, PathEnd, PathStart};

use super::scratch::{Memory, timed};
use super::{ModeLabel, ModeResidual, Plan, Reference};

/// The modes of one sector in one sample.
#[derive(Debug, Clone)]
pub(super) struct SectorModes {
    /// Modes of the sector. Where the secular equation found the growing ones, the others are approximations in the right order.
    pub modes: Modes,
    /// Unstable modes, beyond the threshold of the plan, ascending in frequency.
    pub unstable: Vec<NamedSectorMode>,
    /// Real eigenvalues that surely are beyond the threshold, 1/s, whether of the structure or of an internal state.
    pub divergent: Vec<f64>,
    /// Oscillating modes whose verdict the error bound leaves open.
    pub undecided: Vec<NamedSectorMode>,
    /// Number of real eigenvalues whose verdict is open too.
    pub undecided_real: u32,
    /// Number of eigenvalues on the axis to within rounding of the matrices.
    pub marginal: u32,
}

/// A mode of one sector that is unstable, or may be.
#[derive(Debug, Clone)]
pub(super) struct NamedSectorMode {
    /// Index of the mode among the oscillating modes of the sector.
    pub index: usize,
    /// Eigenvalue, and shape in the basis of the sector.
    pub mode: Mode,
    /// Candidate names as a tracked mode.
    pub names: Vec<ModeLabel>,
    /// Names by MAC, where the study asks for these too.
    pub names_by_likeness: Option<Vec<ModeLabel>>,
    /// Residual of the mode, where the brake found it itself.
    pub residual: Option<ModeResidual>,
}

/// The growing modes of a sector in one sample, with the gain they were found at; `None` where the secular equation leaves a
/// doubt and a spectrum has to decide.
pub(super) type SecularAnswer = Option<(Gain, Growing)>;

/// A mode with the names that it may have.
pub(super) struct NamedMode {
    pub mode: Mode,
    pub names: Vec<ModeLabel>,
    pub names_by_likeness: Option<Vec<ModeLabel>>,
}

/// Solver of the modes of one sector of a scene.
pub(super) struct SectorSolver<'a> {
    /// Solver of the spectra.
    pub eigen_solver: &'a dyn EigenSolver,
    /// Modes that give the names.
    pub reference: &'a Reference,
    /// Plan, which says which modes are judged.
    pub plan: &'a Plan,
    /// Relative error of eigenvalues against the full model that the brake is a reduction of; see
    /// [`UncertainBrake::error_of_reduction`](crate::UncertainBrake::error_of_reduction).
    pub relative_error: f64,
    /// Secular equation of the sector; `None` where spectra are computed instead, see [`Secular::new`].
    pub equation: Option<SectorEquation<'a>>,
    /// True if modes are named by MAC too.
    pub likeness_too: bool,
}

/// Secular equation of one sector of a scene, with its anchors and the gain of the reference modes.
#[derive(Debug, Clone, Copy)]
pub(super) struct SectorEquation<'a> {
    /// The equation.
    pub secular: &'a Secular,
    /// Gains of the scene with known eigenvalues.
    pub anchors: &'a Anchors,
    /// The gain at which the reference modes were computed: the end of every continuation.
    pub reference: Gain,
}

impl SectorSolver<'_> {
    /// The modes of this sector in samples, one of `systems` each, by their spectra; the unstable ones with names.
    pub fn solve(&self, systems: &[SecondOrder], memory: &mut Memory) -> Vec<Result<SectorModes, CeaError>> {
        // Friction does not act on every sector. Where it does not, the systems of all samples are equal: one is solved.
        if let [first, others @ ..] = systems
            && !others.is_empty()
            && others.iter().all(|other| other == first)
        {
            let modes = self.solve(std::slice::from_ref(first), memory).remove(0);
            return vec![modes; systems.len()];
        }
        let Memory { spectra, work, spent } = memory;
        let judged: Vec<Result<ModesWithVerdicts, CeaError>> = timed(&mut spent.spectra, || {
            self.eigen_solver.eigenvalues_of_all(systems, work, spectra);
            let judge = |(system, spectrum): (&SecondOrder, &Result<Spectrum, CeaError>)| {
                let spectrum = spectrum.as_ref().map_err(CeaError::clone)?;
                ModesWithVerdicts::new(system, spectrum, (self.plan, self.relative_error), work)
            };
            systems.iter().zip(&*spectra).map(judge).collect()
        });
        let lambdas: Vec<Vec<Complex<f64>>> =
            judged.iter().map(|judged| judged.as_ref().map(ModesWithVerdicts::lambdas).unwrap_or_default()).collect();
        let named = self.named_of_systems(systems, &lambdas, memory);
        judged.into_iter().zip(named).map(|(judged, named)| Ok(judged?.with_names(named?))).collect()
    }

    /// Modes of this sector in samples, one of `systems` each, that oscillate and that the plan studies, stable ones too, with their names.
    pub fn every_mode(&self, systems: &[SecondOrder], memory: &mut Memory) -> Vec<Result<Vec<NamedMode>, CeaError>> {
        let Memory { spectra, work, spent } = memory;
        let found: Vec<Result<Vec<Complex<f64>>, CeaError>> = timed(&mut spent.spectra, || {
            self.eigen_solver.eigenvalues_of_all(systems, work, spectra);
            let studied = |(system, spectrum): (&SecondOrder, &Result<Spectrum, CeaError>)| {
                let spectrum = spectrum.as_ref().map_err(CeaError::clone)?;
                check_range(system, spectrum)?;
                let mut oscillatory = Modes::classify(system, spectrum, work)?.oscillatory;
                oscillatory.retain(|lambda| self.plan.is_studied(*lambda));
                Ok(oscillatory)
            };
            systems.iter().zip(&*spectra).map(studied).collect()
        });
        let lambdas: Vec<Vec<Complex<f64>>> =
            found.iter().map(|found| found.as_ref().cloned().unwrap_or_default()).collect();
        let named = self.named_of_systems(systems, &lambdas, memory);
        found.into_iter().zip(named).map(|(found, named)| found.and(named)).collect()
    }

    /// The modes of each of `systems` at its eigenvalues in `lambdas`, with their names.
    fn named_of_systems(
        &self,
        systems: &[SecondOrder],
        lambdas: &[Vec<Complex<f64>>],
        memory: &mut Memory,
    ) -> Vec<Result<Vec<NamedMode>, CeaError>> {
        let Memory { work, spent, .. } = memory;
        let asked: Vec<_> = systems.iter().zip(lambdas.iter().map(Vec::as_slice)).collect();
        let shaped = timed(&mut spent.shapes, || Mode::of_all(&asked, work));
        let starts: Vec<PathStart<'_>> = systems.iter().map(PathStart::System).collect();
        self.named(&starts, shaped, memory)
    }

    /// The modes of this sector in samples, from the growing modes that its secular equation `found` for each; these with names.
    pub fn name_growing(&self, found: &[(Gain, Growing)], memory: &mut Memory) -> Vec<Result<SectorModes, CeaError>> {
        let judged: Vec<ModesWithVerdicts> =
            found.iter().map(|(_, growing)| ModesWithVerdicts::from_growing(growing, self.plan)).collect();
        let lambdas: Vec<(Gain, Vec<Complex<f64>>)> =
            found.iter().zip(&judged).map(|((gain, _), judged)| (*gain, judged.lambdas())).collect();
        let named = self.named_at(&lambdas, memory);
        judged.into_iter().zip(named).map(|(judged, named)| Ok(judged.with_names(named?))).collect()
    }

    /// The modes at the eigenvalues of each gain in `of`, with their names; empty for a sector without a secular equation.
    pub fn named_at(
        &self,
        of: &[(Gain, Vec<Complex<f64>>)],
        memory: &mut Memory,
    ) -> Vec<Result<Vec<NamedMode>, CeaError>> {
        let Some(SectorEquation { secular, reference, .. }) = self.equation else { return Vec::new() };
        let Memory { work, spent, .. } = memory;
        let shaped = timed(&mut spent.shapes, || {
            let asked: Vec<_> = of.iter().map(|(gain, lambdas)| (*gain, &lambdas[..])).collect();
            let mut shaped = Vec::with_capacity(of.len());
            for (modes, (gain, lambdas)) in secular.modes(&asked, work).into_iter().zip(of) {
                shaped.push(match modes {
                    Some(modes) => Ok(modes),
                    None => Mode::at(&secular.system(gain), lambdas, work),
                });
            }
            shaped
        });
        let start = |&(from, _): &(Gain, _)| PathStart::Gain(GainPath { secular, from, to: reference });
        self.named(&of.iter().map(start).collect::<Vec<_>>(), shaped, memory)
    }

    /// Names modes by the reference, following each from its own system to it where modes are known by continuation.
    fn named(
        &self,
        starts: &[PathStart<'_>],
        shaped: Vec<Result<Vec<Mode>, CeaError>>,
        memory: &mut Memory,
    ) -> Vec<Result<Vec<NamedMode>, CeaError>> {
        let Memory { work, spent, .. } = memory;
        let end = PathEnd { system: &self.reference.system, modes: &self.reference.modes };
        let modes = shaped.iter().map(|modes| modes.as_deref().unwrap_or_default());
        let paths: Vec<Path<'_>> =
            starts.iter().zip(modes).map(|(&start, start_modes)| Path { start, start_modes, end }).collect();
        let identity = self.plan.mode_identity;
        let names = timed(&mut spent.names, || self.reference.names_of_all(self.eigen_solver, &paths, identity, work));
        let with_names = |(modes, names): (Result<Vec<Mode>, CeaError>, Result<Names, CeaError>)| {
            let modes = modes?;
            let by_likeness = if self.likeness_too { self.reference.names_by_likeness(&modes) } else { None };
            let mut by_likeness = by_likeness.into_iter().flatten();
            let named = modes.into_iter().zip(names?);
            Ok(named.map(|(mode, names)| NamedMode { mode, names, names_by_likeness: by_likeness.next() }).collect())
        };
        shaped.into_iter().zip(names).map(with_names).collect()
    }
}

/// Refuses a spectrum with entries that are not finite: squares of large entries overflow, and an eigenvalue that is no number is in
/// none of the lists of modes.
///
/// # Errors
/// [`CertifiedError::Range`].
pub fn check_range(system: &SecondOrder, spectrum: &Spectrum) -> Result<(), CeaError> {
    if spectrum.scale.is_finite() && spectrum.eigenvalues.iter().all(|lambda| lambda.is_finite()) {
        return Ok(());
    }
    let entries = [&system.m, &system.c, &system.k].into_iter().flat_map(|a| a.iter()).map(|x| x.abs());
    let (smallest, largest) =
        entries.filter(|x| *x > 0.0).fold((f64::INFINITY, 0.0_f64), |(least, most), x| (least.min(x), most.max(x)));
    Err(CertifiedError::Range { smallest, largest }.into())
}

/// Candidate names of modes, one list for each mode.
type Names = Vec<Vec<ModeLabel>>;

/// The modes of one system, with verdicts.
struct ModesWithVerdicts {
    modes: Modes,
    /// Indices of the unstable ones among the oscillating modes.
    unstable: Vec<usize>,
    /// Indices of the modes whose verdict is open.
    undecided: Vec<usize>,
    /// Divergent eigenvalues and counts as in [`SectorModes`].
    divergent: Vec<f64>,
    undecided_real: u32,
    marginal: u32,
}

impl ModesWithVerdicts {
    fn from_growing(Growing { modes, .. }: &Growing, plan: &Plan) -> Self {
        let is_unstable = |lambda: Complex<f64>| plan.threshold.margin(lambda) > 0.0 && plan.is_studied(lambda);
        let unstable = (0..modes.len()).filter(|&index| is_unstable(modes[index])).collect();
        let modes = Modes { oscillatory: modes.clone(), real: Vec::new(), internal: Vec::new() };
        // All modes oscillate: none diverges.
        Self { modes, unstable, divergent: Vec::new(), undecided: Vec::new(), undecided_real: 0, marginal: 0 }
    }

    /// The modes of a spectrum, whose eigenvalues have this relative error beside the error of the solver.
    fn new(
        system: &SecondOrder,
        spectrum: &Spectrum,
        (plan, relative_error): (&Plan, f64),
        work: &mut Workspace,
    ) -> Result<Self, CeaError> {
        check_range(system, spectrum)?;
        let modes = Modes::classify(system, spectrum, work)?;
        let mut judged = Self {
            modes,
            unstable: Vec::new(),
            divergent: Vec::new(),
            undecided: Vec::new(),
            undecided_real: 0,
            marginal: 0,
        };
        let oscillatory = &judged.modes.oscillatory;
        let studied: Vec<usize> = (0..oscillatory.len()).filter(|&index| plan.is_studied(oscillatory[index])).collect();
        // What does not oscillate grows as well: the structure's real eigenvalues, and states that friction has made grow.
        let internal = judged.modes.internal.iter().filter(|lambda| lambda.re > 0.0 && lambda.im >= 0.0);
        let real = judged.modes.real.iter().map(|&re| Complex::from(re)).chain(internal.copied());
        let lambdas: Vec<Complex<f64>> = studied
            .iter()
            .map(|&index| oscillatory[index])
            .chain(real.filter(|lambda| plan.is_studied(*lambda)))
            .collect();
        let verdicts = verdicts_beyond(&plan.threshold, system, &lambdas, spectrum, work)?;
        let known: Vec<_> = lambdas.iter().map(|&lambda| (lambda, relative_error * lambda.norm())).collect();
        for (at, (&lambda, verdict)) in lambdas.iter().zip(verdicts).enumerate() {
            let margin = plan.threshold.margin(lambda).abs();
            let is_open = relative_error > 0.0 && margin <= relative_error * lambda.norm();
            match (verdict, studied.get(at)) {
                // What is on the axis with this basis is it with all of the model, unless it may have met another one there.
                (Verdict::Marginal { .. }, _) if !is_open || is_alone(&known, at) => judged.marginal += 1,
                (Verdict::Marginal { .. }, Some(&index)) => judged.undecided.push(index),
                (Verdict::Marginal { .. }, None) => judged.undecided_real += 1,
                (Verdict::Undecided { .. }, Some(&index)) => judged.undecided.push(index),
                (Verdict::Undecided { .. }, None) => judged.undecided_real += 1,
                (_, Some(&index)) if is_open => judged.undecided.push(index),
                (_, None) if is_open => judged.undecided_real += 1,
                (Verdict::Unstable, Some(&index)) => judged.unstable.push(index),
                (Verdict::Unstable, None) => judged.divergent.push(lambda.re),
                (Verdict::Stable, _) => {}
            }
        }
        Ok(judged)
    }

    /// Eigenvalues of the modes that are to be named: unstable modes, then modes whose verdict is open.
    fn lambdas(&self) -> Vec<Complex<f64>> {
        self.unstable.iter().chain(&self.undecided).map(|&index| self.modes.oscillatory[index]).collect()
    }

    fn with_names(self, named: Vec<NamedMode>) -> SectorModes {
        let mode = |(index, NamedMode { mode, names, names_by_likeness })| NamedSectorMode {
            index,
            mode,
            names,
            names_by_likeness,
            residual: None,
        };
        let Self { modes, unstable, divergent, undecided, undecided_real, marginal } = self;
        let mut named = named.into_iter();
        let unstable = unstable.into_iter().zip(named.by_ref()).map(mode).collect();
        let undecided = undecided.into_iter().zip(named).map(mode).collect();
        SectorModes { modes, unstable, divergent, undecided, undecided_real, marginal }
    }
}
