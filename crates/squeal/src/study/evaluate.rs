//! The evaluation of a block of samples in one scene: certificates first, then growing modes and their names sector by sector,
//! then net work.

use std::borrow::Cow;

use cea::{Anchors, CeaError, EigenSolver, Gain, Growing, Mode, ranks_together};
use linsys::{OperatingPoint, SecondOrder};
use montecarlo::{Progress, StreamRng};
use nalgebra::DMatrix;
use num_complex::Complex;
use work::ModeWork;

use super::band::{BandNames, BandStart};
use super::certificate::{Certificate, certificates};
use super::cost::Cost;
use super::known_names::KnownNames;
use super::memory::{Scratch, timed};
use super::net_work::work_with;
use super::reference::{Bridges, Reference, References, SectoredReference, references};
use super::sector_modes::{SectorEquation, SectorModes, SectorSolver, SecularAnswer, UnstableSectorMode};
use super::secular_equations::{SecularEquations, anchors, equations, growing_modes};
use super::{BandMode, KnownMode, ModeIdentity, ModeLabel, ModeResidual, Plan, Scene, UncertainBrake};
use crate::Error;

/// The result of one complex eigenvalue analysis (CEA) of a study.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Outcome {
    /// The unstable modes, ascending in frequency: those that surely are beyond [`Plan::threshold`].
    pub unstable: Vec<UnstableMode>,
    /// The largest growth rate of an unstable mode or of a divergence, 1/s; 0 where there is none.
    pub growth: f64,
    /// Real eigenvalues of the structure above zero, and beyond the threshold: divergence.
    pub divergent: u32,
    /// Number of modes whose verdict the error bound leaves open.
    pub undecided: u32,
    /// Whether the system was certified to be stable without a spectrum.
    pub is_certified: bool,
}

/// One unstable mode of one CEA.
#[derive(Debug, Clone, PartialEq)]
pub struct UnstableMode {
    /// Frequency rank in this CEA, from 1.
    pub rank: ModeLabel,
    /// Growth rate, Re lambda, 1/s.
    pub growth: f64,
    /// Names it may have as a tracked mode: one, or several near a coalescence, or none.
    pub names: Vec<ModeLabel>,
    /// Names by likeness beside these; in a study with [`StudyOptions::likeness_too`].
    pub names_by_likeness: Option<Vec<ModeLabel>>,
    /// Work in one period on each body; in scenes that want it.
    pub work: Option<ModeWork>,
    /// Its residual in the system that the brake is a reduction of; `None` of a brake that is none.
    pub residual: Option<ModeResidual>,
}

/// How a study is prepared. Neither changes a verdict or a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StudyOptions {
    /// Whether regions of friction are certified to be stable before anything is sampled, so that the samples in them are not
    /// searched. That takes three norm bounds for each configuration, which few samples do not earn back.
    pub certificates: bool,
    /// Whether modes that are known by continuation are named by likeness too ([`ModeIdentity::Mac`]).
    pub likeness_too: bool,
}

impl Default for StudyOptions {
    fn default() -> Self {
        Self { certificates: true, likeness_too: false }
    }
}

/// A brake, ready to be sampled.
pub struct Study<'a, B: UncertainBrake> {
    brake: &'a B,
    solver: &'a dyn EigenSolver,
    /// By origin.
    origin_references: Vec<Reference>,
    references: Vec<Reference>,
    sector_references: Vec<Vec<Reference>>,
    certificates: Vec<Certificate>,
    /// By configuration.
    equations: Vec<SecularEquations>,
    /// By scene and sector.
    anchors: Vec<Vec<Option<Anchors>>>,
    /// By scene, of a brake that finds its modes itself.
    known_names: Vec<KnownNames>,
    /// By scene: where its reference modes were computed.
    reference_points: Vec<OperatingPoint>,
    /// By scene: the gain there.
    reference_gains: Vec<Option<Gain>>,
    options: StudyOptions,
}

impl<'a, B: UncertainBrake> Study<'a, B> {
    /// Computes what all samples share: the reference modes of every scene, and for every configuration the certificates, the
    /// secular equations and their anchors.
    ///
    /// # Errors
    /// Those of the brake and of the solver; a study that would take more memory than [`Cost::MOST_BYTES`].
    pub fn new(brake: &'a B, solver: &'a dyn EigenSolver) -> Result<Self, Error> {
        Self::with_progress(brake, solver, &())
    }

