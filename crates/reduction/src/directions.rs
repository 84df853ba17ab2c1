//! Orthonormal directions of vectors, and the fewest of them.

use nalgebra::DMatrix;

use super::dense;
use crate::ReductionError;

/// The principal directions of the parts of `columns` that are orthogonal to `basis`: orthonormal, by descending singular
/// value. Those with singular values up to `floor` are left out.
pub(super) fn directions(
    basis: &DMatrix<f64>,
    mut columns: DMatrix<f64>,
    floor: f64,
) -> Result<DMatrix<f64>, ReductionError> {
    for _ in 0..2 {
        let inside = dense::transposed_product(basis, &columns);
        dense::add_product(&mut columns, -1.0, basis, &inside);
    }
    let (mut vectors, values) = dense::left_singular(&columns)?;
    let kept = values.iter().take_while(|&&value| value > floor).count();
    vectors = vectors.columns(0, kept).into_owned();
    let inside = dense::transposed_product(basis, &vectors);
    dense::add_product(&mut vectors, -1.0, basis, &inside);
    vectors.column_iter_mut().for_each(|mut column| {
        column.normalize_mut();
    });
    Ok(vectors)
}

/// Largest singular value, of vectors of unit length, of a direction that is nothing but rounding; the vectors have about ten digits.
pub(super) const ROUNDING: f64 = 1e-11;

/// The fewest leading columns of `directions` that make `error` at most `wanted`; `most` of them, or all, where no fewer do, whatever the error is then. By
/// bisection: more columns are taken to be better.
pub(super) fn fewest(
    directions: &DMatrix<f64>,
    most: usize,
    wanted: f64,
    error: impl Fn(&DMatrix<f64>) -> f64,
) -> DMatrix<f64> {
    let first = |count: usize| directions.columns(0, count).into_owned();
    let (mut low, mut high) = (0, most.min(directions.ncols()));
    while low < high {
        let middle = low.midpoint(high);
        if error(&first(middle)) <= wanted { high = middle } else { low = middle + 1 }
    }
    first(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_orthonormal_and_span_what_is_new() {
        let basis = DMatrix::identity(6, 2);
        let columns = DMatrix::from_fn(6, 3, |i, j| ((2 * i + 3 * j * j + i * j) % 7) as f64 - 2.0);
        let found = directions(&basis, columns.clone(), ROUNDING).unwrap();
        assert_eq!(found.ncols(), 3);
        assert!((found.tr_mul(&found) - DMatrix::identity(3, 3)).amax() < 1e-14);
        assert!(basis.tr_mul(&found).amax() < 1e-15);
        let rest = &columns - &basis * basis.tr_mul(&columns);
        assert!((&found * found.tr_mul(&rest) - rest).amax() < 1e-13);
        // A vector that the basis holds adds no column.
        assert_eq!(directions(&basis, basis.clone(), ROUNDING).unwrap().ncols(), 0);
        assert_eq!(fewest(&found, 9, 1.0, |columns| 3.0 - columns.ncols() as f64).ncols(), 2);
        assert_eq!(fewest(&found, 1, 0.0, |_| 1.0).ncols(), 1);
    }
}
