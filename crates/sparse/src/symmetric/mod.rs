//! Symmetric parts of sparse matrices: scaled, the signs of their eigenvalues, and those nearest to zero.

mod factor;

use nalgebra::{DMatrix, SymmetricEigen};
use nalgebra_sparse::{CooMatrix, CscMatrix};

use crate::SparseError;
use crate::product::times;
use crate::unpatterned::unpatterned;
pub(crate) use factor::Factor;

/// Fraction of the largest entry of a row below which the diagonal entry does not scale the row; chosen: below what the diagonal of a
/// rotational row is, compared with its coupling to displacements, in any usual unit.
const SMALL_DIAGONAL: f64 = 1e-8;
/// Number of steps of inverse iteration; chosen: each step is a solution with the whole block, and divides what is not wanted by the ratio of its distance from zero
/// to that of what is, so that null vectors beside eigenvalues 1e4 times as large, and more, are found to rounding in four. Eigenvalues that are not set apart
/// like that are found roughly.
const STEPS: usize = 4;

/// Scales s_i with which `A_ij / (s_i s_j)` has a diagonal of 1: the roots of |A_ii|, or of [`SMALL_DIAGONAL`] times the largest entry of row and column i
/// where that is more. 0 where row and column are empty. A may be unsymmetric.
pub(crate) fn scales(a: &CscMatrix<f64>) -> Vec<f64> {
    let (mut diagonal, mut largest) = (vec![0.0; a.nrows()], vec![0.0_f64; a.nrows()]);
    for (row, column, &value) in a.triplet_iter() {
        largest[row] = largest[row].max(value.abs());
        largest[column] = largest[column].max(value.abs());
        if row == column {
            diagonal[row] = value.abs();
        }
    }
    diagonal.iter().zip(largest).map(|(&diagonal, largest)| diagonal.max(SMALL_DIAGONAL * largest).sqrt()).collect()
}

/// The rows of A that are not empty, and the symmetric part on these, scaled. A row of a skew matrix, whose symmetric part is zero, is not empty: `health` counts it as null.
pub(crate) fn scaled_part(a: &CscMatrix<f64>) -> (Vec<usize>, CscMatrix<f64>) {
    let scales = scales(a);
    let rows: Vec<usize> = (0..a.nrows()).filter(|&row| scales[row] > 0.0).collect();
    let mut places = vec![0; a.nrows()];
    rows.iter().enumerate().for_each(|(at, &row)| places[row] = at);
    let mut sum = CooMatrix::new(rows.len(), rows.len());
    for (row, column, &value) in a.triplet_iter().filter(|(_, _, value)| **value != 0.0) {
        let half = 0.5 * value / scales[row] / scales[column];
        sum.push(places[row], places[column], half);
        sum.push(places[column], places[row], half);
    }
    (rows, CscMatrix::from(&sum))
}

/// The largest sum of the absolute values of a column; of a symmetric matrix no eigenvalue exceeds it.
pub(crate) fn norm(a: &CscMatrix<f64>) -> f64 {
    let sums = a.col_iter().map(|column| column.values().iter().map(|value| value.abs()).sum());
    sums.fold(0.0, f64::max)
}

pub(crate) fn largest_entry(a: &CscMatrix<f64>) -> f64 {
    a.values().iter().fold(0.0_f64, |largest, value| largest.max(value.abs()))
}

/// `A + shift I`.
pub(crate) fn shifted(a: &CscMatrix<f64>, shift: f64) -> CscMatrix<f64> {
    a + CscMatrix::identity(a.nrows()) * shift
}

/// Ritz values of a symmetric matrix for its `count` eigenvalues nearest to zero, at most its order, with orthonormal vectors, the nearest first: by inverse iteration
/// with a block and the Rayleigh quotients of it. Callers ask for more vectors than they want, so that those wanted are set apart from those that are not in the block:
/// `health` two more; `reach` of the solver none, as it proves its bound by a factorisation.
/// `factor` is a factorisation of `a - shift I` with |shift| far below the eigenvalues sought.
///
/// Null vectors are found to rounding (see [`STEPS`]). Values of a definite matrix are from above: at least the eigenvalue. Of an indefinite matrix a value need not be near any
/// eigenvalue, where eigenvalues of either sign are nearly as far from zero as each other.
pub(crate) fn nearest_to_zero(
    a: &CscMatrix<f64>,
    factor: &Factor,
    count: usize,
) -> Result<(Vec<f64>, DMatrix<f64>), SparseError> {
    let failed = || SparseError::Decomposition { what: "null vectors of a matrix" };
    // Any start that is orthogonal to no eigenvector will do.
    let mut x = DMatrix::from_fn(a.nrows(), count, |i, j| unpatterned((i * count + j + 1) as f64) - 0.5);
    for _ in 0..STEPS {
        x = factor.solve(&x).qr().q();
        if x.iter().any(|value| !value.is_finite()) {
            return Err(failed());
        }
    }
    let quotients = SymmetricEigen::try_new(x.tr_mul(&times(a, &x)), f64::EPSILON, 1000).ok_or_else(failed)?;
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&i, &j| quotients.eigenvalues[i].abs().total_cmp(&quotients.eigenvalues[j].abs()));
    let values = order.iter().map(|&j| quotients.eigenvalues[j]).collect();
    Ok((values, x * quotients.eigenvectors.select_columns(&order)))
}
