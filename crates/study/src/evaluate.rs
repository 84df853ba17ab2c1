//! Study: a brake ready to be sampled, with the data that all samples share.

mod every_mode;
mod samples;

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use cea::{Anchors, EigenSolver, Gain, WholeSpectra};
use linsys::OperatingPoint;
use montecarlo::{Progress, StreamRng};
use num_complex::Complex;
use work::ModeWork;

use super::certificate::{Certificate, certificates};
use super::check::check;
use super::reference::{Reference, References, SectoredReference, references};
use super::scratch::{Scratch, timed};
use super::sector_modes::{SectorEquation, SectorSolver};
use super::secular_equations::{SecularEquations, anchors, equations};
use super::{ModeIdentity, ModeLabel, ModeResidual, Plan, Scene, UncertainBrake};
use crate::Error;

pub use every_mode::SampledMode;

/// Outcome of one complex eigenvalue analysis (CEA) of a study.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Outcome {
    /// Unstable modes, ascending in frequency: their growth beyond [`Plan::threshold`] is more than its error bound.
    pub unstable: Vec<UnstableMode>,
    /// The largest growth rate of an unstable mode or of a divergence, 1/s; 0 where nothing is unstable.
    pub growth: f64,
    /// Number of real eigenvalues that grow beyond the threshold by more than their bounds: divergence.
    pub divergent: u32,
    /// Largest eigenvalue that diverges, 1/s; 0 where none diverges.
    pub divergence: f64,
    /// Number of eigenvalues whose verdict the error bound leaves open, conjugate pairs once.
    pub undecided: u32,
    /// Modes whose verdict the error bound leaves open: the undecided eigenvalues that oscillate.
    pub open: Vec<OpenMode>,
    /// Number of the undecided eigenvalues that are real: they may be divergence.
    pub undecided_real: u32,
    /// Number of eigenvalues on the imaginary axis to within rounding of the matrices, conjugate pairs once: they neither grow
    /// nor decay.
    pub marginal: u32,
    /// True if the system was certified to be stable without a spectrum.
    pub is_certified: bool,
}

/// Mode of a CEA that may be unstable, or not.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenMode {
    /// Frequency rank in this CEA, from 1.
    pub rank: ModeLabel,
    /// Im lambda, rad/s.
    pub omega: f64,
    /// Candidate names, as an unstable mode has them.
    pub names: Vec<ModeLabel>,
    /// Names by MAC, as an unstable mode has them.
    pub names_by_likeness: Option<Vec<ModeLabel>>,
}

/// Unstable mode of a CEA.
#[derive(Debug, Clone, PartialEq)]
pub struct UnstableMode {
    /// Frequency rank in this CEA, from 1.
    pub rank: ModeLabel,
    /// Eigenvalue lambda, rad/s.
    pub lambda: Complex<f64>,
    /// Candidate names as a tracked mode: one; several near a coalescence; empty where no name is known.
    pub names: Vec<ModeLabel>,
    /// Names by MAC, more than one half with the shape at the origin of names; in a study with [`StudyOptions::likeness_too`].
    pub names_by_likeness: Option<Vec<ModeLabel>>,
    /// Work in one period on each body; `None` in scenes that do not want it.
    pub work: Option<ModeWork>,
    /// Residual in the full model that the brake is a reduction of; `None` for a brake that is not reduced.
    pub residual: Option<ModeResidual>,
}

/// Options of the preparation of a study. None of them changes a verdict, or a name but to an open one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct StudyOptions {
    /// True if regions of friction are certified to be stable before anything is sampled, so that the samples in them are not searched. That takes three
    /// norm bounds for each configuration, which few samples do not earn back.
    pub certificates: bool,
    /// True if growing modes are found, and names continued, by secular equations where friction is alike in all channels. Without these, spectra and
    /// matrices take their place, which leave some more names next to coalescences open.
    pub secular: bool,
    /// True if modes that are known by continuation are named by MAC too ([`ModeIdentity::Mac`]).
    pub likeness_too: bool,
}

impl Default for StudyOptions {
    fn default() -> Self {
        Self { certificates: true, secular: true, likeness_too: false }
    }
}

