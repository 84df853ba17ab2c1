//! Design points: the points of failure that are nearest to the medians, each likelier than all next to it.
//!
//! From a point that fails the ray from the medians to it is searched for the onset, and the onset moved to where its ray meets the surface of
//! failure at a right angle: to the foot of the tangent plane, whose own onset is the next point (Hasofer and Lind 1974, Rackwitz and Fiessler
//! 1978, with exact onsets in place of linear ones). The gradient is taken on the surface alone: where two modes coalesce into flutter the margin
//! is flat before.

use crate::limit_state::{Asked, Counted, LimitState, Mode};
use crate::line_intervals::{OF_WINDOW, PRECISION, STEP, crossing, failing};
use crate::vector::{along, dot, norm, scaled, unit};
use crate::window::Window;

/// Distance from the medians up to which failure is looked for, in standard deviations; chosen: 1.3e-12 lies beyond, one input alone.
pub(crate) const REACH: f64 = 7.0;
/// Largest number of moves to a design point; chosen: after as many the last point is kept, marked as not settled.
const MOST_MOVES: usize = 40;
/// Largest number of steps up the gradient from one direction to failure; chosen: after as many only nearer points of the direction itself are looked at.
const MOST_CLIMBS: usize = 4;
/// Fraction of the way to the next direction that is not halved any more where no nearer onset is found, and the same for windows; chosen: with less, more
/// points are evaluated before a search ends; with more, it ends farther from the design point.
const SMALLEST: f64 = 0.1;
const SMALLEST_OF_WINDOWS: f64 = 0.01;
/// Fractions of the reach at which a direction is looked at too, for failure that ends again before the reach; chosen.
const NEARER: [f64; 3] = [0.8, 0.6, 0.4];
/// Least cosine between ray and gradient at a design point; chosen: 1.1 degrees, beyond which the distance changes by less than an end of an interval.
const RIGHT_ANGLE: f64 = 1.0 - 2e-4;
/// Least cosine of the directions, and largest difference of the distances, of two design points that count as one; chosen: stricter numbers may keep one point
/// twice, looser ones lose one of two points.
const SAME: (f64, f64) = (0.97, 0.25);

/// A design point: the likeliest failure next to it.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct DesignPoint {
    /// The point, in standard deviations from the medians.
    pub point: Vec<f64>,
    /// Direction of the gradient there, of length 1: the squares of its entries are the shares that the inputs have in the failure.
    pub direction: Vec<f64>,
    /// Distance of the point from the medians, in standard deviations.
    pub beta: f64,
    /// Length of the gradient of the margin there, per standard deviation.
    pub slope: f64,
    /// Mode that fails from there on.
    pub mode: Mode,
    /// True if the point is one to the precision that is asked for: the ray meets the surface of failure at a right angle.
    pub is_settled: bool,
}

impl DesignPoint {
    /// Distance of `u` beyond the tangent plane.
    pub(crate) fn beyond(&self, u: &[f64]) -> f64 {
        dot(&self.direction, u) - self.beta
    }

    /// The window beyond it in its direction; `None` where failure does not end within a step.
    ///
    /// # Errors
    /// Those of the limit state.
    pub(crate) fn window<A: Asked>(&self, of: &A) -> Result<Option<Window>, A::Error> {
        let foot = along(&self.point, -dot(&self.point, &self.direction), &self.direction);
        Window::from(of, &|t| along(&foot, t, &self.direction), dot(&self.point, &self.direction))
    }

    /// True if the other point is this one.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        dot(&self.direction, &other.direction) > SAME.0 && (self.beta - other.beta).abs() < SAME.1
    }
}

/// The design points that are found from some points, the nearest first, each once.
///
/// # Errors
/// Those of the limit state.
pub(crate) fn design_points<L: LimitState>(
    of: &Counted<'_, L>,
    directions: &[Vec<f64>],
) -> Result<Vec<DesignPoint>, L::Error> {
    let mut found: Vec<DesignPoint> = Vec::new();
    let failing = of.in_step(directions, |of, direction| climb(of, direction))?;
    for failing in failing.into_iter().flatten() {
        if is_explained(of, &found, &failing)? {
            continue;
        }
        if let Some(point) = design_point(of, &failing)?
            && !found.iter().any(|other| other.is_same(&point))
        {
            found.push(point);
        }
    }
    found.sort_by(|a, b| a.beta.total_cmp(&b.beta));
    Ok(found)
}

/// A failing point in this direction: at the reach, up the gradient of the worst mode from there, or nearer; `None` where no such point fails.
fn climb<A: Asked>(of: &A, direction: &[f64]) -> Result<Option<Vec<f64>>, A::Error> {
    let mut u = scaled(REACH, direction);
    let mut worst = of.worst(&u)?;
    for _ in 0..MOST_CLIMBS {
        if worst.margin > 0.0 {
            return Ok(Some(u));
        }
        let Some((steepest, _)) = of.steepest(&u, &worst)? else { break };
        let next = scaled(REACH, &steepest);
        let there = of.worst(&next)?;
        if there.margin <= worst.margin {
            break;
        }
        (u, worst) = (next, there);
    }
    let nearer = NEARER.map(|part| scaled(part * REACH, direction));
    let worst = of.worst_of_all(&nearer)?;
    Ok(nearer.into_iter().zip(worst).find(|(_, worst)| worst.margin > 0.0).map(|(u, _)| u))
}

