//! Reference modes: what a mode is called in each scene.
//!
//! A tracked mode is named by its frequency rank with every oscillator in contact, Amontons-Coulomb friction and median
//! parameters. Each lattice (constraint set and arrangement) has its own Amontons-Coulomb modes, linked to those by
//! continuation in the contact stiffness of the oscillators that leave contact; each scene has its own modes at median
//! parameters of its law and speed, linked to those of its lattice by continuation in the law. Samples are then
//! matched to the modes of their scene.

use cea::{EigenSolver, Mode, Modes, Way, Workspace, follow, identify, with_idle_states};
use linsys::SecondOrder;
use osc_model::{BrakeModel, ContactArrangement, Linearise};
use rayon::prelude::*;

use super::scene::sliding;
use super::{Plan, Sample, Scene};
use crate::Error;
use crate::case::Law;

/// The modes of one scene at median parameters.
#[derive(Debug, Clone)]
pub struct Reference {
    /// The system.
    pub system: SecondOrder,
    /// Its oscillating modes, ascending in frequency.
    pub modes: Vec<Mode>,
    /// What each is called: one name, several where a coalescence on the way leaves it open, none where a mode only
    /// began to oscillate on the way.
    pub names: Vec<Vec<u16>>,
}

impl Reference {
    fn new(solver: &dyn EigenSolver, system: SecondOrder, work: &mut Workspace) -> Result<Self, Error> {
        let spectrum = solver.eigenvalues(&system, work)?;
        let modes = Modes::classify(&system, &spectrum, work)?;
        let names = (0..modes.oscillatory.len()).map(|i| vec![modes.rank(i) as u16]).collect();
        Ok(Self { modes: Mode::at(&system, &modes.oscillatory, work)?, system, names })
    }

    /// The modes of `system`, named by continuation from this reference: all the way, or, for a `near` system, where MAC
    /// leaves a doubt.
    fn linked(
        &self,
        solver: &dyn EigenSolver,
        system: SecondOrder,
        near: bool,
        work: &mut Workspace,
    ) -> Result<Self, Error> {
        let mut next = Self::new(solver, system, work)?;
        let padded;
        let from = if self.system.states() == next.system.states() {
            &self.system
        } else {
            padded = with_idle_states(&self.system, &next.system);
            &padded
        };
        let link = if near { identify } else { follow };
        let links = link(solver, Way { from: (from, &self.modes), to: (&next.system, &next.modes) }, work)?;
        next.names = vec![Vec::new(); next.modes.len()];
        for (names, link) in self.names.iter().zip(links) {
            for to in link {
                next.names[to].extend(names);
            }
        }
        for names in &mut next.names {
            names.sort_unstable();
            names.dedup();
        }
        Ok(next)
    }
}

/// The reference of each scene of `plan`, in their order.
///
/// # Errors
/// Those of the model and of the solver.
pub(super) fn references(plan: &Plan, solver: &dyn EigenSolver) -> Result<Vec<Reference>, Error> {
    let median = Sample::median(&plan.case);
    let of_set = |constraints: usize| full_contact(plan, constraints, &median, solver);
    let bases = (0..plan.models.len()).map(of_set).collect::<Result<Vec<_>, Error>>()?;
    let of_lattice = |at: usize| of_lattice(plan, at, &bases[plan.lattices[at].0], &median, solver);
    let lattices = (0..plan.lattices.len()).into_par_iter().map(of_lattice).collect::<Result<Vec<_>, Error>>()?;
    let of_scene = |scene: &Scene| of_scene(plan, scene, &lattices[scene.lattice], &median, solver);
    plan.scenes.par_iter().map(of_scene).collect()
}

/// Every oscillator in contact, Amontons-Coulomb: where the names come from.
fn full_contact(
    plan: &Plan,
    constraints: usize,
    median: &Sample,
    solver: &dyn EigenSolver,
) -> Result<Reference, Error> {
    let all = ContactArrangement::full(plan.case.lattice.grid.oscillators());
    let lattice = plan.models[constraints].prepare(&all)?;
    let speed = plan.case.speeds[0].quantile(0.5);
    let at = sliding(&plan.case, &lattice, Law::AmontonsCoulomb, speed, median, |_| 1.0)?;
    Reference::new(solver, lattice.linearised(&at)?, &mut Workspace::default())
}

fn of_lattice(
    plan: &Plan,
    at: usize,
    base: &Reference,
    median: &Sample,
    solver: &dyn EigenSolver,
) -> Result<Reference, Error> {
    let (_, lattice) = &plan.lattices[at];
    let speed = plan.case.speeds[0].quantile(0.5);
    let system = lattice.linearised(&sliding(&plan.case, lattice, Law::AmontonsCoulomb, speed, median, |_| 1.0)?)?;
    // The straight line from one system to the other takes the stiffness and the load of the contacts that differ
    // from 1 to 0 together.
    base.linked(solver, system, false, &mut Workspace::default())
}

fn of_scene(
    plan: &Plan,
    scene: &Scene,
    lattice: &Reference,
    median: &Sample,
    solver: &dyn EigenSolver,
) -> Result<Reference, Error> {
    let mut system = SecondOrder::zeros(lattice.system.order(), 0);
    plan.linearise(scene, median, &mut system)?;
    if system == lattice.system {
        return Ok(lattice.clone());
    }
    lattice.linked(solver, system, true, &mut Workspace::default())
}
