//! The terms of a finite element case: its sparse matrices on common rows.

use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::path::Path;

use formats::{Dof, FormatsError, Kind, Limits, Matrix};
use nalgebra_sparse::{CooMatrix, CscMatrix};
use sparse::{SparseSecondOrder, SparseTerm};

use super::missing::MissingRows;
use super::nodes::Model;
use super::schema::{HolderTable, LossEntry, LossTable, TermTable};
use crate::check::{Check, TakenMatrix, field};
use crate::expression::formulas::Formulas;
use crate::held::{Held, HeldRows};
use crate::symmetry::wanted;
use crate::{CaseError, Expression};

/// A term as it was read: its table, and M, C and K, `None` where it has no such file.
pub(super) struct ReadTerm {
    table: TermTable,
    matrices: [Option<Matrix>; 3],
}

/// The matrices of all terms on common rows.
pub(super) struct Terms {
    pub read: Vec<ReadTerm>,
    /// The rows.
    pub dofs: Vec<Dof>,
    /// Files of matrices, and how each was taken.
    pub files: Vec<TakenMatrix>,
    /// Degrees of freedom that were fixed by a huge diagonal entry (1e36 and the like); their rows are taken out.
    pub held: Vec<Dof>,
}

/// Reads the matrices of all terms, and the names of the rows that they have in common.
pub(super) fn read_terms(check: &Check<'_>, given: Vec<TermTable>) -> Result<Terms, CaseError> {
    check.names("terms.name", given.iter().map(|term| &term.name))?;
    check.names_of_families("terms", given.iter().map(|term| (&term.name, &term.family)))?;
    let (mut all, mut files) = (Vec::new(), Vec::new());
    for table in given {
        let mut read = |file: &Option<std::path::PathBuf>, kind: Kind| {
            let of_field = field("terms", &table.name, &kind.to_string());
            let Some(file) = file else { return Ok(None) };
            let (matrix, taken) =
                check.read_matrix(&of_field, file, &wanted(table.symmetry, kind), Limits::default())?;
            files.push(taken);
            Ok(Some(matrix))
        };
        let matrices = [
            read(&table.mass, Kind::Mass)?,
            read(&table.damping, Kind::Damping)?,
            read(&table.stiffness, Kind::Stiffness)?,
        ];
        if matrices.iter().all(Option::is_none) {
            let found = format!("terms {:?}", table.name);
            return Err(check.value(&found, "no matrix", "mass, damping or stiffness, or several"));
        }
        check.symmetry(&table.name, table.symmetry, matrices.each_ref().map(Option::is_some))?;
        all.push(ReadTerm { table, matrices });
    }
    if all.is_empty() {
        return Err(check.value("terms", "[]", "one term or more"));
    }
    if all.iter().all(|term| term.matrices[0].is_none()) {
        return Err(check.value("terms", "no mass", "a mass in one term or more"));
    }
    let dofs = common_rows(check, &mut all)?;
    let (dofs, held) = take_out_held(check, &mut all, dofs)?;
    Ok(Terms { read: all, dofs, files, held })
}

/// Takes out the rows that are fixed by a huge diagonal entry in any of M, C or K, with a note. Returns the rows kept and the rows taken out.
fn take_out_held(check: &Check<'_>, all: &mut [ReadTerm], dofs: Vec<Dof>) -> Result<(Vec<Dof>, Vec<Dof>), CaseError> {
    let mut rows = HeldRows::new(dofs.len());
    for (at, kind) in [Kind::Mass, Kind::Damping, Kind::Stiffness].into_iter().enumerate() {
        let entries = all.iter().filter_map(|term| term.matrices[at].as_ref()).flat_map(Matrix::entries);
        rows.add(kind, entries.copied()).map_err(|tied| {
            let found = format!("matrices whose row {} has a huge entry", dofs[tied.row - 1]);
            check.value("terms", found, &tied.to_string())
        })?;
    }
    let rows = BTreeSet::from_iter(rows.rows());
    if rows.is_empty() {
        return Ok((dofs, Vec::new()));
    }
    if rows.len() == dofs.len() {
        return Err(check.value("terms", "all rows held by huge entries", "one row or more that is not"));
    }
    let is_held = |(row, dof): (usize, Dof)| if rows.contains(&row) { Err(dof) } else { Ok(dof) };
    let (mut kept, mut held) = (Vec::new(), Vec::new());
    for place in dofs.into_iter().enumerate().map(is_held) {
        match place {
            Ok(dof) => kept.push(dof),
            Err(dof) => held.push(dof),
        }
    }
    let names: Vec<_> = held.iter().map(Dof::to_string).collect();
    check.note(Held(&names).to_string());
    for matrix in all.iter_mut().flat_map(|term| term.matrices.iter_mut().flatten()) {
        *matrix = matrix.without(&rows);
    }
    Ok((kept, held))
}

