//! Coupling of the degrees of freedom and internal states of a system.

use linsys::SecondOrder;
use nalgebra::DMatrix;

/// The smallest index with which each index is coupled, directly or through others, where the degrees of freedom come first and
/// the internal states after them. Two indices are coupled by a nonzero entry in any matrix of any of the systems. All systems
/// have the same order; systems with internal states have the same number of them.
pub(crate) fn first_coupled(systems: &[SecondOrder]) -> Vec<usize> {
    let order = systems.iter().map(SecondOrder::order).max().unwrap_or(0);
    let states = systems.iter().map(SecondOrder::states).max().unwrap_or(0);
    let mut first: Vec<usize> = (0..order + states).collect();
    let mut couple = |matrix: &DMatrix<f64>, rows: usize, columns: usize| {
        for (i, j) in (0..matrix.nrows()).flat_map(|i| (0..matrix.ncols()).map(move |j| (i, j))) {
            let (a, b) = (first[rows + i], first[columns + j]);
            if matrix[(i, j)] != 0.0 && a != b {
                first.iter_mut().filter(|first| **first == a.max(b)).for_each(|first| *first = a.min(b));
            }
        }
    };
    for system in systems {
        couple(&system.m, 0, 0);
        couple(&system.c, 0, 0);
        couple(&system.k, 0, 0);
        couple(&system.internal.drive, order, 0);
        couple(&system.internal.force, 0, order);
    }
    first
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_of_entries_couple() {
        let (mut structure, mut friction) = (SecondOrder::zeros(5, 0), SecondOrder::zeros(5, 2));
        structure.k.fill_diagonal(1.0);
        structure.k[(3, 1)] = -1.0;
        structure.c[(4, 2)] = 1.0;
        friction.internal.drive[(1, 3)] = 1.0;
        assert_eq!(first_coupled(&[structure.clone(), friction.clone()]), [0, 1, 2, 1, 2, 5, 1]);
        // A state that is driven by one degree of freedom and acts on another couples the two.
        friction.internal.force[(2, 1)] = 1.0;
        assert_eq!(first_coupled(&[structure, friction]), [0, 1, 1, 1, 1, 5, 1]);
    }
}
