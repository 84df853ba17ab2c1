//! One block of samples in one scene: spectra, verdicts on the modes near or past the axis, names, net work.

use cea::{Counters, EigenSolver, Mode, Modes, Spectrum, Verdict, Workspace, identify, verdict};
use linsys::SecondOrder;
use montecarlo::StreamRng;
use num_complex::Complex;
use osc_model::Linearise;
use work::mode_work;

use super::reference::{Reference, references};
use super::{Plan, Sample, Scene};
use crate::Error;

/// What one CEA of a study says.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The unstable modes, ascending in frequency.
    pub unstable: Vec<UnstableMode>,
    /// Real eigenvalues of the structure above zero: divergence.
    pub divergent: u32,
    /// Modes whose verdict the error bound leaves open.
    pub undecided: u32,
}

/// One unstable mode of one CEA.
#[derive(Debug, Clone, PartialEq)]
pub struct UnstableMode {
    /// Frequency rank in this CEA, from 1.
    pub rank: u16,
    /// Names it may have as a tracked mode: one, or several near a coalescence, or none.
    pub names: Vec<u16>,
    /// Net work in one period of each body, 1/s^2 times `phi^H M phi`; in scenes that want it.
    pub net_work: Option<Vec<f64>>,
}

/// A case, ready to be sampled.
pub struct Study<'a> {
    plan: &'a Plan,
    solver: &'a dyn EigenSolver,
    references: Vec<Reference>,
}

impl<'a> Study<'a> {
    /// Finds the reference modes of every scene.
    ///
    /// # Errors
    /// Those of the model and of the solver.
    pub fn new(plan: &'a Plan, solver: &'a dyn EigenSolver) -> Result<Self, Error> {
        let failed = |source| Error::Median { path: plan.case.path.clone(), source: Box::new(source) };
        Ok(Self { references: references(plan, solver).map_err(failed)?, plan, solver })
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        self.plan
    }

    /// The reference of each scene.
    pub fn references(&self) -> &[Reference] {
        &self.references
    }

    fn outcome(
        &self,
        at: usize,
        sample: &Sample,
        system: &SecondOrder,
        spectrum: &Spectrum,
        work: &mut Workspace,
    ) -> Result<Outcome, Error> {
        let scene = &self.plan.scenes[at];
        let modes = Modes::classify(system, spectrum, work)?;
        let mut undecided = 0;
        let mut unstable: Vec<(usize, Complex<f64>)> = Vec::new();
        for (index, &lambda) in modes.oscillatory.iter().enumerate() {
            match verdict(system, lambda, spectrum.scale, work)? {
                Verdict::Unstable => unstable.push((index, lambda)),
                Verdict::Marginal { .. } | Verdict::Undecided { .. } => undecided += 1,
                Verdict::Stable => {}
            }
        }
        let divergent = modes.real.iter().filter(|&&re| re > 0.0).count() as u32;
        if unstable.is_empty() {
            return Ok(Outcome { unstable: Vec::new(), divergent, undecided });
        }

        let lambdas: Vec<_> = unstable.iter().map(|&(_, lambda)| lambda).collect();
        let found = Mode::at(system, &lambdas, work)?;
        let reference = &self.references[at];
        let links = identify(self.solver, (system, &found), (&reference.system, &reference.modes), work)?;
        let net_work = |mode: &Mode| match scene.wants_work {
            true => self.net_work(scene, sample, mode).map(Some),
            false => Ok(None),
        };
        let describe = |((&(index, _), mode), link): ((&(usize, _), &Mode), &Vec<usize>)| {
            let mut names: Vec<u16> = link.iter().flat_map(|&to| reference.names[to].iter().copied()).collect();
            names.sort_unstable();
            names.dedup();
            Ok(UnstableMode { rank: modes.rank(index) as u16, names, net_work: net_work(mode)? })
        };
        let unstable = unstable.iter().zip(&found).zip(&links).map(describe).collect::<Result<_, Error>>()?;
        Ok(Outcome { unstable, divergent, undecided })
    }

    /// Net work per body of a mode with `phi^H M phi = 1`.
    fn net_work(&self, scene: &Scene, sample: &Sample, mode: &Mode) -> Result<Vec<f64>, Error> {
        let lattice = self.plan.lattice(scene);
        let mut friction = SecondOrder::zeros(mode.shape.len(), 0);
        lattice.linearise_friction(&self.plan.sliding(scene, sample)?, &mut friction)?;
        Ok(mode_work(lattice.structural(), &friction, mode.lambda, &mode.shape, lattice.bodies())?.net())
    }
}

/// Working memory of one block.
#[derive(Default)]
pub struct Scratch {
    systems: Vec<SecondOrder>,
    spectra: Vec<Result<Spectrum, cea::CeaError>>,
    work: Workspace,
}

impl Scratch {
    /// What was computed so far.
    pub fn counters(&self) -> Counters {
        self.work.counters
    }
}

impl montecarlo::Study for Study<'_> {
    type Sample = Sample;
    type Outcome = Outcome;
    type Error = Error;
    type Scratch = Scratch;

    fn scenes(&self) -> usize {
        self.plan.scenes.len()
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<Sample, Error> {
        Ok(Sample::draw(&self.plan.case, rng)?)
    }

    fn evaluate(&self, scene: usize, sample: &Sample, scratch: &mut Scratch) -> Result<Outcome, Error> {
        let mut system = SecondOrder::zeros(1, 0);
        self.plan.linearise(&self.plan.scenes[scene], sample, &mut system)?;
        let spectrum = self.solver.eigenvalues(&system, &mut scratch.work)?;
        self.outcome(scene, sample, &system, &spectrum, &mut scratch.work)
    }

    fn evaluate_block(
        &self,
        scene: usize,
        samples: &[&Sample],
        scratch: &mut Scratch,
        out: &mut Vec<Result<Outcome, Error>>,
    ) {
        let Scratch { systems, spectra, work } = scratch;
        systems.resize_with(samples.len(), || SecondOrder::zeros(1, 0));
        // A sample that cannot be linearised must not leave its lane empty for the others: it gets no lane.
        let mut filled = 0;
        let mut lanes: Vec<Result<usize, Error>> = Vec::with_capacity(samples.len());
        for sample in samples {
            let linearised = self.plan.linearise(&self.plan.scenes[scene], sample, &mut systems[filled]);
            lanes.push(linearised.map(|()| filled));
            filled += usize::from(lanes.last().is_some_and(Result::is_ok));
        }
        self.solver.eigenvalues_of_all(&systems[..filled], work, spectra);
        for (sample, lane) in samples.iter().zip(lanes) {
            let outcome = lane.and_then(|lane| match &spectra[lane] {
                Ok(spectrum) => self.outcome(scene, sample, &systems[lane], spectrum, work),
                Err(error) => Err(error.clone().into()),
            });
            out.push(outcome);
        }
    }
}