/// The rows of all matrices, which are put on them. A matrix with labels may have some of the rows. A matrix without labels is taken only where all matrices
/// with labels have equal rows, and must have their order; where no matrix has labels, all must have one order.
fn common_rows(check: &Check<'_>, all: &mut [ReadTerm]) -> Result<Vec<Dof>, CaseError> {
    let named = |term: &ReadTerm| {
        let name = term.table.name.clone();
        let keys = ["mass", "damping", "stiffness"].into_iter().zip(&term.matrices);
        keys.filter(|(_, matrix)| matrix.is_some()).map(move |(key, _)| field("terms", &name, key)).collect::<Vec<_>>()
    };
    let fields: Vec<String> = all.iter().flat_map(named).collect();
    let mut matrices: Vec<&mut Matrix> = all.iter_mut().flat_map(|term| term.matrices.iter_mut().flatten()).collect();
    formats::on_common_rows(&mut matrices).map_err(|(at, source)| match source {
        FormatsError::Unlabelled { .. } => {
            let allowed = "names of its rows, as other matrices have that differ in their rows";
            check.value(&fields[at], "a matrix without names of its rows", allowed)
        }
        source => check.matrix(&fields[at], Path::new("the matrices"), source),
    })?;
    let labels = matrices.iter().find_map(|matrix| matrix.row_labels().map(<[Dof]>::to_vec));
    let order = labels.as_ref().map_or_else(|| matrices.first().map_or(0, |matrix| matrix.rows()), Vec::len);
    if let Some(at) = matrices.iter().position(|matrix| (matrix.rows(), matrix.columns()) != (order, order)) {
        let found = format!("a matrix {} x {}", matrices[at].rows(), matrices[at].columns());
        let like = if labels.is_some() { "as the matrices with names of rows" } else { "as the first matrix" };
        return Err(check.value(&fields[at], found, &format!("{order} x {order}, {like}")));
    }
    Ok(labels.unwrap_or_else(|| (1..=order as i64).map(|node| Dof { node, direction: 0 }).collect()))
}

/// Largest difference of an entry of a symmetric matrix from its mirror image, as a fraction of the largest entry; chosen: a stiffness with a larger
/// difference is refused a loss factor.
const SYMMETRIC: f64 = 1e-10;

/// Largest damping ratio by Rayleigh damping in the band of which nothing is said; chosen: linings and shims have a tenth of it.
const LARGEST_DAMPING: f64 = 0.5;