/// A brake, ready to be sampled.
pub struct Study<'a, B: UncertainBrake> {
    brake: &'a B,
    solver: WholeSpectra<'a>,
    /// Modes of each origin, by its index in [`Plan::origins`], from where names are continued.
    origin_references: Arc<[Reference]>,
    references: Arc<[Reference]>,
    sector_references: Vec<Vec<Reference>>,
    certificates: Vec<Certificate>,
    /// Secular equations of each configuration.
    equations: Vec<SecularEquations>,
    /// Anchors of the secular equations, by scene and sector.
    anchors: Vec<Vec<Option<Anchors>>>,
    /// Operating point of each scene at median parameters, at which its reference modes were computed.
    reference_points: Vec<OperatingPoint>,
    /// Gain of each scene at its reference point; `None` where the channels have none in common.
    reference_gains: Vec<Option<Gain>>,
    options: StudyOptions,
    /// Number of gains that secular equations answered, and of spectra, of all samples so far.
    answered: [AtomicU64; 2],
}

impl<'a, B: UncertainBrake> Study<'a, B> {
    /// Computes the data that all samples share: the reference modes of every scene, and for every configuration the certificates, the
    /// secular equations and their anchors.
    ///
    /// # Errors
    /// A [`Contradiction`](super::Contradiction) of the brake; its other errors and errors of the solver. Memory and time that the study
    /// takes are not checked here: see [`Cost::check`](super::Cost::check).
    pub fn new(brake: &'a B, solver: &'a dyn EigenSolver) -> Result<Self, Error> {
        Self::with_progress(brake, solver, &())
    }

    /// Study as by [`Study::new`], with its progress reported.
    ///
    /// # Errors
    /// As [`Study::new`].
    pub fn with_progress(brake: &'a B, solver: &'a dyn EigenSolver, progress: &dyn Progress) -> Result<Self, Error> {
        Self::with_options(brake, solver, StudyOptions::default(), progress)
    }

    /// Study as by [`Study::with_progress`], prepared with `options`.
    ///
    /// # Errors
    /// As [`Study::new`].
    pub fn with_options(
        brake: &'a B,
        solver: &'a dyn EigenSolver,
        options: StudyOptions,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        let plan = brake.plan();
        // One step for each configuration, two for each scene: its reference and its anchors.
        progress.begin((plan.configurations.len() + 2 * plan.scenes.len()) as u64, 0);
        let study = Self::prepared(brake, solver, options, progress);
        progress.end();
        study
    }

    fn prepared(
        brake: &'a B,
        solver: &'a dyn EigenSolver,
        options: StudyOptions,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        check(brake)?;
        let (plan, solver) = (brake.plan(), WholeSpectra(solver));
        let failed = |source: Error| match source.is_cancelled() {
            true => source,
            false => Error::Median { study: plan.source(), source: Box::new(source) },
        };
        let median = brake.median();
        let at_median = |scene: &Scene| brake.operating_point(scene, &median);
        let points = plan.scenes.iter().map(at_median).collect::<Result<Vec<_>, Error>>().map_err(failed)?;
        let by_likeness = options.likeness_too || plan.mode_identity == ModeIdentity::Mac;
        let source = brake.mode_source();
        let References { origins, scenes } =
            references(plan, &points, source, by_likeness, &solver, progress).map_err(failed)?;
        let (references, sector_references): (Vec<_>, Vec<_>) =
            scenes.into_iter().map(|SectoredReference { whole, sectors }| (whole, sectors)).unzip();
        // Certificates and secular equations know the reduced brake alone, and not its error against the full model.
        let is_reduced = source.is_some() || plan.scenes.iter().any(|scene| brake.error_of_reduction(scene) > 0.0);
        let certificates = match options.certificates && !is_reduced {
            true => certificates(brake, progress)?,
            false => vec![Certificate::default(); plan.configurations.len()],
        };
        let equations = match options.secular && !is_reduced {
            true => equations(&plan.configurations, progress)?,
            false => plan.configurations.iter().map(SecularEquations::none).collect(),
        };
        let anchors = anchors(brake, &equations, &certificates, &solver, progress)?;
        let reference_gain = |(scene, at): (&Scene, &OperatingPoint)| equations[scene.configuration].gain(at);
        let reference_gains = plan.scenes.iter().zip(&points).map(reference_gain).collect();
        Ok(Self {
            origin_references: origins.into(),
            references: references.into(),
            sector_references,
            certificates,
            equations,
            anchors,
            reference_points: points,
            reference_gains,
            options,
            answered: Default::default(),
            brake,
            solver,
        })
    }

    /// Number of answers by the route on which the modes of samples were found so far, by its name: of the equations of all sectors, of
    /// spectra, of samples of a brake that finds its modes itself.
    pub fn routes(&self) -> Vec<(&'static str, u64)> {
        match self.brake.mode_source() {
            Some(source) => source.routes(),
            None => ["secular equations", "spectra"]
                .into_iter()
                .zip(self.answered.iter().map(|count| count.load(Ordering::Relaxed)))
                .collect(),
        }
    }

