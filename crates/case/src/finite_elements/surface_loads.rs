//! Normal forces of contacts between faces: given, or in equilibrium with the forces of the case.

use contact::{ContactError, Stiffness};
use formats::plain_text;
use nalgebra::{DMatrix, Vector3};

use super::balance::{Acting, ContactBalance, Recent};
use super::faces::Solids;
use super::structure::Structure;
use super::surface_contact::SurfaceContact;
use super::surface_schema::{ForceTable, LoadEntry};
use crate::check::field;
use crate::{CaseError, Expression};

/// Normal forces of the points of each contact at the medians, a sentence on how they came about, and what they follow from elsewhere.
pub(super) struct Balanced {
    pub forces: Vec<Vec<f64>>,
    pub note: String,
    pub balance: ContactBalance,
}

/// Loads of contacts in equilibrium, with the friction and the stiffness that these have.
pub(super) struct Pressing<'a> {
    pub forces: &'a [ForceTable],
    /// Factor of each of the forces, and their values at the medians.
    pub factors: Vec<Expression>,
    pub at_medians: Vec<f64>,
    /// Coefficient of friction of each contact at the medians.
    pub mu: Vec<f64>,
    /// Factor of the stiffness at the medians.
    pub stiffness: f64,
}

/// The normal force of each point of a contact whose load is given.
pub(super) fn given_forces(solids: &Solids<'_>, contact: &SurfaceContact<'_>) -> Result<Vec<f64>, CaseError> {
    let (check, key) = (solids.model.check, field("contact", &contact.table.name, "load"));
    let forces = match &contact.table.load {
        LoadEntry::Total(total) => contact.interface.uniform(*total),
        LoadEntry::Pressure(table) => contact.interface.uniform(table.pressure * contact.interface.area()),
        LoadEntry::Pressures(table) => {
            let file = check.path.parent().unwrap_or(std::path::Path::new("")).join(&table.pressures);
            let text = std::fs::read_to_string(&file).map_err(|source| CaseError::MatrixRead {
                path: check.path.to_owned(),
                field: key.clone(),
                file: table.pressures.clone(),
                source,
            })?;
            let pressures = pressures(&text).map_err(|(line, found)| {
                let found = format!("{:?}, line {line}: {found:?}", table.pressures.display());
                check.value(&key, found, "lines with the number of a node and its pressure")
            })?;
            contact.interface.of_pressures(&solids.mesh, &pressures)
        }
        LoadEntry::Word(_) => Ok(Vec::new()),
    };
    forces.map_err(check.contact::<ContactError>(&key))
}

/// Nodes with their pressures from lines of a node and its pressure, with a comma, a semicolon or blanks between: csv, and the columns of a report
/// of Abaqus (`CPRESS`) or of Ansys (`PRNSOL, CONT, PRES`). Lines that do not begin with a digit are passed over: heads, remarks and
/// totals.
///
/// # Errors
/// The number, from 1, and the beginning of a line that begins with a digit and is not a node with its pressure.
fn pressures(text: &str) -> Result<Vec<(i64, f64)>, (usize, String)> {
    let mut all = Vec::new();
    for (number, line) in plain_text(text).lines().enumerate() {
        let plain = line.trim().replace('"', "");
        if !plain.starts_with(|c: char| c.is_ascii_digit()) {
            continue;
        }
        let mut fields = plain.split(|c: char| c.is_whitespace() || ",;".contains(c)).filter(|field| !field.is_empty());
        let node = fields.next().and_then(|field| field.parse().ok());
        let pressure = fields.next().and_then(|field| field.parse().ok());
        match (node, pressure, fields.next()) {
            (Some(node), Some(pressure), None) => all.push((node, pressure)),
            _ => return Err((number + 1, plain.chars().take(40).collect())),
        }
    }
    Ok(all)
}