    /// As [`Study::new`], prepared in another way.
    ///
    /// # Errors
    /// As [`Study::new`].
    pub fn with_options(brake: &'a B, solver: &'a dyn EigenSolver, options: StudyOptions) -> Result<Self, Error> {
        Self::prepared(brake, solver, options, &())
    }

    /// As [`Study::new`], and tells how far it has come.
    ///
    /// # Errors
    /// As [`Study::new`].
    pub fn with_progress(brake: &'a B, solver: &'a dyn EigenSolver, progress: &dyn Progress) -> Result<Self, Error> {
        let plan = brake.plan();
        // One step for each configuration, two for each scene: its reference and its anchors.
        progress.begin((plan.configurations.len() + 2 * plan.scenes.len()) as u64, 0);
        let study = Self::prepared(brake, solver, StudyOptions::default(), progress);
        progress.end();
        study
    }

    fn prepared(
        brake: &'a B,
        solver: &'a dyn EigenSolver,
        options: StudyOptions,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        let plan = brake.plan();
        Cost::of(plan).check(&plan.source())?;
        let failed = |source| Error::Median { study: plan.source(), source: Box::new(source) };
        let median = brake.median();
        let at_median = |scene: &Scene| brake.operating_point(scene, &median);
        let points = plan.scenes.iter().map(at_median).collect::<Result<Vec<_>, Error>>().map_err(failed)?;
        let by_likeness = options.likeness_too || plan.mode_identity == ModeIdentity::Mac;
        let bridge = |configuration: usize, modes: [&[Mode]; 2]| brake.bridge(configuration, modes);
        let bridge: Option<&Bridges<'_>> = if brake.has_band_modes() { Some(&bridge) } else { None };
        let paths = |scene: &Scene, [from, to]: [&OperatingPoint; 2]| brake.path(scene, from, to);
        let References { origins, scenes } =
            references(plan, &points, bridge, &paths, by_likeness, solver, progress).map_err(failed)?;
        let (references, sector_references) =
            scenes.into_iter().map(|SectoredReference { whole, sectors }| (whole, sectors)).unzip();
        let certificates = match options.certificates && !brake.has_band_modes() {
            true => certificates(brake)?,
            false => vec![Certificate::default(); plan.configurations.len()],
        };
        let equations = match brake.has_band_modes() {
            true => plan.configurations.iter().map(SecularEquations::none).collect(),
            false => equations(&plan.configurations)?,
        };
        let anchors = anchors(brake, &equations, &certificates, solver, progress)?;
        let reference_gain = |(scene, at): (&Scene, &OperatingPoint)| equations[scene.configuration].gain(at);
        let reference_gains = plan.scenes.iter().zip(&points).map(reference_gain).collect();
        Ok(Self {
            origin_references: origins,
            references,
            sector_references,
            certificates,
            equations,
            anchors,
            known_names: plan.scenes.iter().map(|_| KnownNames::default()).collect(),
            reference_points: points,
            reference_gains,
            options,
            brake,
            solver,
        })
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

    /// The reference of each scene with its modes named by likeness; `None` of a study that does not ask for these names.
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

    /// How each sector of a scene is solved.
    pub(super) fn solvers(&self, scene: usize) -> Vec<SectorSolver<'_>> {
        let equations = &self.equations(scene).sectors;
        let each = self.sector_references[scene].iter().zip(equations).zip(&self.anchors[scene]);
        let gain = self.reference_gains[scene];
        let solvers = each.map(|((reference, secular), anchors)| SectorSolver {
            eigen_solver: self.solver,
            reference,
            plan: self.plan(),
            likeness_too: self.options.likeness_too,
            equation: secular
                .as_ref()
                .zip(anchors.as_ref())
                .zip(gain)
                .map(|((secular, anchors), reference)| SectorEquation { secular, anchors, reference }),
        });
        solvers.collect()
    }

