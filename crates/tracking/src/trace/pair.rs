//! Through the neighbourhood of a coalescence: the pair is followed instead of the mode.
//!
//! The middle m and the square s of `lambda = m +- sqrt(s)` are smooth where the two modes are not. Which of the two square
//! roots continues the mode follows from how s turns about 0 on its way.

use cea::{EigenvaluePair, Line, Workspace};
use num_complex::Complex;

use super::NO_ERROR;
use super::pace::{Pace, misses};

/// The first step, as a part of the way.
const FIRST: f64 = 0.01;
/// Steps shorter than this are not taken.
const SHORTEST: f64 = 1.0 / 4096.0;
/// How often a step is halved in following the turns of s.
const HALVINGS: u32 = 24;
/// By how much the cubic polynomial of a step may miss s, as a part of the difference between the trapezoidal rule and s.
const MISS: f64 = 0.25;
/// How far the mode may be from where its pair has it, relative to their distance.
pub(super) const NOT_IT: f64 = 0.01;
/// Distance from the coalescence, as a part of the way, from which on each goes alone again.
const FREE: f64 = 1.0 / 64.0;

/// A pair on its way.
struct PairTrace<'a> {
    line: Line<'a>,
    pace: Pace,
    here: EigenvaluePair,
    rate: EigenvaluePair,
    /// The square root of s that the mode is.
    root: Complex<f64>,
}

/// Two modes behind their coalescence.
#[derive(Debug, Clone, Copy)]
pub(super) struct Behind {
    /// Part of the way gone.
    pub at: f64,
    /// The eigenvalue that continues the one followed, and the other.
    pub lambdas: [Complex<f64>; 2],
}

/// Follows the modes with the next mode of each past their coalescence, or as far as that goes; `None` where that is not at
/// all.
pub(super) fn follow_pairs(from: &[(Line<'_>, f64, Complex<f64>)], work: &mut Workspace) -> Vec<Option<Behind>> {
    let alone = |mean: Complex<f64>| EigenvaluePair { mean, half_gap_squared: Complex::default() };
    let guesses: Vec<_> = from.iter().map(|&(line, at, lambda)| (line, at, alone(lambda))).collect();
    let begin = from.iter().zip(Line::pairs(&guesses, work));
    let mut traces: Vec<Option<PairTrace<'_>>> =
        begin.map(|(&(line, at, lambda), pair)| PairTrace::new(line, at, lambda, pair?)).collect();
    let mut open: Vec<usize> = (0..traces.len()).filter(|&i| traces[i].is_some()).collect();
    while !open.is_empty() {
        let ahead: Vec<_> = open.iter().filter_map(|&i| traces[i].as_ref().map(PairTrace::ahead)).collect();
        let mut found = Line::pairs(&ahead, work).into_iter();
        open.retain(|&i| traces[i].as_mut().is_some_and(|trace| trace.go(found.next().flatten())));
    }
    let behind = |(trace, (_, begin, _)): (Option<PairTrace<'_>>, &(Line<'_>, f64, Complex<f64>))| {
        let PairTrace { pace: Pace { at, .. }, here: EigenvaluePair { mean, .. }, root, .. } = trace?;
        (at > *begin).then_some(Behind { at, lambdas: [mean + root, mean - root] })
    };
    traces.into_iter().zip(from).map(behind).collect()
}

impl<'a> PairTrace<'a> {
    fn new(line: Line<'a>, at: f64, lambda: Complex<f64>, [here, rate]: [EigenvaluePair; 2]) -> Option<Self> {
        let root = lambda - here.mean;
        let is_one = (root * root - here.half_gap_squared).norm() <= NOT_IT * here.half_gap_squared.norm();
        is_one.then_some(Self { line, pace: Pace::new(at, FIRST), here, rate, root })
    }

    fn ahead(&self) -> (Line<'a>, f64, EigenvaluePair) {
        let step = self.pace.step();
        (self.line, self.pace.at + step, self.here.moved(&self.rate, step))
    }

    /// Goes `there`, where the next step leads, if that can be trusted, and makes the step shorter if not; `false` at the end.
    fn go(&mut self, there: Option<[EigenvaluePair; 2]>) -> bool {
        let step = self.pace.step();
        let tried = there.and_then(|[there, rate]| {
            let ratio = self.ratio(&there, &rate, step);
            let root = if Pace::trusts(ratio) { self.turned(&there, &rate, step)? } else { self.root };
            Some((ratio, there, rate, root))
        });
        self.pace.go(tried.map(|(ratio, ..)| ratio));
        if let Some((_, there, rate, root)) = tried.filter(|(ratio, ..)| Pace::trusts(*ratio)) {
            (self.here, self.rate, self.root) = (there, rate, root);
        }
        let is_behind = self.here.half_gap_squared.norm() >= FREE * self.rate.half_gap_squared.norm();
        !is_behind && !self.pace.is_over(SHORTEST)
    }

    /// How badly a step can be trusted, as that of a mode alone.
    fn ratio(&self, there: &EigenvaluePair, rate: &EigenvaluePair, step: f64) -> f64 {
        let size = self.here.mean.norm();
        let distance = self.here.half_gap_squared.norm().max(there.half_gap_squared.norm()).sqrt();
        let middle = misses([self.here.mean, there.mean], [self.rate.mean, rate.mean], step);
        let square = misses(
            [self.here.half_gap_squared, there.half_gap_squared],
            [self.rate.half_gap_squared, rate.half_gap_squared],
            step,
        );
        let [of_middle, of_square] = [(middle, size), (square, size * distance)]
            .map(|([tangent, trapezoid], size)| trapezoid / tangent.max(NO_ERROR * size));
        of_middle.max(of_square)
    }

    /// The root at the end of a step on which s is a cubic polynomial; `None` where that is too near to 0 to tell.
    fn turned(&self, there: &EigenvaluePair, rate: &EigenvaluePair, step: f64) -> Option<Complex<f64>> {
        let ends = [self.here.half_gap_squared, there.half_gap_squared];
        let rates = [self.rate.half_gap_squared, rate.half_gap_squared].map(|rate| rate * step);
        let [_, trapezoid] = misses(ends, rates, 1.0);
        let square = |u: f64| {
            let v = 1.0 - u;
            let from = ends[0] * (1.0 + 2.0 * u) + rates[0] * u;
            let to = ends[1] * (1.0 + 2.0 * v) - rates[1] * v;
            from * (v * v) + to * (u * u)
        };
        turn(&square, [0.0, 1.0], self.root, MISS * trapezoid, HALVINGS)
    }
}

/// The square root of a function at the end of an interval that goes on from `root` at its beginning; `None` where the
/// function, known to `miss`, is too near to 0.
fn turn(
    square: &dyn Fn(f64) -> Complex<f64>,
    [from, to]: [f64; 2],
    root: Complex<f64>,
    miss: f64,
    halvings: u32,
) -> Option<Complex<f64>> {
    let middle = 0.5 * (from + to);
    let [first, half, last] = [from, middle, to].map(square);
    if [first, half, last].iter().any(|s| s.norm() <= 2.0 * miss) {
        return None;
    }
    let is_straight = |a: Complex<f64>, b: Complex<f64>| (b / a).re > 0.5 * (b / a).norm();
    if is_straight(first, half) && is_straight(half, last) {
        let end = last.sqrt();
        return Some(if (end - root).norm_sqr() <= (end + root).norm_sqr() { end } else { -end });
    }
    let halvings = halvings.checked_sub(1)?;
    let root = turn(square, [from, middle], root, miss, halvings)?;
    turn(square, [middle, to], root, miss, halvings)
}

#[cfg(test)]
mod tests;