/// The forces of contacts in equilibrium at the medians: what acts on the structure (holders and springs in it, contacts not), and friction
/// mu along the sliding.
pub(super) fn balanced(
    solids: &Solids<'_>,
    contacts: &[SurfaceContact<'_>],
    structure: &Structure<'_>,
    pressing: &Pressing<'_>,
) -> Result<Balanced, CaseError> {
    let check = solids.model.check;
    let of_contact = check.contact::<ContactError>(EQUILIBRIUM);
    let loads = acting(solids, pressing.forces)?;
    let area: f64 = contacts.iter().map(|contact| contact.interface.area()).sum();
    let law = contacts[0].law;
    let is_power = |contact: &SurfaceContact<'_>| matches!(contact.law, Stiffness::Power { .. });
    if contacts.iter().any(is_power) && contacts.iter().any(|contact| contact.law != law) {
        let allowed = "one law p = c g^m for all contacts that are in equilibrium, or none";
        return Err(check.value("contact.stiffness", "several laws", allowed));
    }
    // Springs to begin with, which a law replaces: as stiff as it is under the mean pressure.
    let load = &loads * DMatrix::from_column_slice(loads.ncols(), 1, &pressing.at_medians);
    let pressure = load.iter().map(|force| force.abs()).sum::<f64>() / area;
    let mut balance = ContactBalance {
        gaps: Vec::new(),
        slips: Vec::new(),
        areas: Vec::new(),
        springs: Vec::new(),
        law: is_power(&contacts[0]).then_some(law),
        loads,
        factors: pressing.forces.iter().map(|table| table.name.clone()).zip(pressing.factors.clone()).collect(),
        stiff: structure.stiff(),
        at_medians: Vec::new(),
        structures: Recent::default(),
        states: Recent::default(),
    };
    for contact in contacts {
        let points = contact.interface.points();
        let at_mean: Vec<f64> = points.iter().map(|point| pressure * point.area).collect();
        balance.springs.extend(contact.interface.tangents(&contact.law, &at_mean).map_err(&of_contact)?);
        balance.areas.extend(points.iter().map(|point| point.area));
        balance.gaps.extend(points.iter().map(|point| point.gap_row(&solids.rows)));
        balance.slips.extend(points.iter().map(|point| point.slip_row(&solids.rows)));
    }
    let points = balance.points();
    let of_points = contacts.iter().zip(&pressing.mu);
    let mu: Vec<f64> = of_points.flat_map(|(contact, &mu)| vec![mu; contact.interface.points().len()]).collect();
    let (coefficients, k) = (structure.coefficients_at_medians()?, structure.at_medians(0.0)?);
    let at_medians = Acting {
        coefficients: &coefficients,
        loads: &pressing.at_medians,
        mu: &mu,
        stiffness: &vec![pressing.stiffness; points],
    };
    let found = balance.state(&at_medians, &|| k.clone()).map_err(&of_contact)?;
    if found.undetermined > 0 {
        let loads = load.iter().map(|force| force.abs()).sum();
        return Err(of_contact(ContactError::Undetermined { points: found.undetermined, of: points, loads }));
    }
    balance.at_medians = found.stiffness.iter().map(|stiffness| stiffness / pressing.stiffness).collect();
    let closed = found.forces.iter().filter(|force| **force > 0.0).count();
    let mut rest = found.forces.as_slice();
    let mut of_contacts = Vec::new();
    let mut words = Vec::new();
    let first = pressing.mu[0];
    let is_one = pressing.mu.iter().all(|mu| *mu == first);
    for (contact, mu) in contacts.iter().zip(&pressing.mu) {
        let (own, others) = rest.split_at(contact.interface.points().len());
        rest = others;
        let with = if is_one { String::new() } else { format!(" with mu = {mu}") };
        words.push(format!("{} {:.6e} N{with}", contact.table.name, own.iter().sum::<f64>()));
        of_contacts.push(own.to_vec());
    }
    let of_all = if is_one { format!("friction.mu = {first}") } else { "friction".to_owned() };
    let note = format!(
        "contacts in equilibrium, at the medians with {of_all} (Amontons-Coulomb): {closed} of {points} points are closed, {}; {}",
        words.join(", "),
        found.uniqueness
    );
    Ok(Balanced { forces: of_contacts, note, balance })
}

/// The field of contacts whose loads are found by an equilibrium.
pub const EQUILIBRIUM: &str = "contact.load = \"equilibrium\"";

/// The forces of a case on its rows, a column each.
fn acting(solids: &Solids<'_>, forces: &[ForceTable]) -> Result<DMatrix<f64>, CaseError> {
    let (check, model) = (solids.model.check, solids.model);
    if forces.is_empty() {
        return Err(check.value("forces", "missing", "tables of what presses, as contacts are in equilibrium"));
    }
    check.names("forces.name", forces.iter().map(|table| &table.name))?;
    let mut loads = DMatrix::zeros(solids.rows.order(), forces.len());
    for (table, mut load) in forces.iter().zip(loads.column_iter_mut()) {
        let key = |key: &str| field("forces", &table.name, key);
        match (&table.nodes, table.force, &table.faces, table.pressure) {
            (Some(nodes), Some(force), None, None) => {
                let nodes = model.nodes(&key("nodes"), nodes.items())?;
                for (x, force) in force.into_iter().enumerate() {
                    let force = check.finite(&key("force"), force)? / nodes.len() as f64;
                    for &node in &nodes {
                        model.row(node, x as u32 + 1).into_iter().for_each(|row| load[row] += force);
                    }
                }
            }
            (None, None, Some(faces), Some(pressure)) => {
                let pressure = check.finite(&key("pressure"), pressure)?;
                for id in solids.faces(&key("faces"), faces)? {
                    let face = solids.mesh.face(id).map_err(check.contact(&key("faces")))?;
                    // A face of an inverted element looks inwards.
                    solids.mesh.volume(id.element).map_err(check.contact(&key("faces")))?;
                    for (own, weight) in face.kind.rule() {
                        let at = face.at(own);
                        // Against the normal to the outside.
                        let force: Vector3<f64> = at.area * (-pressure * weight);
                        for (&node, n) in face.nodes.iter().zip(at.shape.values()) {
                            for x in 0..3 {
                                solids.rows.row(node, x).into_iter().for_each(|row| load[row] += n * force[x]);
                            }
                        }
                    }
                }
            }
            _ => {
                let allowed = "nodes with force = [x, y, z] in N, or faces with pressure in Pa";
                return Err(check.value(&format!("forces {:?}", table.name), "other fields", allowed));
            }
        }
    }
    Ok(loads)
}

#[cfg(test)]
mod tests {
    use super::pressures;

    #[test]
    fn files_of_pressures_may_have_heads_and_totals() {
        let text = "node, pressure\n# by hand\n\n12, 1.5e6\n13;2e6\n14\t0\n";
        assert_eq!(pressures(text), Ok(vec![(12, 1.5e6), (13, 2e6), (14, 0.0)]));
        let report = "   Node Label          CPRESS\n         @Loc 1\n-----\n     12   1.5E+06\n     13   0.\n\n  Minimum   0.\n  At Node  13\n";
        assert_eq!(pressures(report), Ok(vec![(12, 1.5e6), (13, 0.0)]));
        assert_eq!(pressures("\u{feff}12,1e5\n"), Ok(vec![(12, 1e5)]));
        for ending in ["\r\n", "\r"] {
            assert_eq!(pressures(&report.replace('\n', ending)), pressures(report), "{ending:?}");
        }
        assert_eq!(pressures("\"12\",\"1e5\"\n"), Ok(vec![(12, 1e5)]));
        assert_eq!(pressures("12, 1\n13, x\n"), Err((2, "13, x".to_owned())));
        assert_eq!(pressures("12, 1\n13, 1, 2\n"), Err((2, "13, 1, 2".to_owned())));
    }
}
