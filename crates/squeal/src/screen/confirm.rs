//! Confirmation of sets of changes: all scenes of a study, all sets on the same draws.

use std::ops::Range;

use montecarlo::{
    BoundedMean, Bounds, Confidence, CountDifference, CountedSide, Failures, Merge, QuantileSketch, Runs, Tally, wilson,
};
use serde::{Deserialize, Serialize};
use study::{Plan, Scene, UncertainBrake};

use super::sounded::Sounded;
use crate::results::Estimate;

/// Part of the draws of which the growth, or the loudness, is not exceeded, of [`Confirmed::growth_quantile`] and [`Confirmed::loudness_quantile`].
pub(super) const QUANTILE: f64 = 0.95;

/// Sums over all scenes of each set of changes, sample by sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct ScreenTally {
    /// Sums, by set, of unstable modes and divergences in all analyses of a sample.
    unstable: Vec<BoundedMean>,
    /// Sums, by set, of the analyses of a sample with an unstable mode or divergence.
    squealing: Vec<BoundedMean>,
    /// Sums, by set and other set, of how many more unstable modes the first has.
    drops: Vec<Vec<BoundedMean>>,
    /// Sums, by set and other set, of how many more analyses with an unstable mode or divergence the first has.
    squeal_drops: Vec<Vec<BoundedMean>>,
    /// Largest growth rates in all analyses of a sample, 1/s, by set.
    growth: Vec<QuantileSketch>,
    /// Loudness of the loudest motion in all analyses of a sample, m/s, by set; infinite where a motion cannot be followed. Nothing where it is not asked
    /// for.
    loudness: Vec<QuantileSketch>,
    /// Number of verdicts that the error bound leaves open, by set.
    pub undecided: Vec<u64>,
    /// Number of real eigenvalues beyond the threshold, by set.
    pub divergent: Vec<u64>,
    #[serde(skip)]
    layout: Layout,
}

/// Layout of a tally: the set of each scene, and how many analyses it stands for.
#[derive(Debug, Clone, PartialEq, Default)]
struct Layout {
    scenes: Vec<(usize, i32)>,
}

/// Number of analyses that a scene stands for: members times ranges of speed.
pub(super) fn analyses(plan: &Plan, scene: &Scene) -> usize {
    scene.members.len() * plan.speeds_of(scene.key)
}

impl ScreenTally {
    /// An empty tally of a plan, whose sets of constraints are the sets of changes.
    pub fn empty(plan: &Plan) -> Self {
        let sets = plan.labels.constraints.len();
        let scenes = plan.scenes.iter().map(|scene| (scene.key.constraints, analyses(plan, scene) as i32)).collect();
        let (means, counts) = (vec![BoundedMean::default(); sets], vec![0; sets]);
        Self {
            unstable: means.clone(),
            squealing: means.clone(),
            drops: vec![means.clone(); sets],
            squeal_drops: vec![means; sets],
            growth: vec![QuantileSketch::default(); sets],
            loudness: vec![QuantileSketch::default(); sets],
            undecided: counts.clone(),
            divergent: counts,
            layout: Layout { scenes },
        }
    }
}

impl Merge for ScreenTally {
    fn merge(&mut self, later: Self) {
        let add = |mine: &mut Vec<BoundedMean>, later: Vec<BoundedMean>| {
            mine.iter_mut().zip(later).for_each(|(mine, later)| mine.merge(later));
        };
        let count = |mine: &mut Vec<u64>, later: Vec<u64>| {
            mine.iter_mut().zip(later).for_each(|(mine, later)| *mine += later);
        };
        add(&mut self.unstable, later.unstable);
        add(&mut self.squealing, later.squealing);
        self.drops.iter_mut().zip(later.drops).for_each(|(mine, later)| add(mine, later));
        self.squeal_drops.iter_mut().zip(later.squeal_drops).for_each(|(mine, later)| add(mine, later));
        self.growth.iter_mut().zip(later.growth).for_each(|(mine, later)| mine.merge(later));
        self.loudness.iter_mut().zip(later.loudness).for_each(|(mine, later)| mine.merge(later));
        count(&mut self.undecided, later.undecided);
        count(&mut self.divergent, later.divergent);
    }
}

