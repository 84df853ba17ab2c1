//! Reference modes: what a mode is called in each scene.
//!
//! A tracked mode is named by its frequency rank with every oscillator in contact, Amontons-Coulomb friction and median
//! parameters. Each lattice (constraint set and arrangement) has its own Amontons-Coulomb modes, linked to those by
//! continuation in the contact stiffness of the oscillators that leave contact; each scene has its own modes at median
//! parameters of its law and speed, linked to those of its lattice by continuation in the law. Samples are then
//! matched to the modes of their scene.
//!
//! All this goes sector by sector: modes of different sectors never meet, whatever their frequencies.

use cea::{EigenSolver, Mode, Modes, Workspace, by_frequency, ranks_together};
use linsys::SecondOrder;
use osc_model::{BrakeModel, ContactArrangement, Linearise, OscModelError, PreparedLattice, Sector, Sectors};
use rayon::prelude::*;
use tracking::{Path, PathEnd, PathStart, follow, identify};

use super::scene::{sectors, sliding};
use super::{Plan, Sample, Scene};
use crate::Error;
use crate::case::Law;

/// The modes of one system, or of one sector of it, at median parameters.
#[derive(Debug, Clone)]
pub struct Reference {
    /// The system.
    pub system: SecondOrder,
    /// Its oscillating modes, ascending in frequency.
    pub modes: Vec<Mode>,
    /// What each is called: one name, several where a coalescence on the path leaves it open, none where a mode only
    /// began to oscillate on the path.
    pub names: Vec<Vec<u16>>,
}

/// The modes of one scene at median parameters, as a whole and by sectors.
#[derive(Debug, Clone)]
pub struct References {
    /// The whole lattice.
    pub whole: Reference,
    /// Each of its sectors.
    pub sectors: Vec<Reference>,
}

impl Reference {
    /// The modes of `system`, without names.
    fn unnamed(solver: &dyn EigenSolver, system: SecondOrder, work: &mut Workspace) -> Result<(Self, Modes), Error> {
        let spectrum = solver.eigenvalues(&system, work)?;
        let found = Modes::classify(&system, &spectrum, work)?;
        let modes = Mode::at(&system, &found.oscillatory, work)?;
        Ok((Self { names: vec![Vec::new(); modes.len()], modes, system }, found))
    }

