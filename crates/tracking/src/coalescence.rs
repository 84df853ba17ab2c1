//! Continuation through the neighbourhood of a coalescence: a pair of modes is continued instead of one mode.
//!
//! Of the two eigenvalues `lambda = m +- sqrt(s)`, the mean m and the squared half gap s are smooth functions of the path where
//! the eigenvalues are not. The square root that continues the mode follows from how s turns about 0 on the path.

use cea::{EigenvaluePair, Workspace};
use num_complex::Complex;

use crate::corrector::pairs_on_paths;
use crate::path::{Path, PathPoint};
use crate::step_control::{PredictorErrors, StepControl};
use crate::tuning::tuning;

/// The first step, as a fraction of the path; chosen: steps next to a coalescence are about as short.
const FIRST_PAIR_STEP: f64 = 0.01;
/// Shortest step, as a fraction of the path; chosen: a pair that needs a shorter one is left to subdivision.
const SHORTEST_PAIR_STEP: f64 = 1.0 / 4096.0;
/// Most halvings of a step in which the turn of s about 0 is followed; chosen: a step 2^24 times shorter that still turns by
/// more than 60 degrees passes 0 at a distance of rounding.
const MOST_HALVINGS: u32 = 24;
/// Assumed error of the cubic interpolation of s over a step, as a fraction of the error of the trapezoidal rule; chosen.
const CUBIC_ERROR: f64 = 0.25;
/// Largest distance between an eigenvalue and the same eigenvalue computed from its pair, as a fraction of the distance between the two eigenvalues of the
/// pair; chosen. In squares the same bound applies to s.
pub(crate) const ACCEPTANCE_RADIUS: f64 = 0.01;
/// Distance past the coalescence, as a fraction of the path, at which single-mode continuation resumes: eight of its shortest steps.
const RESUMPTION_DISTANCE: f64 = 1.0 / 64.0;

/// A pair that is being continued.
struct PairContinuation<'a> {
    path: Path<'a>,
    steps: StepControl,
    here: EigenvaluePair,
    rate: EigenvaluePair,
    /// The square root of s for which `m + root` is the eigenvalue of the followed mode.
    root: Complex<f64>,
}

/// Two modes past their coalescence.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PastCoalescence {
    /// Position on the path.
    pub t: f64,
    /// The eigenvalue of the followed mode, and the eigenvalue of the other mode of the pair.
    pub lambdas: [Complex<f64>; 2],
}