impl<B: UncertainBrake> Tally<Sounded<'_, '_, B>> for ScreenTally {
    fn record(&mut self, runs: &Runs<'_, Sounded<'_, '_, B>>) {
        // Of a set in which a scene failed nothing is known of this sample.
        let mut sums: Vec<Option<[i32; 2]>> = vec![Some([0; 2]); self.unstable.len()];
        let mut growth = vec![0.0_f64; sums.len()];
        let mut loudness: Vec<Option<f64>> = vec![None; sums.len()];
        for (&(set, weight), result) in self.layout.scenes.iter().zip(runs.results) {
            match (result, &mut sums[set]) {
                (Ok((outcome, of_scene)), Some([unstable, squealing])) => {
                    *unstable += weight * outcome.instabilities() as i32;
                    *squealing += weight * i32::from(outcome.is_unstable());
                    growth[set] = growth[set].max(outcome.growth);
                    loudness[set] = of_scene.map(|of_scene| loudness[set].unwrap_or(0.0).max(of_scene));
                    self.undecided[set] += weight as u64 * u64::from(outcome.undecided);
                    self.divergent[set] += weight as u64 * u64::from(outcome.divergent);
                }
                (Err(_), sum) => *sum = None,
                (Ok(_), None) => {}
            }
        }
        for (set, sum) in sums.iter().enumerate() {
            let Some([unstable, squealing]) = *sum else { continue };
            self.unstable[set].record(unstable);
            self.squealing[set].record(squealing);
            self.growth[set].record(growth[set]);
            if let Some(loudness) = loudness[set] {
                self.loudness[set].record(loudness);
            }
            for (other, less) in sums.iter().enumerate() {
                if let Some([less, less_squealing]) = *less {
                    self.drops[set][other].record(unstable - less);
                    self.squeal_drops[set][other].record(squealing - less_squealing);
                }
            }
        }
    }

    fn may_be_of(&self, samples: Range<u64>, _: &Failures) -> bool {
        let count = samples.end - samples.start;
        self.unstable.iter().chain(&self.squealing).all(|mean| mean.count() <= count)
    }
}

/// Results of the study of all scenes on a set of changes; each estimate is of one analysis on average, with its 95 % interval.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Confirmed {
    /// Number of unstable modes, divergences among them.
    pub unstable: Estimate,
    /// Drop of the number of unstable modes against the brake without changes, on the same draws.
    pub drop: Estimate,
    /// Fraction of the analyses with an unstable mode or divergence.
    pub squealing: Estimate,
    /// Drop of this fraction against the brake without changes, on the same draws.
    pub squealing_drop: Estimate,
    /// Quantile at 95 %, over the samples, of the largest growth rate in all analyses of a sample, 1/s, to 1/2048 of itself; 0 where nothing grows. Its
    /// limits are order statistics: from 0, to infinity, where samples are too few or some failed.
    pub growth_quantile: Estimate,
    /// Drop of this quantile against the brake without changes, between the limits of the two with 97.5 % each.
    pub growth_quantile_drop: Estimate,
    /// Quantile at 95 %, over the samples, of the loudness of the loudest motion in all analyses of a sample, m/s, as `growth_quantile`; one that could not be
    /// followed is louder than any, so that it may be infinite. `None` where it is not asked for.
    pub loudness_quantile: Option<Estimate>,
    /// Drop of this quantile against the brake without changes.
    pub loudness_quantile_drop: Option<Estimate>,
    /// Number of samples with a motion that could not be followed, among them those that diverge; `None` where none was to be.
    pub not_followed: Option<u64>,
    /// Number of verdicts that the error bound leaves open; they count as stable.
    pub undecided: u64,
    /// Number of real eigenvalues beyond the threshold.
    pub divergent: u64,
    /// Number of samples of which all scenes could be analysed.
    pub samples: u64,
}

impl ScreenTally {
    /// Results on a set after `samples` samples, in each of which those that failed may be anything; `None` where all failed.
    pub fn confirmed(&self, plan: &Plan, set: usize, samples: u64) -> Option<Confirmed> {
        let (by, most) = size(plan, set);
        let squealing = &self.squealing[set];
        let failed = samples.saturating_sub(squealing.count());
        // One analysis of each sample squeals or not.
        let squealing = match by == 1.0 {
            true => {
                let (hits, value) = (squealing.nonzero(), squealing.mean()?);
                let limits = |hits: u64| wilson(hits, samples, Confidence::P95).ok();
                Estimate { value, lower: limits(hits)?.lower, upper: limits(hits + failed)?.upper }
            }
            false => estimate(squealing, by, 1.0, failed)?,
        };
        let is_heard = self.loudness[set].count() + self.loudness[set].not_finite() > 0;
        let loudness = quantile(&self.loudness[set], Confidence::P95, samples);
        let loudness_drop = quantile_drop(&self.loudness, set, samples);
        let nothing = Estimate { value: f64::INFINITY, lower: 0.0, upper: f64::INFINITY };
        let unknown = Estimate { value: f64::NAN, lower: f64::NEG_INFINITY, upper: f64::INFINITY };
        Some(Confirmed {
            unstable: estimate(&self.unstable[set], by, most, failed)?,
            drop: self.difference(plan, 0, set, samples)?,
            squealing,
            squealing_drop: difference(
                &self.squeal_drops[0][set],
                [(&self.squealing[0], 1.0), (&self.squealing[set], 1.0)],
                by,
                samples,
            )?,
            growth_quantile: quantile(&self.growth[set], Confidence::P95, samples)?,
            growth_quantile_drop: quantile_drop(&self.growth, set, samples)?,
            loudness_quantile: is_heard.then(|| loudness.unwrap_or(nothing)),
            loudness_quantile_drop: is_heard.then(|| loudness_drop.unwrap_or(unknown)),
            not_followed: is_heard.then(|| self.loudness[set].not_finite()),
            undecided: self.undecided[set],
            divergent: self.divergent[set],
            samples: self.unstable[set].count(),
        })
    }

