//! One change of the number of unstable modes as the zero of a smooth function between two places.
//!
//! | of | the function |
//! | --- | --- |
//! | flutter of a damped mode | the margin of its eigenvalue beyond the threshold |
//! | a growing mode at an end of the band | the distance of its frequency from there |
//! | flutter of two modes that meet on the axis | the squared half distance of both, as below |
//! | divergence | det K, by its sign alone |
//! | flutter that becomes divergence | the squared half distance of the two eigenvalues, which is real: below zero of a pair, above of two real ones |
//!
//! Where the function is not found at both ends with different signs, or its zero contradicts these, there is no answer and the step
//! is halved.

use cea::{Eigentriple, Workspace};
use linsys::SecondOrder;
use nalgebra::DMatrix;
use num_complex::Complex;

use super::change::{Along, Change, ChangeOf, Place};
use super::divergence::{BESIDE, sign_change};
use super::family::DIFFERENCE;
use super::measure::Measure;
use crate::Error;

/// Most values of a function; chosen: bisection alone takes about 50.
const MOST_VALUES: usize = 80;
/// Number of values within which a bracket has to become half as long, or else is halved; chosen: with fewer, bisection takes the place of a faster method;
/// with more, a slow one goes on for longer.
const PATIENCE: usize = 3;
/// Rounding of a squared half distance, in units of epsilon and the squared scale of the problem; chosen.
const ROUNDINGS: f64 = 256.0;
/// Largest |Im| of a mean that is real, as a fraction of the scale; chosen.
const REAL: f64 = 1e-9;
/// Largest squared half distance, as a fraction of the squared scale, of two eigenvalues that have met; chosen: of two that do not meet it is that of the
/// frequencies of different modes.
const SMALL_SQUARE: f64 = 1e-12;
/// Fraction of the slope over both sides of a zero below which the slope of one side means that the function kinks next to the zero, as the coefficient of
/// a table does; chosen: no smooth function changes so much over the little distance.
const KINKED: f64 = 0.75;
/// Largest distance of the mean of two eigenvalues from its expected value, and largest half distance of the two, as a multiple of the larger half distance
/// at the ends of the step plus the change of the mean over the step; chosen: beyond that they are taken for another pair, and the change is found by
/// halvings.
const LARGEST_DRIFT: f64 = 2.0;