    /// The names of a mode that may have become any of the modes of `link`, ascending, each once.
    pub(crate) fn names_of(&self, link: impl IntoIterator<Item = usize>) -> Vec<u16> {
        let mut names: Vec<u16> = link.into_iter().flat_map(|to| self.names[to].iter().copied()).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// The whole that sectors make up.
    fn joined(system: SecondOrder, sectors: &Sectors, parts: &[Self]) -> Self {
        let named = |(sector, part): (&Sector, &Self)| {
            let whole = |mode: &Mode| Mode::normalised(&system, mode.lambda, sector.expand(&mode.shape));
            part.modes.iter().map(whole).zip(part.names.clone()).collect::<Vec<_>>()
        };
        let mut all: Vec<(Mode, Vec<u16>)> = sectors.iter().zip(parts).flat_map(named).collect();
        all.sort_by(|(a, _), (b, _)| by_frequency(&a.lambda, &b.lambda));
        let (modes, names) = all.into_iter().unzip();
        Self { system, modes, names }
    }

    /// Those modes of a whole lattice that are of one sector.
    fn within(&self, sector: &Sector) -> Result<Self, OscModelError> {
        let mut part = Self { system: sector.reduced(&self.system)?, modes: Vec::new(), names: Vec::new() };
        for (mode, names) in self.modes.iter().zip(&self.names) {
            let shape = sector.project(&mode.shape);
            if shape.norm_squared() > 0.5 * mode.shape.norm_squared() {
                part.modes.push(Mode::normalised(&part.system, mode.lambda, shape));
                part.names.push(names.clone());
            }
        }
        Ok(part)
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
        let (mut next, _) = Self::unnamed(solver, system, work)?;
        let link = if near { identify } else { follow };
        let end = PathEnd { system: &next.system, modes: &next.modes };
        let path = Path { start: PathStart::System(&self.system), start_modes: &self.modes, end };
        let links = link(solver, path, work)?;
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

/// The references of each scene of `plan`, in their order.
///
/// # Errors
/// Those of the model and of the solver.
pub(super) fn references(plan: &Plan, solver: &dyn EigenSolver) -> Result<Vec<References>, Error> {
    let median = Sample::median(&plan.case);
    let of_set = |constraints: usize| full_contact(plan, constraints, &median, solver);
    let bases = (0..plan.models.len()).map(of_set).collect::<Result<Vec<_>, Error>>()?;
    let of_lattice = |at: usize| of_lattice(plan, at, &bases[plan.lattices[at].0], &median, solver);
    let lattices = (0..plan.lattices.len()).into_par_iter().map(of_lattice).collect::<Result<Vec<_>, Error>>()?;
    let of_scene = |scene: &Scene| of_scene(plan, scene, &lattices[scene.lattice], &median, solver);
    plan.scenes.par_iter().map(of_scene).collect()
}

/// A lattice with median Amontons-Coulomb friction.
fn amontons_coulomb(plan: &Plan, lattice: &PreparedLattice, median: &Sample) -> Result<SecondOrder, Error> {
    let speed = plan.case.speeds[0].quantile(0.5);
    let state = sliding(&plan.case, lattice, Law::AmontonsCoulomb, speed, median, |_| 1.0)?;
    Ok(lattice.linearised(&state)?)
}

/// Every oscillator in contact, Amontons-Coulomb: where the names come from.
fn full_contact(
    plan: &Plan,
    constraints: usize,
    median: &Sample,
    solver: &dyn EigenSolver,
) -> Result<Reference, Error> {
    let (model, mut work) = (&plan.models[constraints], Workspace::default());
    let all = ContactArrangement::full(plan.case.lattice.grid.oscillators());
    let (lattice, sectors) = (model.prepare(&all)?, sectors(&plan.case, model, &all)?);
    let system = amontons_coulomb(plan, &lattice, median)?;
    let of_sector = |sector: &Sector| Reference::unnamed(solver, sector.reduced(&system)?, &mut work);
    let (mut parts, found): (Vec<_>, Vec<_>) =
        sectors.iter().map(of_sector).collect::<Result<Vec<_>, Error>>()?.into_iter().unzip();
    for (part, ranks) in parts.iter_mut().zip(ranks_together(&found.iter().collect::<Vec<_>>())) {
        part.names = ranks.into_iter().map(|rank| vec![rank as u16]).collect();
    }
    Ok(Reference::joined(system, &sectors, &parts))
}

fn of_lattice(
    plan: &Plan,
    at: usize,
    base: &Reference,
    median: &Sample,
    solver: &dyn EigenSolver,
) -> Result<References, Error> {
    let ((_, lattice), sectors) = (&plan.lattices[at], &plan.sectors[at]);
    let system = amontons_coulomb(plan, lattice, median)?;
    let from = sectors.iter().map(|sector| base.within(sector)).collect::<Result<Vec<_>, _>>()?;
    // The straight line from one system to the other takes the stiffness and the load of the contacts that differ
    // from 1 to 0 together.
    References::linked(&from, solver, sectors, system, false)
}

fn of_scene(
    plan: &Plan,
    scene: &Scene,
    lattice: &References,
    median: &Sample,
    solver: &dyn EigenSolver,
) -> Result<References, Error> {
    let mut system = SecondOrder::zeros(1, 0);
    plan.linearise(scene, median, &mut system)?;
    if system == lattice.whole.system {
        return Ok(lattice.clone());
    }
    References::linked(&lattice.sectors, solver, &plan.sectors[scene.lattice], system, true)
}

impl References {
    /// The modes of `system`, those of each sector named as [`Reference::linked`] names them `from` its reference.
    fn linked(
        from: &[Reference],
        solver: &dyn EigenSolver,
        sectors: &Sectors,
        system: SecondOrder,
        near: bool,
    ) -> Result<Self, Error> {
        let mut work = Workspace::default();
        let of_sector =
            |(from, sector): (&Reference, &Sector)| from.linked(solver, sector.reduced(&system)?, near, &mut work);
        let parts = from.iter().zip(sectors.iter()).map(of_sector).collect::<Result<Vec<_>, Error>>()?;
        Ok(Self { whole: Reference::joined(system, sectors, &parts), sectors: parts })
    }
}
