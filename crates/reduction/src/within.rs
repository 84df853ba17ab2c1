//! A smaller basis within a larger one, for one configuration of a brake.
//!
//! A basis that holds a brake in all its configurations ([`response_basis`](super::response_basis)) has several hundred columns. For one
//! configuration and the friction of its draws a few dozen are enough, and to find them nothing sparse has to be solved: the brake on the
//! larger basis stands for the full one.

mod search;

use linsys::{AffineSystem, OperatingPoint, SecondOrder};
use nalgebra::DMatrix;
use num_complex::Complex;
use sparse::SparseAffineSystem;

use self::search::Search;
use super::shared::Smaller;
use super::{Options, Wanted, dense};
use crate::ReductionError;

/// Most changes of a smaller basis for each training point; chosen: a residual that stays above the tolerance is not brought below it by more.
const MOST_CHANGES: usize = 20;

/// A smaller basis, and how it was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Within {
    /// W, k x m, orthonormal: columns of the smaller basis in terms of the larger one.
    pub basis: DMatrix<f64>,
    /// The points at which all modes of the larger system were found.
    pub solved: Vec<OperatingPoint>,
    /// Modes of the larger system that were not held by a smaller basis whose residuals were all small.
    pub missed: Vec<Complex<f64>>,
    /// The modes of the larger system in the rectangle at the first given point.
    pub first: Vec<Complex<f64>>,
    /// The largest distance, relative to |lambda|, of a mode of the smaller basis from that of the larger system, where all modes were
    /// found although every residual was small.
    pub distance: f64,
    /// Whether every training point was within the tolerance, and the last complete solutions showed no missed mode.
    pub is_reached: bool,
}

/// The fewest directions within a larger basis that hold the modes in the rectangle at all given and training points. `reduced` is
/// `system` on that basis, with the same terms and channels.
///
/// All modes of the larger system are found at the given points, of which there is at least one. At a training point where a residual in
/// the larger system is above the tolerance the modes are corrected, and what they become enters the basis, until none is. Then,
/// until `options.probes` in a row show no missed mode, all modes are found at the point whose system differs most from those where they
/// have been.
///
/// # Errors
/// A point of another system, no mode in the rectangle at any given point, a singular reduced mass matrix.
pub fn within(
    system: &SparseAffineSystem,
    reduced: &AffineSystem,
    wanted: &Wanted<'_>,
    options: &Options,
) -> Result<Within, ReductionError> {
    let mut search = Search::new(system, reduced, wanted, options)?;
    (0..wanted.points.len()).try_for_each(|at| search.solve(at))?;
    let in_rectangle = |lambda: &Complex<f64>| wanted.rectangle.contains_to_the_right(*lambda, 0.0);
    search.first =
        search.known.first().map_or(&[][..], |known| &known.lambdas).iter().copied().filter(in_rectangle).collect();
    let training: Vec<usize> = (wanted.points.len()..search.points.len()).collect();
    let (mut small, mut next, mut passed, mut quiet) = (search.smaller()?, 0, 0, 0);
    let mut left = MOST_CHANGES * training.len();
    while !training.is_empty() && !search.is_exhausted(small.basis()) && left > 0 {
        if passed < training.len() {
            let at = training[next];
            if search.judged(&mut small, at)?.1 <= options.tolerance {
                (next, passed) = ((next + 1) % training.len(), passed + 1);
                continue;
            }
            search.improve(&mut small, at)?;
            (passed, left) = (0, left - 1);
        } else {
            if quiet >= options.probes {
                break;
            }
            let Some(at) = search.farthest()? else { break };
            if search.probe(&mut small, at)? {
                quiet += 1;
                continue;
            }
            (passed, quiet) = (0, 0);
        }
        small = search.smaller()?;
    }
    let is_reached = passed == training.len() && !search.is_exhausted(small.basis());
    let solved = search.known.iter().filter(|known| known.is_complete());
    let solved = solved.map(|known| (*search.points[known.point].at).clone()).collect();
    let basis = small.into_basis();
    Ok(Within { basis, solved, missed: search.missed, first: search.first, distance: search.distance, is_reached })
}

/// What the first columns of a smaller basis hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Rung {
    /// How many columns.
    pub columns: usize,
    /// The largest residual in the full system of a mode in the rectangle, at all given and training points.
    pub residual: f64,
    /// The eigenvalues in the rectangle at the first given point.
    pub first: Vec<Complex<f64>>,
}

/// Cost against error: what some of the first columns of the basis that [`within()`] found hold. They are its principal directions in
/// the order of what they hold, and an evaluation costs about the square of their number.
///
/// # Errors
/// A point of another system, a singular reduced mass matrix.
pub fn rungs(
    system: &SparseAffineSystem,
    reduced: &AffineSystem,
    wanted: &Wanted<'_>,
    basis: &DMatrix<f64>,
    columns: &[usize],
) -> Result<Vec<Rung>, ReductionError> {
    let options = Options::default();
    let search = Search::new(system, reduced, wanted, &options)?;
    let rung = |&columns: &usize| {
        let basis = basis.columns(0, columns.min(basis.ncols())).into_owned();
        let columns = basis.ncols();
        let mut small = Smaller::new(basis, reduced);
        let (mut first, mut residual) = (None, 0.0_f64);
        for at in 0..search.points.len() {
            let (lambdas, largest) = search.judged(&mut small, at)?;
            residual = residual.max(largest);
            first.get_or_insert(lambdas);
        }
        Ok(Rung { columns, residual, first: first.unwrap_or_default() })
    };
    columns.iter().map(rung).collect()
}

/// All eigenvalues of a system, and vectors whose first n entries are the shapes.
///
/// With `z = [y; lambda y / gamma; t s]` and internal states s the system is `A z = lambda z`,
/// `A = [0, gamma I, 0; -M^-1 K / gamma, -M^-1 C, M^-1 F / (gamma t); 0, gamma t E, -diag(a)]`; t makes both couplings of a state alike in
/// size.
pub(super) fn eigen(system: &SecondOrder, gamma: f64) -> Result<dense::Eigen, ReductionError> {
    let (n, s) = (system.order(), system.states());
    let SecondOrder { m, c, k, internal } = system;
    let right = {
        let mut right = DMatrix::zeros(n, 2 * n + s);
        right.columns_mut(0, n).copy_from(k);
        right.columns_mut(n, n).copy_from(c);
        right.columns_mut(2 * n, s).copy_from(&internal.force);
        dense::solve_real(m, &right)?
    };
    let mut state = DMatrix::zeros(2 * n + s, 2 * n + s);
    state.view_mut((0, n), (n, n)).fill_diagonal(gamma);
    state.view_mut((n, 0), (n, n)).copy_from(&(right.columns(0, n) / -gamma));
    state.view_mut((n, n), (n, n)).copy_from(&-right.columns(n, n));
    for at in 0..s {
        let (force, drive) = (right.column(2 * n + at), internal.drive.row(at));
        let (given, taken) = (force.norm() / gamma, gamma * drive.norm());
        let t = if given > 0.0 && taken > 0.0 { (given / taken).sqrt() } else { 1.0 };
        state.view_mut((n, 2 * n + at), (n, 1)).copy_from(&(force / (gamma * t)));
        state.view_mut((2 * n + at, n), (1, n)).copy_from(&(drive * (gamma * t)));
        state[(2 * n + at, 2 * n + at)] = -internal.decay[at];
    }
    dense::eigen_real(&state)
}
