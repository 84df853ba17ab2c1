//! The columns of a sparse matrix, and its product with a dense matrix, column by column: the product of `nalgebra-sparse` goes along rows of the
//! dense matrix and takes several times as long.

use nalgebra::DMatrix;
use nalgebra_sparse::CscMatrix;

/// Product `A X`, n x k, of a sparse A, n x n, and a dense X, n x k.
#[must_use]
pub fn times(a: &CscMatrix<f64>, x: &DMatrix<f64>) -> DMatrix<f64> {
    let mut product = DMatrix::zeros(a.nrows(), x.ncols());
    for (mut sums, factors) in product.column_iter_mut().zip(x.column_iter()) {
        for ((rows, values), &factor) in columns(a).zip(factors.iter()) {
            for (&row, &value) in rows.iter().zip(values) {
                sums[row] += value * factor;
            }
        }
    }
    product
}

/// Rows and values of the entries of each column.
#[inline]
pub fn columns(a: &CscMatrix<f64>) -> impl Iterator<Item = (&[usize], &[f64])> {
    let (offsets, rows, values) = a.csc_data();
    offsets.windows(2).map(move |ends| {
        let entries = ends[0]..ends[1];
        (&rows[entries.clone()], &values[entries])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_product_is_that_of_the_full_matrices() {
        let a = DMatrix::from_fn(5, 5, |i, j| if (i + 2 * j) % 3 == 0 { (1 + i + 5 * j) as f64 } else { 0.0 });
        let x = DMatrix::from_fn(5, 3, |i, j| (i * j) as f64 - 2.0);
        assert_eq!(times(&CscMatrix::from(&a), &x), a * x);
    }
}