/// Continues each mode together with the mode next to it past their coalescence, or as far as steps succeed; `None` where
/// not even the first does.
pub(crate) fn continue_pairs(from: &[PathPoint<'_>], work: &mut Workspace) -> Vec<Option<PastCoalescence>> {
    let alone = |mean: Complex<f64>| EigenvaluePair { mean, half_gap_squared: Complex::default() };
    let guesses: Vec<_> = from.iter().map(|point| (point.path, point.t, alone(point.lambda))).collect();
    let begin = from.iter().zip(pairs_on_paths(&guesses, work));
    let mut pairs: Vec<Option<PairContinuation<'_>>> =
        begin.map(|(point, pair)| PairContinuation::new(*point, pair?)).collect();
    let mut open: Vec<usize> = (0..pairs.len()).filter(|&i| pairs[i].is_some()).collect();
    while !open.is_empty() {
        let ahead: Vec<_> = open.iter().filter_map(|&i| pairs[i].as_ref().map(PairContinuation::ahead)).collect();
        let mut found = pairs_on_paths(&ahead, work).into_iter();
        open.retain(|&i| pairs[i].as_mut().is_some_and(|pair| pair.advance(found.next().flatten())));
    }
    let past = |(pair, begin): (Option<PairContinuation<'_>>, &PathPoint<'_>)| {
        let PairContinuation { steps: StepControl { t, .. }, here: EigenvaluePair { mean, .. }, root, .. } = pair?;
        (t > begin.t).then_some(PastCoalescence { t, lambdas: [mean + root, mean - root] })
    };
    pairs.into_iter().zip(from).map(past).collect()
}

impl<'a> PairContinuation<'a> {
    fn new(PathPoint { path, t, lambda }: PathPoint<'a>, [here, rate]: [EigenvaluePair; 2]) -> Option<Self> {
        let root = lambda - here.mean;
        let is_member =
            (root * root - here.half_gap_squared).norm() <= ACCEPTANCE_RADIUS * here.half_gap_squared.norm();
        is_member.then_some(Self { path, steps: StepControl::new(t, FIRST_PAIR_STEP), here, rate, root })
    }

    fn ahead(&self) -> (Path<'a>, f64, EigenvaluePair) {
        let step = self.steps.step();
        (self.path, self.steps.t + step, self.here.moved(&self.rate, step))
    }

    /// Takes the next step to the pair `there` if its error ratio is small, and makes the step shorter if not; `false` at the end.
    fn advance(&mut self, there: Option<[EigenvaluePair; 2]>) -> bool {
        let step = self.steps.step();
        let tried = there.and_then(|[there, rate]| {
            let ratio = self.ratio(&there, &rate, step);
            let root = if StepControl::accepts(ratio) { self.turned(&there, &rate, step)? } else { self.root };
            Some((ratio, there, rate, root))
        });
        self.steps.advance(tried.map(|(ratio, ..)| ratio));
        if let Some((_, there, rate, root)) = tried.filter(|(ratio, ..)| StepControl::accepts(*ratio)) {
            (self.here, self.rate, self.root) = (there, rate, root);
        }
        let is_past = self.here.half_gap_squared.norm() >= RESUMPTION_DISTANCE * self.rate.half_gap_squared.norm();
        !is_past && !self.steps.is_over(SHORTEST_PAIR_STEP)
    }

    /// The error ratio of a step: the error ratio of the mean or of s, whichever is larger.
    fn ratio(&self, there: &EigenvaluePair, rate: &EigenvaluePair, step: f64) -> f64 {
        let (size, negligible) = (self.here.mean.norm(), tuning().negligible_error);
        let distance = self.here.half_gap_squared.norm().max(there.half_gap_squared.norm()).sqrt();
        let mean = PredictorErrors::new([self.here.mean, there.mean], [self.rate.mean, rate.mean], step);
        let squares = [self.here.half_gap_squared, there.half_gap_squared];
        let square = PredictorErrors::new(squares, [self.rate.half_gap_squared, rate.half_gap_squared], step);
        mean.ratio(negligible * size).max(square.ratio(negligible * (size * distance)))
    }

    /// The root at the end of a step, with s interpolated by a cubic polynomial; `None` where s comes too near to 0.
    fn turned(&self, there: &EigenvaluePair, rate: &EigenvaluePair, step: f64) -> Option<Complex<f64>> {
        let ends = [self.here.half_gap_squared, there.half_gap_squared];
        let rates = [self.rate.half_gap_squared, rate.half_gap_squared].map(|rate| rate * step);
        let trapezoid = PredictorErrors::new(ends, rates, 1.0).trapezoid;
        let square = |u: f64| {
            let v = 1.0 - u;
            let from = ends[0] * (1.0 + 2.0 * u) + rates[0] * u;
            let to = ends[1] * (1.0 + 2.0 * v) - rates[1] * v;
            from * (v * v) + to * (u * u)
        };
        turn(&square, [0.0, 1.0], self.root, CUBIC_ERROR * trapezoid, MOST_HALVINGS)
    }
}

/// The square root of the function `square` at the end of an interval, continued from `root` at the beginning; `None` where
/// the function, known up to the absolute `error`, is too near to 0.
fn turn(
    square: &dyn Fn(f64) -> Complex<f64>,
    [from, to]: [f64; 2],
    root: Complex<f64>,
    error: f64,
    halvings: u32,
) -> Option<Complex<f64>> {
    let middle = 0.5 * (from + to);
    let [first, half, last] = [from, middle, to].map(square);
    if [first, half, last].iter().any(|s| s.norm() <= 2.0 * error) {
        return None;
    }
    let is_straight = |a: Complex<f64>, b: Complex<f64>| (b / a).re > 0.5 * (b / a).norm();
    if is_straight(first, half) && is_straight(half, last) {
        let end = last.sqrt();
        return Some(if (end - root).norm_sqr() <= (end + root).norm_sqr() { end } else { -end });
    }
    let halvings = halvings.checked_sub(1)?;
    let root = turn(square, [from, middle], root, error, halvings)?;
    turn(square, [middle, to], root, error, halvings)
}

#[cfg(test)]
mod tests;
