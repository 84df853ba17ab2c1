//! One block of samples in one scene: certificates, then sector by sector spectra, verdicts and names, then net work.

use cea::{Anchors, CeaError, EigenSolver, Gain, Growing, Mode, ranks_together};
use linsys::SecondOrder;
use montecarlo::StreamRng;
use osc_model::{Linearise, PreparedLattice, Sector, Sliding};
use work::{Family, family_work};

use super::certificate::{Certificate, certificates};
use super::growing::{Equations, anchors, equations, gain, growing};
use super::memory::{Scratch, timed};
use super::part::{Equation, Known, Part, Solver, Unstable};
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
    /// Of each lattice.
    equations: Vec<Equations>,
    /// Of each sector of each scene.
    anchors: Vec<Vec<Option<Anchors>>>,
    /// Of the reference of each scene.
    reference_gains: Vec<Option<Gain>>,
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
        let (certificates, equations) = (certificates(plan)?, equations(plan)?);
        let anchors = anchors(plan, &equations, &certificates, solver)?;
        let median = Sample::median(&plan.case);
        let reference_gain = |scene| plan.sliding(scene, &median).map(|state| gain(&state));
        let reference_gains = plan.scenes.iter().map(reference_gain).collect::<Result<_, _>>()?;
        Ok(Self { references, sector_references, certificates, equations, anchors, reference_gains, plan, solver })
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

    /// How each sector of a scene is solved.
    pub(super) fn solvers(&self, scene: usize) -> Vec<Solver<'_>> {
        let equations = &self.equations[self.plan.scenes[scene].lattice];
        let each = self.sector_references[scene].iter().zip(equations).zip(&self.anchors[scene]);
        let gain = self.reference_gains[scene];
        let solvers = each.map(|((reference, secular), anchors)| Solver {
            spectra: self.solver,
            reference,
            equation: secular
                .as_ref()
                .zip(anchors.as_ref())
                .zip(gain)
                .map(|((secular, anchors), reference)| Equation { secular, anchors, reference }),
        });
        solvers.collect()
    }

    /// What is to be said of each of these states, which no certificate covers.
    fn open_samples(&self, scene: usize, states: &[Sliding], scratch: &mut Scratch) -> Vec<Result<Outcome, Error>> {
        let Scratch { systems, memory } = scratch;
        let (solvers, scene) = (self.solvers(scene), &self.plan.scenes[scene]);
        let mut known = timed(&mut memory.spent.search, || growing(&solvers, states, &mut memory.work));
        let damps = |found: &Known| found.as_ref().is_some_and(|(_, found)| found.frequencies().next().is_none());
        let mut outcomes: Vec<Result<Outcome, Error>> = states.iter().map(|_| Ok(Outcome::default())).collect();

        // What the secular equations leave to spectra they leave in all sectors.
        let (told, open): (Vec<usize>, Vec<usize>) =
            (0..states.len()).partition(|&at| known.iter().all(|of_sector| of_sector[at].is_some()));
        let growing: Vec<usize> =
            told.into_iter().filter(|&at| !known.iter().all(|of_sector| damps(&of_sector[at]))).collect();
        let mut parts = Vec::with_capacity(solvers.len());
        for (solver, known) in solvers.iter().zip(&mut known) {
            let known: Vec<(Gain, Growing)> = growing.iter().filter_map(|&at| known[at].take()).collect();
            parts.push(solver.known(&known, memory));
        }
        timed(&mut memory.spent.outcomes, || self.enter(scene, states, &growing, parts, &mut outcomes));

        let assembled = timed(&mut memory.spent.assembly, || self.linearise(scene, states, &open, systems));
        // What cannot be linearised has no lane.
        let (mut lanes, mut parts) = (Vec::with_capacity(open.len()), Vec::with_capacity(solvers.len()));
        for (at, made) in open.into_iter().zip(assembled) {
            match made {
                Ok(()) => lanes.push(at),
                Err(error) => outcomes[at] = Err(error),
            }
        }
        for (systems, solver) in systems.iter().zip(&solvers) {
            parts.push(solver.solve(&systems[..lanes.len()], memory));
        }
        timed(&mut memory.spent.outcomes, || self.enter(scene, states, &lanes, parts, &mut outcomes));
        outcomes
    }

    /// Enters what the parts of some samples, sector by sector, say together.
    fn enter(
        &self,
        scene: &Scene,
        states: &[Sliding],
        samples: &[usize],
        parts: Vec<Vec<Result<Part, CeaError>>>,
        outcomes: &mut [Result<Outcome, Error>],
    ) {
        let mut parts: Vec<_> = parts.into_iter().map(Vec::into_iter).collect();
        for &at in samples {
            let of_sample = parts.iter_mut().filter_map(Iterator::next).collect::<Result<Vec<Part>, CeaError>>();
            outcomes[at] = of_sample.map_err(Error::from).and_then(|parts| self.outcome(scene, &states[at], &parts));
        }
    }

    /// Writes the systems of each sector in those of `states` that are `open`, without gaps where one cannot be linearised.
    fn linearise(
        &self,
        scene: &Scene,
        states: &[Sliding],
        open: &[usize],
        systems: &mut Vec<Vec<SecondOrder>>,
    ) -> Vec<Result<(), Error>> {
        let (lattice, sectors) = (self.plan.lattice(scene), &self.plan.sectors[scene.lattice]);
        systems.resize_with(systems.len().max(sectors.iter().len()), Vec::new);
        for of_sector in &mut *systems {
            of_sector.resize_with(of_sector.len().max(open.len()), || SecondOrder::zeros(1, 0));
        }
        let (mut lane, mut whole) = (0, SecondOrder::zeros(1, 0));
        let mut one = |&at: &usize| {
            let of_lane = systems.iter_mut().map(|of_sector| &mut of_sector[lane]);
            sectors.linearise(lattice, &states[at], &mut whole, of_lane)?;
            lane += 1;
            Ok(())
        };
        open.iter().map(&mut one).collect()
    }

    /// What the sectors of one sample say together.
    fn outcome(&self, scene: &Scene, sliding: &Sliding, parts: &[Part]) -> Result<Outcome, Error> {
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
    let damping = lattice.structural().damping_alone();
    let families = [Family { name: "friction", system: &friction }, Family { name: "damping", system: &damping }];
    Ok(family_work(&lattice.structural().m, &families, mode.lambda, &shape, lattice.bodies())?.net())
}

impl montecarlo::Experiment for Study<'_> {
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
        let certificate = &self.certificates[self.plan.scenes[scene].lattice];
        let (mut open, mut states) = (Vec::with_capacity(samples.len()), Vec::with_capacity(samples.len()));
        let mut outcomes = Vec::with_capacity(samples.len());
        timed(&mut scratch.memory.spent.states, || {
            for (at, sample) in samples.iter().enumerate() {
                outcomes.push(self.plan.sliding(&self.plan.scenes[scene], sample).map(|state| {
                    let is_certified = certificate.covers(&state);
                    if !is_certified {
                        open.push(at);
                        states.push(state);
                    }
                    Outcome { is_certified, ..Outcome::default() }
                }));
            }
        });
        for (at, outcome) in open.into_iter().zip(self.open_samples(scene, &states, scratch)) {
            outcomes[at] = outcome;
        }
        out.append(&mut outcomes);
    }
}
