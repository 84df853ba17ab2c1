//! Coverage of the intervals, by simulations with a known truth: the estimate may be farther from it than the half width
//! in one run of twenty at most, wherever the truth is between 0 and 1.

use std::collections::BTreeMap;

use cea::Counters;
use montecarlo::{Confidence, ReplicateMean, StreamRng, stream};
use rand_distr::{Binomial, Distribution as _};

use super::cheapest::{PLAIN_PILOT_SAMPLES, planned_samples};
use super::control_variate::corrected;
use super::interval::PredictionMeans;
use super::sampling::{HitCounts, mean_of_scramblings, of_samples, of_scramblings};
use super::stratum::Stratum;
use super::{Estimated, Estimates};
use crate::ModeLabel;

/// The occurrences that are estimated; chosen: both ends, next to them, where intervals by normal numbers fail, and the middle.
const PROBABILITIES: [f64; 7] = [0.0, 0.0005, 0.005, 0.3, 0.5, 0.995, 1.0];
/// The mode that is estimated.
const MODE: ModeLabel = ModeLabel::new(7);
/// Error probability of an interval.
const TAIL: f64 = 0.05;

/// Counts over the runs of an estimator.
#[derive(Debug, Clone, Copy, Default)]
struct Coverage {
    runs: u64,
    /// Runs whose estimate is farther from the truth than the half width.
    missed: u64,
    /// Runs whose estimate is farther from the truth than half the width of the interval.
    missed_by_halves: u64,
    /// Runs whose half width is at most the one asked for.
    reached: u64,
    half_width: f64,
}

impl Coverage {
    /// The estimates of `runs` runs against the truth; `unseen` is the limit of a mode that is not listed.
    fn of(truth: f64, asked: f64, runs: u64, run: impl Fn(&mut StreamRng) -> (Option<Estimated>, f64)) -> Self {
        let mut coverage = Self { runs, ..Self::default() };
        for index in 0..runs {
            let (found, unseen) = run(&mut stream(1, index));
            let found = found.unwrap_or(Estimated::within(Default::default(), unseen));
            let error = (found.occurrence.lower - truth).abs();
            coverage.missed += u64::from(error > found.half_width());
            coverage.missed_by_halves += u64::from(error > 0.5 * (found.limits.upper - found.limits.lower));
            coverage.reached += u64::from(found.half_width() <= asked);
            coverage.half_width += found.half_width() / runs as f64;
        }
        coverage
    }

    fn print(self, what: &str, truth: f64) {
        let part = |count: u64| 100.0 * count as f64 / self.runs as f64;
        let Self { missed, half_width, .. } = self;
        println!(
            "| {what} | {truth} | {:.2} % | {half_width:.1e} | {:.1} % | {:.2} % |",
            part(self.runs - missed),
            part(self.reached),
            part(self.runs - self.missed_by_halves)
        );
    }

    /// Refuses more misses than three standard deviations of chance account for.
    fn check(self, what: &str, truth: f64) {
        let expected = self.runs as f64 * TAIL;
        let most = expected + 3.0 * (expected * (1.0 - TAIL)).sqrt();
        assert!((self.missed as f64) <= most, "{what}, {truth}: {self:?}");
    }
}

fn binomial(trials: u64, probability: f64, rng: &mut StreamRng) -> u64 {
    Binomial::new(trials, probability.clamp(0.0, 1.0)).unwrap().sample(rng)
}

fn hits(hits: u64) -> HitCounts {
    if hits > 0 { HitCounts::from([(MODE, [hits, 0])]) } else { HitCounts::new() }
}

fn of(estimates: &Estimates) -> (Option<Estimated>, f64) {
    (estimates.modes.get(&MODE).copied(), estimates.unseen)
}

/// Plain sampling to a half width, as many samples as its pilots say.
fn plain(truth: f64, half_width: f64, rng: &mut StreamRng) -> (Option<Estimated>, f64) {
    let mut estimates =
        |samples| of_samples(&hits(binomial(samples, truth, rng)), samples, Counters::default()).unwrap();
    let samples = planned_samples(&estimates(PLAIN_PILOT_SAMPLES), half_width);
    of(&estimates(samples))
}