/// The terms, with Rayleigh damping and loss factors at a frequency in C, and their coefficients. A loss factor without a frequency is that of a complex
/// stiffness. `band` is the band in which modes are wanted, Hz.
pub(super) fn terms_with_coefficients(
    check: &Check<'_>,
    formulas: &mut Formulas<'_>,
    all: Vec<ReadTerm>,
    order: usize,
    band: [f64; 2],
) -> Result<(Vec<SparseTerm>, Vec<Expression>), CaseError> {
    let (mut terms, mut coefficients) = (Vec::new(), Vec::new());
    for ReadTerm { table, matrices } in all {
        let empty = || CscMatrix::zeros(order, order);
        let [m, mut c, k] = matrices.map(|matrix| matrix.map_or_else(empty, |matrix| matrix.to_csc()));
        if let Some(rayleigh) = table.rayleigh {
            let named = |key: &str| field("terms", &table.name, &format!("rayleigh.{key}"));
            let of_mass = check.finite(&named("mass"), rayleigh.mass)?;
            let of_stiffness = check.finite(&named("stiffness"), rayleigh.stiffness)?;
            c = c + &m * of_mass + &k * of_stiffness;
            let ratio = |hz: f64| of_mass / (2.0 * TAU * hz) + of_stiffness * TAU * hz / 2.0;
            let [first, last] = band.map(ratio);
            if first.max(last) > LARGEST_DAMPING {
                check.note(format!(
                    "terms {:?}: by rayleigh the damping ratio is {first:.3} at {:.1} Hz and {last:.3} at {:.1} Hz; is it {{ mass = 1/s, stiffness = s }}?",
                    table.name, band[0], band[1]
                ));
            }
        }
        let named = |key: &str| field("terms", &table.name, &format!("loss_factor{key}"));
        let loss = match table.loss_factor {
            None => 0.0,
            Some(LossEntry::Number(value)) => {
                let value = check.loss_factor(&named(""), value)?;
                let largest = k.values().iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
                let skew = &k - k.transpose();
                if skew.values().iter().any(|value| value.abs() > SYMMETRIC * largest) {
                    return Err(check.value(
                        &named(""),
                        value,
                        "terms of a symmetric stiffness: another one is no spring",
                    ));
                }
                value
            }
            Some(LossEntry::At(LossTable { value, at_hz })) => {
                let value = check.loss_factor(&named(".value"), value)?;
                if !(at_hz.is_finite() && at_hz > 0.0) {
                    return Err(check.value(&named(".at_hz"), at_hz, "a frequency in Hz, > 0"));
                }
                let [least, most] = band.map(|hz| hz / at_hz);
                check.note(format!(
                    "{} = {value} is that of dashpots at {at_hz:.1} Hz: at the ends of the band their loss factor is {least:.3} and {most:.3} times that",
                    named("")
                ));
                // `C = eta K / omega_0`, so that `i omega C = i eta K` at omega_0 alone.
                c = c + &k * (value / (TAU * at_hz));
                0.0
            }
        };
        coefficients.push(formulas.expression(&field("terms", &table.name, "coefficient"), table.coefficient, 1.0)?);
        let family = table.family.unwrap_or_else(|| table.name.clone());
        let matrices = SparseSecondOrder::new(m, c, k).map_err(check.sparse(&format!("terms {:?}", table.name)))?;
        terms.push(SparseTerm { name: table.name, family, matrices, loss });
    }
    Ok((terms, coefficients))
}

/// Term of all holders together: springs and dashpots from nodes to ground. `None` where there are none.
pub(super) fn holders_term(
    model: &Model<'_>,
    holders: &[HolderTable],
    missing: &mut Vec<MissingRows>,
) -> Result<Option<SparseTerm>, CaseError> {
    if holders.is_empty() {
        return Ok(None);
    }
    let (check, order) = (model.check, model.dofs.len());
    check.names("holders.name", holders.iter().map(|holder| &holder.name))?;
    let (mut c, mut k) = (CooMatrix::new(order, order), CooMatrix::new(order, order));
    for holder in holders {
        let of_nodes = field("holders", &holder.name, "nodes");
        let nodes = model.nodes(&of_nodes, holder.nodes.items())?;
        let acts = |direction: &u32| {
            let at = *direction as usize - 1;
            holder.stiffness[at] != 0.0 || holder.damping[at] != 0.0
        };
        let directions: Vec<u32> = (1..=3).filter(acts).collect();
        if !directions.is_empty() {
            missing.extend(model.missing_rows(&of_nodes, &nodes, &directions)?);
        }
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
    Ok(Some(SparseTerm { name: "holders".into(), family: "holders".into(), matrices, loss: 0.0 }))
}