    /// Difference of a set to another one, `less`, in the number of unstable modes, on the same draws.
    pub fn difference(&self, plan: &Plan, set: usize, less: usize, samples: u64) -> Option<Estimate> {
        if set == less {
            // Nothing is drawn that could differ.
            return Some(Estimate { value: 0.0, lower: 0.0, upper: 0.0 }).filter(|_| self.unstable[set].count() > 0);
        }
        let ((by, most), (_, of_less)) = (size(plan, set), size(plan, less));
        difference(&self.drops[set][less], [(&self.unstable[set], most), (&self.unstable[less], of_less)], by, samples)
    }
}

/// Quantile of the largest growth or loudness of each sample; without limits where one of them is not known.
fn quantile(of: &QuantileSketch, confidence: Confidence, samples: u64) -> Option<Estimate> {
    // Samples without a number, whose motions grow without bound or could not be followed, are louder than any: the quantile of all is a larger one of the others,
    // or none of theirs.
    let [numbers, all] = [of.count(), of.count() + of.not_finite()].map(|count| count.saturating_sub(1) as f64);
    let part = if of.not_finite() == 0 { QUANTILE } else { QUANTILE * all / numbers };
    if part > 1.0 {
        return Some(Estimate { value: f64::INFINITY, lower: 0.0, upper: f64::INFINITY });
    }
    let value = of.quantile(part).ok()?;
    let limits = of.quantile_interval(QUANTILE, confidence).ok()?;
    let (lower, upper) = match limits.filter(|_| of.count() == samples) {
        Some(limits) => (limits.lower.min(value), limits.upper.max(value)),
        None => (0.0, f64::INFINITY),
    };
    Some(Estimate { value, lower, upper })
}

/// Drop of the quantile of a set.
fn quantile_drop(of_sets: &[QuantileSketch], set: usize, samples: u64) -> Option<Estimate> {
    // Two intervals that hold together with 95 %, whatever they have to do with each other.
    let confidence = Confidence::P95.halved();
    let (more, less) = (quantile(&of_sets[0], confidence, samples)?, quantile(&of_sets[set], confidence, samples)?);
    Some(match set {
        // Nothing is drawn that could differ.
        0 => Estimate { value: 0.0, lower: 0.0, upper: 0.0 },
        _ => {
            Estimate { value: more.value - less.value, lower: more.lower - less.upper, upper: more.upper - less.lower }
        }
    })
}

/// Number of analyses that a sample of a set stands for, and number of modes that one of them has at most.
fn size(plan: &Plan, set: usize) -> (f64, f64) {
    let of_set = || plan.scenes.iter().filter(|scene| scene.key.constraints == set);
    let modes = of_set().map(|scene| plan.brake(scene).dofs.free().len()).max().unwrap_or(0);
    (of_set().map(|scene| analyses(plan, scene)).sum::<usize>() as f64, modes as f64)
}

/// Mean of one analysis, from sums over the analyses of samples that were solved, of counts of at most `greatest` in one; in `failed`
/// samples it may be anything.
fn estimate(sums: &BoundedMean, by: f64, greatest: f64, failed: u64) -> Option<Estimate> {
    let bounds = Bounds::of_count(greatest * by, by);
    let value = sums.mean()? / by;
    let [lower, upper] =
        [0.0, bounds.greatest].map(|of_failed| sums.and(of_failed as i32, failed).interval(bounds, Confidence::P95));
    Some(Estimate { value, lower: lower.lower / by, upper: upper.upper / by })
}

/// Mean difference of one analysis, from sums over the analyses of samples that were solved, and the sums of which it is the difference with
/// the largest count of each in one analysis.
fn difference(differences: &BoundedMean, sides: [(&BoundedMean, f64); 2], by: f64, samples: u64) -> Option<Estimate> {
    let failed = |sums: &BoundedMean| samples.saturating_sub(sums.count());
    let [more, fewer] = sides.map(|(counts, greatest)| CountedSide {
        counts,
        failed: failed(counts),
        greatest: greatest * by,
        step: by,
        times: 1.0,
    });
    let value = differences.mean()? / by;
    let limits = CountDifference { differences, failed: failed(differences), more, fewer }.interval(Confidence::P95);
    Some(Estimate { value, lower: limits.lower / by, upper: limits.upper / by })
}
