//! Matrices of arrays that a program holds.

use nalgebra::DMatrix;
use nalgebra_sparse::CscMatrix;

use crate::builder::{Builder, Head, Stated};
use crate::{Limits, Matrix, Problem};

impl Matrix {
    /// The matrix of an array, which says as little as one in a file whether it is a triangle: [`Matrix::with_symmetry`] decides.
    ///
    /// # Errors
    /// [`Problem::Value`] for an entry that is not finite; [`Problem::Limit`] for more entries than [`Limits::default`] has.
    pub fn of_array(name: &str, array: &DMatrix<f64>) -> Result<Self, Problem> {
        let rows = array.nrows().max(1);
        let entries = array.iter().enumerate().map(|(at, &value)| (at % rows, at / rows, value));
        Self::of_entries(name, array.shape(), entries)
    }

    /// The matrix of compressed columns, as [`Matrix::of_array`].
    ///
    /// # Errors
    /// As [`Matrix::of_array`].
    pub fn of_sparse(name: &str, matrix: &CscMatrix<f64>) -> Result<Self, Problem> {
        let entries = matrix.triplet_iter().map(|(row, column, &value)| (row, column, value));
        Self::of_entries(name, (matrix.nrows(), matrix.ncols()), entries)
    }

    /// The matrix of entries (row, column, value), from 0 and within the shape.
    fn of_entries(
        name: &str,
        shape: (usize, usize),
        entries: impl IntoIterator<Item = (usize, usize, f64)>,
    ) -> Result<Self, Problem> {
        let mut builder = Builder::new(&Limits::default());
        for (row, column, value) in entries.into_iter().filter(|(.., value)| *value != 0.0) {
            builder.push(row, column, value)?;
        }
        builder.finish(Stated::Array, Head::unlabelled(name, None, shape))
    }
}
