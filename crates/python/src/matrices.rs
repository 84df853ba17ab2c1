//! Matrices: from NumPy and SciPy, and from files of every format.

use std::path::PathBuf;

use formats::{File, FormatsError, Matrix, Stored, Symmetry, Wanted, read_with};
use nalgebra::DMatrix;
use nalgebra_sparse::CscMatrix;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use squeal_cli::Error;

use crate::away::{Ends, away};
use crate::errors;

/// A matrix of NumPy, copied.
pub(crate) fn dense(array: &PyReadonlyArray2<'_, f64>) -> DMatrix<f64> {
    let array = array.as_array();
    DMatrix::from_fn(array.nrows(), array.ncols(), |row, column| array[(row, column)])
}

/// Parts of a matrix of SciPy in compressed columns: order, `indptr`, `indices`, `data`.
pub(crate) type Columns<'py> =
    (usize, PyReadonlyArray1<'py, i64>, PyReadonlyArray1<'py, i64>, PyReadonlyArray1<'py, f64>);

/// A square matrix of SciPy in compressed columns, its indices sorted and without repeats.
pub(crate) fn sparse(
    py: Python<'_>,
    name: &str,
    (order, offsets, rows, values): &Columns<'_>,
) -> PyResult<CscMatrix<f64>> {
    let whole = |of: &PyReadonlyArray1<'_, i64>| -> Option<Vec<usize>> {
        of.as_array().iter().map(|&index| usize::try_from(index).ok()).collect()
    };
    let made = whole(offsets).zip(whole(rows)).and_then(|(offsets, rows)| {
        CscMatrix::try_from_csc_data(*order, *order, offsets, rows, values.as_array().to_vec()).ok()
    });
    made.ok_or_else(|| errors::argument(py, name, "a sparse matrix whose indices do not fit", "indices within it"))
}

/// Storage of a matrix, from its word.
fn symmetry_of(py: Python<'_>, text: &str) -> PyResult<Symmetry> {
    Symmetry::named(text)
        .ok_or_else(|| errors::argument(py, "symmetry", &format!("{text:?}"), "whole, upper, lower or triangle"))
}

/// Whether a matrix is a triangle of a symmetric one, as is said of it; one of which it is not said and cannot be seen is refused.
#[pyfunction]
pub(crate) fn is_triangle(py: Python<'_>, name: &str, matrix: Columns<'_>, symmetry: Option<&str>) -> PyResult<bool> {
    let said = symmetry.map(|text| symmetry_of(py, text)).transpose()?;
    let matrix = sparse(py, name, &matrix)?;
    let taken = py.detach(|| {
        let listed = Matrix::of_sparse(name, &matrix).map_err(|problem| problem.to_string())?;
        listed.with_symmetry(None, said).map_err(|error| error.to_string())
    });
    let taken = taken.map_err(|fault| errors::array(py, name, &fault))?;
    Ok(taken.stored() == Stored::Triangle)
}

/// A matrix as Python has it.
fn as_dict<'py>(py: Python<'py>, matrix: &Matrix) -> PyResult<Bound<'py, PyDict>> {
    let entries = matrix.entries();
    let of = PyDict::new(py);
    of.set_item("name", matrix.name())?;
    of.set_item("kind", matrix.kind().map(|kind| kind.to_string()))?;
    of.set_item("shape", (matrix.rows(), matrix.columns()))?;
    let index = |of: &dyn Fn(usize) -> u32| -> Bound<'py, PyArray1<i64>> {
        (0..entries.len()).map(|at| i64::from(of(at))).collect::<Vec<_>>().into_pyarray(py)
    };
    of.set_item("rows", index(&|at| entries[at].row))?;
    of.set_item("columns", index(&|at| entries[at].column))?;
    of.set_item("values", entries.iter().map(|entry| entry.value).collect::<Vec<_>>().into_pyarray(py))?;
    let names = matrix.row_labels().map(|labels| labels.iter().map(ToString::to_string).collect::<Vec<_>>());
    of.set_item("labels", names)?;
    of.set_item("taken", matrix.taken())?;
    of.set_item("doubts", matrix.doubts().iter().map(ToString::to_string).collect::<Vec<_>>())?;
    Ok(of)
}

/// Names of what was left out of a file, each with the reason.
type LeftOut = Vec<(String, String)>;

/// The matrices of a file, of any format, and the names of what was left out with the reasons.
#[pyfunction]
pub(crate) fn read_matrices<'py>(
    py: Python<'py>,
    path: PathBuf,
    symmetry: Option<&str>,
) -> PyResult<(Vec<Bound<'py, PyDict>>, LeftOut)> {
    let said = symmetry.map(|text| symmetry_of(py, text)).transpose()?;
    let read = move |path: &std::path::Path| -> Result<(Vec<Matrix>, LeftOut), FormatsError> {
        let file = read_with(path, formats::Options::default())?;
        let taken = |matrix: &Matrix| {
            let one = File { format: file.format, matrices: vec![matrix.clone()], left_out: Vec::new() };
            one.take(&Wanted { otherwise: said, ..Wanted::default() })
        };
        Ok((file.matrices.iter().map(taken).collect::<Result<_, _>>()?, file.left_out))
    };
    let (matrices, left_out) = away(py, Ends::LeftBehind, None, move |_| {
        read(&path).map_err(|source| Error::Matrix { path, source: Box::new(source) })
    })?;
    Ok((matrices.iter().map(|matrix| as_dict(py, matrix)).collect::<PyResult<_>>()?, left_out))
}
