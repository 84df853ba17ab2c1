//! Small matrices of tests, by their entries.

use nalgebra_sparse::{CooMatrix, CscMatrix};

/// A matrix of order n from rows, columns and values, which add up.
pub(crate) fn of_entries(n: usize, entries: &[(usize, usize, f64)]) -> CscMatrix<f64> {
    let mut sum = CooMatrix::new(n, n);
    entries.iter().for_each(|&(row, column, value)| sum.push(row, column, value));
    CscMatrix::from(&sum)
}

/// A diagonal matrix.
pub(crate) fn diagonal(values: &[f64]) -> CscMatrix<f64> {
    let entries: Vec<_> = values.iter().enumerate().map(|(i, &value)| (i, i, value)).collect();
    of_entries(values.len(), &entries)
}
