//! A sparse second-order system and its dynamic stiffness Q(lambda).

use linsys::Matrix;
use nalgebra_sparse::CscMatrix;

use crate::SparseError;

/// System `M u'' + C u' + K u = sum_i f_i z_i`, `z_i' = -a_i z_i + e_i^T u'`, with sparse matrices.
///
/// The sparse counterpart of [`linsys::SecondOrder`]:
/// `Q(lambda) = lambda^2 M + lambda C + K + i H - sum_i lambda / (lambda + a_i) f_i e_i^T`.
#[derive(Debug, Clone, PartialEq)]
pub struct SparseSecondOrder {
    /// Mass matrix M, n x n.
    pub m: CscMatrix<f64>,
    /// Damping matrix C, n x n.
    pub c: CscMatrix<f64>,
    /// Stiffness matrix K, n x n.
    pub k: CscMatrix<f64>,
    /// Structural damping H, n x n, `eta K` of parts with a loss factor eta; `None` without structural damping. The stiffness is `K + i H` above the real axis
    /// and `K - i H` below it, where eigenvalues are the conjugates of the eigenvalues above.
    pub h: Option<CscMatrix<f64>>,
    /// The first-order states, none for most systems. Not checked: their degrees of freedom have to exist.
    pub states: Vec<State>,
}

/// First-order state: `z' = -a z + e^T u'`, which adds the force `f z` on the right-hand side.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Decay rate a, 1/s.
    pub decay: f64,
    /// Drive e: degrees of freedom, from 0, with coefficients.
    pub drive: Vec<(usize, f64)>,
    /// Force f: degrees of freedom, from 0, with coefficients.
    pub force: Vec<(usize, f64)>,
}

/// Magnitudes of the largest entry of a matrix of which norms and pivots have squares with all of their digits; chosen, with a margin for sums.
const LARGEST_ENTRIES: std::ops::RangeInclusive<f64> = 1e-140..=1e140;

impl SparseSecondOrder {
    /// A system without internal states.
    ///
    /// # Errors
    /// No degrees of freedom, shapes that differ, an entry that is not finite, units that are too large or too small.
    pub fn new(m: CscMatrix<f64>, c: CscMatrix<f64>, k: CscMatrix<f64>) -> Result<Self, SparseError> {
        let order = m.nrows();
        if order == 0 {
            return Err(SparseError::Empty);
        }
        for (name, matrix) in [(Matrix::Mass, &m), (Matrix::Damping, &c), (Matrix::Stiffness, &k)] {
            check(name, matrix, order)?;
        }
        Ok(Self { m, c, k, h: None, states: Vec::new() })
    }

    /// The system with structural damping H.
    ///
    /// # Errors
    /// Another shape, an entry that is not finite, units that are too large or too small.
    pub fn with_structural_damping(self, h: CscMatrix<f64>) -> Result<Self, SparseError> {
        check(Matrix::StructuralDamping, &h, self.order())?;
        Ok(Self { h: Some(h), ..self })
    }

    /// The system without structural damping, which does not act on the real axis: the system of the real eigenvalues.
    #[must_use]
    pub fn without_structural_damping(self) -> Self {
        Self { h: None, ..self }
    }

    /// Number n of degrees of freedom.
    #[must_use]
    pub fn order(&self) -> usize {
        self.m.nrows()
    }
}

fn check(name: Matrix, matrix: &CscMatrix<f64>, order: usize) -> Result<(), SparseError> {
    let (rows, columns) = (matrix.nrows(), matrix.ncols());
    if (rows, columns) != (order, order) {
        return Err(SparseError::Shape { matrix: name, rows, columns, order });
    }
    if let Some((row, column, &value)) = matrix.triplet_iter().find(|(_, _, value)| !value.is_finite()) {
        return Err(SparseError::NotFinite { matrix: name, row: row + 1, column: column + 1, value });
    }
    match matrix.values().iter().fold(0.0, |largest: f64, value| largest.max(value.abs())) {
        largest if largest == 0.0 || LARGEST_ENTRIES.contains(&largest) => Ok(()),
        largest => Err(SparseError::Units { matrix: name, largest }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::of_entries::diagonal;

    #[test]
    fn shapes_and_numbers_are_checked() {
        let system = SparseSecondOrder::new(diagonal(&[1.0]), diagonal(&[0.0, 1.0]), diagonal(&[1.0]));
        let expected = SparseError::Shape { matrix: Matrix::Damping, rows: 2, columns: 2, order: 1 };
        assert_eq!(system, Err(expected));
        let system = SparseSecondOrder::new(diagonal(&[1.0]), diagonal(&[0.0]), diagonal(&[f64::INFINITY]));
        let value = f64::INFINITY;
        assert_eq!(system, Err(SparseError::NotFinite { matrix: Matrix::Stiffness, row: 1, column: 1, value }));
        for (value, is_allowed) in [(1e-141, false), (1e-139, true), (0.0, true), (1e139, true), (1e141, false)] {
            for place in 0..3 {
                let [m, c, k] = [0, 1, 2].map(|at| diagonal(&[if at == place { value } else { 1.0 }]));
                assert_eq!(SparseSecondOrder::new(m, c, k).is_ok(), is_allowed, "{value:e}");
            }
        }
        assert_eq!(SparseSecondOrder::new(diagonal(&[]), diagonal(&[]), diagonal(&[])), Err(SparseError::Empty));
    }
}
