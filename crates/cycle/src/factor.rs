//! Factors of a matrix that is large, by blocks of columns: most of the work is then in products of matrices.

use nalgebra::{DMatrix, DVector};

/// Columns of a block; chosen.
const BLOCK: usize = 48;

/// Triangular factors L and U of a matrix with its rows exchanged, in place of it.
pub(crate) struct Factor {
    triangles: DMatrix<f64>,
    /// Row with which each row was exchanged in its turn.
    pivots: Vec<usize>,
}

impl Factor {
    /// The factors of a square matrix; `None` where it is singular or not finite.
    pub fn new(mut matrix: DMatrix<f64>) -> Option<Self> {
        let n = matrix.nrows();
        let mut pivots = Vec::with_capacity(n);
        for begin in (0..n).step_by(BLOCK) {
            let end = n.min(begin + BLOCK);
            for at in begin..end {
                let pivot = at + matrix.column(at).rows_range(at..).iamax();
                let value = matrix[(pivot, at)];
                if value == 0.0 || !value.is_finite() {
                    return None;
                }
                matrix.swap_rows(at, pivot);
                pivots.push(pivot);
                let (mut column, mut others) = matrix.columns_range_pair_mut(at, at + 1..end);
                let mut below = column.rows_range_mut(at + 1..);
                below /= value;
                for mut other in others.column_iter_mut() {
                    let factor = -other[at];
                    other.rows_range_mut(at + 1..).axpy(factor, &below, 1.0);
                }
            }
            let (done, mut others) = matrix.columns_range_pair_mut(begin..end, end..);
            let (mut right, mut rest) = others.rows_range_pair_mut(begin..end, end..);
            done.rows_range(begin..end).solve_lower_triangular_with_diag_mut(&mut right, 1.0);
            rest.gemm(-1.0, &done.rows_range(end..), &right, 1.0);
        }
        Some(Self { triangles: matrix, pivots })
    }

    /// The solution of the equations with a right side; `None` where it is not finite.
    pub fn solve(&self, right: &DVector<f64>) -> Option<DVector<f64>> {
        let mut solution = right.clone();
        self.pivots.iter().enumerate().for_each(|(at, &pivot)| solution.swap_rows(at, pivot));
        self.triangles.solve_lower_triangular_with_diag_mut(&mut solution, 1.0);
        let is_solved = self.triangles.solve_upper_triangular_mut(&mut solution);
        (is_solved && solution.iter().all(|x| x.is_finite())).then_some(solution)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn factors_solve_their_equations_and_a_singular_matrix_has_none() {
        for n in [1, 7, BLOCK, BLOCK + 1, 3 * BLOCK - 5] {
            let matrix =
                DMatrix::from_fn(n, n, |i, j| ((i * i + 7 * j + i * j) % 23) as f64 + if i == j { 0.5 } else { 0.0 });
            let expected = DVector::from_fn(n, |i, _| (i % 5) as f64 - 1.5);
            let found = Factor::new(matrix.clone()).unwrap().solve(&(&matrix * &expected)).unwrap();
            assert!((found - expected).amax() < 1e-9, "{n}");
        }
        assert!(Factor::new(DMatrix::from_element(3, 3, 1.0)).is_none());
        assert!(Factor::new(DMatrix::from_element(2, 2, f64::NAN)).is_none());
    }
}
