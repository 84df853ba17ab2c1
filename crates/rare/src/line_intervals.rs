//! Failure along a straight line: all intervals of it, found by steps.
//!
//! The largest margin is known at equal steps. Between two steps it changes its sign, or it comes so near zero at one of three places that
//! a parabola through them crosses: there the steps are halved. An interval that is shorter than a step and shows no sign of itself at the ends of it
//! is overlooked; the steps of each line begin at another place, so that no interval is overlooked by all.

use crate::normal::Interval;

/// Length of a step, in standard deviations; chosen: beside it the density changes by a factor of some hundreds where failure is rare.
pub(crate) const STEP: f64 = 1.0;
/// Shortest step about a place at which the margin comes near zero; chosen: with less, more points are evaluated; with more, a shorter failure is passed over.
const SHORTEST: f64 = STEP / 20.0;
/// Error of an end of an interval, in standard deviations; chosen: it changes the probability beyond by some 1e-3 of itself.
pub(crate) const PRECISION: f64 = 5e-4;
/// Error of an end of a window, as a fraction of its width; chosen: some 1e-3 of its probability.
pub(crate) const OF_WINDOW: f64 = 1e-3;
/// Evaluations for one end after which each halves; chosen: one of a margin that does not jump is found by then.
const PATIENCE: usize = 8;

/// A place along a line, in standard deviations, and the largest margin there.
pub(crate) type Place = (f64, f64);

/// The intervals of `[from, to]` in which the margin is above zero, ascending; `margins` gives it at several places. An interval that is open at an end of
/// the range goes on to infinity. `offset`, 0 to 1, is where the steps begin. Beside these the margin is known at the places `window`, about a window of
/// this `width`, by which the precision of the ends is chosen.
///
/// # Errors
/// Those of the margin.
pub(crate) fn failing<E>(
    mut margins: impl FnMut(&[f64]) -> Result<Vec<f64>, E>,
    [from, to]: [f64; 2],
    offset: f64,
    (width, window): (f64, Vec<Place>),
) -> Result<Vec<Interval>, E> {
    let first = from + STEP * offset.clamp(0.1, 1.0);
    let steps = (0..).map(|step| first + STEP * f64::from(step)).take_while(|at| *at < to - SHORTEST);
    let at: Vec<f64> = std::iter::once(from).chain(steps).chain(std::iter::once(to)).collect();
    let mut places: Vec<Place> = at.iter().copied().zip(margins(&at)?).collect();
    places.extend(window.into_iter().filter(|place| place.0 > from && place.0 < to));
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let precision = PRECISION.min(OF_WINDOW * width);
    let mut margin = |t: f64| Ok(margins(&[t])?.pop().unwrap_or(f64::NAN));
    while let Some(dip) = places.windows(3).position(comes_to_zero) {
        let [a, b, c] = [places[dip].0, places[dip + 1].0, places[dip + 2].0];
        // The longer of the two steps, so that the parabola stays a good one.
        let (place, at) = if b - a >= c - b { (dip + 1, 0.5 * (a + b)) } else { (dip + 2, 0.5 * (b + c)) };
        places.insert(place, (at, margin(at)?));
    }
    let mut open = (places[0].1 > 0.0).then_some(f64::NEG_INFINITY);
    let mut intervals = Vec::new();
    for pair in places.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        if (a.1 > 0.0) != (b.1 > 0.0) {
            let end = crossing(&mut margin, a, b, precision)?;
            match open.take() {
                Some(from) => intervals.push(Interval { from, to: end }),
                None => open = Some(end),
            }
        }
    }
    intervals.extend(open.map(|from| Interval { from, to: f64::INFINITY }));
    Ok(intervals)
}

/// True if a margin of one sign is nearest zero at the middle one of three places, and a parabola through them crosses it between.
fn comes_to_zero(places: &[Place]) -> bool {
    let [(a, left), (b, here), (c, right)] = [places[0], places[1], places[2]];
    let is_one_side = (left > 0.0) == (here > 0.0) && (here > 0.0) == (right > 0.0);
    let is_nearest = here.abs() <= left.abs() && here.abs() <= right.abs() && here.abs() < left.abs().max(right.abs());
    let is_a_number = left.is_finite() && right.is_finite();
    if !(is_one_side && is_nearest && is_a_number && c - a >= 2.5 * SHORTEST) {
        return false;
    }
    let (first, second) = ((left.abs() - here.abs()) / (b - a), (right.abs() - here.abs()) / (c - b));
    let curvature = (first + second) / (0.5 * (c - a));
    let slope = (second * (b - a) - first * (c - b)) / (c - a);
    // Twice as deep as the parabola: a margin may bend more in the middle.
    here.abs() < slope * (slope / curvature)
}

