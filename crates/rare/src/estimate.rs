//! Estimate of a rare probability by line sampling from all design points, held against points elsewhere.
//!
//! With weights w_k that add up to 1 at every u, largest at the point u whose design point is k,
//!
//! ```text
//! P = sum_k E[ integral of w_k(u) 1(u fails) phi(t) dt ],   u = u_across + t a_k,   w_k = e_k / sum_j e_j,   e_k = exp(b_k (a_k . u - b_k))
//! ```
//!
//! over lines in the direction a_k of each design point (Koutsourelakis, Pradlwarter and Schueller 2004; several points with weights as in
//! multiple importance sampling, Veach and Guibas 1995). It holds whatever the directions: good ones make the lines alike.

use montecarlo::Confidence;
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rayon::prelude::*;

use crate::Error;
use crate::elsewhere::{Elsewhere, elsewhere};
use crate::limit_state::{Counted, LimitState};
use crate::line::{PRECISION, failing};
use crate::normal::{Interval, tail, tail_point};
use crate::search::{DesignPoint, design_points};
use crate::vector::{along, dot, unit};

/// Part of the budget for points elsewhere; chosen.
const ELSEWHERE: f64 = 0.2;
/// Part of the probability of the nearest design point that lies beyond the ends of a line; chosen.
const BEYOND_LINES: f64 = 2e-3;
/// Part of the probability of the nearest design point below which one has no lines of its own, and widens the interval instead; chosen.
const MATERIAL: f64 = 1e-3;
/// Fewest lines, in all and of each design point, from which there is an estimate; chosen: fewer do not tell their own spread.
const FEWEST_LINES: [usize; 2] = [48, 12];
/// Lines between two looks at what is reached; chosen: full threads.
const LINES_AT_ONCE: usize = 16;
/// Evaluations of a line, about; measured on the lattice.
const OF_A_LINE: u64 = 18;
/// Plain samples where no failure is found; chosen.
const PLAIN: usize = 1_000;
/// Fewest failures elsewhere of which the mean has an error of its own; chosen.
const FEWEST_HITS: usize = 30;
/// Standard errors that two estimates may be apart.
const APART: f64 = 3.0;

/// Options of an estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Standard error to reach, relative to the probability, > 0.
    pub relative: f64,
    /// Number of evaluations that may be spent, those of the search and of the points elsewhere among them. The search and the first lines, some
    /// thousand evaluations together, are made whatever it is.
    pub budget: u64,
    /// Number of random directions, beside both of every input, from which design points are looked for.
    pub directions: usize,
    /// Seed of the random streams.
    pub seed: u64,
}

impl Default for Options {
    /// A standard error of 10 %, 2,000 evaluations, 32 directions and seed 1.
    fn default() -> Self {
        Self { relative: 0.1, budget: 2_000, directions: 32, seed: 1 }
    }
}

