//! The shapes of modes, for the picture in which they move.

use serde_json::{Value, json};

use super::Geometry;
use super::packed::packed;
use crate::Error;
use crate::report::Results;
use crate::report::findings::SetFindings;
use crate::report::summary::hertz;

/// Numbers of shapes in a page, at most; chosen: 1.6 megabytes. Modes that are ever unstable come first.
const MOST_SHAPE_NUMBERS: usize = 600_000;

/// The shapes of modes where they have their names: real and imaginary part of each number in turn, as parts of the largest modulus.
pub(super) fn shapes(results: &Results<'_>, geometry: &Geometry) -> Result<Vec<Value>, Error> {
    let plan = results.plan();
    let mut listed = Vec::new();
    for constraints in 0..plan.labels.constraints.len() {
        let findings = SetFindings::new(results, constraints)?;
        for (name, mode) in results.modes_of_set(constraints) {
            let place = findings.unstable.iter().position(|(other, _)| *other == name);
            listed.push((place.is_none(), constraints, place, name, mode));
        }
    }
    listed.sort_by_key(|&(is_stable, constraints, place, name, _)| (is_stable, constraints, place, name));
    let mut room = MOST_SHAPE_NUMBERS;
    let mut shapes = Vec::new();
    for (is_stable, constraints, _, name, mode) in listed {
        let Some(shape) = geometry.shape(plan, constraints, name, mode) else { continue };
        if 2 * shape.len() > room {
            break;
        }
        room -= 2 * shape.len();
        let largest = shape.iter().fold(f64::MIN_POSITIVE, |most, u| most.max(u.norm()));
        shapes.push(json!({
            "set": constraints,
            "label": results.mode_label(constraints, name),
            "hertz": hertz(cea::frequency_hz(mode.lambda)),
            "is_unstable": !is_stable,
            "parts": packed(shape.iter().flat_map(|u| [u.re, u.im]), largest),
        }));
    }
    // Set by set, in each the most robust first.
    shapes.sort_by_key(|shape| shape["set"].as_u64());
    Ok(shapes)
}
