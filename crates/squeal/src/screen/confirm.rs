//! Sets of changes confirmed: all scenes of a study, all sets on the same draws.

use montecarlo::{Confidence, Failures, IntegerMean, Merge, Runs, Tally};
use serde::{Deserialize, Serialize};

use super::modified::Modified;
use crate::report::Estimate;
use crate::study::{Plan, Scene, Study, UncertainBrake};

/// Sums over all scenes of each set of changes, sample by sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct ScreenTally {
    /// By set: unstable modes in all analyses of a sample.
    unstable: Vec<IntegerMean>,
    /// By set: analyses of a sample with an unstable mode or divergence.
    squealing: Vec<IntegerMean>,
    /// By set, and set with less: by how much the first has more unstable modes.
    drops: Vec<Vec<IntegerMean>>,
    /// The same of analyses with an unstable mode.
    squeal_drops: Vec<Vec<IntegerMean>>,
    /// By set: verdicts that the error bound leaves open, and real eigenvalues above zero.
    pub undecided: Vec<u64>,
    pub divergent: Vec<u64>,
    #[serde(skip)]
    layout: Layout,
}

/// The set of each scene, and how many analyses it stands for.
#[derive(Debug, Clone, PartialEq, Default)]
struct Layout {
    scenes: Vec<(usize, i32)>,
}

/// How many analyses a scene stands for: members times ranges of speed.
fn analyses(plan: &Plan, scene: &Scene) -> usize {
    scene.members.len() * plan.speeds_of(scene.key)
}

impl ScreenTally {
    /// An empty tally of a plan, whose sets of constraints are the sets of changes.
    pub fn empty(plan: &Plan) -> Self {
        let sets = plan.labels.constraints.len();
        let scenes = plan.scenes.iter().map(|scene| (scene.key.constraints, analyses(plan, scene) as i32)).collect();
        let (means, counts) = (vec![IntegerMean::default(); sets], vec![0; sets]);
        Self {
            unstable: means.clone(),
            squealing: means.clone(),
            drops: vec![means.clone(); sets],
            squeal_drops: vec![means; sets],
            undecided: counts.clone(),
            divergent: counts,
            layout: Layout { scenes },
        }
    }
}

impl Merge for ScreenTally {
    fn merge(&mut self, later: Self) {
        let add = |mine: &mut Vec<IntegerMean>, later: Vec<IntegerMean>| {
            mine.iter_mut().zip(later).for_each(|(mine, later)| mine.merge(later));
        };
        let count = |mine: &mut Vec<u64>, later: Vec<u64>| {
            mine.iter_mut().zip(later).for_each(|(mine, later)| *mine += later);
        };
        add(&mut self.unstable, later.unstable);
        add(&mut self.squealing, later.squealing);
        self.drops.iter_mut().zip(later.drops).for_each(|(mine, later)| add(mine, later));
        self.squeal_drops.iter_mut().zip(later.squeal_drops).for_each(|(mine, later)| add(mine, later));
        count(&mut self.undecided, later.undecided);
        count(&mut self.divergent, later.divergent);
    }
}

impl<B: UncertainBrake> Tally<Study<'_, Modified<'_, B>>> for ScreenTally {
    fn record(&mut self, runs: &Runs<'_, Study<'_, Modified<'_, B>>>) {
        // Of a set in which a scene failed nothing is known of this sample.
        let mut sums: Vec<Option<[i32; 2]>> = vec![Some([0; 2]); self.unstable.len()];
        for (&(set, weight), result) in self.layout.scenes.iter().zip(runs.results) {
            match (result, &mut sums[set]) {
                (Ok(outcome), Some([unstable, squealing])) => {
                    *unstable += weight * outcome.unstable.len() as i32;
                    *squealing += weight * i32::from(!outcome.unstable.is_empty() || outcome.divergent > 0);
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
            for (other, less) in sums.iter().enumerate() {
                if let Some([less, less_squealing]) = *less {
                    self.drops[set][other].record(unstable - less);
                    self.squeal_drops[set][other].record(squealing - less_squealing);
                }
            }
        }
    }

    fn may_be_of(&self, samples: u64, _: &Failures) -> bool {
        self.unstable.iter().chain(&self.squealing).all(|mean| mean.count() <= samples)
    }
}

/// What a study of all scenes says of a set of changes; each number is of one analysis on average, with its 95 % interval.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Confirmed {
    /// Unstable modes.
    pub unstable: Estimate,
    /// By how much that is less than without changes, on the same draws.
    pub drop: Estimate,
    /// Part of the analyses with an unstable mode or divergence.
    pub squealing: Estimate,
    /// By how much that is less than without changes, on the same draws.
    pub squealing_drop: Estimate,
    /// Verdicts that the error bound leaves open; they count as stable.
    pub undecided: u64,
    /// Real eigenvalues above zero.
    pub divergent: u64,
    /// Samples of which all scenes could be analysed.
    pub samples: u64,
}

impl ScreenTally {
    /// What is known of a set; `None` without two samples.
    pub fn confirmed(&self, plan: &Plan, set: usize) -> Option<Confirmed> {
        let of_set = plan.scenes.iter().filter(|scene| scene.key.constraints == set);
        let by = of_set.map(|scene| analyses(plan, scene)).sum::<usize>() as f64;
        Some(Confirmed {
            unstable: estimate(&self.unstable[set], by)?,
            drop: estimate(&self.drops[0][set], by)?,
            squealing: estimate(&self.squealing[set], by)?,
            squealing_drop: estimate(&self.squeal_drops[0][set], by)?,
            undecided: self.undecided[set],
            divergent: self.divergent[set],
            samples: self.unstable[set].count(),
        })
    }

    /// By how much a set has more unstable modes than another, on the same draws.
    pub fn difference(&self, plan: &Plan, set: usize, less: usize) -> Option<Estimate> {
        let of_set = plan.scenes.iter().filter(|scene| scene.key.constraints == set);
        estimate(&self.drops[set][less], of_set.map(|scene| analyses(plan, scene)).sum::<usize>() as f64)
    }
}

fn estimate(mean: &IntegerMean, by: f64) -> Option<Estimate> {
    let (value, interval) = (mean.mean()?, mean.interval(Confidence::P95)?);
    Some(Estimate { value: value / by, lower: interval.lower / by, upper: interval.upper / by })
}
