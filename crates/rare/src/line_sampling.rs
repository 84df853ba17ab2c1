//! Lines from design points.
//!
//! With weights w_k that add up to 1 at every u, largest at the points u whose design point is k,
//!
//! ```text
//! P = sum_k E[ integral of w_k(u) 1(u fails) phi(t) dt ],   u = u_across + t a_k,   w_k = e_k / sum_j e_j,   e_k = exp(b_k (a_k . u - b_k))
//! ```
//!
//! over lines in the direction a_k of each design point (Koutsourelakis, Pradlwarter and Schueller 2004; several points with weights as in
//! multiple importance sampling, Veach and Guibas 1995). It holds whatever the directions: good ones make the lines alike.

use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rayon::prelude::*;

use crate::limit_state::{Asked, Counted, InStep, LimitState};
use crate::line_intervals::{STEP, failing};
use crate::normal::Interval;
use crate::options::Options;
use crate::search::DesignPoint;
use crate::spread::Spread;
use crate::vector::{along, dot};
use crate::window::Window;

/// Fewest lines, in all and of each design point, from which there is an estimate; chosen: fewer do not tell their own spread.
const FEWEST_LINES: [usize; 2] = [48, 12];
/// Number of a stream that no line has; chosen.
const OF_SPREADS: u64 = u32::MAX as u64;
/// Lines between two looks at what is reached; chosen: full threads.
const LINES_AT_ONCE: usize = 16;
/// Evaluations of a line, about; measured on the lattice.
const OF_A_LINE: u64 = 18;

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

/// A line: its weighted probability of failure, and a failing point with its weight.
pub(crate) struct Line {
    pub weight: f64,
    witness: Option<(Vec<f64>, f64)>,
}

/// The lines of each design point that has some.
pub(crate) struct Sampled {
    pub lines: Vec<Vec<Line>>,
}

impl Sampled {
    /// Lines until the error that is asked for is reached, or the budget spent.
    pub fn new<L: LimitState>(
        of: &Counted<'_, L>,
        points: &[&DesignPoint],
        reach: f64,
        options: &Options,
    ) -> Result<Self, L::Error> {
        let mut sampled = Self { lines: points.iter().map(|_| Vec::new()).collect() };
        let windows: Vec<Option<Window>> =
            points.par_iter().map(|point| point.window(of)).collect::<Result<_, L::Error>>()?;
        let spread = |(place, point): (usize, &&DesignPoint)| {
            let mut rng = montecarlo::stream(options.seed, (place as u64 + 1) << 32 | OF_SPREADS);
            Spread::at(of, (point, windows[place]), &mut rng)
        };
        let spreads: Vec<Spread> = points.par_iter().enumerate().map(spread).collect::<Result<_, L::Error>>()?;
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
            let line = |of: &InStep<'_, L>, &(point, number): &(usize, usize)| {
                let stream = ((point as u64 + 1) << 32) + number as u64;
                line(
                    of,
                    (points, &windows),
                    (point, &spreads[point]),
                    reach,
                    &mut montecarlo::stream(options.seed, stream),
                )
            };
            let found = of.in_step(&jobs, line)?;
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

    /// The mean of the weights of the lines of a design point, and the variance of this mean.
    fn moments_of(lines: &[Line]) -> (f64, f64) {
        let count = lines.len() as f64;
        let mean = lines.iter().map(|line| line.weight).sum::<f64>() / count;
        let squares = lines.iter().map(|line| (line.weight - mean).powi(2)).sum::<f64>();
        (mean, squares / (count * (count - 1.0)))
    }

    /// The probability and its variance.
    pub fn moments(&self) -> (f64, f64) {
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

    /// The failing point of each line that has one.
    pub fn witnesses(self) -> Vec<Witness> {
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
fn line<A: Asked>(
    of: &A,
    (points, windows): (&[&DesignPoint], &[Option<Window>]),
    (own, spread): (usize, &Spread),
    reach: f64,
    rng: &mut montecarlo::StreamRng,
) -> Result<Line, A::Error> {
    let direction = &points[own].direction;
    let drawn: Vec<f64> = (0..of.dimensions()).map(|_| StandardNormal.sample(rng)).collect();
    let across = along(&drawn, -dot(&drawn, direction), direction);
    let [offset, which, part, width]: [f64; 4] = std::array::from_fn(|_| StandardUniform.sample(rng));
    let (across, ratio) = spread.drawn(across, width < 0.5);
    let margins = |places: &[f64]| {
        let points: Vec<Vec<f64>> = places.iter().map(|t| along(&across, *t, direction)).collect();
        Ok::<Vec<f64>, A::Error>(of.worst_of_all(&points)?.iter().map(|mode| mode.margin).collect())
    };
    // The windows of all design points are looked at: the weights take it that failure of each is found on every line.
    let (mut narrowest, mut seen) = (STEP, Vec::new());
    for (point, window) in points.iter().zip(windows) {
        let Some(window) = window else { continue };
        if let Some(found) = window.at(of, [&point.point, &point.direction], [&across, direction])? {
            narrowest = narrowest.min(found.window().width);
            seen.extend(found.places);
        }
    }
    let intervals = failing(margins, [-reach, reach], offset, (narrowest, seen))?;
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
    let weights: Vec<f64> = intervals.iter().map(|interval| ratio * interval.integral(weight)).collect();
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
        (along(&across, t, direction), ratio * whole * weight(t) * interval.probability() / of_interval)
    });
    Ok(Line { weight: whole, witness })
}