/// The change of kind `of` between two places whose counts differ by it, and the number of spectra solved; `None` where it is not found, or not confirmed.
///
/// # Errors
/// Those of the brake and of the solver.
pub(super) fn crossing(
    along: &Along<'_>,
    [a, b]: [&Place; 2],
    of: ChangeOf,
    starts: bool,
) -> Result<(Option<Change>, u64), Error> {
    let (more, fewer) = if starts { (b, a) } else { (a, b) };
    let mut search = Search { along, bracket: [a, b], starts, spectra: 0 };
    let found = match of {
        ChangeOf::Divergence => search.divergence()?,
        ChangeOf::Exchange => {
            // Which of several pairs became real: the one that is nearest to two real eigenvalues beyond.
            let (pair, real) = (&fewer.counted.flutter, &more.counted.divergence);
            let mut best: Option<(f64, [Pair; 2])> = None;
            for &lambda in pair {
                for two in real.windows(2) {
                    let here = Pair::new([lambda, lambda.conj()]);
                    let there = Pair::new([two[0], two[1]].map(Complex::from));
                    let distance = (here.mean - there.mean).norm() + here.half().max(there.half());
                    if best.as_ref().is_none_or(|best| distance < best.0) {
                        best = Some((distance, [here, there]));
                    }
                }
            }
            match best {
                Some((_, [here, there])) => search.pair(if starts { [here, there] } else { [there, here] })?,
                None => None,
            }
        }
        ChangeOf::Flutter => {
            let Some(&growing) = along.nearest_to_threshold(more).first() else { return Ok((None, 0)) };
            let distance = |lambda: &&Complex<f64>| (**lambda - growing).norm();
            let nearest =
                |list: &[Complex<f64>]| list.iter().min_by(|x, y| distance(x).total_cmp(&distance(y))).copied();
            let (damped, on_axis) = (nearest(&fewer.counted.below), nearest(&fewer.counted.marginal));
            let is_damped = match (damped, on_axis) {
                (Some(damped), Some(on_axis)) => distance(&&damped) < distance(&&on_axis),
                (damped, _) => damped.is_some(),
            };
            let simple = match damped.filter(|_| is_damped) {
                Some(damped) => {
                    let ends = if starts { [damped, growing] } else { [growing, damped] };
                    search.simple(Measure::Margin(along.threshold), ends)?
                }
                None => None,
            };
            let mut all: Vec<Complex<f64>> = fewer.counted.marginal.clone();
            all.sort_by(|x, y| distance(&x).total_cmp(&distance(&y)));
            match (simple, &all[..]) {
                (None, &[first, second, ..]) if along.threshold.is_axis() => {
                    let apart = Pair::new([first, second]);
                    let grown = Pair::new([growing, -growing.conj()]);
                    search.pair(if starts { [apart, grown] } else { [grown, apart] })?
                }
                (simple, _) => simple,
            }
        }
        ChangeOf::Band => {
            // Which of several growing modes is at the end: that which moves least.
            let is_studied = |lambda: &&Complex<f64>| along.is_studied(**lambda);
            let beside = fewer.counted.flutter.iter().filter(|lambda| !is_studied(lambda));
            let pairs = beside.flat_map(|&beside| {
                more.counted.flutter.iter().filter(is_studied).map(move |&inside| [beside, inside])
            });
            let moved = |[beside, inside]: &[Complex<f64>; 2]| (beside - inside).norm();
            match pairs.min_by(|x, y| moved(x).total_cmp(&moved(y))) {
                Some([beside, inside]) => match along.nearest_end(beside) {
                    Some(end) => search.simple(end, if starts { [beside, inside] } else { [inside, beside] })?,
                    None => None,
                },
                None => None,
            }
        }
    };
    let change = found.map(|zero| {
        let Zero { at, error, lambda, is_double } = zero;
        Change { at, error, lambda, of, starts, is_double }
    });
    let is_inside = |change: &Change| (a.at - BESIDE..=b.at + BESIDE).contains(&change.at);
    // A mode that starts to grow beside the band counts from its end on, and one that enters it counts where it grows.
    let counts = |change: &Change| match change.of {
        ChangeOf::Flutter => along.is_studied(change.lambda),
        ChangeOf::Band => along.threshold.margin(change.lambda) > 0.0,
        ChangeOf::Divergence | ChangeOf::Exchange => true,
    };
    Ok((change.filter(is_inside).filter(counts), search.spectra))
}

/// Slope of a function by which the error of its zero follows from the error of a value: `slope`, which is over both sides of the zero, or, where the
/// function kinks, that one of `sides` that is less steep.
fn of_error(slope: f64, sides: [f64; 2]) -> f64 {
    let less = sides.into_iter().filter(|side| side.abs() < KINKED * slope.abs());
    less.min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(slope)
}

/// Pair of eigenvalues by their mean and their squared half distance, which are smooth where they meet.
#[derive(Debug, Clone, Copy)]
struct Pair {
    mean: Complex<f64>,
    square: Complex<f64>,
}

impl Pair {
    fn new([a, b]: [Complex<f64>; 2]) -> Self {
        let half = 0.5 * (a - b);
        Self { mean: 0.5 * (a + b), square: half * half }
    }

    fn half(&self) -> f64 {
        self.square.norm().sqrt()
    }
}

/// Zero of the function.
struct Zero {
    at: f64,
    /// Bound or estimate of the error of `at`.
    error: f64,
    /// Eigenvalue there, rad/s; of two that meet their mean.
    lambda: Complex<f64>,
    is_double: bool,
}

/// Search for one change between two places, which counts its spectra.
struct Search<'a> {
    along: &'a Along<'a>,
    bracket: [&'a Place; 2],
    starts: bool,
    spectra: u64,
}

