//! A matrix of low rank as a sum of outer products.

use nalgebra::{DMatrix, DVector};

/// Largest entry, as a fraction of the largest of the matrix, that is taken for rounding; chosen: differences of matrices that are projected lose a few
/// digits.
const ROUNDING: f64 = 1e-10;

/// Columns and rows whose outer products sum up to a matrix, by elimination with complete pivoting; `None` where it takes more than `most`.
pub(super) fn outer_products(mut a: DMatrix<f64>, most: usize) -> Option<Vec<[DVector<f64>; 2]>> {
    let floor = ROUNDING * a.amax();
    let mut products = Vec::new();
    loop {
        let (row, column) = a.iamax_full();
        let pivot = a[(row, column)];
        if pivot.abs() <= floor {
            return Some(products);
        }
        if products.len() == most {
            return None;
        }
        let [left, right] = [a.column(column) / pivot, a.row(row).transpose()];
        a.ger(-1.0, &left, &right, 1.0);
        products.push([left, right]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_products_sum_up_to_the_matrix_and_are_as_many_as_its_rank() {
        let [left, right] =
            [3, 5].map(|seed| DMatrix::from_fn(9, 4, |i, j| ((i * seed + 7 * j * j + i * j) % 11) as f64));
        let a = &left * right.transpose();
        let products = outer_products(a.clone(), 4).unwrap();
        let sum = products.iter().fold(DMatrix::zeros(9, 9), |sum, [left, right]| sum + left * right.transpose());
        assert!((sum - &a).amax() < 1e-9 * a.amax());
        assert!(outer_products(a, 3).is_none());
        assert!(outer_products(DMatrix::zeros(3, 3), 0).unwrap().is_empty());
    }
}
