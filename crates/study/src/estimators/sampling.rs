//! Occurrences of one scene by sampling: plain Monte Carlo and randomised quasi-Monte Carlo.

use std::collections::{BTreeMap, BTreeSet};

use cea::Counters;
use montecarlo::rand::RngExt;
use montecarlo::{Confidence, Experiment as _, Interval, ReplicateMean, clopper_pearson, exact_upper_limit, stream};
use serde::{Deserialize, Serialize};

use super::friction_points::sobol_sample;
use super::{EstimatorError, OccurrenceBounds};
use crate::{ModeLabel, Outcome, Study, UncertainBrake};

/// Samples handed to the solver together; chosen: several times its eight lanes.
const SAMPLES_PER_BLOCK: usize = 64;

/// Least standard error of a mean over the points of several scramblings, as a number of hits among all these points. The hits of a scrambling are a whole
/// number: scramblings that agree by chance do not show what is left between two of them. With R scramblings of m points a fraction p of a hit stays unseen
/// with the probability `(1 - p)^R`, above 0.025 up to `p = 3.69 / R`: a mean that is wrong by 3.69 of R m points. Student's t at 95 % is 1.96 or more, and
/// twice that is above 3.69.
pub(super) const UNSEEN_HITS: f64 = 2.0;

/// Occurrence with the limits that its estimator gives.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Estimated {
    /// Estimate of the occurrence.
    pub occurrence: OccurrenceBounds,
    /// Limits of its 95 % interval, within 0 and 1: the lower limit is one of the mode surely unstable, the upper one of the mode perhaps
    /// unstable.
    pub limits: Interval,
}

impl Estimated {
    /// An estimate whose ends may be wrong by `error`.
    pub(super) fn within(occurrence: OccurrenceBounds, error: f64) -> Self {
        let limits =
            Interval { lower: (occurrence.lower - error).max(0.0), upper: (occurrence.upper + error).min(1.0) };
        Self { occurrence, limits }
    }

    /// Largest distance from an end of the occurrence to the limit beyond it: at the confidence of the limits the true
    /// occurrence is at most so far from the estimate. Near 0 and 1, where the interval ends at one side, this is more than half
    /// of its width. The distance that open names leave between the ends is not in it: more samples do not close that.
    #[must_use]
    pub fn half_width(&self) -> f64 {
        (self.occurrence.lower - self.limits.lower).max(self.limits.upper - self.occurrence.upper)
    }
}

/// Estimates for the modes that were unstable in any sample, by name.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Estimates {
    /// Estimate of each tracked mode, by name.
    pub modes: BTreeMap<ModeLabel, Estimated>,
    /// Upper limit, at 95 %, of the occurrence of any mode that is not listed.
    pub unseen: f64,
    /// Counters of the computations.
    pub counters: Counters,
}

impl Estimates {
    /// Largest half width, of a mode that was seen or not.
    #[must_use]
    pub fn half_width(&self) -> f64 {
        self.modes.values().map(Estimated::half_width).fold(self.unseen, f64::max)
    }
}

/// Plain Monte Carlo: the study's own samples, with the interval of Clopper and Pearson, which covers every probability at
/// least as often as it says.
///
/// # Errors
/// A sample that cannot be solved.
pub fn monte_carlo<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    seed: u64,
    samples: u64,
) -> Result<Estimates, EstimatorError> {
    let draws = (0..samples).map(|i| Ok(study.brake().draw(&mut montecarlo::stream(seed, i))?));
    let (hits, counters) = count(study, scene, draws)?;
    of_samples(&hits, samples, counters)
}

/// The estimates from hits among independent samples.
pub(super) fn of_samples(hits: &HitCounts, samples: u64, counters: Counters) -> Result<Estimates, EstimatorError> {
    let estimated = |(&name, &[sure, open]): (&ModeLabel, &[u64; 2])| {
        let interval = |hits: u64| clopper_pearson(hits, samples, Confidence::P95).map_err(crate::Error::from);
        let limits = Interval { lower: interval(sure)?.lower, upper: interval(sure + open)?.upper };
        let of = |hits: u64| hits as f64 / samples as f64;
        let occurrence = OccurrenceBounds { lower: of(sure), upper: of(sure + open) };
        Ok((name, Estimated { occurrence, limits }))
    };
    let modes = hits.iter().map(estimated).collect::<Result<_, EstimatorError>>()?;
    Ok(Estimates { modes, unseen: exact_upper_limit(0, samples, Confidence::P95.tail()), counters })
}

/// Quasi-Monte Carlo: the first `points` of the Sobol sequence under each of `scramblings` independent Owen scramblings,
/// through the quantile functions of the parameters (Owen, J. Complexity 14, 1998; Burley, J. Comput. Graph. Tech. 9,
/// 2020). The scatter of the scramblings, with Student's t, is the error estimate; it takes two or more.
///
/// The sequence has 2^16 points; take a power of two.
///
/// # Errors
/// A brake without samples by quantiles, no points or too many of them, fewer than two scramblings; a sample that cannot be solved.
pub fn quasi_monte_carlo<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    seed: u64,
    points: u32,
    scramblings: u32,
) -> Result<Estimates, EstimatorError> {
    if points == 0 || points > 1 << 16 || scramblings < 2 {
        return Err(EstimatorError::Points { points, scramblings });
    }
    let mut sobol = ScrambledSobol::new(seed, scramblings);
    sobol.extend(study, scene, points)?;
    Ok(sobol.estimates(Confidence::P95))
}