impl Options {
    /// Smallest budget.
    pub const LEAST_BUDGET: u64 = 100;

    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Option`].
    pub fn check(&self) -> Result<(), Error> {
        let refused = |name, value: String, allowed| Err(Error::Option { name, value, allowed });
        if !(self.relative > 0.0 && self.relative < 1.0) {
            return refused("relative", self.relative.to_string(), "a number between 0 and 1");
        }
        if self.budget < Self::LEAST_BUDGET {
            return refused("budget", self.budget.to_string(), "100 evaluations or more");
        }
        Ok(())
    }
}

/// A failing point of a line, drawn so that the probability of any part of failure is the mean over the lines of the weights in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Witness {
    /// The point, in standard deviations from the medians.
    pub point: Vec<f64>,
    /// Index of the line's design point.
    pub design_point: usize,
    /// Number of lines of this design point.
    pub lines: usize,
    /// Weight of the point: on average the probability of failure on the line.
    pub weight: f64,
}

/// A probability with its interval.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Probability {
    /// Best estimate.
    pub value: f64,
    /// Standard error of it.
    pub standard_error: f64,
    /// Lower end of the 95 % interval, without what is not proven.
    pub lower: f64,
    /// Upper end, with what is not proven added to it.
    pub upper: f64,
}

/// An estimate.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Probability of failure.
    pub probability: Probability,
    /// Part of the upper end that no sample says: ends of lines, and regions elsewhere of too small a probability to be a contradiction.
    pub unproven: f64,
    /// Design points, the nearest first.
    pub design_points: Vec<DesignPoint>,
    /// Failing points, one of each line that fails anywhere.
    pub witnesses: Vec<Witness>,
    /// Number of lines.
    pub lines: usize,
    /// Number of points elsewhere, and how many of them fail.
    pub elsewhere: [usize; 2],
    /// Number of plain samples, none of which failed; 0 where failure was found.
    pub plain: usize,
    /// Number of evaluations in all.
    pub evaluations: u64,
    /// The standard error that was asked for is reached.
    pub is_reached: bool,
}

/// Estimates the probability of failure.
///
/// # Errors
/// Those of the limit state; options that are not allowed; a system that fails at the medians; estimates that contradict each other.
pub fn estimate<L: LimitState>(of: &L, options: &Options) -> Result<Estimate, L::Error> {
    options.check()?;
    let of = Counted::new(of);
    let middle = of.worst(&vec![0.0; of.dimensions()])?;
    if middle.margin > 0.0 {
        return Err(Error::NotRare { omega: middle.omega, growth: middle.growth }.into());
    }
    let points = design_points(&of, &directions(of.dimensions(), options))?;
    let Some(nearest) = points.first() else { return never(&of, options) };
    let likeliest = tail(nearest.beta);
    // Quantiles of inputs have no digits farther out.
    let reach = tail_point(BEYOND_LINES * likeliest).min(8.0);
    let number = (ELSEWHERE * options.budget as f64) as usize;
    let looked = elsewhere(&of, &points, reach, (number, options.seed.wrapping_add(1)))?;
    let (with_lines, without): (Vec<&DesignPoint>, Vec<&DesignPoint>) =
        points.iter().partition(|point| tail(point.beta) >= MATERIAL * likeliest);
    let sampled = Sampled::new(&of, &with_lines, reach, options)?;
    let (value, variance) = sampled.moments();
    let error = variance.sqrt();
    // Ends of intervals and of lines, design points without lines, and what elsewhere is too little to contradict.
    let ends = PRECISION * nearest.beta.max(1.0) * value + 2.0 * tail(reach);
    let without: f64 = without.iter().map(|point| tail(point.beta)).sum();
    let unproven = contradicted(&looked, (value, error), options)? + ends + without;
    let lines = sampled.lines.iter().map(Vec::len).sum();
    let witnesses = sampled.witnesses();
    Ok(Estimate {
        probability: Probability::new(value, error, lines, unproven),
        unproven,
        witnesses,
        lines,
        elsewhere: [number, looked.hits],
        plain: 0,
        evaluations: of.evaluations(),
        is_reached: error <= options.relative * value,
        design_points: points,
    })
}

impl Probability {
    /// A mean of so many lines with its standard error. The interval is that of the logarithm, as lines have long tails upwards.
    #[must_use]
    pub fn new(value: f64, standard_error: f64, lines: usize, unproven: f64) -> Self {
        let deviate = Confidence::P95.t(lines.saturating_sub(1).max(1) as u64);
        let factor = if value > 0.0 { (deviate * standard_error / value).exp() } else { 1.0 };
        Self {
            value,
            standard_error,
            lower: (value / factor - unproven).max(0.0),
            upper: (value * factor + unproven).min(1.0),
        }
    }
}

/// Directions from which design points are looked for: both of every input, and random ones.
fn directions(d: usize, options: &Options) -> Vec<Vec<f64>> {
    let of_input = |input: usize, sign: f64| (0..d).map(|i| if i == input { sign } else { 0.0 }).collect();
    let inputs = (0..d).flat_map(|input| [of_input(input, 1.0), of_input(input, -1.0)]);
    let random = |index: usize| {
        let mut rng = montecarlo::stream(options.seed, index as u64);
        unit((0..d).map(|_| StandardNormal.sample(&mut rng)).collect())
    };
    inputs.chain((0..options.directions).filter_map(random)).collect()
}

/// The answer where no direction leads to failure: a bound by plain samples, if none of them fails either.
fn never<L: LimitState>(of: &Counted<'_, L>, options: &Options) -> Result<Estimate, L::Error> {
    let fails = |index: usize| -> Result<Option<Vec<f64>>, L::Error> {
        let mut rng = montecarlo::stream(options.seed.wrapping_add(1), index as u64);
        let u: Vec<f64> = (0..of.dimensions()).map(|_| StandardNormal.sample(&mut rng)).collect();
        Ok((of.worst(&u)?.margin > 0.0).then_some(u))
    };
    let plain = PLAIN.min(options.budget as usize);
    let failing: Vec<_> = (0..plain).into_par_iter().map(fails).collect::<Result<_, L::Error>>()?;
    if let Some(point) = failing.into_iter().flatten().next() {
        let missed = 1.0 / plain as f64;
        return Err(Error::Missed { beta: dot(&point, &point).sqrt(), point, missed, found: 0.0 }.into());
    }
    // So small a probability that this happens once in twenty times.
    let upper = -(0.05f64.ln() / plain as f64).exp_m1();
    Ok(Estimate {
        probability: Probability { value: 0.0, standard_error: 0.0, lower: 0.0, upper },
        unproven: upper,
        design_points: Vec::new(),
        witnesses: Vec::new(),
        lines: 0,
        elsewhere: [0, 0],
        plain,
        evaluations: of.evaluations(),
        is_reached: false,
    })
}

/// The probability elsewhere that the lines do not have and that is too small to contradict them.
fn contradicted(looked: &Elsewhere, (value, error): (f64, f64), options: &Options) -> Result<f64, Error> {
    let Elsewhere { hits, mean, error: of_points, unexplained } = looked;
    let missed: f64 = unexplained.iter().map(|point| tail(point.beta)).sum();
    if let Some(first) = unexplained.first().filter(|_| missed > 0.5 * options.relative * value) {
        return Err(Error::Missed { beta: first.beta, point: first.point.clone(), missed, found: value });
    }
    if *hits >= FEWEST_HITS && (mean - value).abs() > APART * of_points.hypot(error) {
        let (elsewhere, elsewhere_error) = (*mean, *of_points);
        return Err(Error::Disagree { hits: *hits, elsewhere, elsewhere_error, lines: value, lines_error: error });
    }
    Ok(missed)
}

/// A line: its weighted probability of failure, and a failing point with its weight.
struct Line {
    weight: f64,
    witness: Option<(Vec<f64>, f64)>,
}

/// The lines of each design point that has some.
struct Sampled {
    lines: Vec<Vec<Line>>,
}

impl Sampled {
    fn new<L: LimitState>(
        of: &Counted<'_, L>,
        points: &[&DesignPoint],
        reach: f64,
        options: &Options,
    ) -> Result<Self, L::Error> {
        let mut sampled = Self { lines: points.iter().map(|_| Vec::new()).collect() };
        let each = FEWEST_LINES[1].max(FEWEST_LINES[0].div_ceil(points.len()));
        let mut next: Vec<usize> = (0..points.len()).flat_map(|point| std::iter::repeat_n(point, each)).collect();
        loop {
            let mut numbers: Vec<usize> = sampled.lines.iter().map(Vec::len).collect();
            let jobs: Vec<(usize, usize)> = next
                .iter()
                .map(|&point| {
                    numbers[point] += 1;
                    (point, numbers[point] - 1)
                })
                .collect();
            let line = |&(point, number): &(usize, usize)| {
                let stream = ((point as u64 + 1) << 32) + number as u64;
                line(of, points, point, reach, &mut montecarlo::stream(options.seed, stream))
            };
            let found: Vec<Line> = jobs.par_iter().map(line).collect::<Result<_, L::Error>>()?;
            jobs.into_iter().zip(found).for_each(|((point, _), line)| sampled.lines[point].push(line));
            let (value, variance) = sampled.moments();
            let is_reached = variance.sqrt() <= options.relative * value;
            let is_spent = of.evaluations() + OF_A_LINE * LINES_AT_ONCE as u64 > options.budget;
            if is_reached && value > 0.0 || is_spent {
                return Ok(sampled);
            }
            next = sampled.where_to_go();
        }
    }

    /// The mean and the variance of it over the lines of a design point.
    fn moments_of(lines: &[Line]) -> (f64, f64) {
        let count = lines.len() as f64;
        let mean = lines.iter().map(|line| line.weight).sum::<f64>() / count;
        let squares = lines.iter().map(|line| (line.weight - mean).powi(2)).sum::<f64>();
        (mean, squares / (count * (count - 1.0)))
    }

    /// The probability and its variance.
    fn moments(&self) -> (f64, f64) {
        let each = self.lines.iter().map(|lines| Self::moments_of(lines));
        each.fold((0.0, 0.0), |sum, (mean, variance)| (sum.0 + mean, sum.1 + variance))
    }

    /// The design points of the next lines: where each makes the variance smallest.
    fn where_to_go(&self) -> Vec<usize> {
        let mut counts: Vec<f64> = self.lines.iter().map(|lines| lines.len() as f64).collect();
        let spread: Vec<f64> = self.lines.iter().map(|lines| Self::moments_of(lines).1 * lines.len() as f64).collect();
        let gain = |counts: &[f64], point: usize| spread[point] / (counts[point] * (counts[point] + 1.0));
        let mut next = Vec::with_capacity(LINES_AT_ONCE);
        for _ in 0..LINES_AT_ONCE {
            let best = (0..counts.len()).max_by(|&a, &b| gain(&counts, a).total_cmp(&gain(&counts, b))).unwrap_or(0);
            counts[best] += 1.0;
            next.push(best);
        }
        next
    }

    fn witnesses(self) -> Vec<Witness> {
        let of_point = |(design_point, lines): (usize, Vec<Line>)| {
            let count = lines.len();
            let witness = move |line: Line| {
                let (point, weight) = line.witness?;
                Some(Witness { point, design_point, lines: count, weight })
            };
            lines.into_iter().filter_map(witness).collect::<Vec<_>>()
        };
        self.lines.into_iter().enumerate().flat_map(of_point).collect()
    }
}

/// A line in the direction of a design point, across at random.
fn line<L: LimitState>(
    of: &Counted<'_, L>,
    points: &[&DesignPoint],
    own: usize,
    reach: f64,
    rng: &mut montecarlo::StreamRng,
) -> Result<Line, L::Error> {
    let direction = &points[own].direction;
    let drawn: Vec<f64> = (0..of.dimensions()).map(|_| StandardNormal.sample(rng)).collect();
    let across = along(&drawn, -dot(&drawn, direction), direction);
    let [offset, which, part]: [f64; 3] = std::array::from_fn(|_| StandardUniform.sample(rng));
    let margins = |places: &[f64]| {
        let points: Vec<Vec<f64>> = places.iter().map(|t| along(&across, *t, direction)).collect();
        Ok::<Vec<f64>, L::Error>(of.worst_of_all(&points)?.iter().map(|mode| mode.margin).collect())
    };
    let intervals = failing(margins, [-reach, reach], offset)?;
    let exponents: Vec<(f64, f64)> = points
        .iter()
        .map(|point| (point.beyond(&across), dot(&point.direction, direction)))
        .zip(points)
        .map(|((beyond, slope), point)| (beyond * point.beta.max(1.0), slope * point.beta.max(1.0)))
        .collect();
    let weight = |t: f64| {
        let at = |place: usize| exponents[place].0 + t * exponents[place].1;
        1.0 / (0..exponents.len()).map(|other| (at(other) - at(own)).exp()).sum::<f64>()
    };
    let weights: Vec<f64> = intervals.iter().map(|interval| interval.integral(weight)).collect();
    let whole: f64 = weights.iter().sum();
    // An interval is drawn by its weight and a point of it by its probability, which the weight of the point puts right.
    let mut left = which * whole;
    let is_chosen = |(_, weight): &(&Interval, &f64)| {
        left -= **weight;
        left <= 0.0
    };
    let witness = intervals.iter().zip(&weights).find(is_chosen).or(intervals.iter().zip(&weights).next_back());
    let witness = witness.filter(|(_, weight)| **weight > 0.0).map(|(interval, of_interval)| {
        let t = interval.point(part);
        (along(&across, t, direction), whole * weight(t) * interval.probability() / of_interval)
    });
    Ok(Line { weight: whole, witness })
}
