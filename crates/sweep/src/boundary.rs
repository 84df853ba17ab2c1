//! The boundary of stability over two parameters: curves on which Re lambda of one mode is zero, or the stiffness is singular
//! (divergence), followed from point to point.
//!
//! Coordinates are fractions x, y of the two ranges, 0 to 1. From a point a step goes along the tangent, across the gradient of
//! the growth; Newton's method takes it back onto the curve along the gradient. The step is halved where the tangent has turned far,
//! Newton's method went far, the eigenvalue departs from its tangents or the shape has changed: it would be another mode's.
//! Curves run so that the unstable side is on their right.

use nalgebra::{Vector2, vector};
use serde::Serialize;
use study::UncertainBrake;
use tracking::link_error;

use super::curve_point::{CurvePoint, PointOf};
use super::family::Part;
use crate::Error;

/// First step, as a fraction of the ranges; chosen: a curve is drawn by straight lines.
const FIRST_STEP: f64 = 0.01;
/// Longest step, as a fraction of the ranges; chosen: a curve is drawn by straight lines.
const LONGEST_STEP: f64 = 0.03;
/// Shortest step, as a fraction of the ranges: a curve that needs a shorter one is given up; chosen.
const SHORTEST_STEP: f64 = 1e-7;
/// Cosine of the largest turn of the tangent in a step; chosen: 15 degrees.
const LARGEST_TURN: f64 = 0.966;
/// Cosine of the largest turn of the tangent after which the next step is longer; chosen: 6 degrees.
const SMALL_TURN: f64 = 0.9945;
/// Largest correction, as a fraction of the step; chosen: with less, more steps are halved; with more, a step may lead to another curve.
const LARGEST_CORRECTION: f64 = 0.2;
/// Largest departure of lambda from its tangents, as a fraction of its change over a step of that length up the steepest way; chosen likewise.
const LARGEST_DEPARTURE: f64 = 0.05;
/// Least `|x^H z|` of the unit shapes at the ends of a step; chosen: with less, a step may lead to another mode; with more, more steps are halved.
const LEAST_LIKENESS: f64 = 0.8;
/// Largest distance from the curve of a point that is on it; chosen: rounding of coordinates near 1.
const ON_CURVE: f64 = 1e-13;
/// Largest distance of a point that counts as on the curve if corrections do not fall any more; chosen: with less, points whose
/// corrections are rounding are not found; with more, points are farther from the curve.
const ROUNDING: f64 = 1e-9;
/// Most corrections; chosen: a step that needs more is halved.
const MOST_CORRECTIONS: usize = 8;
/// Most points of a curve; chosen: one that needs more counts as lost.
const MOST_POINTS: usize = 20_000;
/// Largest distance from a step of a curve of a known point that counts as lying on it, as a fraction of the step and of the change of the
/// frequency; chosen: the cubic between two points is far nearer.
const SAME_POINT: f64 = 5e-3;

/// Kind of end of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CurveEnd {
    /// The curve is closed.
    Closed,
    /// An end of a range.
    Edge,
    /// A point where it could not be followed: near a coalescence on the boundary, or where two curves meet.
    Lost,
}

/// A point of a boundary curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BoundaryPoint {
    /// Values of the two parameters.
    pub at: [f64; 2],
    /// Frequency Im lambda, rad/s; 0 of divergence, and where a growing pair becomes real.
    pub omega: f64,
    /// Growth rate Re lambda, 1/s: the growth rate of the threshold, but where a growing pair becomes real.
    pub growth: f64,
}

/// Boundary curve, on which one mode is at the threshold, or the stiffness is singular (divergence), or a growing pair becomes two
/// real eigenvalues. On its right, seen along it, there is one more unstable mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BoundaryCurve {
    /// Candidates for the name of the mode where the curve was found, on the straight line from the medians; "divergence" or
    /// "flutter to divergence".
    pub mode: String,
    /// Kinds of its two ends.
    pub ends: [CurveEnd; 2],
    /// Points of the curve; the first again at the end of a closed one.
    pub points: Vec<BoundaryPoint>,
}

