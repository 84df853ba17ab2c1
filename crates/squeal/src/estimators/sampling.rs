//! Occurrences of one scene by sampling: plain Monte Carlo and randomised quasi-Monte Carlo.

use std::collections::BTreeMap;

use cea::Counters;
use montecarlo::{Confidence, Experiment as _, wilson};
use serde::{Deserialize, Serialize};

use super::friction_points::{check_points, sobol_sample};
use super::{EstimatorError, OccurrenceBounds};
use crate::study::{ModeLabel, Outcome, Scratch, Study, UncertainBrake};

/// Number of samples solved together; chosen, eight times the number of lanes of the batched solver.
const SAMPLES_PER_BLOCK: usize = 64;

/// An estimated occurrence with its confidence interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Estimated {
    /// The estimate.
    pub occurrence: OccurrenceBounds,
    /// Half width of the 95 % confidence interval, including the part that is due to open names.
    pub half_width: f64,
}

impl Estimated {
    /// The half width without the part that is due to open names: more samples do not reduce that.
    #[must_use]
    pub fn closed_half_width(&self) -> f64 {
        self.half_width - 0.5 * (self.occurrence.upper - self.occurrence.lower)
    }
}

/// Estimates for the modes that were unstable in any sample, by name.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Estimates {
    /// Occurrences by name of the tracked mode.
    pub modes: BTreeMap<ModeLabel, Estimated>,
    /// Numbers of computations.
    pub counters: Counters,
}

/// Plain Monte Carlo with the samples of the study, and Wilson's interval.
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
    let mut scratch = Scratch::default();
    let hits = count(study, scene, draws, &mut scratch)?;
    let estimated = |(name, [sure, open]): (ModeLabel, [u64; 2])| {
        let limits = |hits: u64| wilson(hits, samples, Confidence::P95).map_err(crate::Error::from);
        let (lower, upper) = (limits(sure)?.lower, limits(sure + open)?.upper);
        let of = |hits: u64| hits as f64 / samples as f64;
        let occurrence = OccurrenceBounds { lower: of(sure), upper: of(sure + open) };
        Ok((name, Estimated { occurrence, half_width: 0.5 * (upper - lower) }))
    };
    let modes = hits.into_iter().map(estimated).collect::<Result<_, EstimatorError>>()?;
    Ok(Estimates { modes, counters: scratch.counters() })
}

/// Quasi-Monte Carlo: the first `points` of the Sobol sequence under each of `scramblings` independent Owen scramblings,
/// through the quantile functions of the parameters (Owen, J. Complexity 14, 1998; Burley, J. Comput. Graph. Tech. 9,
/// 2020). The interval follows from the scatter of the scramblings, at least two, by Student's t.
///
/// `points` is at most 2^16 and should be a power of two. One draw must be shared by all contacts.
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
    check_points(points, scramblings)?;
    let (brake, of_scene) = (study.brake(), &study.plan().scenes[scene]);
    let mut runs: Vec<HitCounts> = Vec::new();
    let mut scratch = Scratch::default();
    for scrambling in 0..scramblings {
        let samples = (0..points).map(|i| sobol_sample(brake, of_scene, i, seed.wrapping_add(scrambling)));
        runs.push(count(study, scene, samples, &mut scratch)?);
    }
    let names: std::collections::BTreeSet<ModeLabel> = runs.iter().flat_map(|run| run.keys().copied()).collect();
    let t = Confidence::P95.t(u64::from(scramblings - 1));
    let estimated = |name: ModeLabel| {
        let share = |run: &HitCounts, open: usize| {
            let [sure, maybe] = run.get(&name).copied().unwrap_or_default();
            (sure + open as u64 * maybe) as f64 / f64::from(points)
        };
        let mean = |open| runs.iter().map(|run| share(run, open)).sum::<f64>() / f64::from(scramblings);
        let occurrence = OccurrenceBounds { lower: mean(0), upper: mean(1) };
        let centre = 0.5 * (occurrence.lower + occurrence.upper);
        let deviation = |run| 0.5 * (share(run, 0) + share(run, 1)) - centre;
        let variance = runs.iter().map(|run| deviation(run).powi(2)).sum::<f64>() / f64::from(scramblings - 1);
        let half_width = t * (variance / f64::from(scramblings)).sqrt() + 0.5 * (occurrence.upper - occurrence.lower);
        (name, Estimated { occurrence, half_width })
    };
    Ok(Estimates { modes: names.into_iter().map(estimated).collect(), counters: scratch.counters() })
}

/// Numbers of certain and of ambiguous hits by name.
type HitCounts = BTreeMap<ModeLabel, [u64; 2]>;

fn count<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    samples: impl Iterator<Item = Result<B::Sample, EstimatorError>>,
    scratch: &mut Scratch,
) -> Result<HitCounts, EstimatorError> {
    let mut hits = HitCounts::new();
    let mut samples = samples.peekable();
    let mut outcomes: Vec<Result<Outcome, crate::Error>> = Vec::new();
    while samples.peek().is_some() {
        let block: Vec<B::Sample> = samples.by_ref().take(SAMPLES_PER_BLOCK).collect::<Result<_, _>>()?;
        outcomes.clear();
        study.evaluate_block(scene, &block.iter().collect::<Vec<_>>(), scratch, &mut outcomes);
        for outcome in outcomes.drain(..) {
            for (name, is_sure) in outcome?.unstable_names() {
                hits.entry(name).or_default()[usize::from(!is_sure)] += 1;
            }
        }
    }
    Ok(hits)
}
