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
/// Least damping ratio of a mode that is said to be stable; chosen: far above rounding.
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

/// Geometry and shapes, as JSON: of the modes in their order as many as a page has room for, and how many it leaves out. A shape has the real and the
/// imaginary part of each number in turn, as fractions of the largest modulus. In the page they stand group by group.
///
/// # Errors
/// A mode that does not fit the mesh.
pub(super) fn moving<'m>(
    geometry: &Geometry<'_>,
    groups: &[String],
    modes: impl IntoIterator<Item = MovingMode<'m>>,
) -> Result<Value, Error> {
    let (mut room, mut left_out) = (MOST_SHAPE_NUMBERS, 0);
    let mut shapes = Vec::new();
    for MovingMode { group, name, lambda, note, of } in modes {
        let Some(shape) = geometry.motion(of)? else { continue };
        if 2 * shape.len() > room {
            left_out += 1;
            continue;
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
    let left_out = without_room(left_out, "mode", "modes");
    Ok(json!({ "geometry": geometry.json(), "groups": groups, "shapes": shapes, "left_out": left_out }))
}

/// Sentence on the number of modes or cycles that a page has no room for; `None` where it has room for all.
fn without_room(number: usize, one: &str, more: &str) -> Option<String> {
    let what = match number {
        0 => return None,
        1 => format!("1 more {one} is"),
        number => format!("{number} more {more} are"),
    };
    Some(format!("{what} left out, as a page has room for {MOST_SHAPE_NUMBERS} numbers of shapes."))
}

/// A cycle that a page shows in motion.
pub(super) struct MovingCycle<'m> {
    /// Name of the cycle, as "Cycle from mode 2".
    pub name: String,
    /// Text beside the frequency, after a comma; may be empty.
    pub note: String,
    /// Contacts that open, each with a letter for each of equal steps of the period: `o` where it is open. Those that are points of the drawing are shown.
    pub open: Vec<(String, String)>,
    pub harmonics: &'m Harmonics,
}

/// Geometry and cycles as [`moving`] has modes: the mean and the first harmonics of each, one after the other in `parts`, with their numbers in
/// `orders`, as parts of the largest modulus. Harmonics are left out where the first ones hold the motion, and where there is no room for all; cycles without
/// room for their first are counted.
///
/// # Errors
/// A motion that does not fit the mesh.
pub(super) fn moving_cycles(
    geometry: &Geometry<'_>,
    (basis, dofs): (BasisOf<'_>, &DofMap),
    cycles: Vec<MovingCycle<'_>>,
) -> Result<Value, Error> {
    let (mut room, mut left, mut left_out) = (MOST_SHAPE_NUMBERS, cycles.len(), 0);
    let mut shapes = Vec::new();
    for MovingCycle { name, note, open, harmonics } in cycles {
        let motion = |order: usize| {
            let shape = DVector::from_vec(harmonics.displacement(order));
            geometry.motion(ModeOf { basis, dofs, shape: &shape })
        };
        let Some(mean) = motion(0)? else { continue };
        let fit = |room: usize| (room / (2 * mean.len().max(1))).saturating_sub(1);
        let number = harmonics_that_hold(harmonics).min(fit(room / left).max(1)).min(fit(room));
        left -= 1;
        if number == 0 {
            left_out += 1;
            continue;
        }
        let mut waves = mean;
        for order in 1..=number {
            waves.extend(motion(order)?.unwrap_or_default());
        }
        room -= 2 * waves.len();
        let open = open.into_iter().filter(|(name, _)| geometry.has_point(name));
        let largest = waves.iter().fold(f64::MIN_POSITIVE, |most, u| most.max(u.norm()));
        let shown = if number == 1 { "harmonic".to_owned() } else { format!("{number} harmonics") };
        shapes.push(json!({
            "group": 0,
            "name": name,
            "hertz": hertz(harmonics.frequency_hz(1)),
            "note": format!("{note}; its mean and first {shown}"),
            "open": open.map(|(name, steps)| (name, Value::from(steps))).collect::<Map<_, _>>(),
            "orders": (0..=number).collect::<Vec<_>>(),
            "parts": packed(waves.iter().flat_map(|u| [u.re, u.im]), largest),
        }));
    }
    let left_out = without_room(left_out, "cycle", "cycles");
    Ok(json!({ "geometry": geometry.json(), "groups": ["One period of each"], "shapes": shapes, "left_out": left_out }))
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Harmonics of a motion that is 1 m/s in the first of `order` degrees of freedom.
    fn harmonics(order: usize) -> Harmonics {
        let mut velocity = vec![Complex::default(); order];
        velocity[0] = Complex::new(1.0, 0.0);
        Harmonics { omega: 10.0, mean: vec![0.0; order], velocity: vec![velocity] }
    }

    fn shown(geometry: &Geometry<'_>, order: usize, number: usize) -> Value {
        let (dofs, harmonics) = (DofMap::all(order), harmonics(order));
        let open = vec![("2".to_owned(), "-o".to_owned()), ("belt".to_owned(), "o-".to_owned())];
        let cycle =
            || MovingCycle { name: "Cycle".into(), note: String::new(), open: open.clone(), harmonics: &harmonics };
        let cycles = (0..number).map(|_| cycle()).collect();
        moving_cycles(geometry, (BasisOf::Set(0), &dofs), cycles).unwrap()
    }

    #[test]
    fn cycles_that_do_not_fit_are_counted() {
        let of_lattice = |rows: usize, number| {
            let moving = shown(&Geometry::lattice(rows, 1), 3 * rows + 3, number);
            (moving["shapes"].as_array().unwrap().len(), moving["left_out"].clone())
        };
        assert_eq!(of_lattice(2, 3), (3, Value::Null));
        // A cycle has four numbers for each degree of freedom.
        let words = "2 more cycles are left out, as a page has room for 600000 numbers of shapes.";
        assert_eq!(of_lattice(30_000, 3), (1, json!(words)));
        assert_eq!(of_lattice(60_000, 1), (0, json!(words.replace("2 more cycles are", "1 more cycle is"))));
    }

    #[test]
    fn contacts_open_at_points_that_are_drawn() {
        let moving = shown(&Geometry::lattice(2, 1), 9, 1);
        assert_eq!(moving["shapes"][0]["open"], json!({ "2": "-o" }));
        let moving = shown(&Geometry::none("a reason"), 9, 1);
        assert_eq!((moving["shapes"].as_array().unwrap().len(), &moving["left_out"]), (0, &Value::Null));
    }
}