/// The direction in which a point is corrected.
#[derive(Debug, Clone, Copy)]
enum Along {
    Gradient,
    /// Coordinate of this index alone; the other stays.
    Axis(usize),
}

/// Follower of the curves of one part of a family, which counts its computations.
pub(super) struct Tracer<'a, B: UncertainBrake> {
    pub part: &'a Part<'a, B>,
    /// Number of eigenpairs found from neighbouring ones.
    pub continued: u64,
}

impl<B: UncertainBrake> Tracer<'_, B> {
    /// The point of the curve next to a prediction; `None` where Newton's method fails or leaves the ranges.
    fn corrected(
        &mut self,
        from: &CurvePoint,
        mut at: Vector2<f64>,
        along: Along,
    ) -> Result<Option<CurvePoint>, Error> {
        let mut last = f64::INFINITY;
        let mut near = from.clone();
        let mut guess = from.value() + from.change(at - from.at);
        // Where the growth does not change with either parameter there is no direction to go.
        if at.iter().any(|part| part.is_nan()) {
            return Ok(None);
        }
        for _ in 0..MOST_CORRECTIONS {
            self.continued += 1;
            let Some(point) = near.moved(self.part, at, guess)? else { return Ok(None) };
            let (gradient, growth) = (point.gradient(), point.growth());
            let step = match along {
                Along::Gradient => -gradient * (growth / gradient.norm_squared()),
                Along::Axis(axis) => {
                    let mut step = Vector2::zeros();
                    step[axis] = -growth / gradient[axis];
                    step
                }
            };
            let size = step.norm();
            if size <= ON_CURVE || (size <= ROUNDING && size >= last) {
                return Ok(Some(point));
            }
            last = size;
            let next = at + step;
            if !next.iter().all(|part| (0.0..=1.0).contains(part)) {
                return Ok(None);
            }
            guess = point.value() + point.change(step);
            (at, near) = (next, point);
        }
        Ok(None)
    }

    /// The curve through a point, both ways until it is closed or ends, and how it ends.
    ///
    /// # Errors
    /// Those of the brake.
    pub fn curve(&mut self, start: CurvePoint) -> Result<(Vec<CurvePoint>, [CurveEnd; 2]), Error> {
        let (forward, end) = self.one_way(&start, 1.0)?;
        if end == CurveEnd::Closed {
            let closing = start.clone();
            return Ok((std::iter::once(start).chain(forward).chain([closing]).collect(), [end; 2]));
        }
        let (backward, beginning) = self.one_way(&start, -1.0)?;
        let points = backward.into_iter().rev().chain([start]).chain(forward).collect();
        Ok((points, [beginning, end]))
    }

    /// The points after the start in one direction.
    fn one_way(&mut self, start: &CurvePoint, sign: f64) -> Result<(Vec<CurvePoint>, CurveEnd), Error> {
        let mut points: Vec<CurvePoint> = Vec::new();
        let (mut here, mut step) = (start.clone(), FIRST_STEP);
        let start_point = KnownPoint { at: start.at, omega: start.omega(), error: 0.0, of: start.of() };
        while points.len() < MOST_POINTS {
            let tangent = here.tangent() * sign;
            let (to_edge, edge) = to_edge(here.at, tangent);
            if to_edge <= ROUNDING {
                return Ok((points, CurveEnd::Edge));
            }
            let reaches_edge = to_edge <= step;
            let (length, along) = if reaches_edge { (to_edge, Along::Axis(1 - edge)) } else { (step, Along::Gradient) };
            let mut predicted = here.at + tangent * length;
            if reaches_edge {
                predicted[edge] = predicted[edge].round();
            }
            let inside = predicted.map(|part| part.clamp(0.0, 1.0));
            let next = self
                .corrected(&here, inside, along)?
                .filter(|next| is_next(&here, next, inside, sign) && next.is_boundary(&self.part.threshold()));
            let Some(next) = next else {
                step = 0.5 * length;
                if step < SHORTEST_STEP {
                    return Ok((points, CurveEnd::Lost));
                }
                continue;
            };
            if points.len() > 2 && passes(&here, &next, sign, &start_point) {
                return Ok((points, CurveEnd::Closed));
            }
            if next.tangent().dot(&here.tangent()) >= SMALL_TURN {
                step = (1.5 * step).min(LONGEST_STEP);
            }
            here = next.clone();
            points.push(next);
            if reaches_edge {
                return Ok((points, CurveEnd::Edge));
            }
        }
        Ok((points, CurveEnd::Lost))
    }
}