/// True if the onset on the ray to a failing point is on the tangent plane of a design point that is known, to a tenth of the distance from the medians.
fn is_explained<A: Asked>(of: &A, known: &[DesignPoint], failing: &[f64]) -> Result<bool, A::Error> {
    let onset = |point: &DesignPoint| {
        Some(point.beta / dot(&point.direction, failing)).filter(|part| (0.0..0.95).contains(part))
    };
    let Some(part) = known.iter().filter_map(onset).min_by(f64::total_cmp) else { return Ok(false) };
    let fails = |part: f64| Ok::<bool, A::Error>(of.worst(&scaled(part, failing))?.margin > 0.0);
    Ok(!fails(0.9 * part)? && fails((1.1 * part).min(1.0))?)
}

/// The design point that a failing point leads to; `None` where there is no onset before it, or no gradient.
///
/// # Errors
/// Those of the limit state.
pub(crate) fn design_point<A: Asked>(of: &A, from: &[f64]) -> Result<Option<DesignPoint>, A::Error> {
    let Some(mut ray) = unit(from.to_vec()) else { return Ok(None) };
    let length = norm(from);
    let margins = |places: &[f64]| {
        let points: Vec<Vec<f64>> = places.iter().map(|t| scaled(*t, &ray)).collect();
        Ok::<Vec<f64>, A::Error>(of.worst_of_all(&points)?.iter().map(|mode| mode.margin).collect())
    };
    // The interval that the point itself lies in: others before it have other points.
    let own =
        failing(margins, [0.0, length], 1.0, (STEP, Vec::new()))?.into_iter().rfind(|interval| interval.from <= length);
    let Some(mut beta) = own.map(|interval| interval.from).filter(|beta| *beta > 0.0) else { return Ok(None) };
    let mut window = Window::from(of, &|t| scaled(t, &ray), beta)?;
    let smallest = if window.is_some() { SMALLEST_OF_WINDOWS } else { SMALLEST };
    let mut precision = PRECISION;
    let mut part: f64 = 1.0;
    let mut best: Option<DesignPoint> = None;
    for _ in 0..MOST_MOVES {
        let (point, mode) = just_beyond(of, beta, &ray, precision)?;
        let steepest = of.steepest(&point, &mode)?.filter(|(direction, _)| dot(direction, &ray) > 0.0);
        let Some((direction, slope)) = steepest else {
            // Failure without a gradient that leads to it: lines along the ray are as right, and need not be as good.
            best = best.or(Some(DesignPoint { point, direction: ray, beta, slope: 0.0, mode, is_settled: false }));
            break;
        };
        let cosine = dot(&direction, &ray);
        let is_settled = cosine >= RIGHT_ANGLE;
        best = Some(DesignPoint { point, direction: direction.clone(), beta, slope, mode, is_settled });
        if is_settled {
            break;
        }
        let Some(towards) = unit(along(&scaled(1.0 - part, &ray), part, &direction)) else { break };
        let plane = beta * cosine / dot(&towards, &direction);
        let line = |t: f64| scaled(t, &towards);
        let found = match window {
            Some(window) => match window.on(of, &line, plane + 0.5 * window.width)? {
                Some(seen) => {
                    let onset = seen.onset(&mut |t| Ok::<f64, A::Error>(of.worst(&line(t))?.margin))?;
                    onset.map(|onset| (onset, Some(seen.window())))
                }
                None => None,
            },
            None => onset_near(of, &line, plane, [0.0, beta])?.map(|onset| (onset, None)),
        };
        match found {
            Some((next, seen)) if next < beta - 1e-4 => {
                (ray, beta, window) = (towards, next, seen);
                precision = window.map_or(PRECISION, |window| OF_WINDOW * window.width);
                part = (2.0 * part).min(1.0);
            }
            // Nothing nearer there: half the way.
            _ if part > smallest => part *= 0.5,
            _ => break,
        }
    }
    Ok(best)
}

/// A point of a ray at an onset, or as little beyond it as its precision asks for, and its worst mode: one that fails, as before the onset of flutter margins are flat.
fn just_beyond<A: Asked>(of: &A, onset: f64, ray: &[f64], precision: f64) -> Result<(Vec<f64>, Mode), A::Error> {
    let point = scaled(onset, ray);
    let mode = of.worst(&point)?;
    if mode.margin > 0.0 {
        return Ok((point, mode));
    }
    // A bracket of an onset is no longer than that.
    let beyond = scaled(onset + 4.0 * precision, ray);
    let there = of.worst(&beyond)?;
    Ok(if there.margin > 0.0 { (beyond, there) } else { (point, mode) })
}

/// The onset on a line, looked for between two ends, from `near` downwards if `near` fails, else upwards; `None` where no onset is found.
pub(crate) fn onset_near<A: Asked>(
    of: &A,
    line: &dyn Fn(f64) -> Vec<f64>,
    near: f64,
    [least, most]: [f64; 2],
) -> Result<Option<f64>, A::Error> {
    let mut margin = |t: f64| Ok::<f64, A::Error>(of.worst(&line(t))?.margin);
    let start = near.min(most);
    let mut here = (start, margin(start)?);
    let is_failing = here.1 > 0.0;
    let mut step = 0.1;
    loop {
        let at = if is_failing { (here.0 - step).max(least) } else { (here.0 + step).min(most) };
        if at == here.0 {
            return Ok(None);
        }
        let there = (at, margin(at)?);
        if (there.1 > 0.0) != is_failing {
            return crossing(&mut margin, here, there, PRECISION).map(Some);
        }
        (here, step) = (there, 2.0 * step);
    }
}
