//! Counts of the samples of a study, whose size does not depend on the number of samples; and the samples, where they are asked for.

use std::collections::BTreeMap;
use std::ops::Range;

use montecarlo::{BoundedMean, Confidence, Failures, Merge, Proportion, Runs, distance, wilson};
use serde::{Deserialize, Serialize};

use super::comparison::{Comparison, Panel, comparisons, panels};
use super::{KeptSamples, ModeLabel, Outcome, Plan, SceneTally, Strength, Study, UncertainBrake};

/// Counts of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StudyTally {
    /// Tally of each scene.
    pub scenes: Vec<SceneTally>,
    /// Number of unstable modes and divergences in all arrangements of each panel together, over the samples solved in all of them.
    pub panels: Vec<BoundedMean>,
    /// Number of open verdicts in all arrangements of each panel together, over the same samples.
    pub open_verdicts: Vec<u64>,
    /// Difference of the numbers of `panels` for the two panels of each comparison, each times the number of arrangements of the other, so
    /// that it is a whole number.
    pub comparisons: Vec<BoundedMean>,
    /// Strength of each mode by its tracked name, where that is sure, over all evaluations of a set of constraints under a law: all laws of
    /// the first set, then all laws of the second, and so on. A symmetry class is evaluated once.
    pub strengths: Vec<BTreeMap<ModeLabel, Strength>>,
    /// Samples kept of each scene, in a study that keeps them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kept: Option<Vec<KeptSamples>>,
    #[serde(skip)]
    layout: PanelLayout,
}

/// Layout of panels: which scenes make up which panel. It follows from the plan and is not stored with the counts.
#[derive(Debug, Clone, PartialEq, Default)]
struct PanelLayout {
    panels: Vec<Panel>,
    comparisons: Vec<Comparison>,
    weights: Vec<i32>,
    /// Place of each scene in the strengths.
    groups: Vec<usize>,
}

impl StudyTally {
    /// An empty tally of a plan.
    pub fn empty(plan: &Plan) -> Self {
        let panels = panels(plan);
        let comparisons = comparisons(plan, &panels);
        let weights = plan.scenes.iter().map(|scene| scene.members.len() as i32).collect();
        let laws = plan.labels.laws.len();
        let groups = plan.scenes.iter().map(|scene| scene.key.constraints * laws + scene.key.law).collect();
        Self {
            scenes: vec![SceneTally::default(); plan.scenes.len()],
            panels: vec![BoundedMean::default(); panels.len()],
            open_verdicts: vec![0; panels.len()],
            comparisons: vec![BoundedMean::default(); comparisons.len()],
            strengths: vec![BTreeMap::new(); plan.labels.constraints.len() * laws],
            kept: None,
            layout: PanelLayout { panels, comparisons, weights, groups },
        }
    }

    /// An empty tally of a plan that keeps the samples too: its size grows with the number of unstable samples.
    pub fn keeping_samples(plan: &Plan) -> Self {
        Self { kept: Some(vec![KeptSamples::default(); plan.scenes.len()]), ..Self::empty(plan) }
    }
}

impl StudyTally {
    /// Largest distance of an occurrence from its estimate at a confidence, over all scenes and modes, seen or not; of modes that are tracked or, if not,
    /// named by rank. The fraction of the samples that failed or have an open verdict, any of which may be unstable in any mode, is added; the width that
    /// open names leave is not.
    #[must_use]
    pub fn distance(&self, failures: &Failures, is_tracked: bool, confidence: Confidence) -> f64 {
        let of_scene = |(scene, &failed): (&SceneTally, &u64)| {
            let counts = if is_tracked { &scene.tracked } else { &scene.ranked };
            // A mode that was never seen has no hit in as many trials.
            let unseen = if counts.trials() == 0 { 1.0 } else { upper_limit_of_none(counts.trials(), confidence) };
            let others = [scene.divergence(), if is_tracked { scene.unnamed() } else { Proportion::default() }];
            let all = counts.proportions().map(|(_, proportion)| proportion).chain(others);
            let sampled = all.filter(|of| of.trials() > 0).map(|of| distance(&of, confidence)).fold(unseen, f64::max);
            let failed = failed + failures.draws();
            let left_open = failed + scene.undecided.min(scene.solved);
            (sampled + left_open as f64 / (scene.solved + failed).max(1) as f64).min(1.0)
        };
        self.scenes.iter().zip(failures.by_scene()).map(of_scene).fold(0.0, f64::max)
    }
}

/// Wilson's upper limit of an event that occurred in no trial.
fn upper_limit_of_none(trials: u64, confidence: Confidence) -> f64 {
    wilson(0, trials, confidence).map_or(1.0, |interval| interval.upper)
}