/// Distance along a direction to the edge of the ranges, and index of the coordinate that ends there.
fn to_edge(at: Vector2<f64>, along: Vector2<f64>) -> (f64, usize) {
    let distance = |axis: usize| match along[axis] {
        0.0 => f64::INFINITY,
        rate if rate > 0.0 => (1.0 - at[axis]) / rate,
        rate => -at[axis] / rate,
    };
    let [x, y] = [distance(0), distance(1)];
    if x <= y { (x, 0) } else { (y, 1) }
}

/// True if a point continues a curve.
fn is_next(here: &CurvePoint, next: &CurvePoint, predicted: Vector2<f64>, sign: f64) -> bool {
    let by = next.at - here.at;
    let departure = link_error([here.value(), next.value()], [here.change(by), next.change(by)]);
    next.tangent().dot(&here.tangent()) >= LARGEST_TURN
        && by.dot(&here.tangent()) * sign > 0.0
        && (next.at - predicted).norm() <= LARGEST_CORRECTION * by.norm()
        && departure <= LARGEST_DEPARTURE * here.rates.norm() * by.norm()
        && here.likeness(next) >= LEAST_LIKENESS
}

/// A point of the boundary found on a line of the grid.
pub(super) struct KnownPoint {
    pub at: Vector2<f64>,
    /// Frequency, rad/s, zero of divergence.
    pub omega: f64,
    /// Kind of crossing at the point.
    pub of: PointOf,
    /// Bound or estimate of the distance of the point from the boundary, as a fraction of the range: large where the growth of a mode changes little along
    /// the line, as the place where it crosses the threshold is then known poorly.
    pub error: f64,
}

/// True if the curve goes through a known point between two of its own.
pub(super) fn passes(here: &CurvePoint, next: &CurvePoint, sign: f64, known: &KnownPoint) -> bool {
    let &KnownPoint { at, omega, error, of } = known;
    if here.of() != of {
        return false;
    }
    let chord = next.at - here.at;
    let length = chord.norm();
    let part = (at - here.at).dot(&chord) / (length * length);
    if !(-SAME_POINT..=1.0 + SAME_POINT).contains(&part) {
        return false;
    }
    // The cubic through both points with both tangents.
    let cubic = |from: f64, to: f64, rates: [f64; 2]| {
        let (u, v) = (part, 1.0 - part);
        (from * (1.0 + 2.0 * u) + rates[0] * u) * v * v + (to * (1.0 + 2.0 * v) - rates[1] * v) * u * u
    };
    let along = |tangent: Vector2<f64>| tangent * (sign * length);
    let (out, back) = (along(here.tangent()), along(next.tangent()));
    let near = vector![cubic(here.at.x, next.at.x, [out.x, back.x]), cubic(here.at.y, next.at.y, [out.y, back.y])];
    let rates = [here, next].map(|point| point.omega_rate() * sign * length);
    let change = (next.omega() - here.omega()).abs() + rates[0].abs();
    let reach = SAME_POINT * length + error;
    (near - at).norm() <= reach + ROUNDING
        && (cubic(here.omega(), next.omega(), rates) - omega).abs() <= change * reach / length + ROUNDING * omega
}
