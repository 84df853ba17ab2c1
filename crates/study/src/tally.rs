//! Counts of the samples of a study, whose size does not depend on the number of samples; and the samples, where they are asked for.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use montecarlo::{
    BoundedMean, Confidence, Failures, LabelTally, Merge, Proportion, QuantileSketch, Runs, Trial, distance,
    occurring_labels, wilson,
};
use serde::{Deserialize, Serialize};

use super::comparison::{Comparison, Panel, comparisons, panels};
use super::third_octave::{InThirdOctave, ThirdOctave};
use super::{KeptSamples, ModeLabel, Outcome, Plan, Strength, Study, UncertainBrake, UnstableMode};

/// Counts of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StudyTally {
    /// Tally of each scene.
    pub scenes: Vec<SceneTally>,
    /// Number of unstable modes and divergences in all arrangements of each panel together, over the samples solved in all of them.
    pub panels: Vec<BoundedMean>,
    /// Difference of the numbers of `panels` for the two panels of each comparison, each times the number of arrangements of the other, so
    /// that it is a whole number.
    pub comparisons: Vec<BoundedMean>,
    /// Strength of each mode by its tracked name, where that is sure, over all evaluations of a set of constraints under a law: all laws of
    /// the first set, then those of the second, and so on. A symmetry class is evaluated once.
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

/// Counts of one scene.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct SceneTally {
    /// Samples solved, those that a certificate covers among them.
    pub solved: u64,
    /// Samples that a certificate covers: stable up to rounding, without a spectrum.
    pub certified: u64,
    /// Samples with any unstable mode or divergence.
    pub any_unstable: u64,
    /// Samples in which nothing surely is unstable and a verdict is open.
    pub perhaps_unstable: u64,
    /// Unstable modes in all samples.
    pub unstable_modes: u64,
    /// Number of the unstable modes that have not one sure name: they pass near a coalescence, or began to oscillate on the path.
    pub ambiguous_modes: u64,
    /// Real eigenvalues surely beyond the threshold.
    pub divergent: u64,
    /// Samples with a real eigenvalue surely beyond the threshold.
    pub diverging: u64,
    /// Samples in which no real eigenvalue surely is beyond the threshold, and the verdict on one is open.
    pub perhaps_diverging: u64,
    /// Verdicts that the error bound leaves open.
    pub undecided: u64,
    /// Eigenvalues on the imaginary axis to within rounding of the matrices.
    pub marginal: u64,
    /// Unstable modes of a reduced brake whose residual in the full model is known.
    pub residuals: u64,
    /// Unstable modes whose residual in the full model is above the one that was asked for.
    pub residuals_above: u64,
    /// Largest relative residual of an unstable mode in the full model.
    pub largest_residual: f64,
    /// Samples in which any mode of a third octave is unstable, or may be.
    pub third_octaves: BTreeMap<ThirdOctave, InThirdOctave>,
    /// Samples in which a tracked mode is unstable, by name; ambiguous where an unstable mode may be this one or another, or has
    /// no name and may be any.
    pub tracked: LabelTally<ModeLabel>,
    /// Samples in which the mode of a frequency rank is unstable.
    pub ranked: LabelTally<ModeLabel>,
    /// Net work of each body in one period per `phi^H M phi`, 1/s^2, by name of the mode, over the samples in which it is
    /// unstable and known by name; one sketch for each body of the scene's brake.
    pub net_work: BTreeMap<ModeLabel, Vec<QuantileSketch>>,
    /// Net work as in `net_work`, told apart by family of forces, in the order of `AffineSystem::families`: of each family the bodies.
    pub family_work: BTreeMap<ModeLabel, Vec<Vec<QuantileSketch>>>,
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
            comparisons: vec![BoundedMean::default(); comparisons.len()],
            strengths: vec![BTreeMap::new(); plan.labels.constraints.len() * laws],
            kept: None,
            layout: PanelLayout { panels, comparisons, weights, groups },
        }
    }

    /// An empty tally of a plan that keeps the samples too: its size grows with those that are unstable.
    pub fn keeping_samples(plan: &Plan) -> Self {
        Self { kept: Some(vec![KeptSamples::default(); plan.scenes.len()]), ..Self::empty(plan) }
    }
}

impl StudyTally {
    /// Largest distance of an occurrence from its estimate at a confidence, over all scenes and modes, seen or not; of modes that are
    /// tracked or, if not, named by rank. The width that open names leave is not in it.
    #[must_use]
    pub fn distance(&self, is_tracked: bool, confidence: Confidence) -> f64 {
        let of_scene = |scene: &SceneTally| {
            let counts = if is_tracked { &scene.tracked } else { &scene.ranked };
            // A mode that was never seen has no hit in as many trials.
            let unseen = if counts.trials() == 0 { 1.0 } else { upper_limit_of_none(counts.trials(), confidence) };
            let others = [scene.divergence(), if is_tracked { scene.unnamed() } else { Proportion::default() }];
            let all = counts.proportions().map(|(_, proportion)| proportion).chain(others);
            all.filter(|of| of.trials() > 0).map(|of| distance(&of, confidence)).fold(unseen, f64::max)
        };
        self.scenes.iter().map(of_scene).fold(0.0, f64::max)
    }
}

