//! Terms of the structure: their matrices and coefficients.

use std::path::Path;

use formats::{Dof, FormatsError, Kind, Limits, Matrix, Wanted, on_common_rows, split_name};
use linsys::{SecondOrder, Term};
use nalgebra::DMatrix;

use super::schema::{MatrixEntry, TermTable};
use crate::check::{Check, TakenMatrix, field};
use crate::expression::formulas::Formulas;
use crate::input::{LARGEST_MATRIX, LARGEST_ORDER, check_size};
use crate::relaxing::BranchTable;
use crate::symmetry::wanted;
use crate::{CaseError, Expression};

/// The terms with their coefficients.
pub(super) struct Terms {
    pub terms: Vec<Term>,
    pub coefficients: Vec<Expression>,
    /// Loss factor of each term, where it has one.
    pub losses: Vec<Option<f64>>,
    /// Viscoelastic branches of each term.
    pub branches: Vec<Vec<BranchTable>>,
    /// How each matrix was taken.
    pub taken: Vec<TakenMatrix>,
    /// The rows of the matrices, where files name them.
    pub rows: Option<Vec<Dof>>,
}

/// Reads the matrices of all terms, which must have the same order, and at least one a mass.
pub(super) fn read_terms(
    check: &Check<'_>,
    formulas: &mut Formulas<'_>,
    given: Vec<TermTable>,
) -> Result<Terms, CaseError> {
    check.names("terms.name", given.iter().map(|term| &term.name))?;
    check.names_of_families("terms", given.iter().map(|term| (&term.name, &term.family)))?;
    if given.is_empty() {
        return Err(check.value("terms", "[]", "one term or more"));
    }
    let (mut all, mut fields, mut taken) = (Vec::new(), Vec::new(), Vec::new());
    let (mut tables, mut losses, mut branches) = (Vec::new(), Vec::new(), Vec::new());
    for TermTable { name, family, coefficient, symmetry, mass, damping, stiffness, loss_factor, viscoelastic } in given
    {
        let parts = [(Kind::Mass, mass), (Kind::Damping, damping), (Kind::Stiffness, stiffness)];
        let has = parts.each_ref().map(|(_, entry)| entry.is_some());
        if has == [false; 3] {
            return Err(check.value(&format!("terms {name:?}"), "no matrix", "mass, damping or stiffness, or several"));
        }
        check.symmetry(&name, symmetry, has)?;
        for (kind, entry) in parts {
            let Some(entry) = entry else { continue };
            let field = field("terms", &name, &kind.to_string());
            let wanted = wanted(symmetry, kind);
            let (matrix, of_field) = match entry {
                MatrixEntry::Rows(rows) => from_rows(check, &field, &rows, &wanted)?,
                MatrixEntry::File(file) => read_file(check, &field, &file, &wanted)?,
            };
            all.push(matrix);
            taken.push(of_field);
            fields.push(field);
        }
        losses.push(loss_factor);
        branches.push(viscoelastic);
        tables.push((name, family, coefficient, has));
    }
    if !tables.iter().any(|(.., has)| has[0]) {
        return Err(check.value("terms", "no mass", "a mass in one term or more"));
    }
    let rows = common_rows(check, &mut all, &fields)?;
    let order = all.first().map_or(0, Matrix::rows);
    for (matrix, field) in all.iter().zip(&fields) {
        let (rows, columns) = (matrix.rows(), matrix.columns());
        if (rows, columns) != (order, order) {
            let allowed = match rows == order {
                true => "a square matrix".to_owned(),
                false => format!("{order} x {order}, as the first matrix"),
            };
            return Err(check.value(field, format!("a matrix {rows} x {columns}"), &allowed));
        }
    }
    let mut matrices = all.iter().map(Matrix::to_dense);
    let (mut terms, mut coefficients) = (Vec::new(), Vec::new());
    for (name, family, coefficient, has) in tables {
        let mut next =
            |has: bool| has.then(|| matrices.next()).flatten().unwrap_or_else(|| DMatrix::zeros(order, order));
        let [m, c, k] = has.map(&mut next);
        coefficients.push(formulas.expression(&field("terms", &name, "coefficient"), coefficient, 1.0)?);
        let refused = check.system(&format!("terms {name:?}"));
        let family = family.unwrap_or_else(|| name.clone());
        terms.push(SecondOrder::new(m, c, k).and_then(|system| Term::new(name, family, system)).map_err(refused)?);
    }
    Ok(Terms { terms, coefficients, losses, branches, taken, rows })
}

/// Reads a matrix from a file of any format, small enough to be a full one.
fn read_file(
    check: &Check<'_>,
    field: &str,
    file: &Path,
    wanted: &Wanted<'_>,
) -> Result<(Matrix, TakenMatrix), CaseError> {
    let path = check.path.parent().unwrap_or(Path::new("")).join(file);
    check_size(split_name(&path).0, LARGEST_MATRIX).map_err(|source| CaseError::MatrixRead {
        path: check.path.to_owned(),
        field: field.to_owned(),
        file: file.to_owned(),
        source,
    })?;
    // Lists in any order may have more rows than they come to have beside others.
    let limits = Limits { bytes: LARGEST_MATRIX, ..Limits::default() };
    let (matrix, taken) = check.read_matrix(field, file, wanted, limits)?;
    let (rows, columns) = (matrix.rows(), matrix.columns());
    if rows.max(columns) > LARGEST_ORDER {
        let allowed =
            format!("{LARGEST_ORDER} rows and columns at most; larger brakes are of kind \"finite-elements\"");
        return Err(check.value(field, format!("a matrix {rows} x {columns}"), &allowed));
    }
    Ok((matrix, taken))
}

/// Puts the matrices on common rows, as far as their files name them.
fn common_rows(check: &Check<'_>, all: &mut [Matrix], fields: &[String]) -> Result<Option<Vec<Dof>>, CaseError> {
    on_common_rows(&mut all.iter_mut().collect::<Vec<_>>()).map_err(|(at, source)| match source {
        FormatsError::Unlabelled { .. } => {
            let allowed = "names of its rows, as other matrices have that differ in their rows";
            check.value(&fields[at], "a matrix without names of its rows", allowed)
        }
        source => check.matrix(&fields[at], Path::new("the matrices"), source),
    })?;
    if let Some(matrix) = all.iter().find(|matrix| matrix.rows() > LARGEST_ORDER) {
        let allowed = format!("{LARGEST_ORDER} rows of all matrices together at most");
        return Err(check.value("terms", format!("{} rows", matrix.rows()), &allowed));
    }
    Ok(all.iter().find_map(|matrix| matrix.row_labels().map(<[Dof]>::to_vec)))
}

/// The matrix of rows in the case file, taken as an array in another file is.
fn from_rows(
    check: &Check<'_>,
    field: &str,
    rows: &[Vec<f64>],
    wanted: &Wanted<'_>,
) -> Result<(Matrix, TakenMatrix), CaseError> {
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
    let array = DMatrix::from_fn(rows.len(), columns, |i, j| rows[i][j]);
    let name = wanted.kind.map_or_else(String::new, |kind| kind.to_string());
    let listed = Matrix::of_array(&name, &array).map_err(|problem| check.value(field, problem, "rows of numbers"))?;
    let matrix = listed.with_symmetry(wanted.symmetry, wanted.otherwise).map_err(|source| CaseError::Rows {
        path: check.path.to_owned(),
        field: field.to_owned(),
        source: Box::new(source),
    })?;
    let taken = TakenMatrix { field: field.to_owned(), file: None, name, taken: matrix.taken() };
    Ok((matrix, taken))
}
