//! Terms of the structure: their matrices and coefficients.

use std::path::Path;

use linsys::{SecondOrder, Term};
use nalgebra::DMatrix;

use super::formulas::Formulas;
use super::schema;
use crate::case::check::{Check, field};
use crate::case::{CaseError, Expression};
use crate::input::{LARGEST_MATRIX, parse_matrix, read};

/// The terms with their coefficients. All terms must have the same order, and at least one a mass.
pub(super) fn terms_with_coefficients(
    check: &Check<'_>,
    formulas: &mut Formulas<'_>,
    given: Vec<schema::TermTable>,
) -> Result<(Vec<Term>, Vec<Expression>), CaseError> {
    check.names("terms.name", given.iter().map(|term| &term.name))?;
    check.names_of_families("terms", given.iter().map(|term| (&term.name, &term.family)))?;
    let mut order = None;
    let mut has_mass = false;
    let (mut terms, mut coefficients) = (Vec::new(), Vec::new());
    for schema::TermTable { name, family, coefficient, mass, damping, stiffness } in given {
        has_mass |= mass.is_some();
        let mut loaded = |key: &str, matrix: Option<schema::MatrixEntry>| match matrix {
            None => Ok(None),
            Some(matrix) => load(check, &field("terms", &name, key), matrix, &mut order).map(Some),
        };
        let parts = [loaded("mass", mass)?, loaded("damping", damping)?, loaded("stiffness", stiffness)?];
        let Some(n) = parts.iter().flatten().map(DMatrix::nrows).next() else {
            return Err(check.value(&format!("terms {name:?}"), "no matrix", "mass, damping or stiffness, or several"));
        };
        let [m, c, k] = parts.map(|part| part.unwrap_or_else(|| DMatrix::zeros(n, n)));
        coefficients.push(formulas.expression(&field("terms", &name, "coefficient"), coefficient, 1.0)?);
        let refused = check.system(&format!("terms {name:?}"));
        let family = family.unwrap_or_else(|| name.clone());
        terms.push(SecondOrder::new(m, c, k).and_then(|system| Term::new(name, family, system)).map_err(refused)?);
    }
    match (terms.is_empty(), has_mass) {
        (true, _) => Err(check.value("terms", "[]", "one term or more")),
        (_, false) => Err(check.value("terms", "no mass", "a mass in one term or more")),
        _ => Ok((terms, coefficients)),
    }
}

/// Reads a square matrix of the same order as the matrices before it.
fn load(
    check: &Check<'_>,
    field: &str,
    matrix: schema::MatrixEntry,
    order: &mut Option<usize>,
) -> Result<DMatrix<f64>, CaseError> {
    let matrix = match matrix {
        schema::MatrixEntry::Rows(rows) => from_rows(check, field, &rows)?,
        schema::MatrixEntry::File(file) => {
            let (path, named) = (check.path.to_owned(), field.to_owned());
            match read(&check.path.parent().unwrap_or(Path::new("")).join(&file), LARGEST_MATRIX) {
                Err(source) => return Err(CaseError::MatrixRead { path, field: named, file, source }),
                Ok(bytes) => match parse_matrix(&bytes) {
                    Err(source) => return Err(CaseError::Matrix { path, field: named, file, source }),
                    Ok(matrix) => matrix.to_dense(),
                },
            }
        }
    };
    let (rows, columns) = matrix.shape();
    let expected = *order.get_or_insert(rows);
    if rows != expected || columns != expected {
        let allowed = match rows == expected {
            true => "a square matrix".to_owned(),
            false => format!("{expected} x {expected}, as the first matrix"),
        };
        return Err(check.value(field, format!("a matrix {rows} x {columns}"), &allowed));
    }
    Ok(matrix)
}

fn from_rows(check: &Check<'_>, field: &str, rows: &[Vec<f64>]) -> Result<DMatrix<f64>, CaseError> {
    let columns = rows.first().map_or(0, Vec::len);
    if columns == 0 {
        return Err(check.value(field, "no entries", "rows of numbers"));
    }
    if let Some(at) = rows.iter().position(|row| row.len() != columns) {
        let found = format!("row {} with {} numbers", at + 1, rows[at].len());
        return Err(check.value(field, found, &format!("{columns}, as in row 1")));
    }
    for &value in rows.iter().flatten() {
        check.finite(field, value)?;
    }
    Ok(DMatrix::from_fn(rows.len(), columns, |i, j| rows[i][j]))
}