/// The place between two at which a margin changes its sign, to a precision, by the method of Illinois kept from standing still by bisection.
///
/// # Errors
/// Those of the margin.
pub(crate) fn crossing<E>(
    margin: &mut impl FnMut(f64) -> Result<f64, E>,
    (mut a, mut at_a): Place,
    (mut b, mut at_b): Place,
    precision: f64,
) -> Result<f64, E> {
    let is_failing = at_a > 0.0;
    // Illinois: the value at an end that stays is halved.
    let (mut pull_a, mut pull_b) = (at_a, at_b);
    let mut evaluations = 0;
    while (b - a).abs() > 4.0 * precision {
        evaluations += 1;
        let next = if evaluations % 4 == 0 || evaluations > PATIENCE {
            0.5 * (a + b)
        } else {
            between((a, pull_a), (b, pull_b))
        };
        // Never nearer to an end than that: an end that is all but zero need not be the place.
        let next = next.clamp(a.min(b) + 2.0 * precision, a.max(b) - 2.0 * precision);
        let found = margin(next)?;
        if (found > 0.0) == is_failing {
            (a, at_a, pull_a, pull_b) = (next, found, found, 0.5 * pull_b);
        } else {
            (b, at_b, pull_b, pull_a) = (next, found, found, 0.5 * pull_a);
        }
    }
    Ok(between((a, at_a), (b, at_b)))
}

/// Zero of the chord between two places; the middle where it is no number.
fn between((a, at_a): (f64, f64), (b, at_b): (f64, f64)) -> f64 {
    let chord = a + (b - a) * at_a / (at_a - at_b);
    if chord.is_finite() { chord.clamp(a.min(b), a.max(b)) } else { 0.5 * (a + b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends(margin: impl Fn(f64) -> f64, offset: f64) -> (Vec<f64>, usize) {
        let mut count = 0;
        let counted = |places: &[f64]| {
            count += places.len();
            Ok::<_, ()>(places.iter().map(|t| margin(*t)).collect())
        };
        let found = failing(counted, [-6.0, 6.0], offset, (STEP, Vec::new())).unwrap();
        (found.iter().flat_map(|interval| [interval.from, interval.to]).collect(), count)
    }

    #[test]
    fn all_intervals_are_found_and_their_ends_to_full_precision() {
        for offset in [0.0, 0.3, 0.9] {
            let (found, count) = ends(|t| t - 4.2, offset);
            assert!((found[0] - 4.2).abs() < 1e-12 && found[1] == f64::INFINITY && count < 18, "{found:?} {count}");
            let (found, count) = ends(|t| (t - 4.2).max(-1.0 - t / 3.0), offset);
            assert!(found.len() == 4 && found[0] == f64::NEG_INFINITY, "{found:?}");
            assert!((found[1] + 3.0).abs() < 1e-3 && (found[2] - 4.2).abs() < 1e-3 && count < 26, "{found:?} {count}");
            // A gap and an island narrower than a step, which a parabola foresees.
            let (found, _) = ends(|t| 0.04 - (t - 2.1).powi(2), offset);
            assert!(found.len() == 2 && (found[0] - 1.9).abs() < 1e-3 && (found[1] - 2.3).abs() < 1e-3, "{found:?}");
            let (found, _) = ends(|t| (t - 2.1).powi(2) - 0.04, offset);
            assert!(found.len() == 4 && (found[1] - 1.9).abs() < 1e-3, "{found:?}");
            // The margin of light damping: flat, then the root of the distance from a coalescence.
            let (found, count) = ends(|t| (t - 3.0).max(0.0).sqrt() - 0.05, offset);
            assert!((found[0] - 3.0025).abs() < 1e-3 && count < 32, "{found:?} {count}");
            // A mode that comes into the band and fails there.
            let (found, _) = ends(|t| if t > 3.3 { 5.0 } else { -1.0 }, offset);
            assert!((found[0] - 3.3).abs() < 1e-3, "{found:?}");
        }
        assert_eq!(ends(|_| -1.0, 0.5).0, Vec::<f64>::new());
        assert_eq!(ends(|_| 1.0, 0.5).0, [f64::NEG_INFINITY, f64::INFINITY]);
    }
}
