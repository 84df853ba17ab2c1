//! Bodies that turn, and springs in any direction: terms of a case that are made here and not read.

use elements::{Axis, Body, ElementsError, Material};
use nalgebra::{DMatrix, DVector, Vector3};
use nalgebra_sparse::{CooMatrix, CscMatrix};
use num_complex::Complex;
use sparse::{Problem, SparseSecondOrder, SparseTerm};

use super::faces::Solids;
use super::missing::MissingRows;
use super::nodes::Model;
use super::surface_schema::{ActsEntry, RotationTable, SpringTable};
use crate::case::check::field;
use crate::case::matrices::formulas::Formulas;
use crate::case::matrices::schema::Formula;
use crate::case::{CaseError, Expression};

/// The symmetric part of a gyroscopic matrix, as a part of the skew one, above which the body is none of revolution; chosen: a coarse mesh of
/// a disc has a hundredth.
const NOT_ROUND: f64 = 0.1;

/// The terms of a body that turns with the speed Omega: `2 G` with the coefficient Omega, and `- P + K_sigma` with Omega^2. The stress
/// is that of the centrifugal load in the structure, whose stiffness is given.
pub(super) fn rotation_terms(
    solids: &Solids<'_>,
    formulas: &mut Formulas<'_>,
    table: &RotationTable,
    structure: &CscMatrix<f64>,
) -> Result<[(SparseTerm, Expression); 2], CaseError> {
    let check = solids.model.check;
    let key = |key: &str| field("rotation", &table.name, key);
    let of_body = check.contact::<ElementsError>(&format!("rotation {:?}", table.name));
    let axis = Axis::new(table.axis, table.through).map_err(&of_body)?;
    let elements = solids.elements(&key("elements"), &table.elements)?;
    let body = Body::new(&solids.mesh, elements, &solids.rows).map_err(&of_body)?;
    let transport = body.transport(table.density, &axis).map_err(&of_body)?;
    if transport.departure > NOT_ROUND {
        let by = transport.departure;
        check.note(format!(
            "rotation {:?}: the body is none of revolution (its surface does not turn into itself, by {by:.2} of the gyroscopic terms); in axes \
             that stand still it is described in the mean alone",
            table.name
        ));
    }
    let mut of_square = -&transport.centripetal;
    if let Some(material) = table.stress {
        let material = Material::new(material.young, material.poisson).map_err(&of_body)?;
        let load = body.centrifugal_load(table.density, &axis).map_err(&of_body)?;
        let still = statics(structure, &load).map_err(check.sparse(&key("stress")))?;
        of_square = of_square + body.stress_stiffness(&material, &body.displacements(&still)).map_err(&of_body)?;
    }
    let zero = || CscMatrix::zeros(solids.rows.order(), solids.rows.order());
    let text = match &table.speed {
        Formula::Number(value) => check.finite(&key("speed"), *value)?.to_string(),
        Formula::Text(text) => text.clone(),
    };
    let mut term = |kind: &str, formula: String, c: CscMatrix<f64>, k: CscMatrix<f64>| {
        let name = format!("{} {kind}", table.name);
        let matrices = SparseSecondOrder::new(zero(), c, k).map_err(check.sparse(&key("elements")))?;
        let coefficient = formulas.expression(&key("speed"), Some(Formula::Text(formula)), 0.0)?;
        Ok::<_, CaseError>((SparseTerm { family: name.clone(), name, matrices }, coefficient))
    };
    Ok([
        term("gyroscopic", text.clone(), transport.gyroscopic * 2.0, zero())?,
        term("centrifugal", format!("({text})^2"), zero(), of_square)?,
    ])
}

