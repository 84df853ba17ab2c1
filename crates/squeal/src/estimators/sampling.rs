//! Occurrences of one scene by sampling: plain Monte Carlo and randomised quasi-Monte Carlo.

use std::collections::BTreeMap;

use cea::Counters;
use montecarlo::{Confidence, Experiment as _, wilson};
use serde::{Deserialize, Serialize};

use super::friction_points::sobol_sample;
use super::{EstimatorError, OccurrenceBounds};
use crate::study::{Outcome, Study, UncertainBrake, unstable_names};

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
    pub modes: BTreeMap<u16, Estimated>,
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
    let estimated = |(name, [sure, open]): (u16, [u64; 2])| {
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
    let mut runs: Vec<BTreeMap<u16, [u64; 2]>> = Vec::new();
    let mut counters = Counters::default();
    for scrambling in 0..scramblings {
        let samples = (0..points).map(|i| sobol_sample(brake, of_scene, i, seed.wrapping_add(scrambling)));
        let (hits, computed) = count(study, scene, samples)?;
        counters = sum(counters, computed);
        runs.push(hits);
    }
    let names: std::collections::BTreeSet<u16> = runs.iter().flat_map(|run| run.keys().copied()).collect();
    let t = Confidence::P95.t(u64::from(scramblings - 1));
    let estimated = |name: u16| {
        let share = |run: &BTreeMap<u16, [u64; 2]>, open: usize| {
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
    Ok(Estimates { modes: names.into_iter().map(estimated).collect(), counters })
}

/// Sure and open hits by name.
type HitCounts = BTreeMap<u16, [u64; 2]>;

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
            for (name, is_sure) in unstable_names(&outcome?.unstable) {
                hits.entry(name).or_default()[usize::from(!is_sure)] += 1;
            }
        }
    }
    Ok((hits, scratch.counters()))
}

fn sum(a: Counters, b: Counters) -> Counters {
    Counters {
        eigenvalue_solves: a.eigenvalue_solves + b.eigenvalue_solves,
        certified_solves: a.certified_solves + b.certified_solves,
        factorisations: a.factorisations + b.factorisations,
        eigenvectors: a.eigenvectors + b.eigenvectors,
        secular_values: a.secular_values + b.secular_values,
        continuations: a.continuations + b.continuations,
    }
}
