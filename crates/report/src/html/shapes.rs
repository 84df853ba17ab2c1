//! The shapes of modes, for the picture in which they move.

use num_complex::Complex;
use output::hertz;
use serde_json::{Value, json};
use squeal::results::Results;
use squeal::results::findings::SetFindings;
use squeal::study::origin_of_set;

use super::geometry::{BasisOf, Geometry, ModeOf};
use super::packed::packed;
use crate::Error;

/// Numbers of shapes in a page, at most; chosen: 1.6 megabytes. The modes that come first are shown.
const MOST_SHAPE_NUMBERS: usize = 600_000;
/// Damping ratio from which on a mode is said to be stable; chosen, far above rounding.
const NEXT_TO_AXIS: f64 = 1e-9;
/// The part of a page that moves modes.
pub(super) const SECTION: &str = include_str!("shapes.html");

/// A mode that a page shows in motion.
pub(super) struct MovingMode<'m> {
    /// Index of its group in the list of choices.
    pub group: usize,
    /// Name of the mode, as "Mode 16".
    pub name: String,
    /// Eigenvalue lambda, rad/s.
    pub lambda: Complex<f64>,
    /// Text beside the frequency, after a comma; may be empty.
    pub note: String,
    pub of: ModeOf<'m>,
}

/// Geometry and shapes, of the first modes as many as a page has room for: real and imaginary part of each number in turn, as
/// parts of the largest modulus. In the page they stand group by group.
///
/// # Errors
/// A mode that does not fit the mesh.
pub(super) fn moving<'m>(
    geometry: &Geometry<'_>,
    groups: &[String],
    modes: impl IntoIterator<Item = MovingMode<'m>>,
) -> Result<Value, Error> {
    let mut room = MOST_SHAPE_NUMBERS;
    let mut shapes = Vec::new();
    for MovingMode { group, name, lambda, note, of } in modes {
        let Some(shape) = geometry.motion(of)? else { continue };
        if 2 * shape.len() > room {
            break;
        }
        room -= 2 * shape.len();
        let largest = shape.iter().fold(f64::MIN_POSITIVE, |most, u| most.max(u.norm()));
        shapes.push(json!({
            "group": group,
            "name": name,
            "hertz": hertz(cea::frequency_hz(lambda)),
            "note": note,
            "parts": packed(shape.iter().flat_map(|u| [u.re, u.im]), largest),
        }));
    }
    shapes.sort_by_key(|shape| shape["group"].as_u64());
    Ok(json!({ "geometry": geometry.json(), "groups": groups, "shapes": shapes }))
}

/// The modes of a study where they have their names, those that are ever unstable first, of each set the most robust first.
///
/// # Errors
/// As [`moving`].
pub(super) fn of_study(results: &Results, geometry: &Geometry<'_>) -> Result<Value, Error> {
    let plan = results.plan();
    let mut listed = Vec::new();
    for constraints in 0..plan.labels.constraints.len() {
        let Some(origin) = origin_of_set(plan, constraints) else { continue };
        let dofs = &plan.origins[origin].brake.dofs;
        let findings = SetFindings::new(results, constraints)?;
        for (label, mode) in results.modes_of_set(constraints) {
            let place = findings.unstable.iter().position(|(other, _)| *other == label);
            let note = place.map_or_else(String::new, |place| {
                let there =
                    if mode.lambda.re < -NEXT_TO_AXIS * mode.lambda.norm() { ", where it is stable" } else { "" };
                let words = findings.unstable[place].1.in_words();
                let hertz = results.unstable_hertz(constraints, label).filter(|hertz| hertz.range.is_some());
                let hertz = hertz.map_or_else(String::new, |hertz| format!(" at {hertz} Hz"));
                format!("the shape at the medians{there}; {words}{hertz}")
            });
            let moving = MovingMode {
                group: constraints,
                name: format!("Mode {}", results.mode_label(constraints, label)),
                lambda: mode.lambda,
                note,
                of: ModeOf { basis: BasisOf::Set(constraints), dofs, shape: &mode.shape },
            };
            listed.push(((place.is_none(), constraints, place, label), moving));
        }
    }
    listed.sort_by_key(|(order, _)| *order);
    moving(geometry, &plan.labels.constraints, listed.into_iter().map(|(_, mode)| mode))
}