/// An event in the unit square of a given probability.
#[derive(Debug, Clone, Copy)]
enum Event {
    /// u below a number.
    Strip,
    /// The product of u and v below a number.
    Hyperbola,
}

impl Event {
    /// Number below which u or u v is with a probability P: `P = c`, and `P = c (1 - ln c)`.
    fn threshold(self, probability: f64) -> f64 {
        let (mut low, mut high) = (0.0_f64, 1.0_f64);
        for _ in 0..100 {
            let c = 0.5 * (low + high);
            let below = match self {
                Self::Strip => c,
                Self::Hyperbola => c * (1.0 - c.ln()),
            };
            if below < probability { low = c } else { high = c }
        }
        if probability == 0.0 { 0.0 } else { high }
    }
}

/// Quasi-Monte Carlo with `points` in each of `scramblings` scramblings.
fn quasi(event: Event, truth: f64, points: u32, scramblings: u32, rng: &mut StreamRng) -> (Option<Estimated>, f64) {
    use rand::RngExt;

    let threshold = event.threshold(truth) as f32;
    let of_scrambling = |seed: u32| {
        let is_hit = |index: &u32| {
            let at = |dimension| sobol_burley::sample(*index, dimension, seed) + 0.5_f32.powi(25);
            at(0) * if matches!(event, Event::Strip) { 1.0 } else { at(1) } < threshold
        };
        hits((0..points).filter(is_hit).count() as u64)
    };
    let runs: Vec<HitCounts> = (0..scramblings).map(|_| of_scrambling(rng.random())).collect();
    of(&of_scramblings(&runs, points, Counters::default(), Confidence::P95))
}

/// Joint distribution of prediction and reference.
#[derive(Debug, Clone, Copy)]
struct Population {
    /// Probability that the prediction is uncertain.
    uncertain: f64,
    /// Probabilities that the prediction alone says unstable, and that the reference alone does, of clear and of uncertain samples.
    alone: [[f64; 2]; 2],
    truth: f64,
}

impl Population {
    /// A population whose prediction errs in fractions of the stable and of the unstable samples, by kind.
    fn new(truth: f64, uncertain: f64, errs: [[f64; 2]; 2]) -> Self {
        let alone = errs.map(|[of_stable, of_unstable]| [(1.0 - truth) * of_stable, truth * of_unstable]);
        Self { uncertain, alone, truth }
    }

    fn predicted(&self) -> f64 {
        let [clear, uncertain] = self.alone.map(|[prediction, reference]| prediction - reference);
        (self.truth + (1.0 - self.uncertain) * clear + self.uncertain * uncertain).clamp(0.0, 1.0)
    }

    /// Brings a stratum to a number of samples.
    fn solve(&self, kind: usize, size: u64, stratum: &mut Stratum, rng: &mut StreamRng) {
        let named = |is_unstable: bool| is_unstable.then_some((MODE, true)).into_iter().collect::<BTreeMap<_, _>>();
        let [prediction, reference] = self.alone[kind];
        let new = size.saturating_sub(stratum.samples);
        let by_prediction = binomial(new, prediction, rng);
        let by_reference = binomial(new - by_prediction, reference / (1.0 - prediction).max(reference), rng);
        stratum.enter_alike(by_prediction, &named(true), &named(false));
        stratum.enter_alike(by_reference, &named(false), &named(true));
        stratum.enter_alike(new - by_prediction - by_reference, &named(false), &named(false));
    }

