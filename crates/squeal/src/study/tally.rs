//! What is kept of the samples: counts, whose size does not depend on the number of samples.

use std::collections::BTreeMap;

use montecarlo::{IntegerMean, Merge, QuantileSketch, Runs};
use serde::{Deserialize, Serialize};

use super::compare::{Comparison, Panel, comparisons, panels};
use super::{Outcome, Plan, Study, UncertainBrake, UnstableMode};

/// Counts of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// One per scene.
    pub scenes: Vec<SceneTally>,
    /// Per panel, unstable modes summed over all arrangements, over samples solved in all of them.
    pub panels: Vec<IntegerMean>,
    /// Per comparison, the difference of the two sums, each times the number of arrangements of the other panel.
    pub comparisons: Vec<IntegerMean>,
    #[serde(skip)]
    layout: Layout,
}

/// How scenes make up panels; a part of the plan, not of the counts.
#[derive(Debug, Clone, PartialEq, Default)]
struct Layout {
    panels: Vec<Panel>,
    comparisons: Vec<Comparison>,
    weights: Vec<i32>,
}

/// Counts of one scene.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct SceneTally {
    /// Samples solved, those proven to be stable among them.
    pub solved: u64,
    /// Samples proven to be stable without a spectrum.
    pub certified: u64,
    /// Samples with any unstable mode or divergence.
    pub any_unstable: u64,
    /// Unstable modes in all samples.
    pub unstable_modes: u64,
    /// Those among them whose name is open.
    pub ambiguous_modes: u64,
    /// Real eigenvalues of the structure above zero.
    pub divergent: u64,
    /// Verdicts that the error bound leaves open.
    pub undecided: u64,
    /// Samples in which a tracked mode is unstable, by name.
    pub tracked: BTreeMap<u16, Hits>,
    /// Samples in which the mode of a frequency rank is unstable.
    pub ranked: BTreeMap<u16, Hits>,
    /// Net work of each body, by name of the mode, over the samples in which it is unstable and known by name.
    pub net_work: BTreeMap<u16, Vec<QuantileSketch>>,
    /// The same of each family of forces.
    pub family_work: BTreeMap<u16, Vec<Vec<QuantileSketch>>>,
}

/// In how many samples something is so, and in how many more it may be so.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Hits {
    /// Surely.
    pub sure: u64,
    /// Perhaps: an unstable mode may be this one or another.
    pub open: u64,
}

impl Tally {
    /// An empty tally of a plan.
    pub fn empty(plan: &Plan) -> Self {
        let panels = panels(plan);
        let comparisons = comparisons(plan, &panels);
        let weights = plan.scenes.iter().map(|scene| scene.members.len() as i32).collect();
        Self {
            scenes: vec![SceneTally::default(); plan.scenes.len()],
            panels: vec![IntegerMean::default(); panels.len()],
            comparisons: vec![IntegerMean::default(); comparisons.len()],
            layout: Layout { panels, comparisons, weights },
        }
    }
}

impl SceneTally {
    fn record(&mut self, outcome: &Outcome) {
        self.solved += 1;
        self.certified += u64::from(outcome.is_certified);
        self.any_unstable += u64::from(!outcome.unstable.is_empty() || outcome.divergent > 0);
        self.unstable_modes += outcome.unstable.len() as u64;
        self.divergent += u64::from(outcome.divergent);
        self.undecided += u64::from(outcome.undecided);
        for mode in &outcome.unstable {
            self.ranked.entry(mode.rank).or_default().sure += 1;
            if mode.names.len() != 1 {
                self.ambiguous_modes += 1;
            }
            if let (&[name], Some(work)) = (mode.names.as_slice(), &mode.work) {
                record_work(self.net_work.entry(name).or_default(), &work.net());
                let families = self.family_work.entry(name).or_default();
                families.resize_with(families.len().max(work.families.len()), Vec::new);
                families.iter_mut().zip(&work.families).for_each(|(bodies, work)| record_work(bodies, &work.bodies));
            }
        }
        for (name, is_sure) in unstable_names(&outcome.unstable) {
            let hits = self.tracked.entry(name).or_default();
            if is_sure {
                hits.sure += 1;
            } else {
                hits.open += 1;
            }
        }
    }

