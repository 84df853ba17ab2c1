//! The shapes of modes, for the picture in which they move.

use linsys::DofMap;
use nalgebra::DVector;
use num_complex::Complex;
use output::hertz;
use serde_json::{Map, Value, json};
use squeal::cycle::Harmonics;
use squeal::results::Results;
use squeal::results::findings::SetFindings;
use squeal::study::origin_of_set;

use super::geometry::{BasisOf, Geometry, ModeOf};
use super::packed::packed;
use super::text::filled;
use crate::Error;

/// Numbers of shapes in a page, at most; chosen: 1.6 megabytes. The modes that come first are shown.
const MOST_SHAPE_NUMBERS: usize = 600_000;
/// Damping ratio from which on a mode is said to be stable; chosen, far above rounding.
const NEXT_TO_AXIS: f64 = 1e-9;
/// Part of the mean square of the displacements about their mean that a moving cycle leaves out, at most; chosen: a thousandth of the motion.
const LEFT_OUT: f64 = 1e-6;

/// The part of a page that moves modes.
pub(super) fn section_of_modes() -> String {
    section([
        "How the modes move",
        "Mode",
        "Largest motions of this mode",
        "Amplitude, of the largest",
        "Phase, degrees",
    ])
}

/// The part of a page that moves cycles.
pub(super) fn section_of_cycles() -> String {
    section([
        "How the cycles move",
        "Cycle",
        "Largest motions of this cycle",
        "Largest distance from steady sliding, of the largest",
        "Phase there, degrees",
    ])
}

fn section([title, choice, caption, amplitude, phase]: [&str; 5]) -> String {
    let values =
        [("title", title), ("choice", choice), ("caption", caption), ("amplitude", amplitude), ("phase", phase)];
    filled(include_str!("shapes.html"), &values)
}

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

/// A cycle that a page shows in motion.
pub(super) struct MovingCycle<'m> {
    /// Name of the cycle, as "Cycle from mode 2".
    pub name: String,
    /// Text beside the frequency, after a comma; may be empty.
    pub note: String,
    /// Contacts that open, each with a letter for each of equal steps of the period: `o` where it is open.
    pub open: Vec<(String, String)>,
    pub harmonics: &'m Harmonics,
}

/// Geometry and cycles as [`moving`] has modes: the mean and the first harmonics of each, one after the other in `parts`, with their numbers in
/// `orders`, as parts of the largest modulus. Harmonics are left out where the first ones hold the motion, and where there is no room for all.
///
/// # Errors
/// A motion that does not fit the mesh.
pub(super) fn moving_cycles(
    geometry: &Geometry<'_>,
    (basis, dofs): (BasisOf<'_>, &DofMap),
    cycles: Vec<MovingCycle<'_>>,
) -> Result<Value, Error> {
    let (mut room, mut left) = (MOST_SHAPE_NUMBERS, cycles.len());
    let mut shapes = Vec::new();
    for MovingCycle { name, note, open, harmonics } in cycles {
        let motion = |order: usize| {
            let shape = DVector::from_vec(harmonics.displacement(order));
            geometry.motion(ModeOf { basis, dofs, shape: &shape })
        };
        let Some(mean) = motion(0)? else { continue };
        let fit = |room: usize| (room / (2 * mean.len().max(1))).saturating_sub(1);
        let number = harmonics_that_hold(harmonics).min(fit(room / left).max(1)).min(fit(room));
        if number == 0 {
            break;
        }
        let mut waves = mean;
        for order in 1..=number {
            waves.extend(motion(order)?.unwrap_or_default());
        }
        room -= 2 * waves.len();
        left -= 1;
        let largest = waves.iter().fold(f64::MIN_POSITIVE, |most, u| most.max(u.norm()));
        let shown = if number == 1 { "harmonic".to_owned() } else { format!("{number} harmonics") };
        shapes.push(json!({
            "group": 0,
            "name": name,
            "hertz": hertz(harmonics.frequency_hz(1)),
            "note": format!("{note}; its mean and first {shown}"),
            "open": open.into_iter().map(|(name, steps)| (name, Value::from(steps))).collect::<Map<_, _>>(),
            "orders": (0..=number).collect::<Vec<_>>(),
            "parts": packed(waves.iter().flat_map(|u| [u.re, u.im]), largest),
        }));
    }
    Ok(json!({ "geometry": geometry.json(), "groups": ["One period of each"], "shapes": shapes }))
}

/// Number of the first harmonics that hold the displacements, as many as there are at most.
fn harmonics_that_hold(harmonics: &Harmonics) -> usize {
    let number = harmonics.velocity.len();
    let square = |order: usize| harmonics.displacement(order).iter().map(|u| u.norm_sqr()).sum::<f64>();
    let squares: Vec<f64> = (1..=number).map(square).collect();
    let (all, mut held) = (squares.iter().sum::<f64>(), 0.0);
    let holds = |square: &f64| {
        held += square;
        held >= (1.0 - LEFT_OUT) * all
    };
    squares.iter().position(holds).map_or(number, |last| last + 1)
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