    /// The outcomes at operating points of a scene of a brake that finds its modes itself.
    fn band_samples(
        &self,
        scene: usize,
        points: &[OperatingPoint],
        scratch: &mut Scratch,
    ) -> Vec<Result<Outcome, Error>> {
        let memory = &mut scratch.memory;
        let names = BandNames {
            solver: self.solver,
            plan: self.plan(),
            reference: &self.references[scene],
            known: &self.known_names[scene],
            likeness_too: self.options.likeness_too,
        };
        let reference = &self.reference_points[scene];
        let of_scene = &self.plan().scenes[scene];
        let model = &self.plan().brake(of_scene).system;
        let found = timed(&mut memory.spent.search, || self.brake.band_modes(of_scene, points));
        let outcome = |(at, found): (&OperatingPoint, Result<Vec<BandMode>, Error>)| {
            let found = found?;
            if found.is_empty() {
                return Ok(Outcome::default());
            }
            let mass = self.mass(scene, at)?;
            let start = || match self.brake.path(of_scene, at, reference) {
                Some(path) => Ok(BandStart::Owned(path)),
                None => Ok(BandStart::System(Box::new(model.assemble(at)?))),
            };
            let from_known = |known: &KnownMode| {
                self.brake.path(of_scene, &self.brake.known_point(of_scene, known.point)?, reference)
            };
            let modes = names.sector_modes(found, &mass, start, from_known, memory)?;
            timed(&mut memory.spent.outcomes, || self.outcome(scene, at, &[modes]))
        };
        points.iter().zip(found).map(outcome).collect()
    }

    /// The outcomes at operating points of a scene that no certificate covers.
    fn open_samples(
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

        let assembled = timed(&mut memory.spent.assembly, || self.assemble(scene, points, &open, systems));
        // A sample whose matrices cannot be assembled takes no lane of the solver.
        let (mut lanes, mut of_sectors) = (Vec::with_capacity(open.len()), Vec::with_capacity(solvers.len()));
        for (at, made) in open.into_iter().zip(assembled) {
            match made {
                Ok(()) => lanes.push(at),
                Err(error) => outcomes[at] = Err(error),
            }
        }
        for (systems, solver) in systems.iter().zip(&solvers) {
            of_sectors.push(solver.solve(&systems[..lanes.len()], memory));
        }
        timed(&mut memory.spent.outcomes, || self.enter(scene, points, &lanes, of_sectors, &mut outcomes));
        outcomes
    }

    /// Puts the modes of all sectors of some samples together and enters the outcomes.
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

    /// Writes the systems of each sector at those of `points` that are `open`, by sector and sample. A sample that cannot be
    /// assembled takes no place: the next is written in its stead.
    fn assemble(
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

    /// The mass matrix at an operating point of a scene: that of its reference where both have the same coefficients.
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
            for UnstableSectorMode { index, mode, names, names_by_likeness, residual } in &of_sector.unstable {
                let of_mode = |mass| work_with(mass, brake, at, mode.lambda, &sector.expand(&mode.shape));
                let work = mass.as_deref().map(of_mode).transpose()?;
                outcome.growth = outcome.growth.max(mode.lambda.re);
                outcome.unstable.push(UnstableMode {
                    rank: ModeLabel::of_rank(ranks[*index]),
                    growth: mode.lambda.re,
                    names: names.clone(),
                    names_by_likeness: names_by_likeness.clone(),
                    work,
                    residual: *residual,
                });
            }
            let counts = |re: f64| self.plan().threshold.margin(Complex::from(re)) > 0.0;
            let is_divergent = |re: &&f64| counts(**re) && self.plan().is_studied(Complex::from(**re));
            for &re in of_sector.modes.real.iter().filter(is_divergent) {
                outcome.divergent += 1;
                outcome.growth = outcome.growth.max(re);
            }
            outcome.undecided += of_sector.undecided;
        }
        outcome.unstable.sort_by_key(|mode| mode.rank);
        Ok(outcome)
    }
}

/// Which samples have growing modes, and which are open, by the answers of all sectors: a sample that one sector leaves open
/// needs the spectra of all. Samples in neither list are stable.
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
            for (at, sample) in samples.iter().enumerate() {
                outcomes.push(self.brake.operating_point(of_scene, sample).map(|point| {
                    let is_certified = certificate.covers(&point);
                    if !is_certified {
                        open.push(at);
                        points.push(point);
                    }
                    Outcome { is_certified, ..Outcome::default() }
                }));
            }
        });
        let found = match self.brake.has_band_modes() {
            true => self.band_samples(scene, &points, scratch),
            false => self.open_samples(scene, &points, scratch),
        };
        for (at, outcome) in open.into_iter().zip(found) {
            outcomes[at] = outcome;
        }
        out.append(&mut outcomes);
    }
}
