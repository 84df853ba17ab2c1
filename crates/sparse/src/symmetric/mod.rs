//! Symmetric parts of sparse matrices: scaled, the signs of their eigenvalues, and those nearest to zero.

mod factor;

use nalgebra::{DMatrix, SymmetricEigen};
use nalgebra_sparse::{CooMatrix, CscMatrix};

use crate::SparseError;
use crate::product::times;
use crate::unpatterned::unpatterned;
pub(crate) use factor::Factor;

/// Fraction of the largest entry of a row below which the diagonal entry does not scale the row; chosen: the diagonal entry of a rotation is a larger
/// fraction of the entries that couple it with displacements in metres.
const SMALL_DIAGONAL: f64 = 1e-8;
/// Number of steps of inverse iteration; chosen: with fewer the eigenvalues have fewer digits, each step is a solution with the whole block.
const STEPS: usize = 4;

/// Scales s_i with which `A_ij / (s_i s_j)` has a diagonal of 1: the roots of |A_ii|, or of [`SMALL_DIAGONAL`] times the largest entry of row and column i
/// where that is more. 0 where row and column are empty.
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

/// The rows that are not empty, and the symmetric part on these, scaled.
pub(crate) fn scaled_part(a: &CscMatrix<f64>) -> (Vec<usize>, CscMatrix<f64>) {
    let scales = scales(a);
    let rows: Vec<usize> = (0..a.nrows()).filter(|&row| scales[row] > 0.0).collect();
    let mut place = vec![0; a.nrows()];
    rows.iter().enumerate().for_each(|(at, &row)| place[row] = at);
    let mut sum = CooMatrix::new(rows.len(), rows.len());
    for (row, column, &value) in a.triplet_iter().filter(|(_, _, value)| **value != 0.0) {
        let half = 0.5 * value / scales[row] / scales[column];
        sum.push(place[row], place[column], half);
        sum.push(place[column], place[row], half);
    }
    (rows, CscMatrix::from(&sum))
}

/// The largest sum of a row's absolute values, which no eigenvalue exceeds.
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

/// The `count` eigenvalues of a symmetric matrix nearest to zero, at most its order, with orthonormal vectors, the nearest first: by inverse iteration with
/// a block and the Rayleigh quotients of it. `factor` is of the matrix, or of the matrix shifted by next to nothing.
pub(crate) fn nearest_to_zero(
    a: &CscMatrix<f64>,
    factor: &Factor,
    count: usize,
) -> Result<(Vec<f64>, DMatrix<f64>), SparseError> {
    let failed = || SparseError::Decomposition { what: "null vectors of a matrix" };
    // Any start will do that no vector is orthogonal to.
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
