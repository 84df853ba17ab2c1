//! Free degrees of freedom, and the conversion between the full and the free numbering.

use nalgebra::{DMatrix, DVector, Scalar};
use num_traits::Zero;

use crate::LinsysError;

/// Free and constrained degrees of freedom of a model with `total` of them.
///
/// A constraint eliminates the row and the column of its degree of freedom from the matrices; there is no penalty stiffness.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DofMap {
    free: Vec<usize>,
    position: Vec<Option<usize>>,
}

impl DofMap {
    /// `total` degrees of freedom, all free except `constrained` (indices from 0, any order).
    ///
    /// # Errors
    /// An index out of range or named twice, or no degree of freedom left free.
    pub fn new(total: usize, constrained: &[usize]) -> Result<Self, LinsysError> {
        let mut is_free = vec![true; total];
        for &dof in constrained {
            let slot = is_free.get_mut(dof).ok_or(LinsysError::UnknownDof { dof, total })?;
            if !std::mem::replace(slot, false) {
                return Err(LinsysError::ConstrainedTwice { dof });
            }
        }
        let free: Vec<usize> = (0..total).filter(|&i| is_free[i]).collect();
        if free.is_empty() {
            return Err(LinsysError::AllConstrained { total });
        }
        let mut position = vec![None; total];
        for (reduced, &full) in free.iter().enumerate() {
            position[full] = Some(reduced);
        }
        Ok(Self { free, position })
    }

    /// `total` degrees of freedom, all free.
    pub fn all(total: usize) -> Self {
        Self { free: (0..total).collect(), position: (0..total).map(Some).collect() }
    }

    /// Degrees of freedom of the unconstrained model.
    #[must_use]
    pub fn total(&self) -> usize {
        self.position.len()
    }

    /// Full indices of the free degrees of freedom, ascending.
    #[must_use]
    pub fn free(&self) -> &[usize] {
        &self.free
    }

    /// Position of a full index among the free ones; `None` if it is constrained or out of range.
    #[must_use]
    pub fn position(&self, full: usize) -> Option<usize> {
        self.position.get(full).copied().flatten()
    }

    /// Rows and columns of `full` (total x total) that are free.
    #[must_use]
    pub fn reduce(&self, full: &DMatrix<f64>) -> DMatrix<f64> {
        DMatrix::from_fn(self.free.len(), self.free.len(), |i, j| full[(self.free[i], self.free[j])])
    }

    /// A vector over the free degrees of freedom as one over all, zero where constrained.
    #[must_use]
    pub fn expand<T: Scalar + Zero>(&self, reduced: &DVector<T>) -> DVector<T> {
        let mut full = DVector::from_element(self.total(), T::zero());
        for (value, &index) in reduced.iter().zip(&self.free) {
            full[index] = value.clone();
        }
        full
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reduce_then_expand_keeps_free_values() {
        let map = DofMap::new(4, &[2, 0]).unwrap();
        assert_eq!(map.free(), [1, 3]);
        assert_eq!(map.position(3), Some(1));
        assert_eq!(map.position(2), None);
        let full = DMatrix::from_fn(4, 4, |i, j| (10 * i + j) as f64);
        assert_eq!(map.reduce(&full), nalgebra::dmatrix![11.0, 13.0; 31.0, 33.0]);
        assert_eq!(map.expand(&nalgebra::dvector![5.0, 7.0]), nalgebra::dvector![0.0, 5.0, 0.0, 7.0]);
    }

    #[test]
    fn refuses_what_is_not_there() {
        assert_eq!(DofMap::new(3, &[3]), Err(LinsysError::UnknownDof { dof: 3, total: 3 }));
        assert_eq!(DofMap::new(3, &[1, 1]), Err(LinsysError::ConstrainedTwice { dof: 1 }));
        assert_eq!(DofMap::new(2, &[0, 1]), Err(LinsysError::AllConstrained { total: 2 }));
    }
}
