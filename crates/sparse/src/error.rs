//! Errors of sparse systems.

use linsys::{LinsysError, Matrix};

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SparseError {
    /// The system has no degrees of freedom.
    #[error("the system has no degrees of freedom")]
    Empty,
    /// A matrix does not have the order of the mass matrix, or is not square.
    #[error("the {matrix} matrix is {rows} x {columns}; expected {order} x {order}")]
    Shape {
        /// The matrix.
        matrix: Matrix,
        /// Its rows.
        rows: usize,
        /// Its columns.
        columns: usize,
        /// Degrees of freedom of the mass matrix.
        order: usize,
    },
    /// An entry is NaN or infinite.
    #[error("the {matrix} matrix has {value} in row {row}, column {column}; every entry must be finite")]
    NotFinite {
        /// The matrix.
        matrix: Matrix,
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// An operating point that does not belong to the system, or a channel that acts on a degree of freedom that does not exist.
    #[error(transparent)]
    System(#[from] LinsysError),
}
