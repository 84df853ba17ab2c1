//! Occurrences of one scene by sampling: plain Monte Carlo and randomised quasi-Monte Carlo.

use std::collections::{BTreeMap, BTreeSet};

use cea::Counters;
use montecarlo::{Confidence, Experiment as _, ReplicateMean, wilson};
use serde::{Deserialize, Serialize};

use super::friction_points::sobol_sample;
use super::{EstimatorError, OccurrenceBounds};
use crate::study::{ModeLabel, Outcome, Study, UncertainBrake};

/// Samples handed to the solver together: some times its eight lanes; chosen.
const SAMPLES_PER_BLOCK: usize = 64;

/// An occurrence with what its estimator knows of its error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Estimated {
    /// The estimate.
    pub occurrence: OccurrenceBounds,
    /// Half width of its 95 % confidence interval, with what open names leave open.
    pub half_width: f64,
}

impl Estimated {
    /// The half width without what open names leave open: more samples do not close that.
    #[must_use]
    pub fn closed_half_width(&self) -> f64 {
        self.half_width - 0.5 * (self.occurrence.upper - self.occurrence.lower)
    }
}

/// Estimates for the modes that were unstable in any sample, by name.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Estimates {
    /// By name of the tracked mode.
    pub modes: BTreeMap<ModeLabel, Estimated>,
    /// What was computed.
    pub counters: Counters,
}

/// Plain Monte Carlo: the study's own samples, with Wilson's interval.
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
    let estimated = |(name, [sure, open]): (ModeLabel, [u64; 2])| {
        let limits = |hits: u64| wilson(hits, samples, Confidence::P95).map_err(crate::Error::from);
        let (lower, upper) = (limits(sure)?.lower, limits(sure + open)?.upper);
        let of = |hits: u64| hits as f64 / samples as f64;
        let occurrence = OccurrenceBounds { lower: of(sure), upper: of(sure + open) };
        Ok((name, Estimated { occurrence, half_width: 0.5 * (upper - lower) }))
    };
    let modes = hits.into_iter().map(estimated).collect::<Result<_, EstimatorError>>()?;
    Ok(Estimates { modes, counters })
}

/// Quasi-Monte Carlo: the first `points` of the Sobol sequence under each of `scramblings` independent Owen scramblings,
/// through the quantile functions of the parameters (Owen, J. Complexity 14, 1998; Burley, J. Comput. Graph. Tech. 9,
/// 2020). The scatter of the scramblings, with Student's t, is the error estimate; it takes two or more.
///
/// The sequence has 2^16 points; take a power of two. One draw is shared by all contacts.
///
/// # Errors
/// Separate draws, no points or too many of them, fewer than two scramblings; a sample that cannot be solved.
pub fn quasi_monte_carlo<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    seed: u32,
    points: u32,
    scramblings: u32,
) -> Result<Estimates, EstimatorError> {
    if points == 0 || points > 1 << 16 || scramblings < 2 {
        return Err(EstimatorError::Points { points, scramblings });
    }
    let (brake, of_scene) = (study.brake(), &study.plan().scenes[scene]);
    let mut runs: Vec<HitCounts> = Vec::new();
    let mut counters = Counters::default();
    for scrambling in 0..scramblings {
        let samples = (0..points).map(|i| sobol_sample(brake, of_scene, i, seed.wrapping_add(scrambling)));
        let (hits, computed) = count(study, scene, samples)?;
        counters += computed;
        runs.push(hits);
    }
    let names: BTreeSet<ModeLabel> = runs.iter().flat_map(|run| run.keys().copied()).collect();
    let estimated = |name: ModeLabel| {
        let share = |run: &HitCounts, open: f64| {
            let [sure, maybe] = run.get(&name).copied().unwrap_or_default();
            (sure as f64 + open * maybe as f64) / f64::from(points)
        };
        // Sure hits alone, with half of the open ones, and with all of them.
        let mean = |open: f64| ReplicateMean::of(runs.iter().map(|run| share(run, open)));
        let [lower, centre, upper] = [mean(0.0)?, mean(0.5)?, mean(1.0)?];
        let interval = centre.interval(Confidence::P95);
        let occurrence = OccurrenceBounds { lower: lower.mean, upper: upper.mean };
        let half_width = 0.5 * (interval.upper - interval.lower) + 0.5 * (occurrence.upper - occurrence.lower);
        Some((name, Estimated { occurrence, half_width }))
    };
    let modes = names.into_iter().map(estimated).collect::<Option<_>>();
    Ok(Estimates { modes: modes.ok_or(EstimatorError::Points { points, scramblings })?, counters })
}

/// Sure and open hits by name.
type HitCounts = BTreeMap<ModeLabel, [u64; 2]>;

fn count<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    samples: impl Iterator<Item = Result<B::Sample, EstimatorError>>,
) -> Result<(HitCounts, Counters), EstimatorError> {
    let mut hits = HitCounts::new();
    let mut scratch = crate::study::Scratch::default();
    let mut samples = samples.peekable();
    let mut outcomes: Vec<Result<Outcome, crate::Error>> = Vec::new();
    while samples.peek().is_some() {
        let block: Vec<B::Sample> = samples.by_ref().take(SAMPLES_PER_BLOCK).collect::<Result<_, _>>()?;
        outcomes.clear();
        study.evaluate_block(scene, &block.iter().collect::<Vec<_>>(), &mut scratch, &mut outcomes);
        for outcome in outcomes.drain(..) {
            for (name, is_sure) in outcome?.unstable_names() {
                hits.entry(name).or_default()[usize::from(!is_sure)] += 1;
            }
        }
    }
    Ok((hits, scratch.counters()))
}