impl Search<'_> {
    fn ends(&self) -> [f64; 2] {
        self.bracket.map(|place| place.at)
    }

    /// The system and all its eigenvalues at a place, with the scale of the problem.
    fn spectrum(&mut self, at: f64) -> Result<(SecondOrder, Vec<Complex<f64>>, f64), Error> {
        self.spectra += 1;
        let system = (self.along.system)(at)?;
        let spectrum = self.along.solver.eigenvalues(&system, &mut Workspace::default())?;
        Ok((system, spectrum.eigenvalues, spectrum.scale))
    }

    /// The place where det Q at the growth rate of the threshold changes its sign; `None` where it does not, or its error is as large as the step.
    fn divergence(&mut self) -> Result<Option<Zero>, Error> {
        let growth = self.along.threshold.growth_above();
        let [from, to] = self.ends();
        let found = sign_change(self.along.system, growth, [from, to])?;
        // Of a body that is free to move det K vanishes everywhere, and its sign changes by rounding.
        Ok(found.filter(|change| change.error < to - from + BESIDE).map(|change| Zero {
            at: change.at,
            error: change.error,
            lambda: Complex::from(growth),
            is_double: false,
        }))
    }

    /// The zero of a function of one eigenvalue, `ends` at the two ends; `None` where there is none with a slope of the right sign and a bound of its
    /// error.
    fn simple(&mut self, measure: Measure, ends: [Complex<f64>; 2]) -> Result<Option<Zero>, Error> {
        let mut work = Workspace::default();
        let mut bracket = Bracket::new(self.ends(), ends.map(|lambda| measure.value(lambda)));
        let bracket_length = bracket.length();
        let mut known = ends;
        for _ in 0..MOST_VALUES {
            let Some(at) = bracket.next() else { return Ok(None) };
            let part = bracket.part(at);
            let guess = known[0] * (1.0 - part) + known[1] * part;
            let (system, eigenvalues, _) = self.spectrum(at)?;
            let distance = |lambda: &Complex<f64>| (lambda - guess).norm();
            let nearest = eigenvalues.into_iter().min_by(|x, y| distance(x).total_cmp(&distance(y)));
            let Some(nearest) = nearest else { return Ok(None) };
            let Ok(triple) = Eigentriple::new(&system, nearest, &mut work) else { return Ok(None) };
            let (lambda, bound) = (triple.refined(&system), triple.rounding_of_entries(&system));
            let value = measure.value(lambda);
            if !(value.is_finite() && bound.is_finite()) {
                return Ok(None);
            }
            let [below, above] = [(at - DIFFERENCE).max(0.0), (at + DIFFERENCE).min(1.0)];
            let is_at_end = value.abs() <= bound || bracket.is_shortest();
            if is_at_end {
                let [q, r] = [below, above].map(|at| (self.along.system)(at));
                let [q, here, r] = [&q?, &system, &r?].map(|system| system.dynamic_stiffness(lambda));
                let slope_over = |change: &DMatrix<Complex<f64>>, distance: f64| {
                    measure.rate(lambda, triple.rate_over(change, distance))
                };
                let sides = [slope_over(&(&here - &q), at - below), slope_over(&(&r - &here), above - at)];
                let slope = of_error(slope_over(&(r - q), above - below), sides);
                let (step, error) = (-value / slope, bound / slope.abs());
                let stands = step.abs() <= 2.0 * error + 4.0 * f64::EPSILON && (slope > 0.0) == self.starts;
                let zero = Zero { at: at + step, error: error + step.abs(), lambda, is_double: false };
                return Ok((stands && error < bracket_length + 1e-6).then_some(zero));
            }
            known[bracket.enter(at, value)] = lambda;
        }
        Ok(None)
    }

    /// The zero of the squared half distance of two eigenvalues, `ends` at the two ends; `None` where other eigenvalues come in between, or the two do not
    /// meet.
    fn pair(&mut self, ends: [Pair; 2]) -> Result<Option<Zero>, Error> {
        let squares = ends.map(|pair| pair.square.re);
        if squares[0] * squares[1] >= 0.0 {
            return Ok(None);
        }
        let [from, to] = self.ends();
        let slope = (squares[1] - squares[0]) / (to - from);
        let reach = ends[0].half().max(ends[1].half()) + (ends[0].mean - ends[1].mean).norm();
        let mut bracket = Bracket::new([from, to], squares);
        let mut known = ends;
        for _ in 0..MOST_VALUES {
            let Some(at) = bracket.next() else { return Ok(None) };
            let guess = (known[0].mean, known[1].mean);
            let part = bracket.part(at);
            let guess = guess.0 * (1.0 - part) + guess.1 * part;
            let (_, mut eigenvalues, scale) = self.spectrum(at)?;
            // The double zero of a rigid motion is there everywhere.
            eigenvalues.retain(|lambda| lambda.norm() > self.along.rigid);
            let distance = |lambda: &Complex<f64>| (lambda - guess).norm();
            eigenvalues.sort_by(|x, y| distance(x).total_cmp(&distance(y)));
            let &[first, second, ..] = &eigenvalues[..] else { return Ok(None) };
            let pair = Pair::new([first, second]);
            if (pair.mean - guess).norm() > LARGEST_DRIFT * reach || pair.half() > LARGEST_DRIFT * reach {
                return Ok(None);
            }
            let rounding = f64::EPSILON * scale * scale;
            let is_zero = pair.square.re.abs() <= rounding;
            if is_zero || bracket.is_shortest() {
                let left = if is_zero { 0.0 } else { bracket.length() };
                let sides = [squares[0] / (from - at), squares[1] / (to - at)];
                let error = left + ROUNDINGS * rounding / of_error(slope, sides).abs();
                // Of two that met at zero or on the real axis the mean is real but for rounding.
                let is_real = pair.mean.im.abs() <= REAL * scale;
                let lambda = if is_real { Complex::from(pair.mean.re) } else { pair.mean };
                // The real part is zero too where the difference of the two is at 45 degrees to the axes, and they do not meet.
                let stands = pair.square.norm() <= SMALL_SQUARE * scale * scale;
                return Ok(stands.then_some(Zero { at, error, lambda, is_double: true }));
            }
            known[bracket.enter(at, pair.square.re)] = pair;
        }
        Ok(None)
    }
}