/// Seed of a scrambling of a study with a seed: scramblings of studies with other seeds, the next one too, have nothing in common.
fn scrambling_seed(seed: u64, scrambling: u32) -> u32 {
    // Streams of samples count up from 0.
    stream(seed, u64::MAX - u64::from(scrambling)).random()
}

/// Hits at the first points of the Sobol sequence under several scramblings, of which more can be added.
pub(super) struct ScrambledSobol {
    seed: u64,
    points: u32,
    runs: Vec<HitCounts>,
    counters: Counters,
}

impl ScrambledSobol {
    pub fn new(seed: u64, scramblings: u32) -> Self {
        let runs = (0..scramblings).map(|_| HitCounts::new()).collect();
        Self { seed, points: 0, runs, counters: Counters::default() }
    }

    /// Solves the points that are missing of the first `points` in each scrambling.
    pub fn extend<B: UncertainBrake>(
        &mut self,
        study: &Study<'_, B>,
        scene: usize,
        points: u32,
    ) -> Result<(), EstimatorError> {
        let (brake, of_scene) = (study.brake(), &study.plan().scenes[scene]);
        for (scrambling, run) in (0..).zip(&mut self.runs) {
            let seed = scrambling_seed(self.seed, scrambling);
            let samples = (self.points..points).map(|i| sobol_sample(brake, of_scene, i, seed));
            let (hits, computed) = count(study, scene, samples)?;
            self.counters += computed;
            for (name, more) in hits {
                let hits = run.entry(name).or_default();
                hits.iter_mut().zip(more).for_each(|(hits, more)| *hits += more);
            }
        }
        self.points = self.points.max(points);
        Ok(())
    }

    pub fn estimates(&self, confidence: Confidence) -> Estimates {
        of_scramblings(&self.runs, self.points, self.counters, confidence)
    }
}

/// The estimates from the hits of each of two or more scramblings among their points.
pub(super) fn of_scramblings(runs: &[HitCounts], points: u32, counters: Counters, confidence: Confidence) -> Estimates {
    let names: BTreeSet<ModeLabel> = runs.iter().flat_map(|run| run.keys().copied()).collect();
    let estimated = |name: ModeLabel| {
        let hits = |run: &HitCounts| run.get(&name).copied().unwrap_or_default();
        let sure = mean_of_scramblings(runs.iter().map(|run| hits(run)[0] as f64), points);
        let perhaps = mean_of_scramblings(runs.iter().map(|run| hits(run).iter().sum::<u64>() as f64), points);
        let occurrence = OccurrenceBounds { lower: sure.mean, upper: perhaps.mean };
        let [lower, upper] = [sure, perhaps].map(|mean| mean.interval(confidence));
        (name, Estimated { occurrence, limits: Interval { lower: lower.lower.max(0.0), upper: upper.upper.min(1.0) } })
    };
    let none = mean_of_scramblings(runs.iter().map(|_| 0.0), points);
    let unseen = none.interval(confidence).upper.min(1.0);
    Estimates { modes: names.into_iter().map(estimated).collect(), unseen, counters }
}

/// The mean share of hits among the points of each scrambling, from the hits of all scramblings, with a standard error of
/// [`UNSEEN_HITS`] or more. Nothing is known of a single scrambling.
pub(super) fn mean_of_scramblings(hits: impl Iterator<Item = f64> + Clone, points: u32) -> ReplicateMean {
    let points = f64::from(points);
    let unknown = ReplicateMean { mean: 0.0, standard_error: f64::INFINITY, replicates: 2 };
    let found = ReplicateMean::of(hits.map(|hits| hits / points)).unwrap_or(unknown);
    let least = UNSEEN_HITS / (points * found.replicates as f64);
    ReplicateMean { standard_error: found.standard_error.max(least), ..found }
}

/// Sure and open hits by name.
pub(super) type HitCounts = BTreeMap<ModeLabel, [u64; 2]>;

fn count<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    samples: impl Iterator<Item = Result<B::Sample, EstimatorError>>,
) -> Result<(HitCounts, Counters), EstimatorError> {
    let (mut hits, all_names) = (HitCounts::new(), study.references()[scene].all_names());
    let mut scratch = crate::Scratch::default();
    let mut samples = samples.peekable();
    let mut outcomes: Vec<Result<Outcome, crate::Error>> = Vec::new();
    while samples.peek().is_some() {
        let block: Vec<B::Sample> = samples.by_ref().take(SAMPLES_PER_BLOCK).collect::<Result<_, _>>()?;
        outcomes.clear();
        study.evaluate_block(scene, &block.iter().collect::<Vec<_>>(), &mut scratch, &mut outcomes);
        for outcome in outcomes.drain(..) {
            for (name, is_sure) in outcome?.unstable_names(&all_names) {
                hits.entry(name).or_default()[usize::from(!is_sure)] += 1;
            }
        }
    }
    Ok((hits, scratch.counters()))
}

#[cfg(test)]
mod tests {
    use super::scrambling_seed;

    /// With seeds that count on, as a user who repeats a study gives them.
    #[test]
    fn scramblings_of_neighbouring_seeds_have_nothing_in_common() {
        let of_seeds = (0..100).chain([u64::from(u32::MAX), 1 << 32, u64::MAX]);
        let all: Vec<u32> = of_seeds.flat_map(|seed| (0..16).map(move |of| scrambling_seed(seed, of))).collect();
        assert_eq!(all.iter().collect::<std::collections::BTreeSet<_>>().len(), all.len());
    }
}
