//! Confirmation of sets of changes: all scenes of a study, all sets on the same draws.

use std::ops::Range;

use montecarlo::{
    BoundedMean, Bounds, Confidence, CountDifference, CountedSide, Estimate, Failures, Merge, QuantileSketch, Runs,
    Tally, wilson,
};
use serde::{Deserialize, Serialize};
use study::{Plan, Scene, UncertainBrake};

use super::sounded::Sounded;

/// Part of the draws of which the growth, or the loudness, is not exceeded, of [`Confirmed::growth_quantile`] and [`Confirmed::loudness_quantile`].
pub(super) const QUANTILE: f64 = 0.95;

/// Sums over all scenes of each set of changes, sample by sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct ScreenTally {
    /// Counts of unstable modes and divergences in all analyses of a sample.
    unstable: CountsOfSets,
    /// Counts of the analyses of a sample with an unstable mode or divergence.
    squealing: CountsOfSets,
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

/// Counts of a sample by set, of what is unstable for certain and of what may be, where verdicts are open.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct CountsOfSets {
    /// Sums of what is for certain, by set.
    sure: Vec<BoundedMean>,
    /// Sums of what is or may be, by set.
    at_most: Vec<BoundedMean>,
    /// Sums, by set and other set, of how many more the first has, for certain each.
    drops: Vec<Vec<BoundedMean>>,
    /// Sums, by set and other set, of how many more the first may have than the other has for certain.
    most_drops: Vec<Vec<BoundedMean>>,
}

impl CountsOfSets {
    fn empty(sets: usize) -> Self {
        let (means, drops) = (vec![BoundedMean::default(); sets], vec![vec![BoundedMean::default(); sets]; sets]);
        Self { sure: means.clone(), at_most: means, drops: drops.clone(), most_drops: drops }
    }

    /// Enters the counts of a sample in each set, for certain and at most; `None` of a set in which a scene failed.
    fn record(&mut self, counts: &[Option<[i32; 2]>]) {
        for (set, count) in counts.iter().enumerate() {
            let Some([sure, at_most]) = *count else { continue };
            self.sure[set].record(sure);
            self.at_most[set].record(at_most);
            for (other, less) in counts.iter().enumerate() {
                if let Some([less, _]) = *less {
                    self.drops[set][other].record(sure - less);
                    self.most_drops[set][other].record(at_most - less);
                }
            }
        }
    }

    fn merge(&mut self, later: Self) {
        let add = |mine: &mut Vec<BoundedMean>, later: Vec<BoundedMean>| {
            mine.iter_mut().zip(later).for_each(|(mine, later)| mine.merge(later));
        };
        add(&mut self.sure, later.sure);
        add(&mut self.at_most, later.at_most);
        self.drops.iter_mut().zip(later.drops).for_each(|(mine, later)| add(mine, later));
        self.most_drops.iter_mut().zip(later.most_drops).for_each(|(mine, later)| add(mine, later));
    }

    /// Mean of a set in one of `by` analyses, of counts of at most `greatest` in one; in `failed` samples it may be anything, and what may be unstable is in the upper
    /// limit.
    fn estimate(&self, set: usize, by: f64, greatest: f64, failed: u64) -> Option<Estimate> {
        let [sure, at_most] = [&self.sure, &self.at_most].map(|of| estimate(&of[set], by, greatest, failed));
        let (sure, at_most) = (sure?, at_most?);
        Some(Estimate { upper: sure.upper.max(at_most.upper), ..sure })
    }