    /// The control variate, from the means of the prediction over independent points to the last look.
    fn control_variate(&self, half_width: f64, points: u32, rng: &mut StreamRng) -> (Option<Estimated>, f64) {
        let mut mean = |probability: f64| -> ReplicateMean {
            let hits: Vec<u64> = (0..32).map(|_| binomial(points.into(), probability, rng)).collect();
            mean_of_scramblings(hits.iter().map(|&hits| hits as f64), points)
        };
        let means = PredictionMeans {
            modes: BTreeMap::from([(MODE, [mean(self.predicted()); 2])]),
            uncertain: mean(self.uncertain),
        };
        let found = corrected(&means, half_width, 0, |kind, size, stratum| {
            self.solve(kind, size, stratum, rng);
            Ok(())
        });
        let found = found.unwrap();
        (found.modes.get(&MODE).copied(), found.unseen)
    }
}

/// Predictions: right, wrong now and then, and of no use at all.
fn populations(truth: f64) -> [(&'static str, Population); 3] {
    [
        ("right", Population::new(truth, 0.02, [[0.0; 2]; 2])),
        ("wrong now and then", Population::new(truth, 0.02, [[2e-4; 2], [0.12; 2]])),
        ("never unstable", Population::new(truth, 0.02, [[0.0, 1.0]; 2])),
    ]
}

/// An estimator, the truth, and how well it keeps its promise.
type Row = (String, f64, Coverage);

/// The estimators that take a half width, at every probability.
fn measured(half_width: f64, runs: u64) -> Vec<Row> {
    // The error of the means has to leave a part of the half width.
    let points = (30.0 / half_width) as u32;
    let mut rows = Vec::new();
    for truth in PROBABILITIES {
        let coverage = Coverage::of(truth, half_width, 4 * runs, |rng| plain(truth, half_width, rng));
        rows.push((format!("plain sampling to {half_width}"), truth, coverage));
        for (prediction, population) in populations(truth) {
            let what = format!("control variate to {half_width}, prediction {prediction}");
            let estimate = |rng: &mut StreamRng| population.control_variate(half_width, points, rng);
            rows.push((what, truth, Coverage::of(truth, half_width, runs, estimate)));
        }
    }
    rows
}

/// Quasi-Monte Carlo at every probability.
fn measured_quasi(runs: u64) -> Vec<Row> {
    let mut rows = Vec::new();
    for truth in PROBABILITIES {
        for (event, [scramblings, points]) in [
            (Event::Strip, [8, 64]),
            (Event::Hyperbola, [8, 64]),
            (Event::Strip, [4, 256]),
            (Event::Hyperbola, [4, 256]),
        ] {
            let coverage = Coverage::of(truth, 0.02, runs, |rng| quasi(event, truth, points, scramblings, rng));
            rows.push((format!("quasi-Monte Carlo, {scramblings} x {points}, {event:?}"), truth, coverage));
        }
    }
    rows
}

#[test]
fn no_estimate_is_farther_from_the_truth_than_it_says() {
    for (what, truth, coverage) in measured(0.02, 100).into_iter().chain(measured_quasi(200)) {
        coverage.check(&what, truth);
    }
}

#[test]
fn half_the_width_of_an_interval_that_ends_at_0_would_not_do() {
    // A probability of 5e-4, of which 4,000 samples often show nothing: the limit is 9e-4 then, and the estimate 0.
    let (truth, half_width) = (5e-4, 1e-3);
    let run =
        |rng: &mut StreamRng| of(&of_samples(&hits(binomial(4_000, truth, rng)), 4_000, Counters::default()).unwrap());
    let coverage = Coverage::of(truth, half_width, 2_000, run);
    coverage.check("plain sampling", truth);
    assert!(coverage.missed_by_halves > 200, "{coverage:?}");
}

/// Command: `cargo test --release -p brake-squeal-study --lib coverage -- --ignored --nocapture`
#[test]
#[ignore = "a hundred thousand simulated estimates"]
fn coverage_of_every_estimator() {
    println!("| estimator | occurrence | covered | mean half width | reached | by halves |");
    println!("| --- | ---: | ---: | ---: | ---: | ---: |");
    for (what, truth, coverage) in
        measured(0.02, 1_000).into_iter().chain(measured(0.001, 1_000)).chain(measured_quasi(4_000))
    {
        coverage.print(&what, truth);
        coverage.check(&what, truth);
    }
}
