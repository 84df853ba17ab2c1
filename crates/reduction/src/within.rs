//! A smaller basis within a larger one, for one configuration of a brake.
//!
//! A basis that holds a brake in all its configurations ([`response_basis`](super::response_basis)) has several hundred columns. For one
//! configuration and the friction of its draws a few dozen are enough, and to find them nothing sparse has to be solved: the brake on the
//! larger basis stands for the full one.

mod search;

use linsys::{AffineSystem, OperatingPoint};
use nalgebra::DMatrix;
use num_complex::Complex;
use sparse::SparseAffineSystem;

use self::search::Search;
use super::shared::Smaller;
use super::{Options, Wanted};
use crate::ReductionError;

/// Most changes of a smaller basis; chosen: a residual that stays above the tolerance is not brought below it by more.
const MOST_ROUNDS: usize = 20;

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
    /// True if every training point was within the tolerance, and the last complete solutions showed no missed mode.
    pub is_reached: bool,
}

/// The fewest directions within a larger basis that hold the modes in the rectangle at all given and training points. `reduced` is
/// `system` on that basis, with the same terms and channels.
///
/// All modes of the larger system are found at the given points, of which there is at least one. At the training points where a residual in
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
    search.first = search.known.first().map_or(Vec::new(), |known| in_rectangle(&known.lambdas, wanted));
    let training: Vec<usize> = (wanted.points.len()..search.points.len()).collect();
    let (mut small, mut quiet, mut rounds) = (search.smaller()?, 0, 0);
    let is_reached = loop {
        let judged = search.judged(&mut small, &training)?;
        let above: Vec<_> = judged.into_iter().filter(|judged| judged.residual > options.tolerance).collect();
        if search.is_exhausted(small.basis()) || rounds == MOST_ROUNDS {
            break above.is_empty() && quiet >= options.probes && !search.is_exhausted(small.basis());
        }
        if above.is_empty() {
            if training.is_empty() || quiet >= options.probes {
                break true;
            }
            let Some(at) = search.farthest()? else { break true };
            if search.probe(&mut small, at)? {
                quiet += 1;
                continue;
            }
            quiet = 0;
        } else {
            for judged in above {
                if !search.is_exhausted(small.basis()) {
                    search.improve(judged)?;
                }
            }
        }
        small = search.smaller()?;
        rounds += 1;
    };
    let solved = search.known.iter().filter(|known| known.is_complete());
    let solved = solved.map(|known| (*search.points[known.point].at).clone()).collect();
    let basis = small.into_basis();
    Ok(Within { basis, solved, missed: search.missed, first: search.first, distance: search.distance, is_reached })
}

/// Error of the first columns of a smaller basis, taken as a basis.
#[derive(Debug, Clone, PartialEq)]
pub struct Rung {
    /// Number of columns.
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
        for judged in search.judged(&mut small, &(0..search.points.len()).collect::<Vec<_>>())? {
            residual = residual.max(judged.residual);
            first.get_or_insert_with(|| in_rectangle(&judged.lambdas, wanted));
        }
        Ok(Rung { columns, residual, first: first.unwrap_or_default() })
    };
    columns.iter().map(rung).collect()
}

/// The wanted ones of some eigenvalues.
fn in_rectangle(lambdas: &[Complex<f64>], wanted: &Wanted<'_>) -> Vec<Complex<f64>> {
    lambdas.iter().copied().filter(|&lambda| wanted.rectangle.contains_to_the_right(lambda, 0.0)).collect()
}