/// Wilson's upper limit of an event that occurred in no trial.
fn upper_limit_of_none(trials: u64, confidence: Confidence) -> f64 {
    wilson(0, trials, confidence).map_or(1.0, |interval| interval.upper)
}

impl SceneTally {
    /// Samples in which anything is unstable, those with open verdicts as ambiguous.
    pub fn any(&self) -> Proportion {
        Proportion::of_counts(self.any_unstable, self.perhaps_unstable, self.solved)
    }

    /// Samples with divergence.
    pub fn divergence(&self) -> Proportion {
        Proportion::of_counts(self.diverging, self.perhaps_diverging, self.solved)
    }

    /// Samples with an unstable mode that has no name as a tracked mode.
    pub fn unnamed(&self) -> Proportion {
        Proportion::of_counts(self.tracked.unlabelled(), 0, self.solved)
    }

    fn record(&mut self, outcome: &Outcome) {
        self.solved += 1;
        self.certified += u64::from(outcome.is_certified);
        self.any_unstable += u64::from(outcome.is_unstable());
        self.perhaps_unstable += u64::from(outcome.may_be_unstable());
        self.unstable_modes += outcome.unstable.len() as u64;
        self.divergent += u64::from(outcome.divergent);
        self.diverging += u64::from(outcome.divergent > 0);
        self.perhaps_diverging += u64::from(outcome.divergent == 0 && outcome.undecided_real > 0);
        self.undecided += u64::from(outcome.undecided);
        self.record_third_octaves(outcome);
        self.marginal += u64::from(outcome.marginal);
        for mode in &outcome.unstable {
            if let Some(residual) = mode.residual {
                self.residuals += 1;
                self.residuals_above += u64::from(residual.is_above);
                self.largest_residual = self.largest_residual.max(residual.value);
            }
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
        self.ranked.record(&outcome.unstable.iter().map(|mode| [mode.rank]).collect::<Vec<_>>());
        self.tracked.record(&candidate_names(&outcome.unstable));
    }

    /// Enters the third octaves in which a mode is unstable, or may be.
    fn record_third_octaves(&mut self, outcome: &Outcome) {
        let of = |omegas: &mut dyn Iterator<Item = f64>| -> BTreeSet<ThirdOctave> {
            omegas.filter(|omega| *omega > 0.0).map(ThirdOctave::of_omega).collect()
        };
        let unstable = of(&mut outcome.unstable.iter().map(|mode| mode.lambda.im));
        let perhaps = of(&mut outcome.undecided_omegas.iter().copied());
        for &octave in &unstable {
            self.third_octaves.entry(octave).or_default().unstable += 1;
        }
        for &octave in perhaps.difference(&unstable) {
            self.third_octaves.entry(octave).or_default().perhaps += 1;
        }
    }

    /// Samples in which any mode of a third octave is unstable, those with open verdicts there as ambiguous.
    pub fn in_third_octave(&self, octave: ThirdOctave) -> Proportion {
        let InThirdOctave { unstable, perhaps } = self.third_octaves.get(&octave).copied().unwrap_or_default();
        Proportion::of_counts(unstable, perhaps, self.solved)
    }

    fn merge(&mut self, later: Self) {
        for (octave, InThirdOctave { unstable, perhaps }) in later.third_octaves {
            let own = self.third_octaves.entry(octave).or_default();
            (own.unstable, own.perhaps) = (own.unstable + unstable, own.perhaps + perhaps);
        }
        self.solved += later.solved;
        self.certified += later.certified;
        self.any_unstable += later.any_unstable;
        self.perhaps_unstable += later.perhaps_unstable;
        self.unstable_modes += later.unstable_modes;
        self.ambiguous_modes += later.ambiguous_modes;
        self.divergent += later.divergent;
        self.diverging += later.diverging;
        self.perhaps_diverging += later.perhaps_diverging;
        self.undecided += later.undecided;
        self.marginal += later.marginal;
        self.residuals += later.residuals;
        self.residuals_above += later.residuals_above;
        self.largest_residual = self.largest_residual.max(later.largest_residual);
        self.tracked.merge(later.tracked);
        self.ranked.merge(later.ranked);
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

/// Names of unstable modes, from the candidate names of each; the value says whether the name is sure. A mode without a name may be any
/// of `all`, and is listed as unnamed.
pub(crate) fn unstable_names(candidates: &[impl AsRef<[ModeLabel]>], all: &[ModeLabel]) -> BTreeMap<ModeLabel, bool> {
    let known = occurring_labels(candidates).into_iter().map(|(name, trial)| (name, trial == Trial::Yes));
    let mut names: BTreeMap<ModeLabel, bool> = known.collect();
    if candidates.iter().any(|names| names.as_ref().is_empty()) {
        for &name in all {
            names.entry(name).or_insert(false);
        }
        names.insert(ModeLabel::UNNAMED, true);
    }
    names
}

impl Outcome {
    /// True if anything surely is unstable.
    #[must_use]
    pub fn is_unstable(&self) -> bool {
        self.instabilities() > 0
    }

    /// True if nothing surely is unstable, and a verdict is open.
    #[must_use]
    pub fn may_be_unstable(&self) -> bool {
        !self.is_unstable() && self.undecided > 0
    }

    /// Number of unstable modes and divergences.
    #[must_use]
    pub fn instabilities(&self) -> u32 {
        self.unstable.len() as u32 + self.divergent
    }

    /// Names of all that is unstable, each with whether it is sure; divergence is listed as [`ModeLabel::DIVERGENCE`].
    pub(crate) fn unstable_names(&self, all: &[ModeLabel]) -> BTreeMap<ModeLabel, bool> {
        let mut names = unstable_names(&candidate_names(&self.unstable), all);
        if self.divergent > 0 || self.undecided_real > 0 {
            names.insert(ModeLabel::DIVERGENCE, self.divergent > 0);
        }
        names
    }
}

fn candidate_names(modes: &[UnstableMode]) -> Vec<&[ModeLabel]> {
    modes.iter().map(|mode| mode.names.as_slice()).collect()
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
        let sum_of = |panel: &Panel| {
            let of_scene =
                |&scene: &usize| outcomes[scene].map(|outcome| weights[scene] * outcome.instabilities() as i32);
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

impl Merge for StudyTally {
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
            outcome
        };
        let outcomes: Vec<Option<Outcome>> =
            runs.results.iter().map(|result| result.as_ref().ok().map(alike)).collect();
        self.by_likeness.enter(&outcomes.iter().map(Option::as_ref).collect::<Vec<_>>());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_complex::Complex;

    fn labels(numbers: &[u16]) -> Vec<ModeLabel> {
        numbers.iter().copied().map(ModeLabel::new).collect()
    }

    fn unstable(names: &[&[u16]]) -> Vec<UnstableMode> {
        let mode = |(names, rank): (&&[u16], u16)| UnstableMode {
            rank: ModeLabel::new(rank),
            lambda: Complex::new(1.0, 100.0),
            names: labels(names),
            names_by_likeness: None,
            work: None,
            residual: None,
        };
        names.iter().zip(1..).map(mode).collect()
    }

    #[test]
    fn an_unstable_mode_without_a_name_is_in_the_upper_limit_of_every_mode_that_it_could_be() {
        let mut tally = SceneTally::default();
        for modes in [unstable(&[&[1], &[]]), unstable(&[&[1], &[2, 3]])] {
            (0..100).for_each(|_| tally.record(&Outcome { unstable: modes.clone(), ..Outcome::default() }));
        }
        let counts = |name: u16| {
            let proportion = tally.tracked.proportion(&ModeLabel::new(name));
            (proportion.hits(), proportion.ambiguous())
        };
        assert_eq!([1, 2, 3, 4].map(counts), [(200, 0), (0, 200), (0, 200), (0, 100)]);
        assert_eq!(tally.ambiguous_modes, 200);
        // A mode that was never seen by name may be unstable half of the time.
        let never = tally.tracked.interval(&ModeLabel::new(4), Confidence::P95);
        assert!(never.lower == 0.0 && never.upper > 0.5, "{never:?}");
        assert_eq!(tally.ranked.proportion(&ModeLabel::new(2)).ambiguous(), 0);
    }

    #[test]
    fn names_of_a_mode_without_one_are_open() {
        let names = |modes: &[&[u16]]| {
            let candidates: Vec<Vec<ModeLabel>> = modes.iter().map(|names| labels(names)).collect();
            let found = unstable_names(&candidates, &labels(&[1, 2, 3]));
            found.into_iter().map(|(name, is_sure)| (name.to_string(), is_sure)).collect::<Vec<_>>()
        };
        let expected = |names: &[(&str, bool)]| -> Vec<(String, bool)> {
            names.iter().map(|(name, is_sure)| ((*name).to_owned(), *is_sure)).collect()
        };
        let one_unnamed = [("1", false), ("2", true), ("3", false), ("unnamed", true)];
        assert_eq!(names(&[&[2], &[]]), expected(&one_unnamed));
        let all_unnamed = [("1", false), ("2", false), ("3", false), ("unnamed", true)];
        assert_eq!(names(&[&[], &[], &[]]), expected(&all_unnamed));
        assert_eq!(names(&[&[2], &[1, 3]]), expected(&one_unnamed[..3]));
        assert!(names(&[]).is_empty());
    }
}
