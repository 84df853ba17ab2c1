//! Reference modes: the modes by which the modes of each scene are named.
//!
//! A tracked mode is named by its frequency rank (by [`rank_order`]) at the [`Origin`] of its configuration: for a lattice every oscillator
//! in contact, Amontons-Coulomb friction and median parameters. Each configuration has modes of its own at its naming point, linked to
//! those by continuation, for instance in the contact stiffness of the oscillators that leave contact; each scene has its own modes at
//! median parameters of its law and speed, linked to the modes of its configuration. Samples are then matched to the modes of their scene.
//!
//! Under [`ModeIdentity::Mac`] nothing is followed: a mode has the name of the mode of the origin that it resembles by MAC.
//!
//! Each step is done in every sector apart: modes of different sectors do not couple, however near their frequencies are.
//! Of equal modes of different sectors the mode of the smaller sector ranks first; names of equal modes of one sector are open
//! between them.

mod of_plan;

use cea::{CeaError, EQUAL_BUT_FOR_ROUNDING, EigenSolver, Mode, Modes, Workspace, rank_order};
use linsys::{SecondOrder, real_times_complex};
use nalgebra::DMatrix;
use num_complex::Complex;
use osc_model::{OscModelError, Sector, Sectors};
use tracking::{Links, OwnedPath, Path, PathEnd, PathStart, follow, identify, identify_all};

pub(super) use self::of_plan::{References, references};

use super::named_shapes::NamedShapes;
use super::{CoarsePath, ModeIdentity, ModeLabel, Plan};
use crate::Error;

/// Memory for the reference modes of a configuration or a scene, or for its anchors, that bounds how many spectra in more digits
/// than a double's are computed. Where no system is stiff no such spectrum is computed; where systems are stiff, each step of a mode that has to be
/// followed needs such spectra. One takes about 5e-7 s times the cube of the order; chosen: a fifth of a second, and 16 in any case.
pub(super) fn bounded_workspace(order: usize) -> Workspace {
    let most = 4e5 / (order as f64).powi(3);
    Workspace::with_most_certified_solves((most as u64).max(16))
}

/// The modes of one system, or of one sector of it, at median parameters.
#[derive(Debug, Clone)]
pub struct Reference {
    /// The system: over the free degrees of freedom of the brake, or over the shapes of one sector.
    pub system: SecondOrder,
    /// Oscillating modes of the system, ascending in frequency; eigenvalues in rad/s, shapes with `phi^H M phi = 1`.
    pub modes: Vec<Mode>,
    /// Names of each mode: one; several where a coalescence on the path leaves open which mode is which, or where modes of one
    /// sector have equal eigenvalues; empty where a mode did not oscillate at the beginning of the path, or resembles no mode of the origin.
    pub names: Vec<Vec<ModeLabel>>,
    /// Modes of the origin, where others are named by their MAC with these.
    shapes: Option<NamedShapes>,
}

/// Least fraction of the squared norm of a shape that is left in fewer coordinates if their basis contains it; chosen: with less it is another shape.
const HELD: f64 = 0.98;

/// A mode in the fewer coordinates of a system on a basis of orthonormal columns; `None` where the basis does not contain its shape.
pub(crate) fn on_basis(mode: &Mode, system: &SecondOrder, basis: &DMatrix<f64>) -> Option<Mode> {
    let shape = real_times_complex(&basis.transpose(), &mode.shape);
    let is_held = shape.norm_squared() >= HELD * mode.shape.norm_squared();
    is_held.then(|| Mode::normalised(&system.m, mode.lambda, shape))
}

/// The modes of `modes` whose shapes a basis of fewer coordinates contains: their indices, and the modes in these coordinates.
fn held(modes: &[Mode], system: &SecondOrder, basis: &DMatrix<f64>) -> (Vec<usize>, Vec<Mode>) {
    modes.iter().enumerate().filter_map(|(at, mode)| Some((at, on_basis(mode, system, basis)?))).unzip()
}

/// The modes of one scene at median parameters, as a whole and by sectors.
#[derive(Debug, Clone)]
pub struct SectoredReference {
    /// Reference modes of the whole brake.
    pub whole: Reference,
    /// Reference modes of each sector.
    pub sectors: Vec<Reference>,
}

impl Reference {
    /// The reference in the fewer coordinates of its system on a basis of orthonormal columns: the modes whose shapes the basis contains.
    pub(crate) fn on_basis(&self, system: SecondOrder, basis: &DMatrix<f64>) -> Self {
        let held = self.modes.iter().zip(&self.names);
        let held = held.filter_map(|(mode, names)| Some((on_basis(mode, &system, basis)?, names.clone())));
        let (modes, names) = held.unzip();
        Self { system, modes, names, shapes: None }
    }