    /// Mean difference of a set to another one, `less`, in one of `by` analyses, of counts of at most `greatest` in each; what may be unstable in either is in the
    /// limits.
    fn difference(&self, (set, less): (usize, usize), greatest: [f64; 2], by: f64, samples: u64) -> Option<Estimate> {
        let Self { sure, at_most, drops, most_drops } = self;
        let [of_set, of_less] = greatest;
        let value = difference(&drops[set][less], [(&sure[set], of_set), (&sure[less], of_less)], by, samples)?;
        if [set, less].iter().all(|&of| sure[of] == at_most[of]) {
            return Some(value);
        }
        let most = difference(&most_drops[set][less], [(&at_most[set], of_set), (&sure[less], of_less)], by, samples)?;
        let least = difference(&most_drops[less][set], [(&at_most[less], of_less), (&sure[set], of_set)], by, samples)?;
        Some(Estimate { lower: value.lower.min(-least.upper), upper: value.upper.max(most.upper), ..value })
    }
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
        let counts = vec![0; sets];
        Self {
            unstable: CountsOfSets::empty(sets),
            squealing: CountsOfSets::empty(sets),
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
        let count = |mine: &mut Vec<u64>, later: Vec<u64>| {
            mine.iter_mut().zip(later).for_each(|(mine, later)| *mine += later);
        };
        self.unstable.merge(later.unstable);
        self.squealing.merge(later.squealing);
        self.growth.iter_mut().zip(later.growth).for_each(|(mine, later)| mine.merge(later));
        self.loudness.iter_mut().zip(later.loudness).for_each(|(mine, later)| mine.merge(later));
        count(&mut self.undecided, later.undecided);
        count(&mut self.divergent, later.divergent);
    }
}

impl<B: UncertainBrake> Tally<Sounded<'_, '_, B>> for ScreenTally {
    fn record(&mut self, runs: &Runs<'_, Sounded<'_, '_, B>>) {
        // Of a set in which a scene failed nothing is known of this sample.
        let sets = self.undecided.len();
        let (mut unstable, mut squealing) = (vec![Some([0; 2]); sets], vec![Some([0; 2]); sets]);
        let mut growth = vec![0.0_f64; sets];
        let mut loudness: Vec<Option<f64>> = vec![None; sets];
        for (&(set, weight), result) in self.layout.scenes.iter().zip(runs.results) {
            match (result, &mut unstable[set], &mut squealing[set]) {
                (Ok((outcome, of_scene)), Some(unstable), Some(squealing)) => {
                    let (modes, open) = (outcome.instabilities() as i32, outcome.undecided as i32);
                    let (squeals, may_squeal) = (outcome.is_unstable(), outcome.may_be_unstable());
                    unstable[0] += weight * modes;
                    unstable[1] += weight * (modes + open);
                    squealing[0] += weight * i32::from(squeals);
                    squealing[1] += weight * i32::from(squeals || may_squeal);
                    growth[set] = growth[set].max(outcome.growth);
                    loudness[set] = of_scene.map(|of_scene| loudness[set].unwrap_or(0.0).max(of_scene));
                    self.undecided[set] += weight as u64 * u64::from(outcome.undecided);
                    self.divergent[set] += weight as u64 * u64::from(outcome.divergent);
                }
                (Err(_), ..) => (unstable[set], squealing[set]) = (None, None),
                (Ok(_), ..) => {}
            }
        }
        self.unstable.record(&unstable);
        self.squealing.record(&squealing);
        for set in (0..sets).filter(|&set| unstable[set].is_some()) {
            self.growth[set].record(growth[set]);
            if let Some(loudness) = loudness[set] {
                self.loudness[set].record(loudness);
            }
        }
    }

