//! The friction channels of a case.

use std::collections::BTreeMap;

use linsys::Channel;

use super::dofs::DofNames;
use super::{GainExpressions, LagExpressions, schema};
use crate::CaseError;
use crate::check::{Check, field};
use crate::expression::formulas::{Formula, Formulas};

/// The family of a contact without a `family`.
const FAMILY_OF_FRICTION: &str = "friction";

/// The channels with the expressions of their gains.
pub(super) fn channels_with_gains(
    check: &Check<'_>,
    formulas: &mut Formulas<'_>,
    dofs: &DofNames<'_>,
    given: Vec<schema::ContactTable>,
) -> Result<(Vec<Channel>, Vec<GainExpressions>), CaseError> {
    check.names("contacts.name", given.iter().map(|contact| &contact.name))?;
    check.names_of_families("contacts", given.iter().map(|contact| (&contact.name, &contact.family)))?;
    let (mut channels, mut gains) = (Vec::new(), Vec::new());
    for schema::ContactTable { name, family, force, reading, mu, slope, lag, load, speed, stiffness } in given {
        let b = sparse_vector(check, dofs, &field("contacts", &name, "force"), &force)?;
        let r = sparse_vector(check, dofs, &field("contacts", &name, "reading"), &reading)?;
        for (key, vector) in [("force", &b), ("reading", &r)] {
            if !vector.is_empty() && vector.iter().all(|(_, value)| *value == 0.0) {
                return Err(check.value(
                    &field("contacts", &name, key),
                    "0 throughout",
                    "a number that is not 0, or several",
                ));
            }
        }
        if b.is_empty() {
            return Err(check.value(&field("contacts", &name, "force"), "{}", "one degree of freedom or more"));
        }
        match (r.is_empty(), &mu, slope.is_some() || lag.is_some()) {
            (_, None, false) => {
                let found = "neither mu nor slope nor lag";
                return Err(check.value(&format!("contacts {name:?}"), found, "one of them, or several"));
            }
            (true, Some(_), _) => {
                let allowed = "the normal force that mu multiplies, as { y = 11.0 }";
                return Err(check.value(&field("contacts", &name, "reading"), "{}", allowed));
            }
            (false, None, _) => {
                let allowed = "an expression, or no reading";
                return Err(check.value(&field("contacts", &name, "mu"), "missing", allowed));
            }
            _ => {}
        }
        let motion = [("load", load), ("speed", speed), ("stiffness", stiffness)].map(|(key, given)| {
            given.map(|formula| formulas.expression(&field("contacts", &name, key), Some(formula), 0.0)).transpose()
        });
        let [load, speed, stiffness] = motion;
        let mut expression =
            |key: &str, given: Option<Formula>| formulas.expression(&field("contacts", &name, key), given, 0.0);
        gains.push(GainExpressions {
            load: load?,
            speed: speed?,
            stiffness: stiffness?,
            mu: expression("mu", mu)?,
            slope: expression("slope", slope)?,
            lag: match lag {
                None => None,
                Some(schema::LagTable { decay, drive, force }) => Some(LagExpressions {
                    decay: expression("lag.decay", Some(decay))?,
                    drive: expression("lag.drive", Some(drive))?,
                    force: expression("lag.force", Some(force))?,
                }),
            },
        });
        channels.push(Channel::new(name, family.unwrap_or_else(|| FAMILY_OF_FRICTION.to_owned()), b, r));
    }
    Ok((channels, gains))
}

/// The entries of a vector by their degrees of freedom, as indices and finite numbers; `field` names the table in messages.
fn sparse_vector(
    check: &Check<'_>,
    dofs: &DofNames<'_>,
    field: &str,
    entries: &BTreeMap<String, f64>,
) -> Result<Vec<(usize, f64)>, CaseError> {
    let mut vector = Vec::with_capacity(entries.len());
    for (dof, &value) in entries {
        let entry = format!("{field}.{dof}");
        vector.push((dofs.index(&entry, dof)?, check.finite(&entry, value)?));
    }
    Ok(vector)
}