/// `K^-1 f`.
fn statics(structure: &CscMatrix<f64>, load: &DVector<f64>) -> Result<DVector<f64>, sparse::SparseError> {
    let zero = || CscMatrix::zeros(structure.nrows(), structure.nrows());
    let system = SparseSecondOrder::new(zero(), zero(), structure.clone())?;
    let load = DMatrix::from_column_slice(load.len(), 1, load.as_slice());
    let solution = Problem::new(&system)?.solve(Complex::from(0.0), &load)?;
    Ok(DVector::from_iterator(load.len(), solution.iter().map(|z| z.re)))
}

/// A spring with a dashpot as a term: of each node to ground, shared equally, or of the mean of the nodes, to ground or to the mean of others.
pub(super) fn spring_term(
    model: &Model<'_>,
    formulas: &mut Formulas<'_>,
    table: &SpringTable,
    missing: &mut Vec<MissingRows>,
) -> Result<(SparseTerm, Expression), CaseError> {
    let (check, order) = (model.check, model.dofs.len());
    let key = |key: &str| field("springs", &table.name, key);
    let direction = Vector3::from(table.direction).try_normalize(0.0).filter(|unit| unit.iter().all(|x| x.is_finite()));
    let Some(direction) = direction else {
        let allowed = "a direction of three finite numbers, not all 0";
        return Err(check.value(&key("direction"), format!("{:?}", table.direction), allowed));
    };
    for (name, value) in [("stiffness", table.stiffness), ("damping", table.damping)] {
        if !(value.is_finite() && value >= 0.0) {
            return Err(check.value(&key(name), value, "a finite number >= 0"));
        }
    }
    if table.stiffness == 0.0 && table.damping == 0.0 {
        return Err(check.value(&format!("springs {:?}", table.name), "nothing", "a stiffness or a damping > 0"));
    }
    let mut of_nodes = |name: &str, nodes: &super::schema::Nodes| {
        let found = model.nodes(&key(name), nodes.items())?;
        let directions: Vec<u32> = (1..=3).filter(|&d| direction[d as usize - 1] != 0.0).collect();
        missing.extend(MissingRows::of(model, &key(name), &found, &directions)?);
        Ok::<_, CaseError>(found)
    };
    let from = of_nodes("nodes", &table.nodes)?;
    let to = table.to.as_ref().map(|nodes| of_nodes("to", nodes)).transpose()?;
    // Rows, each a motion that the spring sees, and what part of it acts there.
    let entry = |node: i64, share: f64| {
        (1..=3).filter_map(move |d| Some((model.row(node, d)?, share * direction[d as usize - 1])))
    };
    let mean = |nodes: &[i64], sign: f64| {
        let share = sign / nodes.len() as f64;
        nodes.iter().flat_map(|&node| entry(node, share)).filter(|(_, value)| *value != 0.0).collect::<Vec<_>>()
    };
    let rows: Vec<(Vec<(usize, f64)>, f64)> = match (&to, table.acts) {
        (None, ActsEntry::Each) => {
            let share = 1.0 / from.len() as f64;
            from.iter().map(|node| (mean(std::slice::from_ref(node), 1.0), share)).collect()
        }
        (None, ActsEntry::Mean) => vec![(mean(&from, 1.0), 1.0)],
        (Some(to), _) => vec![([mean(&from, 1.0), mean(to, -1.0)].concat(), 1.0)],
    };
    let sum = |value: f64| {
        let mut sum = CooMatrix::new(order, order);
        for (row, share) in &rows {
            for &(i, a) in row {
                row.iter().for_each(|&(j, b)| sum.push(i, j, value * share * (a * b)));
            }
        }
        let sum = CscMatrix::from(&sum);
        (&sum + sum.transpose()) * 0.5
    };
    let zero = CscMatrix::zeros(order, order);
    let matrices = SparseSecondOrder::new(zero, sum(table.damping), sum(table.stiffness));
    let matrices = matrices.map_err(check.sparse(&format!("springs {:?}", table.name)))?;
    let coefficient = formulas.expression(&key("coefficient"), table.coefficient.clone(), 1.0)?;
    Ok((SparseTerm { name: table.name.clone(), family: table.name.clone(), matrices }, coefficient))
}