    fn merge(&mut self, later: Self) {
        self.solved += later.solved;
        self.certified += later.certified;
        self.any_unstable += later.any_unstable;
        self.unstable_modes += later.unstable_modes;
        self.ambiguous_modes += later.ambiguous_modes;
        self.divergent += later.divergent;
        self.undecided += later.undecided;
        for (mine, more) in [(&mut self.tracked, later.tracked), (&mut self.ranked, later.ranked)] {
            for (name, hits) in more {
                let entry = mine.entry(name).or_default();
                entry.sure += hits.sure;
                entry.open += hits.open;
            }
        }
        for (name, bodies) in later.net_work {
            self.net_work.entry(name).or_default().merge(bodies);
        }
        for (name, families) in later.family_work {
            self.family_work.entry(name).or_default().merge(families);
        }
    }
}

/// Enters the work on each body.
fn record_work(bodies: &mut Vec<QuantileSketch>, work: &[f64]) {
    bodies.resize_with(bodies.len().max(work.len()), QuantileSketch::default);
    bodies.iter_mut().zip(work).for_each(|(sketch, &value)| sketch.record(value));
}

/// Names of the unstable modes of one sample, and whether each is sure.
///
/// As many modes as a set of names has members, each open between just those, are all of them, whoever is who.
pub(crate) fn unstable_names(modes: &[UnstableMode]) -> BTreeMap<u16, bool> {
    let mut names = BTreeMap::new();
    for mode in modes {
        let alike = modes.iter().filter(|other| other.names == mode.names).count();
        let is_sure = !mode.names.is_empty() && alike >= mode.names.len();
        for &name in &mode.names {
            *names.entry(name).or_insert(false) |= is_sure;
        }
    }
    names
}

impl Merge for Tally {
    fn merge(&mut self, later: Self) {
        for (mine, more) in self.scenes.iter_mut().zip(later.scenes) {
            mine.merge(more);
        }
        for (mine, more) in self.panels.iter_mut().zip(later.panels) {
            mine.merge(more);
        }
        for (mine, more) in self.comparisons.iter_mut().zip(later.comparisons) {
            mine.merge(more);
        }
    }
}

impl<B: UncertainBrake> montecarlo::Tally<Study<'_, B>> for Tally {
    fn record(&mut self, runs: &Runs<'_, Study<'_, B>>) {
        for (tally, result) in self.scenes.iter_mut().zip(runs.results) {
            if let Ok(outcome) = result {
                tally.record(outcome);
            }
        }
        let Layout { panels, comparisons, weights } = &self.layout;
        let sum_of = |panel: &Panel| {
            let of_scene = |&scene: &usize| {
                runs.results[scene].as_ref().ok().map(|outcome| weights[scene] * outcome.unstable.len() as i32)
            };
            panel.scenes.iter().map(of_scene).sum::<Option<i32>>()
        };
        let sums: Vec<Option<i32>> = panels.iter().map(sum_of).collect();
        for (mean, sum) in self.panels.iter_mut().zip(&sums) {
            if let Some(sum) = *sum {
                mean.record(sum);
            }
        }
        for (mean, pair) in self.comparisons.iter_mut().zip(comparisons) {
            if let (Some(more), Some(fewer)) = (sums[pair.more], sums[pair.fewer]) {
                let (n, m) = (panels[pair.more].arrangements as i32, panels[pair.fewer].arrangements as i32);
                mean.record(more * m - fewer * n);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mode(names: &[u16]) -> UnstableMode {
        UnstableMode { rank: 1, names: names.to_vec(), work: None }
    }

    #[test]
    fn an_open_pair_is_sure_where_both_are_unstable() {
        let names = |modes: &[UnstableMode]| unstable_names(modes).into_iter().collect::<Vec<_>>();
        assert_eq!(names(&[mode(&[15]), mode(&[17])]), [(15, true), (17, true)]);
        assert_eq!(names(&[mode(&[15, 16])]), [(15, false), (16, false)]);
        assert_eq!(names(&[mode(&[15, 16]), mode(&[15, 16])]), [(15, true), (16, true)]);
        assert_eq!(names(&[mode(&[15, 16]), mode(&[16])]), [(15, false), (16, true)]);
        assert!(names(&[mode(&[])]).is_empty());
    }
}
