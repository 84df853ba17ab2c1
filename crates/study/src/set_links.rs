//! Links between the modes of one set of constraints and the modes of another set that holds more.
//!
//! Modes have their names by frequency rank in each set of its own, so equal names of two sets say nothing. Between the two sets
//! the coupling between the degrees of freedom that the second set holds and the others fades out, and each mode is followed by
//! continuation. The path ends in the modes of the second set and, apart from them, in the modes of the held degrees of freedom. Springs to
//! ground whose stiffness grows without limit would end in the same modes, but push the modes of the held degrees of freedom up through all
//! others, which exchange shapes with them on the way.

use cea::{EigenSolver, Mode, Modes, Workspace};
use linsys::{DofMap, SecondOrder};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use rayon::prelude::*;
use tracking::{Path, PathEnd, PathStart, follow, mac};

use super::reference::bounded_workspace;
use super::{Plan, Reference};
use crate::Error;

/// Links between the modes of one set of constraints and the modes of another set that holds more.
#[derive(Debug, Clone, PartialEq)]
pub struct SetLinks {
    /// Index of the set that holds less.
    pub from: usize,
    /// Index of the set that holds more.
    pub to: usize,
    /// MAC of each mode of `from` (row) and mode of `to` (column), in the order of the reference modes of their origins.
    pub mac: DMatrix<f64>,
    /// Modes that each mode of `from` may become, several where a coalescence leaves it open: index of a mode of `to`, or `None`, a mode of
    /// the held degrees of freedom.
    pub becomes: Vec<Vec<Option<usize>>>,
}

/// Index of the origin of a set of constraints, in [`Plan::origins`]; `None` where no scene has the set.
pub fn origin_of_set(plan: &Plan, constraints: usize) -> Option<usize> {
    let scene = plan.scenes.iter().find(|scene| scene.key.constraints == constraints)?;
    Some(plan.configuration(scene).origin)
}

/// The links between all pairs of sets of which the later one holds all that the earlier one does, and more.
///
/// # Errors
/// Those of the solver.
pub fn set_links(plan: &Plan, origins: &[Reference], solver: &dyn EigenSolver) -> Result<Vec<SetLinks>, Error> {
    let sets: Vec<(usize, usize)> =
        (0..plan.labels.constraints.len()).filter_map(|set| Some((set, origin_of_set(plan, set)?))).collect();
    let dofs = |origin: usize| &plan.origins[origin].brake.dofs;
    let pairs: Vec<[(usize, usize); 2]> = sets
        .iter()
        .flat_map(|&a| sets.iter().map(move |&b| [a, b]))
        .filter(|[a, b]| a.0 < b.0 && holds_more(dofs(a.1), dofs(b.1)))
        .collect();
    let link = |&[a, b]: &[(usize, usize); 2]| {
        let pair = Pair { from: (dofs(a.1), &origins[a.1]), to: (dofs(b.1), &origins[b.1]) };
        let (mac, becomes) = (pair.mac(), pair.becomes(solver)?);
        Ok(SetLinks { from: a.0, to: b.0, mac, becomes })
    };
    pairs.par_iter().map(link).collect()
}

/// True if `b` holds all that `a` does, and more.
fn holds_more(a: &DofMap, b: &DofMap) -> bool {
    a.total() == b.total() && b.free().len() < a.free().len() && b.free().iter().all(|&dof| a.position(dof).is_some())
}

/// Two sets with their degrees of freedom and modes.
struct Pair<'a> {
    from: (&'a DofMap, &'a Reference),
    to: (&'a DofMap, &'a Reference),
}

impl Pair<'_> {
    /// Flag of each degree of freedom of `from`, true if it is held in `to`.
    fn is_held(&self) -> Vec<bool> {
        self.from.0.free().iter().map(|&dof| self.to.0.position(dof).is_none()).collect()
    }

    /// The modes of `to` over the degrees of freedom of `from`: zero where held.
    fn ends(&self) -> Vec<Mode> {
        let expand = |mode: &Mode| {
            let shape: Vec<Complex<f64>> = self
                .from
                .0
                .free()
                .iter()
                .map(|&dof| self.to.0.position(dof).map_or(Complex::ZERO, |at| mode.shape[at]))
                .collect();
            Mode { lambda: mode.lambda, shape: DVector::from_vec(shape) }
        };
        self.to.1.modes.iter().map(expand).collect()
    }

    fn mac(&self) -> DMatrix<f64> {
        mac(&self.from.1.modes, &self.ends(), &self.from.1.system.m)
    }

    /// Modes that each mode of `from` may become, as [`SetLinks::becomes`].
    fn becomes(&self, solver: &dyn EigenSolver) -> Result<Vec<Vec<Option<usize>>>, Error> {
        let (held, start, mut ends) = (self.is_held(), self.from.1, self.ends());
        let mut work = bounded_workspace(start.system.order());
        let kept = ends.len();
        ends.extend(modes_of_held(&start.system, &held, solver, &mut work)?);
        let uncoupled = without_coupling(&start.system, &held);
        let end = PathEnd { system: &uncoupled, modes: &ends };
        let path = Path { start: PathStart::System(&start.system), start_modes: &start.modes, end };
        let links = follow(solver, path, &mut work)?;
        let ends_of = |link: Vec<usize>| {
            let mut ends: Vec<Option<usize>> = link.into_iter().map(|to| (to < kept).then_some(to)).collect();
            ends.sort_unstable();
            ends.dedup();
            ends
        };
        Ok(links.into_iter().map(ends_of).collect())
    }
}

/// The modes of the held degrees of freedom left to themselves, over all degrees of freedom.
fn modes_of_held(
    system: &SecondOrder,
    held: &[bool],
    solver: &dyn EigenSolver,
    work: &mut Workspace,
) -> Result<Vec<Mode>, Error> {
    let places: Vec<usize> = (0..held.len()).filter(|&i| held[i]).collect();
    let part = |matrix: &DMatrix<f64>| matrix.select_rows(&places).select_columns(&places);
    let alone = SecondOrder::new(part(&system.m), part(&system.c), part(&system.k))?;
    let spectrum = solver.eigenvalues(&alone, work)?;
    let found = Modes::classify(&alone, &spectrum, work)?;
    let expand = |mode: Mode| {
        let mut shape = DVector::zeros(held.len());
        places.iter().zip(mode.shape.iter()).for_each(|(&i, &u)| shape[i] = u);
        Mode { lambda: mode.lambda, shape }
    };
    Ok(Mode::at(&alone, &found.oscillatory, work)?.into_iter().map(expand).collect())
}

/// The system without coupling between the held degrees of freedom and the others; internal states stay with the others.
fn without_coupling(system: &SecondOrder, held: &[bool]) -> SecondOrder {
    let mut apart = system.clone();
    for matrix in [&mut apart.m, &mut apart.c, &mut apart.k] {
        for i in 0..held.len() {
            for j in (0..held.len()).filter(|&j| held[i] != held[j]) {
                matrix[(i, j)] = 0.0;
            }
        }
    }
    for i in (0..held.len()).filter(|&i| held[i]) {
        apart.internal.drive.column_mut(i).fill(0.0);
        apart.internal.force.row_mut(i).fill(0.0);
    }
    apart
}
