//! Symmetric parts of sparse matrices: scaled, the signs of their eigenvalues, and those nearest to zero.

mod factor;

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use nalgebra_sparse::{CooMatrix, CscMatrix};

use crate::SparseError;
use crate::unpatterned::unpatterned;
pub(crate) use factor::Factor;

/// Fraction of the largest entry of a row below which the diagonal entry does not scale the row; chosen: the diagonal entry of a rotation is a larger
/// fraction of the entries that couple it with displacements, in any usual unit.
const SMALL_DIAGONAL: f64 = 1e-8;
/// Least number of vectors of the space in which the eigenvalues nearest to zero are looked for; chosen: with 32 the least eigenvalue of a consistent mass is
/// found within some per cent, each vector is a solution.
const LEAST_BASIS: usize = 32;
/// Least number of blocks of that space; chosen: null vectors are found by the second.
const LEAST_BLOCKS: usize = 3;
/// Part of a vector, as a fraction of its length, below which rounding alone is left of it; chosen, some hundred roundings.
const NOTHING_LEFT: f64 = 1e-13;

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

/// The `count` eigenvalues of a symmetric matrix nearest to zero, at most its order, with orthonormal vectors, the nearest first: by the Rayleigh-Ritz
/// procedure for the inverse, on a block Krylov space of it. `factor` is of `A + shift I`, with a shift of next to nothing. Null vectors are found to rounding where
/// `count` is more than their number; other values are from above in their distance from zero, and that of the first is within some per cent.
///
/// The Ritz values are those of the inverse, because those of A itself may lie anywhere between its eigenvalues, at zero too where it is indefinite. The
/// first is never nearer to `-shift` than an eigenvalue is.
pub(crate) fn nearest_to_zero(
    factor: &Factor,
    shift: f64,
    count: usize,
) -> Result<(Vec<f64>, DMatrix<f64>), SparseError> {
    let failed = || SparseError::Decomposition { what: "null vectors of a matrix" };
    let order = factor.order();
    let wanted = LEAST_BASIS.max(LEAST_BLOCKS * count).min(order);
    // Any start is right that is orthogonal to no eigenvector.
    let mut block = DMatrix::from_fn(order, count, |i, j| unpatterned((i * count + j + 1) as f64) - 0.5);
    let mut basis: Vec<DVector<f64>> = Vec::with_capacity(wanted);
    let mut images = Vec::with_capacity(wanted);
    while basis.len() < wanted {
        let known = basis.len();
        for column in block.column_iter() {
            basis.extend(orthonormal(column.into_owned(), &basis));
        }
        if basis.len() == known {
            // The space is invariant.
            break;
        }
        block = factor.solve(&DMatrix::from_columns(&basis[known..]));
        if block.iter().any(|value| !value.is_finite()) {
            return Err(failed());
        }
        images.extend(block.column_iter().map(|column| column.into_owned()));
    }
    let basis = DMatrix::from_columns(&basis);
    let projected = basis.tr_mul(&DMatrix::from_columns(&images));
    let symmetric = (&projected + projected.transpose()) * 0.5;
    let ritz = SymmetricEigen::try_new(symmetric, f64::EPSILON, 1000).ok_or_else(failed)?;
    let mut nearest: Vec<usize> = (0..ritz.eigenvalues.len()).collect();
    nearest.sort_by(|&i, &j| ritz.eigenvalues[j].abs().total_cmp(&ritz.eigenvalues[i].abs()));
    nearest.truncate(count);
    let values = nearest.iter().map(|&j| 1.0 / ritz.eigenvalues[j] - shift).collect();
    Ok((values, basis * ritz.eigenvectors.select_columns(&nearest)))
}

/// A vector without its parts along an orthonormal basis, of length 1; `None` where rounding alone is left.
fn orthonormal(mut vector: DVector<f64>, basis: &[DVector<f64>]) -> Option<DVector<f64>> {
    let length = vector.norm();
    loop {
        let before = vector.norm();
        for known in basis {
            vector.axpy(-known.dot(&vector), known, 1.0);
        }
        let left = vector.norm();
        if left <= NOTHING_LEFT * length {
            return None;
        }
        if left > 0.5 * before {
            return Some(vector / left);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The distance of the eigenvalues from zero, of a dense matrix and by the search; the latter is never less.
    fn distances(dense: &DMatrix<f64>) -> [f64; 2] {
        let a = CscMatrix::from(dense);
        let (found, vectors) = nearest_to_zero(&Factor::new(&a).unwrap(), 0.0, 2.min(a.nrows())).unwrap();
        let unit = vectors.tr_mul(&vectors);
        assert!((&unit - DMatrix::identity(unit.nrows(), unit.ncols())).amax() < 1e-12, "{unit}");
        let exact = SymmetricEigen::new(dense.clone()).eigenvalues.abs().min();
        assert!(found[0].abs() > (1.0 - 1e-9) * exact, "{} for {exact}", found[0]);
        [exact, found[0].abs()]
    }

    proptest! {
        /// Dashpots of both signs that are coupled weakly: after scaling the eigenvalues crowd at 1 and -1, and none is near zero.
        #[test]
        fn eigenvalues_of_both_signs_do_not_cancel(
            diagonal in proptest::collection::vec(prop_oneof![-30.0..-10.0, 10.0..30.0], 1..60),
            coupling in -4.0..4.0,
        ) {
            let n = diagonal.len();
            let entry = |i: usize, j: usize| if i == j { diagonal[i] } else if i.abs_diff(j) == 1 { coupling } else { 0.0 };
            let [exact, found] = distances(&DMatrix::from_fn(n, n, entry));
            prop_assert!(found < 1.05 * exact, "{found} for {exact}");
        }
    }

    /// The consistent mass of a cube of n^3 nodes, scaled to a unit diagonal, has eigenvalues crowded towards the least one, a product of those of a line.
    #[test]
    fn the_least_of_crowded_eigenvalues_is_found() {
        let line = |n: usize| {
            let diagonal = |i: usize| if i == 0 || i == n - 1 { 2.0_f64 } else { 4.0 };
            DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
                0 => 1.0,
                1 => 1.0 / (diagonal(i) * diagonal(j)).sqrt(),
                _ => 0.0,
            })
        };
        for n in [5, 8] {
            let side = line(n);
            let [exact, found] = distances(&side.kronecker(&side).kronecker(&side));
            assert!(found < 1.05 * exact, "{found} for {exact}");
        }
    }
}