/// A bracket of a zero with the values at its ends: the Illinois method, and bisection where that is slow.
#[derive(Debug, Clone, Copy)]
struct Bracket {
    at: [f64; 2],
    /// Values at the ends, one of them halved where the other end has moved twice.
    values: [f64; 2],
    last: Option<usize>,
    /// Length of the bracket `since` values ago.
    was: f64,
    since: usize,
}

impl Bracket {
    fn new(at: [f64; 2], values: [f64; 2]) -> Self {
        Self { at, values, last: None, was: at[1] - at[0], since: 0 }
    }

    /// Place of the next value of the function; `None` where both ends have one sign.
    fn next(&mut self) -> Option<f64> {
        let [[a, b], [x, y]] = [self.at, self.values];
        if x * y > 0.0 || !(x.is_finite() && y.is_finite()) {
            return None;
        }
        let length = self.length();
        if self.since >= PATIENCE {
            let is_slow = length > 0.5 * self.was;
            (self.was, self.since) = (length, 0);
            if is_slow {
                return Some(0.5 * (a + b));
            }
        }
        self.since += 1;
        let at = a + length * (x / (x - y));
        Some(if at.is_finite() { at.clamp(a, b) } else { 0.5 * (a + b) })
    }

    /// Enters a value, and gives the index of the end that it has become.
    fn enter(&mut self, at: f64, value: f64) -> usize {
        let end = usize::from((value > 0.0) == (self.values[1] > 0.0));
        (self.at[end], self.values[end]) = (at, value);
        if self.last == Some(end) {
            self.values[1 - end] *= 0.5;
        }
        self.last = Some(end);
        end
    }

    fn is_shortest(&self) -> bool {
        self.length() <= 2.0 * f64::EPSILON * self.at[1].abs().max(1e-3)
    }

    fn length(&self) -> f64 {
        self.at[1] - self.at[0]
    }

    /// Fraction of the bracket at which a place is.
    fn part(&self, at: f64) -> f64 {
        let [from, to] = self.at;
        if to > from { (at - from) / (to - from) } else { 0.5 }
    }
}
