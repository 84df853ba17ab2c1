//! Coalescences: points where two eigenvalues would be one.
//!
//! Of two eigenvalues m +- sqrt(s) the squared half distance s is a smooth function of the parameter, also where they meet. Its
//! zeros are the branch points: at a real one the two eigenvalues coalesce; one next to the real axis is the rest of a
//! coalescence where damping keeps them apart. s and its derivative at three real parameters determine a polynomial of degree
//! five, whose zero is the branch point; the middle one of them moves until the zero stands. Here the parameter is the fraction of its
//! range, 0 to 1.

use num_complex::Complex;
use serde::Serialize;
use tracking::{BranchPoint, Branches, RefinedPoint};

use super::parameter::SweptParameter;
use crate::Error;

/// Largest distance of a branch point from the real axis, as a fraction of the range, at which it is listed; chosen: farther away
/// the eigenvalues pass each other without a bend that is seen.
pub(super) const FARTHEST: f64 = 0.02;
/// Least distance of the three parameters, as a fraction of the range; chosen: nearer to a branch point eigenvalues lose digits.
const LEAST_SPACING: f64 = 1e-4;
/// Largest last change of a branch point that has settled, as a fraction of the range; chosen: with less, more moves are needed, and a point may not settle
/// within [`MOST_MOVES`].
const SETTLED: f64 = 1e-9;
/// Most moves of a branch point; chosen: one that needs more is not listed.
const MOST_MOVES: usize = 8;
/// Largest distance of two zeros of s that count as one, as a fraction of the range: that is a crossing of eigenvalues that are not coupled, and no branch
/// point; chosen.
const DOUBLE: f64 = 1e-5;

/// Coalescence of two modes, or the rest that damping leaves of one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Coalescence {
    /// Value of the parameter: the real part of the branch point.
    pub at: f64,
    /// Distance of the branch point from the real axis, in units of the parameter; 0 within `error` is a coalescence in fact.
    pub distance: f64,
    /// Estimate of the error of the branch point: its change in the last step of the search, or its change from a polynomial of degree
    /// three to the polynomial of degree five, whichever is larger.
    pub error: f64,
    /// Frequency Im lambda of both modes there, rad/s.
    pub omega: f64,
    /// Growth rate Re lambda of both modes there, 1/s.
    pub growth: f64,
    /// Candidates for the names of the two modes, one text each.
    pub modes: [String; 2],
}

impl Coalescence {
    /// The coalescence, given in fractions of the range of a parameter, in values of the parameter.
    pub(super) fn in_values(self, parameter: &SweptParameter) -> Self {
        let slope = parameter.slope(self.at);
        Self { at: parameter.at(self.at), distance: self.distance * slope, error: self.error * slope, ..self }
    }
}

/// The mean and the squared half distance of two eigenvalues at a parameter, each with its derivative.
#[derive(Debug, Clone, Copy)]
struct Pair {
    at: f64,
    mean: [Complex<f64>; 2],
    square: [Complex<f64>; 2],
}

impl Pair {
    fn new(at: f64, a: BranchPoint, b: BranchPoint) -> Self {
        let (half, half_rate) = (0.5 * (a.lambda - b.lambda), 0.5 * (a.rate - b.rate));
        let mean = [0.5 * (a.lambda + b.lambda), 0.5 * (a.rate + b.rate)];
        Self { at, mean, square: [half * half, 2.0 * half * half_rate] }
    }

    /// The zero of s by its tangent.
    fn zero(&self) -> Complex<f64> {
        self.at - self.square[0] / self.square[1]
    }
}

/// A guess of a branch point, and the two branches next to it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    pair: Pair,
    pub branches: [usize; 2],
}

impl Candidate {
    /// True if both are of the same branches and lead to the same place as far as they can tell, and this one is nearer to it.
    fn replaces(&self, other: &Self) -> bool {
        let reach = |candidate: &Self| (candidate.pair.zero() - candidate.pair.at).norm();
        let distance = (self.pair.zero() - other.pair.zero()).norm();
        self.branches == other.branches && distance <= reach(self).max(reach(other)) && reach(self) <= reach(other)
    }
}

/// Adds a candidate to a list, in place of candidates that lead to the same place from farther away.
pub(super) fn add(candidate: Candidate, list: &mut Vec<Candidate>) {
    if list.iter().any(|other| other.replaces(&candidate)) {
        return;
    }
    list.retain(|other| !candidate.replaces(other));
    list.push(candidate);
}

/// Candidates at a parameter of the root locus with its neighbours at `from` and `to`, near the real axis by `farthest` as in [`settle`].
pub(super) fn candidates(
    at: f64,
    points: &[(usize, BranchPoint)],
    [from, to]: [f64; 2],
    farthest: f64,
) -> Vec<Candidate> {
    let mut found = Vec::new();
    for (i, &(first, a)) in points.iter().enumerate() {
        for &(second, b) in &points[i + 1..] {
            let pair = Pair::new(at, a, b);
            let zero = pair.zero();
            if (from..=to).contains(&zero.re) && zero.im.abs() <= (to - from).min(2.0 * farthest) {
                found.push(Candidate { pair, branches: [first, second] });
            }
        }
    }
    found
}

