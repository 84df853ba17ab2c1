//! One block of samples in one scene: certificates, then sector by sector spectra, verdicts and names, then net work.

use cea::{CeaError, Counters, EigenSolver, Mode, Spectrum, Workspace, ranks_together};
use linsys::SecondOrder;
use montecarlo::StreamRng;
use osc_model::{Linearise, PreparedLattice, Sector, Sliding};
use work::mode_work;

use super::certificate::{Certificate, certificates};
use super::part::{Part, Unstable, solve};
use super::reference::{Reference, References, references};
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
    sector_references: Vec<Vec<Reference>>,
    certificates: Vec<Certificate>,
}

impl<'a> Study<'a> {
    /// Finds the reference modes of every scene and certifies what it can of every lattice.
    ///
    /// # Errors
    /// Those of the model and of the solver.
    pub fn new(plan: &'a Plan, solver: &'a dyn EigenSolver) -> Result<Self, Error> {
        let failed = |source| Error::Median { path: plan.case.path.clone(), source: Box::new(source) };
        let references = references(plan, solver).map_err(failed)?.into_iter();
        let (references, sector_references) = references.map(|References { whole, sectors }| (whole, sectors)).unzip();
        Ok(Self { references, sector_references, certificates: certificates(plan)?, plan, solver })
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        self.plan
    }

    /// The reference of each scene.
    pub fn references(&self) -> &[Reference] {
        &self.references
    }

    /// The reference of each sector of each scene, in the order of its lattice's sectors.
    pub fn sector_references(&self) -> &[Vec<Reference>] {
        &self.sector_references
    }

    /// The certificate of each lattice.
    pub fn certificates(&self) -> &[Certificate] {
        &self.certificates
    }

    /// What the sectors of one sample say together.
    fn outcome(&self, scene: &Scene, sliding: &Sliding, parts: &[&Part]) -> Result<Outcome, Error> {
        let mut outcome = Outcome::default();
        let ranks = ranks_together(&parts.iter().map(|part| &part.modes).collect::<Vec<_>>());
        for ((part, ranks), sector) in parts.iter().zip(ranks).zip(self.plan.sectors[scene.lattice].iter()) {
            for Unstable { index, mode, names } in &part.unstable {
                let net_work = match scene.wants_work {
                    true => Some(net_work(self.plan.lattice(scene), sector, sliding, mode)?),
                    false => None,
                };
                outcome.unstable.push(UnstableMode { rank: ranks[*index] as u16, names: names.clone(), net_work });
            }
            outcome.divergent += part.modes.real.iter().filter(|&&re| re > 0.0).count() as u32;
            outcome.undecided += part.undecided;
        }
        outcome.unstable.sort_by_key(|mode| mode.rank);
        Ok(outcome)
    }
}

/// Net work per body of a mode of a sector, with `phi^H M phi = 1`.
fn net_work(lattice: &PreparedLattice, sector: &Sector, sliding: &Sliding, mode: &Mode) -> Result<Vec<f64>, Error> {
    let shape = sector.expand(&mode.shape);
    let mut friction = SecondOrder::zeros(shape.len(), 0);
    lattice.linearise_friction(sliding, &mut friction)?;
    Ok(mode_work(lattice.structural(), &friction, mode.lambda, &shape, lattice.bodies())?.net())
}

/// Working memory of one block.
#[derive(Default)]
pub struct Scratch {
    /// Of each sector, those of the samples.
    systems: Vec<Vec<SecondOrder>>,
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
        let (references, scene) = (&self.sector_references[scene], &self.plan.scenes[scene]);
        let (lattice, sectors) = (self.plan.lattice(scene), &self.plan.sectors[scene.lattice]);
        let (certificate, mut whole) = (&self.certificates[scene.lattice], SecondOrder::zeros(1, 0));
        systems.resize_with(systems.len().max(references.len()), Vec::new);
        let systems = &mut systems[..references.len()];
        for of_sector in &mut *systems {
            of_sector.resize_with(samples.len(), || SecondOrder::zeros(1, 0));
        }
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
                let of_lane = systems.iter_mut().map(|of_sector| &mut of_sector[lane]);
                sectors.linearise(lattice, &sliding, &mut whole, of_lane)?;
                slidings.push(sliding);
                Ok(Some(lane))
            }));
        }

        let solve = |(systems, reference): (&mut Vec<SecondOrder>, &Reference)| {
            solve(self.solver, &systems[..slidings.len()], reference, spectra, work)
        };
        let parts: Vec<Vec<Result<Part, CeaError>>> = systems.iter_mut().zip(references).map(solve).collect();

        out.extend(lanes.into_iter().map(|lane| {
            let Some(lane) = lane? else { return Ok(Outcome { is_certified: true, ..Outcome::default() }) };
            let parts = parts.iter().map(|of_sector| of_sector[lane].as_ref());
            let parts = parts.collect::<Result<Vec<&Part>, _>>().map_err(CeaError::clone)?;
            self.outcome(scene, &slidings[lane], &parts)
        }));
    }
}