    /// The modes of `system` that a plan follows, without names.
    pub(super) fn unnamed(
        solver: &dyn EigenSolver,
        system: SecondOrder,
        plan: &Plan,
        work: &mut Workspace,
    ) -> Result<Self, Error> {
        let mut spectrum = solver.eigenvalues(&system, work)?;
        // What is not followed need not be told from internal states.
        spectrum.eigenvalues.retain(|&lambda| plan.is_followed(lambda));
        let found = Modes::classify(&system, &spectrum, work)?;
        Self::of_modes(system, &found.oscillatory, work)
    }

    /// The modes of `system` with the eigenvalues `lambdas`, without names.
    fn of_modes(system: SecondOrder, lambdas: &[Complex<f64>], work: &mut Workspace) -> Result<Self, Error> {
        let modes = Mode::at(&system, lambdas, work)?;
        Ok(Self { names: vec![Vec::new(); modes.len()], modes, system, shapes: None })
    }

    /// The reference itself, by whose modes all others are named that resemble them by MAC.
    fn naming_by_likeness(mut self) -> Self {
        self.shapes = Some(NamedShapes { modes: self.modes.clone(), names: self.names.clone() });
        self
    }

    /// The names of the modes at the beginning of each path, which ends at this reference, by an identity.
    pub(crate) fn names_of_all(
        &self,
        solver: &dyn EigenSolver,
        paths: &[Path<'_>],
        identity: ModeIdentity,
        work: &mut Workspace,
    ) -> Vec<Result<Vec<Vec<ModeLabel>>, CeaError>> {
        if identity == ModeIdentity::Mac {
            return paths.iter().map(|path| Ok(self.names_by_likeness(path.start_modes).unwrap_or_default())).collect();
        }
        let names = |links: Links| links.into_iter().map(|link| self.names_of(link)).collect();
        identify_all(solver, paths, work).into_iter().map(|links| links.map(names)).collect()
    }

    /// The names of each of `modes`, of a system with this mass matrix, by MAC with the shapes of the origin; `None` where these are
    /// not kept.
    pub(super) fn names_by_likeness(&self, modes: &[Mode]) -> Option<Vec<Vec<ModeLabel>>> {
        Some(self.shapes.as_ref()?.names_of(modes, &self.system.m))
    }

    /// The reference with its modes named by MAC; `None` where the shapes for that are not kept.
    pub(super) fn named_by_likeness(&self) -> Option<Self> {
        Some(Self { names: self.names_by_likeness(&self.modes)?, ..self.clone() })
    }

    /// The names of a mode that becomes one of the modes of `link`, ascending, each once.
    #[must_use]
    pub fn names_of(&self, link: impl IntoIterator<Item = usize>) -> Vec<ModeLabel> {
        let mut names: Vec<ModeLabel> = link.into_iter().flat_map(|to| self.names[to].iter().copied()).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Names that any mode has or may have, ascending, each once.
    #[must_use]
    pub fn all_names(&self) -> Vec<ModeLabel> {
        self.names_of(0..self.modes.len())
    }

    /// Opens the names of modes whose eigenvalues are equal within rounding: their shapes are any combinations of each other,
    /// and which of them is which has no answer. Each gets the names of all.
    fn open_equal_modes(&mut self) {
        let is_equal = |a: &Mode, b: &Mode| (a.lambda - b.lambda).norm() <= EQUAL_BUT_FOR_ROUNDING * b.lambda.norm();
        let sizes: Vec<usize> = self.modes.chunk_by(is_equal).map(<[Mode]>::len).collect();
        let mut first = 0;
        for size in sizes {
            let together = self.names_of(first..first + size);
            self.names[first..first + size].fill(together);
            first += size;
        }
    }

    /// The modes of the whole brake, from the modes of all its sectors.
    fn joined(system: SecondOrder, sectors: &Sectors, of_sectors: &[Self]) -> Self {
        let named = |(sector, part): (&Sector, &Self)| {
            let whole = |mode: &Mode| Mode::normalised(&system.m, mode.lambda, sector.expand(&mode.shape));
            part.modes.iter().map(whole).zip(part.names.clone()).collect::<Vec<_>>()
        };
        let all: Vec<(Mode, Vec<ModeLabel>)> = sectors.iter().zip(of_sectors).flat_map(named).collect();
        let lambdas: Vec<Complex<f64>> = all.iter().map(|(mode, _)| mode.lambda).collect();
        let (modes, names) = rank_order(&lambdas).into_iter().map(|at| all[at].clone()).unzip();
        let expanded = |(sector, part): (&Sector, &Self)| {
            let NamedShapes { modes, names } = part.shapes.as_ref()?;
            let whole = |mode: &Mode| Mode::normalised(&system.m, mode.lambda, sector.expand(&mode.shape));
            Some(NamedShapes { modes: modes.iter().map(whole).collect(), names: names.clone() })
        };
        let shapes = sectors.iter().zip(of_sectors).map(expanded).collect::<Option<Vec<_>>>().map(NamedShapes::joined);
        Self { system, modes, names, shapes }
    }

    /// The modes of a whole brake that lie in one sector: with more than half of their squared norm.
    fn within(&self, sector: &Sector) -> Result<Self, OscModelError> {
        let system = sector.reduced(&self.system)?;
        let mut part = Self { system, modes: Vec::new(), names: Vec::new(), shapes: None };
        for (mode, names) in self.modes.iter().zip(&self.names) {
            let shape = sector.project(&mode.shape);
            if shape.norm_squared() > 0.5 * mode.shape.norm_squared() {
                part.modes.push(Mode::normalised(&part.system.m, mode.lambda, shape));
                part.names.push(names.clone());
            }
        }
        Ok(if self.shapes.is_some() { part.naming_by_likeness() } else { part })
    }

    /// The modes of `system`, with names from this reference: by MAC with the shapes of the origin, or by continuation, in fewer coordinates where the
    /// brake has some: there only the modes whose shapes these contain give and get names.
    fn linked(
        &self,
        solver: &dyn EigenSolver,
        system: SecondOrder,
        (way, coarse): (Way, Option<&CoarsePath<'_>>),
        plan: &Plan,
        work: &mut Workspace,
    ) -> Result<Self, Error> {
        let mut next = Self::unnamed(solver, system, plan, work)?;
        next.shapes = self.shapes.clone();
        if plan.mode_identity == ModeIdentity::Mac {
            next.names = next.names_by_likeness(&next.modes).unwrap_or_default();
            return Ok(next);
        }
        let linked = |[from, to]: [(&SecondOrder, &[Mode]); 2], work: &mut Workspace| {
            let path = Path {
                start: PathStart::System(from.0),
                start_modes: from.1,
                end: PathEnd { system: to.0, modes: to.1 },
            };
            match way {
                Way::Far => follow(solver, path, work),
                Way::Near => identify(solver, path, work),
            }
        };
        let links = match coarse {
            Some(CoarsePath { systems: [from, to], basis }) => {
                let [starts, ends] = [held(&self.modes, from, basis), held(&next.modes, to, basis)];

                let found = linked([(from, &starts.1), (to, &ends.1)], work)?;
                let mut links = vec![Vec::new(); self.modes.len()];
                for (start, link) in starts.0.into_iter().zip(found) {
                    links[start] = link.into_iter().map(|to| ends.0[to]).collect();
                }
                links
            }
            None => linked([(&self.system, &self.modes), (&next.system, &next.modes)], work)?,
        };
        next.name(&self.names, links);
        Ok(next)
    }

    /// Gives these modes the names of the modes that become them.
    fn name(&mut self, names: &[Vec<ModeLabel>], links: Vec<Vec<usize>>) {
        for (names, link) in names.iter().zip(links) {
            for to in link {
                self.names[to].extend(names);
            }
        }
        self.open_equal_modes();
    }
}

/// Way of modes from one system to another.
#[derive(Debug, Clone, Copy)]
enum Way {
    /// Continuation of every mode.
    Far,
    /// MAC of the modes first; all are followed where one is in doubt.
    Near,
}

/// The beginning of a path from a system, which the brake evaluates where it can.
fn path_start<'a>(system: &'a SecondOrder, own: Option<&'a dyn OwnedPath>) -> PathStart<'a> {
    own.map_or(PathStart::System(system), |own| PathStart::Owned(&system.m, own))
}

impl SectoredReference {
    /// The modes of `system`, named sector by sector as [`Reference::linked`] does.
    fn linked(
        from: &[Reference],
        solver: &dyn EigenSolver,
        sectors: &Sectors,
        system: SecondOrder,
        (way, coarse): (Way, Option<CoarsePath<'_>>),
        plan: &Plan,
    ) -> Result<Self, Error> {
        let mut work = bounded_workspace(system.order());
        let of_sector = |(from, sector): (&Reference, &Sector)| {
            from.linked(solver, sector.reduced(&system)?, (way, coarse.as_ref()), plan, &mut work)
        };
        let parts = from.iter().zip(sectors.iter()).map(of_sector).collect::<Result<Vec<_>, Error>>()?;
        Ok(Self { whole: Reference::joined(system, sectors, &parts), sectors: parts })
    }
}