/// A branch point that has settled: its place, the estimate of its error, and the eigenvalue there, rad/s.
#[derive(Debug, Clone, Copy)]
pub(super) struct BranchPointFound {
    pub at: Complex<f64>,
    pub error: f64,
    pub lambda: Complex<f64>,
}

/// The branch point that a candidate leads to; `None` where it leads out of the range, farther from the real axis than `farthest`, a fraction
/// of the range, or nowhere.
pub(super) fn settle<B: Branches<Error = Error>>(
    branches: &mut B,
    candidate: &Candidate,
    farthest: f64,
) -> Result<Option<BranchPointFound>, Error> {
    let (mut pair, mut zero) = (candidate.pair, candidate.pair.zero());
    for _ in 0..MOST_MOVES {
        if !((0.0..=1.0).contains(&zero.re) && zero.im.abs() <= 2.0 * farthest) {
            return Ok(None);
        }
        let spacing = (2.0 * zero.im.abs()).clamp(LEAST_SPACING, farthest);
        let centre = zero.re.clamp(spacing, 1.0 - spacing);
        let mut nodes = Vec::with_capacity(3);
        for at in [centre - spacing, centre, centre + spacing] {
            let Some(next) = pair_at(branches, &pair, at)? else { return Ok(None) };
            nodes.push(next);
        }
        let of = |part: fn(&Pair) -> [Complex<f64>; 2]| -> Vec<[Complex<f64>; 2]> { nodes.iter().map(part).collect() };
        let places: Vec<f64> = nodes.iter().map(|node| node.at).collect();
        let square = Hermite::new(&places, &of(|node| node.square));
        let Some(next) = square.zero(zero) else { return Ok(None) };
        let change = (next - zero).norm();
        (pair, zero) = (nodes[1], next);
        if change <= SETTLED {
            let outer = [nodes[0], nodes[2]].map(|node| (node.at, node.square));
            let coarse = Hermite::new(&outer.map(|node| node.0), &outer.map(|node| node.1)).zero(zero);
            let error = coarse.map_or(spacing, |coarse| change.max((coarse - zero).norm()));
            let [_, slope, curvature] = square.values(zero);
            let is_double = slope.norm() <= 0.5 * DOUBLE * curvature.norm();
            let is_near = (0.0..=1.0).contains(&zero.re) && zero.im.abs() <= farthest;
            let lambda = Hermite::new(&places, &of(|node| node.mean)).values(zero)[0];
            return Ok((is_near && !is_double).then_some(BranchPointFound { at: zero, error, lambda }));
        }
    }
    Ok(None)
}

/// The pair at another parameter that continues a pair; `None` where there are no two eigenvalues.
fn pair_at<B: Branches<Error = Error>>(branches: &mut B, from: &Pair, at: f64) -> Result<Option<Pair>, Error> {
    let by = at - from.at;
    let (mean, square) = (from.mean[0] + from.mean[1] * by, from.square[0] + from.square[1] * by);
    let root = square.sqrt();
    let mut lambdas = branches.lambdas(at)?.to_vec();
    let mut points = Vec::with_capacity(2);
    for guess in [mean + root, mean - root] {
        let distance = |lambda: &Complex<f64>| (lambda - guess).norm();
        let Some(best) = (0..lambdas.len()).min_by(|&a, &b| distance(&lambdas[a]).total_cmp(&distance(&lambdas[b])))
        else {
            return Ok(None);
        };
        let RefinedPoint { lambda, rate, .. } = branches.refined(at, lambdas.swap_remove(best))?;
        points.push(BranchPoint { lambda, rate });
    }
    Ok(Some(Pair::new(at, points[0], points[1])))
}

/// The polynomial through values and derivatives at some places, in Newton's form.
struct Hermite {
    nodes: Vec<f64>,
    coefficients: Vec<Complex<f64>>,
}

impl Hermite {
    fn new(places: &[f64], values: &[[Complex<f64>; 2]]) -> Self {
        let nodes: Vec<f64> = places.iter().flat_map(|&place| [place, place]).collect();
        let mut column: Vec<Complex<f64>> = values.iter().flat_map(|value| [value[0], value[0]]).collect();
        let mut coefficients = vec![column[0]];
        for order in 1..nodes.len() {
            column = (0..nodes.len() - order)
                .map(|i| match nodes[i + order] - nodes[i] {
                    0.0 => values[i / 2][1],
                    distance => (column[i + 1] - column[i]) / distance,
                })
                .collect();
            coefficients.push(column[0]);
        }
        Self { nodes, coefficients }
    }

    /// Value, first and second derivative of the polynomial.
    fn values(&self, at: Complex<f64>) -> [Complex<f64>; 3] {
        let mut values = [Complex::default(); 3];
        for (coefficient, node) in self.coefficients.iter().zip(&self.nodes).rev() {
            let by = at - node;
            values = [values[0] * by + coefficient, values[1] * by + values[0], values[2] * by + 2.0 * values[1]];
        }
        values
    }

    /// The zero that Newton's method finds from a guess; `None` where it does not converge to rounding.
    fn zero(&self, guess: Complex<f64>) -> Option<Complex<f64>> {
        let mut at = guess;
        for _ in 0..50 {
            let [value, slope, _] = self.values(at);
            let step = value / slope;
            at -= step;
            if step.norm() <= 1e-15 {
                return Some(at);
            }
        }
        None
    }
}
