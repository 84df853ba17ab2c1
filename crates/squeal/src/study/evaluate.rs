//! One block of samples in one scene: certificates, spectra, verdicts on the modes near or past the axis, names, net work.

use cea::{
    CeaError, Counters, EigenSolver, Links, Mode, Modes, Spectrum, Verdict, Way, Workspace, identify_all, verdict,
};
use linsys::SecondOrder;
use montecarlo::StreamRng;
use num_complex::Complex;
use osc_model::{Linearise, PreparedLattice, Sliding};
use work::mode_work;

use super::certificate::{Certificate, certificates};
use super::reference::{Reference, references};
use super::{Plan, Sample, Scene};
use crate::Error;

/// What one CEA of a study says.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Outcome {
    /// The unstable modes, ascending in frequency.
    pub unstable: Vec<UnstableMode>,
    /// Real eigenvalues of the structure above zero: divergence.
    pub divergent: u32,
    /// Modes whose verdict the error bound leaves open.
    pub undecided: u32,
    /// Whether the system was proven to be stable without a spectrum.
    pub is_certified: bool,
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
    certificates: Vec<Certificate>,
}

impl<'a> Study<'a> {
    /// Finds the reference modes of every scene and certifies what it can of every lattice.
    ///
    /// # Errors
    /// Those of the model and of the solver.
    pub fn new(plan: &'a Plan, solver: &'a dyn EigenSolver) -> Result<Self, Error> {
        let failed = |source| Error::Median { path: plan.case.path.clone(), source: Box::new(source) };
        let references = references(plan, solver).map_err(failed)?;
        Ok(Self { references, certificates: certificates(plan)?, plan, solver })
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        self.plan
    }

    /// The reference of each scene.
    pub fn references(&self) -> &[Reference] {
        &self.references
    }

    /// The certificate of each lattice.
    pub fn certificates(&self) -> &[Certificate] {
        &self.certificates
    }

    /// What the unstable modes of a sample are called, and their net work.
    fn outcome(
        &self,
        scene: &Scene,
        sliding: &Sliding,
        growing: &Growing,
        (modes, links): (&[Mode], &Links),
        names: &[Vec<u16>],
    ) -> Result<Outcome, Error> {
        let net_work = |mode: &Mode| match scene.wants_work {
            true => net_work(self.plan.lattice(scene), sliding, mode).map(Some),
            false => Ok(None),
        };
        let describe = |((&rank, mode), link): ((&u16, &Mode), &Vec<usize>)| {
            let mut names: Vec<u16> = link.iter().flat_map(|&to| names[to].iter().copied()).collect();
            names.sort_unstable();
            names.dedup();
            Ok(UnstableMode { rank, names, net_work: net_work(mode)? })
        };
        let unstable = growing.ranks.iter().zip(modes).zip(links).map(describe).collect::<Result<_, Error>>()?;
        Ok(Outcome { unstable, divergent: growing.divergent, undecided: growing.undecided, is_certified: false })
    }
}

/// Net work per body of a mode with `phi^H M phi = 1`.
fn net_work(lattice: &PreparedLattice, sliding: &Sliding, mode: &Mode) -> Result<Vec<f64>, Error> {
    let mut friction = SecondOrder::zeros(mode.shape.len(), 0);
    lattice.linearise_friction(sliding, &mut friction)?;
    Ok(mode_work(lattice.structural(), &friction, mode.lambda, &mode.shape, lattice.bodies())?.net())
}

/// The eigenvalues of one sample that call for more than themselves.
#[derive(Debug, Default)]
struct Growing {
    /// Unstable modes, ascending in frequency.
    lambdas: Vec<Complex<f64>>,
    /// The frequency rank of each.
    ranks: Vec<u16>,
    divergent: u32,
    undecided: u32,
}

impl Growing {
    fn new(system: &SecondOrder, spectrum: &Spectrum, work: &mut Workspace) -> Result<Self, CeaError> {
        let modes = Modes::classify(system, spectrum, work)?;
        let mut growing = Self::default();
        for (index, &lambda) in modes.oscillatory.iter().enumerate() {
            match verdict(system, lambda, spectrum.scale, work)? {
                Verdict::Unstable => {
                    growing.lambdas.push(lambda);
                    growing.ranks.push(modes.rank(index) as u16);
                }
                Verdict::Marginal { .. } | Verdict::Undecided { .. } => growing.undecided += 1,
                Verdict::Stable => {}
            }
        }
        growing.divergent = modes.real.iter().filter(|&&re| re > 0.0).count() as u32;
        Ok(growing)
    }
}

/// Working memory of one block.
#[derive(Default)]
pub struct Scratch {
    systems: Vec<SecondOrder>,
    spectra: Vec<Result<Spectrum, CeaError>>,
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
        let mut outcomes = Vec::with_capacity(1);
        self.evaluate_block(scene, &[sample], scratch, &mut outcomes);
        outcomes.remove(0)
    }

    fn evaluate_block(
        &self,
        scene: usize,
        samples: &[&Sample],
        scratch: &mut Scratch,
        out: &mut Vec<Result<Outcome, Error>>,
    ) {
        let Scratch { systems, spectra, work } = scratch;
        let (at, scene) = (scene, &self.plan.scenes[scene]);
        let lattice = self.plan.lattice(scene);
        let certificate = &self.certificates[scene.lattice];
        systems.resize_with(samples.len(), || SecondOrder::zeros(1, 0));
        // A sample that is certified stable or cannot be linearised must not leave its lane empty for the others: it
        // gets no lane.
        let mut slidings: Vec<Sliding> = Vec::with_capacity(samples.len());
        let mut lanes: Vec<Result<Option<usize>, Error>> = Vec::with_capacity(samples.len());
        for sample in samples {
            lanes.push(self.plan.sliding(scene, sample).and_then(|sliding| {
                if certificate.covers(&sliding) {
                    return Ok(None);
                }
                let lane = slidings.len();
                lattice.linearise(&sliding, &mut systems[lane])?;
                slidings.push(sliding);
                Ok(Some(lane))
            }));
        }
        let systems = &systems[..slidings.len()];

        self.solver.eigenvalues_of_all(systems, work, spectra);
        let growing: Vec<Result<Growing, CeaError>> = systems
            .iter()
            .zip(spectra)
            .map(|(system, spectrum)| Growing::new(system, spectrum.as_ref().map_err(CeaError::clone)?, work))
            .collect();

        let lambdas = growing.iter().map(|growing| growing.as_ref().map_or(&[][..], |growing| &growing.lambdas[..]));
        let modes = Mode::of_all(&systems.iter().zip(lambdas).collect::<Vec<_>>(), work);

        let modes_of = |lane: usize| modes[lane].as_deref().unwrap_or_default();
        let reference = &self.references[at];
        let to = (&reference.system, &reference.modes[..]);
        let ways: Vec<Way<'_>> =
            (0..systems.len()).map(|lane| Way { from: (&systems[lane], modes_of(lane)), to }).collect();
        let links = identify_all(self.solver, &ways, work);

        out.extend(lanes.into_iter().map(|lane| {
            let Some(lane) = lane? else { return Ok(Outcome { is_certified: true, ..Outcome::default() }) };
            let growing = growing[lane].as_ref().map_err(CeaError::clone)?;
            let modes = modes[lane].as_ref().map_err(CeaError::clone)?;
            let links = links[lane].as_ref().map_err(CeaError::clone)?;
            self.outcome(scene, &slidings[lane], growing, (modes, links), &reference.names)
        }));
    }
}
