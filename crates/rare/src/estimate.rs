//! Estimate of a rare probability by lines from all design points, compared with points elsewhere.

use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

use crate::Error;
use crate::answer::{Estimate, Probability};
use crate::elsewhere::{Elsewhere, elsewhere};
use crate::limit_state::{Asked, Counted, LimitState};
use crate::line_intervals::PRECISION;
use crate::line_sampling::Sampled;
use crate::normal::{tail, tail_point};
use crate::one_input;
use crate::options::Options;
use crate::search::{DesignPoint, design_points};
use crate::vector::{norm, unit};

/// Fraction of the budget for points elsewhere; chosen: with less, a failure that the lines do not have is seen less surely; with more, fewer lines are
/// evaluated.
const ELSEWHERE: f64 = 0.2;
/// Fraction of the probability of the nearest design point that lies beyond the ends of a line; chosen: with less, lines are longer; with more, what lies
/// beyond widens the interval more.
const BEYOND_LINES: f64 = 2e-3;
/// Fraction of the probability of the nearest design point below which a design point has no lines of its own, and widens the interval by its probability
/// instead; chosen.
const MATERIAL: f64 = 1e-3;
/// Plain samples where no failure is found; chosen: with n of them, none failing, the upper limit of the probability is about 3 / n.
const PLAIN: usize = 1_000;
/// Fewest failures elsewhere of which the mean has an error of its own; chosen: of fewer the mean is not compared with the lines.
const FEWEST_HITS: usize = 30;
/// Standard errors that two estimates may be apart; chosen: by chance they are farther apart in some 3 of 1,000 runs.
const APART: f64 = 3.0;

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
    if of.dimensions() == 1 {
        return one_input::estimate(&of, options)?.map_or_else(|| never(&of, options), Ok);
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
    let lines = sampled.lines.iter().map(Vec::len).sum();
    if value <= 0.0 {
        return Err(Error::NoLine { lines, beta: nearest.beta }.into());
    }
    // Ends of intervals and of lines, design points without lines, and what elsewhere is too little to contradict.
    let ends = PRECISION * nearest.beta.max(1.0) * value + 2.0 * tail(reach);
    // Nor are design points none of whose lines fail anywhere.
    let unseen = with_lines.iter().zip(&sampled.lines).filter(|(_, lines)| lines.iter().all(|line| line.weight <= 0.0));
    let unseen = unseen.map(|(point, _)| *point);
    let without: f64 = without.iter().copied().chain(unseen).map(|point| tail(point.beta)).sum();
    let unproven = contradicted(&looked, (value, error), options)? + ends + without;
    let witnesses = sampled.witnesses();
    Ok(Estimate {
        probability: Probability::new(value, error, lines, unproven),
        unproven,
        witnesses,
        lines,
        elsewhere: [number, looked.hits],
        plain: 0,
        scanned: None,
        evaluations: of.evaluations(),
        is_reached: error <= options.relative * value,
        design_points: points,
    })
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
        return Err(Error::Missed { beta: norm(&point), point, missed, found: 0.0 }.into());
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
        scanned: None,
        evaluations: of.evaluations(),
        is_reached: false,
    })
}

/// The probability elsewhere that the lines do not have; an error where it is so large that it contradicts them.
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
