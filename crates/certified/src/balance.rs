//! Balancing: rows and columns of a matrix scaled to one size by powers of two, and large rows first.
//!
//! A diagonal similarity (Parlett and Reinsch, Numer. Math. 13, 1969) is exact in binary numbers. Where degrees of freedom are as
//! different as masses over many powers of ten, it shows how the matrix is graded. Householder's reduction and QR steps keep rows
//! graded downwards so, and small eigenvalues their digits.

use nalgebra::DMatrix;

use super::lane::Lane;
use super::planar::Planar;

/// Least ratio of the scales of two rows: a matrix that is not graded gains nothing, and of zeros that are rounding errors balancing
/// makes more than they are (Watkins, Electron. Trans. Numer. Anal. 23, 2006).
const LEAST_GRADING: f64 = 1e6;
/// Most sweeps over all rows and columns; chosen for those that would take turns for ever: most matrices take three to six.
const MOST_SWEEPS: usize = 20;

/// A matrix similar to the one given.
pub(super) struct Balanced<T> {
    pub(super) matrix: Planar<T>,
    /// Absolute error of this matrix per relative error of the columns of the given one.
    pub(super) columns: f64,
}

/// `matrix` balanced and its rows in descending order, or as it is where its rows need no different scales.
pub(super) fn balanced<T: Lane>(matrix: Planar<T>) -> Balanced<T> {
    let size = matrix.rows();
    let mut moduli = DMatrix::from_fn(size, size, |i, j| if i == j { 0.0 } else { matrix.get(i, j).value().abs() });
    let scale = scale(&mut moduli);
    let (least, most) = scale.iter().fold((1.0, 1.0), |(a, b): (f64, f64), &s| (a.min(s), b.max(s)));
    if most < LEAST_GRADING * least {
        let columns = matrix.norm();
        return Balanced { matrix, columns };
    }
    let column = |j: usize| matrix.rounded(j).iter().map(|x| x * x).sum::<f64>() * scale[j] * scale[j];
    let columns = (0..size).map(column).sum::<f64>() * scale.iter().map(|s| 1.0 / (s * s)).sum::<f64>();
    let largest = |i: usize| matrix.get(i, i).value().abs().max(moduli.row(i).amax());
    let mut order: Vec<_> = (0..size).map(|i| (largest(i), i)).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    let matrix = Planar::from_fn(size, size, |i, j| {
        let (i, j) = (order[i].1, order[j].1);
        matrix.get(i, j) * T::from(scale[j] / scale[i])
    });
    Balanced { matrix, columns: columns.sqrt() }
}

/// Powers of two s with columns and rows of `a_ij s_j / s_i` of like sums; `a` becomes that.
fn scale(a: &mut DMatrix<f64>) -> Vec<f64> {
    let size = a.nrows();
    let mut scale = vec![1.0; size];
    for _ in 0..MOST_SWEEPS {
        let mut is_done = true;
        for (i, scale) in scale.iter_mut().enumerate() {
            let (column, row) = (a.column(i).sum(), a.row(i).sum());
            if !(column > 0.0 && row > 0.0 && column.is_finite() && row.is_finite()) {
                continue;
            }
            // Column and row become `f column` and `row / f`, and their sum is smallest where these are equal.
            let f = (row / column).sqrt().log2().round().clamp(-100.0, 100.0).exp2();
            if f * column + row / f < 0.95 * (column + row) {
                is_done = false;
                *scale *= f;
                a.column_mut(i).scale_mut(f);
                a.row_mut(i).unscale_mut(f);
            }
        }
        if is_done {
            break;
        }
    }
    scale
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::wave;

    #[test]
    fn a_graded_matrix_is_balanced_in_descending_order_and_keeps_its_powers() {
        let n = 12;
        let grade = |i: usize| (7 * i % n) as i32;
        let plain = DMatrix::from_fn(n, n, |i, j| wave(i, j) * 2f64.powi(-2 * grade(i).max(grade(j))));
        let hidden = DMatrix::from_fn(n, n, |i, j| plain[(i, j)] * 2f64.powi(9 * (grade(i) - grade(j))));
        let found = balanced(Planar::<f64>::from(&hidden)).matrix;
        let found = DMatrix::from_fn(n, n, |i, j| found.get(i, j));
        assert!(found.norm() < 2.0 * plain.norm() && found.norm() < 1e-9 * hidden.norm());
        assert!((1..n).all(|i| found.row(i).amax() <= found.row(i - 1).amax()));
        let (mut power, mut expected) = (found.clone(), plain.clone());
        for _ in 0..4 {
            assert!((power.trace() - expected.trace()).abs() < 1e-14 * expected.norm());
            (power, expected) = (power * &found, expected * &plain);
        }
    }

    #[test]
    fn what_is_not_graded_or_not_finite_stays_as_it_is() {
        for entry in [0.3, 1e5, f64::NAN] {
            let mut a = DMatrix::from_fn(6, 6, wave);
            a[(2, 4)] = entry;
            let found = balanced(Planar::<f64>::from(&a)).matrix;
            assert!((0..6).all(|i| (0..6).all(|j| found.get(i, j).to_bits() == a[(i, j)].to_bits())));
        }
    }
}