    fn may_be_of(&self, samples: Range<u64>, _: &Failures) -> bool {
        let count = samples.end - samples.start;
        self.unstable.sure.iter().chain(&self.squealing.sure).all(|mean| mean.count() <= count)
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
    /// Number of verdicts that the error bound leaves open: they count as stable in values, and as either in limits.
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
        let [squealing, perhaps] = [&self.squealing.sure[set], &self.squealing.at_most[set]];
        let failed = samples.saturating_sub(squealing.count());
        // One analysis of each sample squeals or not.
        let squealing = match by == 1.0 {
            true => {
                let (hits, value) = (squealing.nonzero(), squealing.mean()?);
                let limits = |hits: u64| wilson(hits, samples, Confidence::P95).ok();
                Estimate { value, lower: limits(hits)?.lower, upper: limits(perhaps.nonzero() + failed)?.upper }
            }
            false => self.squealing.estimate(set, by, 1.0, failed)?,
        };
        let is_heard = self.loudness[set].count() + self.loudness[set].not_finite() > 0;
        let loudness = quantile(&self.loudness[set], Confidence::P95, samples);
        let loudness_drop = quantile_drop(&self.loudness, set, samples);
        let nothing = Estimate { value: f64::INFINITY, lower: 0.0, upper: f64::INFINITY };
        let unknown = Estimate { value: f64::NAN, lower: f64::NEG_INFINITY, upper: f64::INFINITY };
        Some(Confirmed {
            unstable: self.unstable.estimate(set, by, most, failed)?,
            drop: self.difference(plan, 0, set, samples)?,
            squealing,
            squealing_drop: self.squealing.difference((0, set), [1.0; 2], by, samples)?,
            growth_quantile: quantile(&self.growth[set], Confidence::P95, samples)?,
            growth_quantile_drop: quantile_drop(&self.growth, set, samples)?,
            loudness_quantile: is_heard.then(|| loudness.unwrap_or(nothing)),
            loudness_quantile_drop: is_heard.then(|| loudness_drop.unwrap_or(unknown)),
            not_followed: is_heard.then(|| self.loudness[set].not_finite()),
            undecided: self.undecided[set],
            divergent: self.divergent[set],
            samples: self.unstable.sure[set].count(),
        })
    }

    /// Difference of a set to another one, `less`, in the number of unstable modes, on the same draws.
    pub fn difference(&self, plan: &Plan, set: usize, less: usize, samples: u64) -> Option<Estimate> {
        if set == less {
            // Nothing is drawn that could differ.
            return Some(Estimate { value: 0.0, lower: 0.0, upper: 0.0 })
                .filter(|_| self.unstable.sure[set].count() > 0);
        }
        let ((by, most), (_, of_less)) = (size(plan, set), size(plan, less));
        self.unstable.difference((set, less), [most, of_less], by, samples)
    }
}

/// Number that the largest growth or loudness of a sample does not exceed in 95 % of them; without limits where one of them is not known.
fn quantile(of: &QuantileSketch, confidence: Confidence, samples: u64) -> Option<Estimate> {
    // Samples without a number, whose motions grow without bound or could not be followed, are louder than any.
    let value = of.not_exceeded(QUANTILE).ok()?;
    let limits = of.quantile_interval(QUANTILE, confidence).ok()?;
    let (lower, upper) = match limits.filter(|_| value.is_finite() && of.count() == samples) {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Growth that 95 % of the draws do not exceed is that of a draw: 0 where 95 % of them are stable, and infinite where more than 5 % were not followed.
    #[test]
    fn what_95_percent_do_not_exceed_is_that_of_a_draw() {
        for (stable, growing, lost, expected) in [
            (285, 15, 0, 0.0),
            (284, 16, 0, 4.0),
            (19, 1, 0, 0.0),
            (18, 2, 0, 4.0),
            (0, 285, 15, 4.0),
            (285, 0, 15, 0.0),
            (284, 0, 16, f64::INFINITY),
            (0, 0, 3, f64::INFINITY),
        ] {
            let mut sketch = QuantileSketch::default();
            (0..stable).for_each(|_| sketch.record(0.0));
            (0..growing).for_each(|_| sketch.record(4.0));
            (0..lost).for_each(|_| sketch.record(f64::INFINITY));
            let found = quantile(&sketch, Confidence::P95, stable + growing + lost).unwrap();
            let is_near = found.value == expected
                || (found.value - expected).abs() <= QuantileSketch::RELATIVE_ACCURACY * expected;
            assert!(is_near, "{stable}, {growing}, {lost}: {found:?}");
            assert!(found.lower <= found.value && found.value <= found.upper, "{found:?}");
        }
        assert!(quantile(&QuantileSketch::default(), Confidence::P95, 3).is_none());
    }
}
