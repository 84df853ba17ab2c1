//! Bodies that turn, and springs in any direction: terms of a case that are made here and not read.

use std::collections::{BTreeMap, BTreeSet};

use elements::{Axis, Body, ElementsError, Material};
use nalgebra::{DMatrix, DVector, Vector3};
use nalgebra_sparse::{CooMatrix, CscMatrix};
use num_complex::Complex;
use sparse::{Problem, SparseSecondOrder, SparseTerm};

use super::entries::Nodes;
use super::faces::Solids;
use super::missing::MissingRows;
use super::nodes::Model;
use super::surface_schema::{ActsEntry, RotationTable, SpringTable};
use crate::check::field;
use crate::expression::formulas::{Formula, Formulas};
use crate::{CaseError, Expression};

/// Largest symmetric part of the gyroscopic matrix of a body of revolution, as a fraction of its skew part; chosen: a coarse mesh of a disc has a hundredth.
const NOT_ROUND: f64 = 0.1;

/// The terms of a body that turns with the speed Omega: `2 G` with the coefficient Omega, and `- P + K_sigma` with Omega^2. The stress
/// is the stress that the centrifugal load makes in the structure, whose stiffness is given.
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
        Ok::<_, CaseError>((SparseTerm { family: name.clone(), name, matrices, loss: 0.0 }, coefficient))
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

/// A spring with a dashpot as a term, with its coefficient.
pub(super) struct Spring {
    pub term: SparseTerm,
    pub coefficient: Expression,
    /// Directions b of its stiffness `sum b b^T`, as entries; none without a stiffness.
    pub directions: Vec<Vec<(usize, f64)>>,
}

/// A spring with a dashpot: of each node to ground, shared equally, or of the mean of the nodes, to ground or to the mean of others;
/// means by area need the mesh.
pub(super) fn spring(
    model: &Model<'_>,
    formulas: &mut Formulas<'_>,
    table: &SpringTable,
    missing: &mut Vec<MissingRows>,
) -> Result<Spring, CaseError> {
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
    // Nodes with what part of the motion each has.
    let mut weighed = |name: &str, nodes: &Nodes| {
        let found = match table.acts {
            ActsEntry::Each | ActsEntry::Mean => {
                let found = model.nodes(&key(name), nodes.items())?;
                let share = 1.0 / found.len() as f64;
                found.into_iter().map(|node| (node, share)).collect::<Vec<_>>()
            }
            ActsEntry::Area => by_area(&Solids::new(model, &key("acts"))?, &key(name), nodes)?,
        };
        let labels: Vec<i64> = found.iter().map(|(node, _)| *node).collect();
        let directions: Vec<u32> = (1..=3).filter(|&d| direction[d as usize - 1] != 0.0).collect();
        missing.extend(model.missing_rows(&key(name), &labels, &directions)?);
        Ok::<_, CaseError>(found)
    };
    let from = weighed("nodes", &table.nodes)?;
    let to = table.to.as_ref().map(|nodes| weighed("to", nodes)).transpose()?;
    let nodes_of = |nodes: &[(i64, f64)]| nodes.iter().map(|(node, _)| *node).collect::<BTreeSet<_>>();
    if to.as_ref().is_some_and(|to| nodes_of(to) == nodes_of(&from)) {
        let allowed = "other nodes than those of nodes, whose mean motion against themselves is 0";
        return Err(check.value(&key("to"), "the same nodes", allowed));
    }
    let entry = |node: i64, share: f64| {
        (1..=3).filter_map(move |d| Some((model.row(node, d)?, share * direction[d as usize - 1])))
    };
    let motion = |nodes: &[(i64, f64)], sign: f64| {
        let entries = nodes.iter().flat_map(|&(node, share)| entry(node, sign * share));
        entries.filter(|(_, value)| *value != 0.0).collect::<Vec<_>>()
    };
    // Rows, each a motion that the spring sees, and what part of it acts there.
    let rows: Vec<(Vec<(usize, f64)>, f64)> = match (&to, table.acts) {
        (None, ActsEntry::Each) => from.iter().map(|&(node, share)| (motion(&[(node, 1.0)], 1.0), share)).collect(),
        (None, ActsEntry::Mean | ActsEntry::Area) => vec![(motion(&from, 1.0), 1.0)],
        (Some(to), _) => vec![([motion(&from, 1.0), motion(to, -1.0)].concat(), 1.0)],
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
    let direction = |(row, share): &(Vec<(usize, f64)>, f64)| {
        let root = (table.stiffness * share).sqrt();
        row.iter().map(|&(at, a)| (at, root * a)).collect::<Vec<_>>()
    };
    let resists = |(row, share): &&(Vec<(usize, f64)>, f64)| !row.is_empty() && table.stiffness * share > 0.0;
    let directions = rows.iter().filter(resists).map(direction).collect();
    let term = SparseTerm { name: table.name.clone(), family: table.name.clone(), matrices, loss: 0.0 };
    Ok(Spring { term, coefficient, directions })
}

/// The nodes of faces with `int N dA / A` of each.
fn by_area(solids: &Solids<'_>, field: &str, names: &Nodes) -> Result<Vec<(i64, f64)>, CaseError> {
    let (mut of_node, mut whole) = (BTreeMap::<i64, f64>::new(), 0.0);
    for id in solids.faces(field, names)? {
        let face = solids.mesh.face(id).map_err(solids.model.check.contact(field))?;
        for (own, weight) in face.kind.rule() {
            let at = face.at(own);
            let area = weight * at.area.norm();
            whole += area;
            for (&node, n) in face.nodes.iter().zip(at.shape.values()) {
                *of_node.entry(solids.mesh.labels()[node]).or_default() += n * area;
            }
        }
    }
    Ok(of_node.into_iter().map(|(node, area)| (node, area / whole)).collect())
}
