//! Units that a case says its numbers have, against what these numbers are.

use elements::Body;
use serde::Deserialize;
use study::Units;

use super::faces::Solids;
use super::nodes::Model;
use super::structure::Structure;
use crate::CaseError;
use crate::check::Check;

/// Densities of what brakes are made of, kg/m^3, with room on both sides; chosen: kg/m^3 and t/mm^3, the units of the two systems, are a factor of 1e12 apart.
const DENSITIES: [f64; 2] = [100.0, 30_000.0];

/// Table `[units]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct UnitsTable {
    pub system: String,
}

/// The units of a case; SI where it says nothing.
///
/// # Errors
/// A system that is not known.
pub(super) fn units(check: &Check<'_>, table: Option<&UnitsTable>) -> Result<Units, CaseError> {
    let Some(UnitsTable { system }) = table else { return Ok(Units::default()) };
    let named = Units::ALL.into_iter().find(|units| units.name() == system);
    let allowed = Units::ALL.map(|units| format!("{:?}", units.name())).join(", ");
    named.ok_or_else(|| check.value("units.system", format!("{system:?}"), &allowed))
}

/// Refuses a density that no part of a brake has in these units.
///
/// # Errors
/// Error of that density, naming another system in which it is in the range; `what` goes before the number in the message.
pub(super) fn possible_density(
    check: &Check<'_>,
    units: Units,
    field: &str,
    what: &str,
    density: f64,
) -> Result<(), CaseError> {
    let [least, most] = DENSITIES;
    let is_possible = |units: Units| (least..=most).contains(&(density * units.density()));
    if is_possible(units) {
        return Ok(());
    }
    let [from, to] = DENSITIES.map(|density| density / units.density());
    let other = Units::ALL.into_iter().find(|other| is_possible(*other));
    let other = other.map_or_else(String::new, |other| format!(", or units.system = {:?}", other.name()));
    let unit = units.of("kg/m^3");
    Err(check.value(field, format!("{what}{density:.3e} {unit}"), &format!("{from:e} to {to:e} {unit}{other}")))
}

/// Refuses units in which the solids of the mesh have a mean density that no part of a brake has: the mass that a translation along x moves over
/// their volume. Nothing is compared where the mesh has no solids whose volume is known.
///
/// # Errors
/// As [`possible_density`]; elements without a volume.
pub(super) fn mean_density(model: &Model<'_>, structure: &Structure<'_>, units: Units) -> Result<(), CaseError> {
    let Ok(solids) = Solids::new(model, "units") else { return Ok(()) };
    let body = Body::new(&solids.mesh, solids.mesh.all(), &solids.rows).map_err(model.check.contact("brake.mesh"))?;
    let volume = body.volume().map_err(model.check.contact("brake.mesh"))?;
    let is_along_x = |row: usize| model.dofs[row].direction == 1;
    let mut mass = 0.0;
    for (term, theta) in structure.terms.iter().zip(structure.coefficients_at_medians()?) {
        let entries = term.matrices.m.triplet_iter().filter(|(i, j, _)| is_along_x(*i) && is_along_x(*j));
        mass += entries.map(|(_, _, value)| theta * value).sum::<f64>();
    }
    let system = format!("{:?}, in which the solids of the mesh have a mean density of ", units.name());
    possible_density(model.check, units, "units.system", &system, mass / volume)
}
