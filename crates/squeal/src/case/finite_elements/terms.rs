//! The terms of a finite element case: its sparse matrices on common rows.

use std::path::Path;

use formats::{Dof, Kind, Limits, Matrix};
use nalgebra_sparse::{CooMatrix, CscMatrix};
use sparse::{SparseSecondOrder, SparseTerm};

use super::nodes::Model;
use super::schema::{HolderTable, TermTable};
use crate::case::check::{Check, field};
use crate::case::matrices::formulas::Formulas;
use crate::case::{CaseError, Expression};

/// The mass, damping and stiffness matrix of a term, as far as it has them.
pub(super) struct Parts {
    table: TermTable,
    matrices: [Option<Matrix>; 3],
}

/// Reads the matrices of all terms, and the names of the rows that they have in common.
pub(super) fn read_terms(check: &Check<'_>, given: Vec<TermTable>) -> Result<(Vec<Parts>, Vec<Dof>), CaseError> {
    check.names("terms.name", given.iter().map(|term| &term.name))?;
    check.names_of_families("terms", given.iter().map(|term| (&term.name, &term.family)))?;
    let mut all = Vec::new();
    for table in given {
        let read = |key: &str, file: &Option<std::path::PathBuf>, kind: Kind| {
            file.as_ref().map(|file| read_matrix(check, &field("terms", &table.name, key), file, kind)).transpose()
        };
        let matrices = [
            read("mass", &table.mass, Kind::Mass)?,
            read("damping", &table.damping, Kind::Damping)?,
            read("stiffness", &table.stiffness, Kind::Stiffness)?,
        ];
        if matrices.iter().all(Option::is_none) {
            let found = format!("terms {:?}", table.name);
            return Err(check.value(&found, "no matrix", "mass, damping or stiffness, or several"));
        }
        all.push(Parts { table, matrices });
    }
    if all.is_empty() {
        return Err(check.value("terms", "[]", "one term or more"));
    }
    if all.iter().all(|parts| parts.matrices[0].is_none()) {
        return Err(check.value("terms", "no mass", "a mass in one term or more"));
    }
    let dofs = common_rows(check, &mut all)?;
    Ok((all, dofs))
}

/// The rows of all matrices, which are put on them. Matrices with labels may have some of the rows each; those without must have
/// one order.
fn common_rows(check: &Check<'_>, all: &mut [Parts]) -> Result<Vec<Dof>, CaseError> {
    let matrices = || all.iter().flat_map(|parts| parts.matrices.iter().flatten());
    let is_labelled = |matrix: &Matrix| matrix.row_labels().is_some();
    if matrices().all(is_labelled) {
        let refused = |source| check.matrix("terms", Path::new("the matrices"), source);
        let labels = formats::common_labels(matrices()).map_err(refused)?;
        for matrix in all.iter_mut().flat_map(|parts| parts.matrices.iter_mut().flatten()) {
            *matrix = matrix.on(&labels).map_err(refused)?;
        }
        return Ok(labels);
    }
    if matrices().any(is_labelled) {
        let allowed = "names of the rows of all matrices, or of none";
        return Err(check.value("terms", "matrices of which some have names of their rows", allowed));
    }
    let order = matrices().next().map_or(0, Matrix::rows);
    if let Some(other) = matrices().find(|matrix| (matrix.rows(), matrix.columns()) != (order, order)) {
        let found = format!("a matrix {} x {}", other.rows(), other.columns());
        return Err(check.value("terms", found, &format!("{order} x {order}, as the first matrix")));
    }
    Ok((1..=order as i64).map(|node| Dof { node, direction: 0 }).collect())
}

/// The matrix of this kind in a file, or its only one.
fn read_matrix(check: &Check<'_>, field: &str, file: &Path, kind: Kind) -> Result<Matrix, CaseError> {
    let path = check.path.parent().unwrap_or(Path::new("")).join(file);
    let refused = |source| check.matrix(field, file, source);
    let found =
        formats::read_with(&path, formats::Options { limits: Limits::default(), ..formats::Options::default() })
            .map_err(refused)?;
    if found.matrices.len() > 1 { found.of_kind(kind).cloned() } else { found.only() }.map_err(refused)
}

/// The terms with their coefficients.
pub(super) fn terms_with_coefficients(
    check: &Check<'_>,
    formulas: &mut Formulas<'_>,
    all: Vec<Parts>,
    order: usize,
) -> Result<(Vec<SparseTerm>, Vec<Expression>), CaseError> {
    let (mut terms, mut coefficients) = (Vec::new(), Vec::new());
    for Parts { table, matrices } in all {
        let empty = || CscMatrix::zeros(order, order);
        let [m, mut c, k] = matrices.map(|matrix| matrix.map_or_else(empty, |matrix| matrix.to_csc()));
        if let Some(rayleigh) = table.rayleigh {
            let named = |key: &str| field("terms", &table.name, &format!("rayleigh.{key}"));
            let of_mass = check.finite(&named("mass"), rayleigh.mass)?;
            let of_stiffness = check.finite(&named("stiffness"), rayleigh.stiffness)?;
            c = c + &m * of_mass + &k * of_stiffness;
        }
        coefficients.push(formulas.expression(&field("terms", &table.name, "coefficient"), table.coefficient, 1.0)?);
        let family = table.family.unwrap_or_else(|| table.name.clone());
        let matrices = SparseSecondOrder::new(m, c, k).map_err(check.sparse(&format!("terms {:?}", table.name)))?;
        terms.push(SparseTerm { name: table.name, family, matrices });
    }
    Ok((terms, coefficients))
}

/// All holders as one term: springs and dashpots from nodes to ground.
pub(super) fn holders_term(model: &Model<'_>, holders: &[HolderTable]) -> Result<Option<SparseTerm>, CaseError> {
    if holders.is_empty() {
        return Ok(None);
    }
    let (check, order) = (model.check, model.dofs.len());
    check.names("holders.name", holders.iter().map(|holder| &holder.name))?;
    let (mut c, mut k) = (CooMatrix::new(order, order), CooMatrix::new(order, order));
    for holder in holders {
        let nodes = model.nodes(&field("holders", &holder.name, "nodes"), holder.nodes.items())?;
        for (key, sum, values) in [("stiffness", &mut k, holder.stiffness), ("damping", &mut c, holder.damping)] {
            let named = field("holders", &holder.name, key);
            for (direction, value) in (1..).zip(values) {
                if !(value.is_finite() && value >= 0.0) {
                    return Err(check.value(&named, value, "a finite number >= 0 for each of x, y and z"));
                }
                let rows = nodes.iter().filter_map(|&node| model.row(node, direction));
                rows.for_each(|row| sum.push(row, row, value / nodes.len() as f64));
            }
        }
    }
    let matrices = SparseSecondOrder::new(CscMatrix::zeros(order, order), (&c).into(), (&k).into());
    let matrices = matrices.map_err(check.sparse("holders"))?;
    Ok(Some(SparseTerm { name: "holders".into(), family: "holders".into(), matrices }))
}