    /// The brake.
    pub fn brake(&self) -> &'a B {
        self.brake
    }

    /// The plan.
    pub fn plan(&self) -> &'a Plan {
        self.brake.plan()
    }

    /// The modes of each origin, each named by its frequency rank there.
    pub fn origin_references(&self) -> &[Reference] {
        &self.origin_references
    }

    /// The reference of each scene.
    pub fn references(&self) -> &[Reference] {
        &self.references
    }

    /// The modes of each origin, for results that outlive the study.
    pub fn shared_origin_references(&self) -> Arc<[Reference]> {
        Arc::clone(&self.origin_references)
    }

    /// The reference of each scene, for results that outlive the study.
    pub fn shared_references(&self) -> Arc<[Reference]> {
        Arc::clone(&self.references)
    }

    /// The reference of each scene with its modes named by MAC; `None` of a study that does not ask for these names.
    pub fn references_by_likeness(&self) -> Option<Vec<Reference>> {
        self.references.iter().map(Reference::named_by_likeness).collect()
    }

    /// The reference of each sector of each scene, in the order of its configuration's sectors.
    pub fn sector_references(&self) -> &[Vec<Reference>] {
        &self.sector_references
    }

    /// The certificate of each configuration.
    pub fn certificates(&self) -> &[Certificate] {
        &self.certificates
    }

    /// The secular equations of the configuration of a scene.
    pub(super) fn equations(&self, scene: usize) -> &SecularEquations {
        &self.equations[self.plan().scenes[scene].configuration]
    }

    /// Solvers of the sectors of a scene.
    pub(super) fn solvers(&self, scene: usize) -> Vec<SectorSolver<'_>> {
        let equations = &self.equations(scene).sectors;
        let each = self.sector_references[scene].iter().zip(equations).zip(&self.anchors[scene]);
        let gain = self.reference_gains[scene];
        let relative_error = self.brake.error_of_reduction(&self.plan().scenes[scene]);
        let solvers = each.map(|((reference, secular), anchors)| SectorSolver {
            eigen_solver: &self.solver,
            reference,
            plan: self.plan(),
            likeness_too: self.options.likeness_too,
            relative_error,
            equation: secular
                .as_ref()
                .zip(anchors.as_ref())
                .zip(gain)
                .map(|((secular, anchors), reference)| SectorEquation { secular, anchors, reference }),
        });
        solvers.collect()
    }
}

impl<B: UncertainBrake> montecarlo::Experiment for Study<'_, B> {
    type Sample = B::Sample;
    type Outcome = Outcome;
    type Error = Error;
    type Scratch = Scratch;

    fn scenes(&self) -> usize {
        self.plan().scenes.len()
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<B::Sample, Error> {
        self.brake.draw(rng)
    }

    fn evaluate(&self, scene: usize, sample: &B::Sample, scratch: &mut Scratch) -> Result<Outcome, Error> {
        let mut outcomes = Vec::with_capacity(1);
        self.evaluate_block(scene, &[sample], scratch, &mut outcomes);
        outcomes.remove(0)
    }

    fn evaluate_block(
        &self,
        scene: usize,
        samples: &[&B::Sample],
        scratch: &mut Scratch,
        out: &mut Vec<Result<Outcome, Error>>,
    ) {
        let of_scene = &self.plan().scenes[scene];
        let certificate = &self.certificates[of_scene.configuration];
        let (mut open, mut points) = (Vec::with_capacity(samples.len()), Vec::with_capacity(samples.len()));
        let mut outcomes = Vec::with_capacity(samples.len());
        timed(&mut scratch.memory.spent.states, || {
            for (at, point) in self.brake.operating_points(of_scene, samples).into_iter().enumerate() {
                outcomes.push(point.map(|point| {
                    let is_certified = certificate.covers(&point);
                    if !is_certified {
                        open.push(at);
                        points.push(point);
                    }
                    Outcome { is_certified, ..Outcome::default() }
                }));
            }
        });
        let found = match self.brake.mode_source() {
            Some(source) => self.band_samples(source, scene, &points, scratch),
            None => {
                let before = scratch.memory.work.counters;
                let found = self.open_samples(scene, &points, scratch);
                let after = scratch.memory.work.counters;
                self.answered[0].fetch_add(after.secular_answers - before.secular_answers, Ordering::Relaxed);
                self.answered[1].fetch_add(after.eigenvalue_solves - before.eigenvalue_solves, Ordering::Relaxed);
                found
            }
        };
        for (at, outcome) in open.into_iter().zip(found) {
            outcomes[at] = outcome;
        }
        out.append(&mut outcomes);
    }
}