impl StudyTally {
    /// Enters one sample: its outcome in each scene, where it has one.
    fn enter(&mut self, outcomes: &[Option<&Outcome>]) {
        for (tally, outcome) in self.scenes.iter_mut().zip(outcomes) {
            if let Some(outcome) = outcome {
                tally.record(outcome);
            }
        }
        let PanelLayout { panels, comparisons, weights, groups } = &self.layout;
        for (&group, outcome) in groups.iter().zip(outcomes) {
            for mode in outcome.iter().flat_map(|outcome| &outcome.unstable) {
                if let (&[name], Some(strengths)) = (mode.names.as_slice(), self.strengths.get_mut(group)) {
                    strengths.entry(name).or_default().record(mode.lambda);
                }
            }
        }
        let sum_of = |panel: &Panel, count: &dyn Fn(&Outcome) -> u32| {
            let of_scene = |&scene: &usize| outcomes[scene].map(|outcome| weights[scene] * count(outcome) as i32);
            panel.scenes.iter().map(of_scene).sum::<Option<i32>>()
        };
        let sums: Vec<Option<i32>> = panels.iter().map(|panel| sum_of(panel, &Outcome::instabilities)).collect();
        for (mean, sum) in self.panels.iter_mut().zip(&sums) {
            if let Some(sum) = *sum {
                mean.record(sum);
            }
        }
        for (open, panel) in self.open_verdicts.iter_mut().zip(panels) {
            *open += sum_of(panel, &|outcome| outcome.undecided).unwrap_or(0) as u64;
        }
        for (mean, pair) in self.comparisons.iter_mut().zip(comparisons) {
            if let (Some(more), Some(fewer)) = (sums[pair.more], sums[pair.fewer]) {
                let (n, m) = (panels[pair.more].arrangements as i32, panels[pair.fewer].arrangements as i32);
                mean.record(more * m - fewer * n);
            }
        }
    }
}

impl Merge for StudyTally {
    fn merge(&mut self, later: Self) {
        for (mine, more) in self.scenes.iter_mut().zip(later.scenes) {
            mine.merge(more);
        }
        for (mine, more) in self.panels.iter_mut().zip(later.panels) {
            mine.merge(more);
        }
        for (mine, more) in self.open_verdicts.iter_mut().zip(later.open_verdicts) {
            *mine += more;
        }
        for (mine, more) in self.comparisons.iter_mut().zip(later.comparisons) {
            mine.merge(more);
        }
        for (mine, more) in self.strengths.iter_mut().zip(later.strengths) {
            for (name, strength) in more {
                mine.entry(name).or_default().merge(strength);
            }
        }
        for (mine, more) in self.kept.iter_mut().flatten().zip(later.kept.into_iter().flatten()) {
            mine.merge(more);
        }
    }
}

impl<B: UncertainBrake> montecarlo::Tally<Study<'_, B>> for StudyTally {
    fn record(&mut self, runs: &Runs<'_, Study<'_, B>>) {
        let outcomes: Vec<Option<&Outcome>> = runs.results.iter().map(|result| result.as_ref().ok()).collect();
        for (kept, outcome) in self.kept.iter_mut().flatten().zip(&outcomes) {
            kept.record(runs.index, *outcome);
        }
        self.enter(&outcomes);
    }

    fn may_be_of(&self, samples: Range<u64>, failures: &Failures) -> bool {
        let count = samples.end - samples.start;
        let counted = |(tally, &failed): (&SceneTally, &u64)| {
            tally.solved.checked_add(failed + failures.draws()) == Some(count)
                && tally.certified <= tally.solved
                && tally.any_unstable + tally.perhaps_unstable <= tally.solved
                && tally.diverging + tally.perhaps_diverging <= tally.solved
                && tally.diverging <= tally.any_unstable
        };
        let may_be_kept = |(kept, tally): (&KeptSamples, &SceneTally)| {
            kept.may_be_of(&samples, [tally.any_unstable, tally.perhaps_unstable])
        };
        self.scenes.len() == failures.by_scene().len()
            && self.scenes.iter().zip(failures.by_scene()).all(counted)
            && self.kept.as_ref().is_none_or(|kept| kept.len() == self.scenes.len())
            && self.kept.iter().flatten().zip(&self.scenes).all(may_be_kept)
    }
}

/// Counts of a study with [`StudyOptions::likeness_too`](super::StudyOptions): with modes named by the plan, and the same
/// samples with modes known by MAC.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TwiceNamedTally {
    /// Counts by the names of the plan.
    pub by_plan: StudyTally,
    /// Counts by the names that MAC gives.
    pub by_likeness: StudyTally,
}

impl TwiceNamedTally {
    /// An empty tally of a plan.
    pub fn empty(plan: &Plan) -> Self {
        Self { by_plan: StudyTally::empty(plan), by_likeness: StudyTally::empty(plan) }
    }
}

impl Merge for TwiceNamedTally {
    fn merge(&mut self, later: Self) {
        self.by_plan.merge(later.by_plan);
        self.by_likeness.merge(later.by_likeness);
    }
}

impl<B: UncertainBrake> montecarlo::Tally<Study<'_, B>> for TwiceNamedTally {
    fn record(&mut self, runs: &Runs<'_, Study<'_, B>>) {
        self.by_plan.record(runs);
        let alike = |outcome: &Outcome| {
            let mut outcome = outcome.clone();
            for mode in &mut outcome.unstable {
                mode.names = mode.names_by_likeness.take().unwrap_or_default();
            }
            for mode in &mut outcome.open {
                mode.names = mode.names_by_likeness.take().unwrap_or_default();
            }
            outcome
        };
        let outcomes: Vec<Option<Outcome>> =
            runs.results.iter().map(|result| result.as_ref().ok().map(alike)).collect();
        self.by_likeness.enter(&outcomes.iter().map(Option::as_ref).collect::<Vec<_>>());
    }
}
