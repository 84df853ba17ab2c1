//! Counts turned into occurrences, means and intervals.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, PoisonError};

use montecarlo::{
    BoundedMean, Bounds, Confidence, CountDifference, CountedSide, Estimate, LabelTally, Proportion, Summary, quantile,
};
use num_complex::Complex;
use study::{
    Comparison, ComparisonKind, DrawnInputs, FullChecks, ModeLabel, ModeNaming, ModeSource, Panel, Plan, Reference,
    Study, StudyTally, ThirdOctave, UncertainBrake, origin_of_set,
};

use crate::Error;

/// Occurrence of one mode in one arrangement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArrangementOccurrence {
    /// Index of the arrangement in its panel's list.
    pub arrangement: usize,
    /// Proportion of all samples: those in which the mode surely is unstable, and those in which it may be, because an unstable mode is
    /// this one or another, or because the sample could not be evaluated.
    pub proportion: Proportion,
    /// Number of samples that could not be evaluated, among them.
    pub failed: u64,
}

impl ArrangementOccurrence {
    /// Fraction of the samples in which the mode surely is unstable, with Wilson's 95 % interval; samples in which it is open
    /// which mode is unstable, and those that failed, widen the interval upwards.
    pub fn estimate(&self) -> Estimate {
        let value = self.proportion.estimate().map_or(0.0, |part| part.lower);
        let interval = self.proportion.interval(Confidence::P95);
        Estimate { value, lower: interval.lower, upper: interval.upper }
    }
}

/// Shapes by set of constraints and mode, each at chosen degrees of freedom with their names.
type WholeShapes = Vec<Vec<Vec<(String, Complex<f64>)>>>;

/// The results of a study.
pub struct Results {
    plan: Arc<Plan>,
    origins: Arc<[Reference]>,
    references: Arc<[Reference]>,
    /// Counts of the study.
    pub summary: Summary<StudyTally>,
    /// Naming of modes in the report.
    pub labels: ModeNaming,
    /// Names of the inputs that are drawn for its scenes, each once; none of a brake that does not tell them.
    pub(super) drawn: Arc<[String]>,
    /// Counts of draws of a reduced brake checked against the full model.
    pub full_checks: Option<FullChecks>,
    /// True if the brake finds its modes itself, in a band, and so shows no divergence.
    pub has_band_modes: bool,
    /// Shapes of the modes of each set of constraints at its origin in the full model of a reduced brake; `None` of another brake.
    pub(super) whole_shapes: Option<Arc<WholeShapes>>,
    /// Reason why nothing is known of the errors of each scene, where that is so.
    pub unknown_errors: Vec<Option<&'static str>>,
    /// Relative error of the eigenvalues of each scene against the full model; 0 for a brake that is not reduced.
    pub errors_of_reduction: Vec<f64>,
    panels: Vec<Panel>,
    comparisons: Vec<Comparison>,
    /// Notes beside the counts, for the manifest.
    notes: Mutex<Vec<String>>,
}

/// Names of the inputs that are drawn for the scenes of a plan, each once, the inputs of the first scene first.
fn drawn_names<S>(of: &dyn DrawnInputs<S>, plan: &Plan) -> Arc<[String]> {
    let mut known = BTreeSet::new();
    let names = plan.scenes.iter().flat_map(|scene| of.inputs(scene)).map(|input| input.name);
    names.filter(|name| known.insert(name.clone())).collect()
}

/// The modes of all origins, with the eigenvalues of the brake in place of the eigenvalues of the systems in which its modes are followed.
fn with_own_eigenvalues(plan: &Plan, origins: &[Reference], source: &dyn ModeSource) -> Arc<[Reference]> {
    let mut own = origins.to_vec();
    for set in 0..plan.labels.constraints.len() {
        let Some(origin) = origin_of_set(plan, set) else { continue };
        own[origin].modes.iter_mut().for_each(|mode| mode.lambda = source.eigenvalue_at_origin(set, mode.lambda));
    }
    own.into()
}

impl Results {
    /// The results of a finished run.
    pub fn new<B: UncertainBrake>(study: &Study<'_, B>, summary: Summary<StudyTally>) -> Self {
        Self::with_references(study, study.shared_references(), summary)
    }

    /// Results as by [`Results::new`], with reference modes of the scenes that are named in another way, as by
    /// [`Study::references_by_likeness`].
    pub fn with_references<B: UncertainBrake>(
        study: &Study<'_, B>,
        references: Arc<[Reference]>,
        summary: Summary<StudyTally>,
    ) -> Self {
        let plan = Arc::new(study.plan().clone());
        let panels = study::panels(&plan);
        let comparisons = study::comparisons(&plan, &panels);
        let source = study.brake().mode_source();
        let origins = study.shared_origin_references();
        let origins = source.map_or(Arc::clone(&origins), |source| with_own_eigenvalues(&plan, &origins, source));
        let (labels, full_checks, has_band_modes) =
            (plan.mode_labels, source.and_then(|source| source.full_checks()).cloned(), source.is_some());
        let unknown_errors =
            plan.scenes.iter().map(|scene| source.and_then(|source| source.unknown_error(scene))).collect();
        let errors_of_reduction = plan.scenes.iter().map(|scene| study.brake().error_of_reduction(scene)).collect();
        let of_set = |(set, source): (usize, &dyn ModeSource)| -> Vec<Vec<(String, Complex<f64>)>> {
            let modes = origin_of_set(&plan, set).map_or(&[][..], |origin| &origins[origin].modes);
            modes.iter().map(|mode| source.whole_shape(set, &mode.shape)).collect()
        };
        let whole_shapes = source
            .map(|source| Arc::new((0..plan.labels.constraints.len()).map(|set| of_set((set, source))).collect()));
        let drawn = study.brake().drawn_inputs().map_or_else(Default::default, |of| drawn_names(of, &plan));
        let notes = Mutex::default();
        Self {
            whole_shapes,
            labels,
            drawn,
            plan,
            origins,
            references,
            summary,
            full_checks,
            has_band_modes,
            unknown_errors,
            errors_of_reduction,
            panels,
            comparisons,
            notes,
        }
    }

    /// The results with modes named in another way, by the same counts.
    pub fn labelled(&self, labels: ModeNaming) -> Self {
        Self {
            labels,
            summary: self.summary.clone(),
            panels: self.panels.clone(),
            comparisons: self.comparisons.clone(),
            full_checks: self.full_checks.clone(),
            unknown_errors: self.unknown_errors.clone(),
            errors_of_reduction: self.errors_of_reduction.clone(),
            whole_shapes: self.whole_shapes.clone(),
            notes: Mutex::default(),
            drawn: Arc::clone(&self.drawn),
            plan: Arc::clone(&self.plan),
            origins: Arc::clone(&self.origins),
            references: Arc::clone(&self.references),
            ..*self
        }
    }

    /// The results of the laws `laws` alone, by the same counts: what a study of these laws would have counted. `laws` are indices in the plan's
    /// list, which stays as it is.
    pub fn of_laws(&self, laws: &[usize]) -> Self {
        let is_of = |at: usize| laws.contains(&self.panels[at].key.law);
        let kept: Vec<usize> = (0..self.panels.len()).filter(|&at| is_of(at)).collect();
        let mut summary = self.summary.clone();
        summary.tally.panels = kept.iter().map(|&at| self.summary.tally.panels[at]).collect();
        summary.tally.open_verdicts = kept.iter().map(|&at| self.summary.tally.open_verdicts[at]).collect();
        let place = |panel: usize| kept.binary_search(&panel).ok();
        let moved = |(comparison, mean): (&Comparison, &BoundedMean)| {
            let (more, fewer) = (place(comparison.more)?, place(comparison.fewer)?);
            Some((Comparison { more, fewer, ..*comparison }, *mean))
        };
        let compared = self.comparisons.iter().zip(&self.summary.tally.comparisons).filter_map(moved);
        let comparisons;
        (comparisons, summary.tally.comparisons) = compared.unzip();
        let panels = kept.iter().map(|&at| self.panels[at].clone()).collect();
        Self { summary, panels, comparisons, ..self.labelled(self.labels) }
    }

    /// Notes something for the manifest.
    pub fn note(&self, note: String) {
        self.notes.lock().unwrap_or_else(PoisonError::into_inner).push(note);
    }

    /// Notes so far.
    pub(super) fn notes(&self) -> Vec<String> {
        self.notes.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The modes of each origin of the plan.
    pub(super) fn origins(&self) -> &[Reference] {
        &self.origins
    }

    /// The reference modes of each scene.
    pub fn references(&self) -> &[Reference] {
        &self.references
    }

    /// Panels of the study, in the order of their keys.
    pub fn panels(&self) -> &[Panel] {
        &self.panels
    }

    /// Panels of a law under a constraint set, by speed range and number in contact.
    pub fn panels_of(&self, constraints: usize, law: usize) -> impl Iterator<Item = &Panel> {
        self.panels.iter().filter(move |panel| panel.key.constraints == constraints && panel.key.law == law)
    }

    /// Occurrences of every mode that is ever unstable in a panel, or may be, by its name, one entry per arrangement. Where an unstable mode
    /// has no name every mode of the scene may have been unstable, and is listed. Divergence and modes without a name are in
    /// [`other_occurrences`](Self::other_occurrences).
    pub fn occurrences(&self, panel: &Panel) -> BTreeMap<ModeLabel, Vec<ArrangementOccurrence>> {
        let seen = panel.scenes.iter().flat_map(|&scene| self.counts(scene).proportions());
        let set = panel.key.constraints;
        let mut names: BTreeSet<ModeLabel> = seen.map(|(&rank, _)| self.name(set, rank)).collect();
        let open = panel.scenes.iter().filter(|&&scene| has_any(self.counts(scene).unlabelled()));
        names.extend(open.flat_map(|&scene| self.references[scene].all_names()).map(|rank| self.name(set, rank)));
        names.into_iter().map(|name| (name, self.occurrences_of(panel, name))).collect()
    }

    /// Occurrences of all that is unstable in a panel, or may be, beside the modes with names: unstable modes without one, and
    /// divergence.
    pub fn other_occurrences(&self, panel: &Panel) -> BTreeMap<ModeLabel, Vec<ArrangementOccurrence>> {
        let is_seen = |&name: &ModeLabel| {
            let of_solved = panel.scenes.iter().map(|&scene| self.of_solved(scene, name));
            of_solved.into_iter().any(has_any)
        };
        let seen = [ModeLabel::UNNAMED, ModeLabel::DIVERGENCE].into_iter().filter(is_seen);
        seen.map(|name| (name, self.occurrences_of(panel, name))).collect()
    }

    /// Occurrences as by [`occurrences`](Self::occurrences), of every mode, whether it is ever unstable or not.
    pub fn all_occurrences(&self, panel: &Panel) -> BTreeMap<ModeLabel, Vec<ArrangementOccurrence>> {
        let mut all = self.occurrences(panel);
        for (name, _) in self.modes_of_set(panel.key.constraints) {
            all.entry(name).or_insert_with(|| self.occurrences_of(panel, name));
        }
        all
    }

    /// Occurrences as by [`all_occurrences`](Self::all_occurrences), and the [other ones](Self::other_occurrences).
    pub fn every_occurrence(&self, panel: &Panel) -> BTreeMap<ModeLabel, Vec<ArrangementOccurrence>> {
        let mut all = self.all_occurrences(panel);
        all.extend(self.other_occurrences(panel));
        all
    }

    /// Occurrences of one mode in a panel, whether it ever is unstable there or not, one entry per arrangement.
    pub fn occurrences_of(&self, panel: &Panel, name: ModeLabel) -> Vec<ArrangementOccurrence> {
        self.by_arrangement(panel, |scene| self.of_solved(scene, name))
    }

    /// Occurrence of any instability in a panel, a mode with a name or without or divergence, one entry per arrangement.
    pub fn any_occurrence(&self, panel: &Panel) -> Vec<ArrangementOccurrence> {
        self.by_arrangement(panel, |scene| self.summary.tally.scenes[scene].any())
    }

    /// Occurrence of any unstable mode of a third octave in a panel, with a name or without, one entry per arrangement.
    pub fn third_octave_occurrence(&self, panel: &Panel, octave: ThirdOctave) -> Vec<ArrangementOccurrence> {
        self.by_arrangement(panel, |scene| self.summary.tally.scenes[scene].in_third_octave(octave))
    }

    /// A proportion of the samples solved in each scene of a panel as one of all samples: one that failed may be anything.
    fn by_arrangement(&self, panel: &Panel, of_solved: impl Fn(usize) -> Proportion) -> Vec<ArrangementOccurrence> {
        let mut list = Vec::with_capacity(panel.arrangements);
        for &scene in &panel.scenes {
            let failed = self.failed(scene);
            let proportion = of_solved(scene).and_unknown(failed);
            let members = self.plan().scenes[scene].members.iter();
            list.extend(members.map(|&arrangement| ArrangementOccurrence { arrangement, proportion, failed }));
        }
        list.sort_by_key(|occurrence| occurrence.arrangement);
        list
    }

    /// Samples that could not be evaluated in a scene.
    pub fn failed(&self, scene: usize) -> u64 {
        let failures = &self.summary.failures;
        failures.draws() + failures.by_scene().get(scene).copied().unwrap_or(0)
    }

    /// Proportion of the samples solved in a scene in which a mode with this label, or divergence, is unstable.
    fn of_solved(&self, scene: usize, name: ModeLabel) -> Proportion {
        let tally = &self.summary.tally.scenes[scene];
        match name {
            ModeLabel::DIVERGENCE => tally.divergence(),
            // A frequency rank is a name that every mode has.
            ModeLabel::UNNAMED if self.labels != ModeNaming::Tracked => Proportion::of_counts(0, 0, tally.solved),
            ModeLabel::UNNAMED => tally.unnamed(),
            name if self.labels == ModeNaming::Tracked => self.counts(scene).proportion(&name),
            name => {
                let rank = self.rank_of(self.plan.scenes[scene].key.constraints, name);
                self.counts(scene).proportion(&ModeLabel::of_rank(rank))
            }
        }
    }

    fn counts(&self, scene: usize) -> &LabelTally<ModeLabel> {
        let tally = &self.summary.tally.scenes[scene];
        if self.labels == ModeNaming::Tracked { &tally.tracked } else { &tally.ranked }
    }

    /// The name of the mode of a frequency rank under a set of constraints.
    pub fn name(&self, constraints: usize, rank: ModeLabel) -> ModeLabel {
        self.labels.name(rank, self.modes_under(constraints))
    }

    /// The frequency rank of a mode of a set of constraints, whichever way it is named.
    pub fn rank_of(&self, constraints: usize, name: ModeLabel) -> usize {
        self.labels.rank(name, self.modes_under(constraints))
    }

    /// Number of modes under a set of constraints, an overdamped one counted once.
    pub fn modes_under(&self, constraints: usize) -> usize {
        let origin = origin_of_set(&self.plan, constraints);
        origin.map_or(0, |origin| self.plan.origins[origin].brake.dofs.free().len())
    }

    /// The tracked name, under which a scene's net work is kept, of a mode named as the report names it; `None` where the
    /// reference has no mode of this rank, or one whose name is open.
    pub fn tracked_name(&self, scene: usize, name: ModeLabel) -> Option<ModeLabel> {
        if self.labels == ModeNaming::Tracked {
            return Some(name);
        }
        let place = self.rank_of(self.plan.scenes[scene].key.constraints, name).checked_sub(1)?;
        match self.references[scene].names.get(place)?.as_slice() {
            &[only] => Some(only),
            _ => None,
        }
    }

    /// Median over the arrangements of a panel; its limits are the medians of the arrangements' limits.
    ///
    /// # Errors
    /// None for a panel that has arrangements.
    pub fn median(&self, occurrences: &[ArrangementOccurrence]) -> Result<Estimate, Error> {
        let estimates: Vec<Estimate> = occurrences.iter().map(ArrangementOccurrence::estimate).collect();
        let median = |of: fn(&Estimate) -> f64| {
            let mut values: Vec<f64> = estimates.iter().map(of).collect();
            values.sort_by(f64::total_cmp);
            quantile(&values, 0.5)
        };
        Ok(Estimate { value: median(|e| e.value)?, lower: median(|e| e.lower)?, upper: median(|e| e.upper)? })
    }

    /// Mean number of unstable modes and divergences in one CEA of a panel. In a sample of which an arrangement failed
    /// everything may be unstable and nothing surely is; a verdict that is open may be one more.
    pub fn mean_unstable(&self, panel: &Panel) -> Option<Estimate> {
        let at = self.panels.iter().position(|p| p.key == panel.key)?;
        let (solved, arrangements) = (&self.summary.tally.panels[at], panel.arrangements as f64);
        solved.mean()?;
        let open = self.summary.tally.open_verdicts[at] as f64 / solved.count() as f64;
        let greatest = self.most_unstable(panel) * arrangements;
        let bounds = Bounds::of_count(greatest, arrangements);
        let failed = self.summary.samples.saturating_sub(solved.count());
        let [least, most] = [0, greatest as i32].map(|of_failed| solved.and(of_failed, failed));
        let [lower, upper] = [least, most].map(|mean| mean.interval(bounds, Confidence::P95));
        let per_analysis = |sum: f64| sum / arrangements;
        let value = per_analysis(least.mean()?);
        Some(Estimate {
            value,
            lower: per_analysis(lower.lower),
            upper: per_analysis((upper.upper + open).min(greatest)),
        })
    }

    /// Number of modes that one CEA of a panel has: no more of them are unstable.
    fn most_unstable(&self, panel: &Panel) -> f64 {
        let modes = |&scene: &usize| self.plan.brake(&self.plan.scenes[scene]).dofs.free().len();
        panel.scenes.iter().map(modes).max().unwrap_or(0) as f64
    }

    /// Comparisons of one kind with the difference of the two means and its interval: positive where it is as expected.
    pub fn differences(
        &self,
        kind: ComparisonKind,
        confidence: Confidence,
    ) -> impl Iterator<Item = (&Panel, &Panel, Option<Estimate>)> + '_ {
        let of_kind = move |(comparison, _): &(&Comparison, &BoundedMean)| comparison.kind == kind;
        self.comparisons.iter().zip(&self.summary.tally.comparisons).filter(of_kind).map(move |(comparison, mean)| {
            let (more, fewer) = (&self.panels[comparison.more], &self.panels[comparison.fewer]);
            (more, fewer, self.difference(comparison, mean, confidence))
        })
    }

    /// Difference of two panels per analysis, from the difference in the samples solved in both; a sample that failed may have any difference.
    fn difference(&self, of: &Comparison, differences: &BoundedMean, confidence: Confidence) -> Option<Estimate> {
        let arrangements = |panel: usize| self.panels[panel].arrangements as f64;
        let failed = |solved: &BoundedMean| self.summary.samples.saturating_sub(solved.count());
        let side = |panel: usize, other: usize| {
            let (counts, step) = (&self.summary.tally.panels[panel], arrangements(panel));
            let greatest = self.most_unstable(&self.panels[panel]) * step;
            CountedSide { counts, failed: failed(counts), greatest, step, times: arrangements(other) }
        };
        let (more, fewer) = (side(of.more, of.fewer), side(of.fewer, of.more));
        let by = arrangements(of.more) * arrangements(of.fewer);
        let value = differences.mean()? / by;
        let limits = CountDifference { differences, failed: failed(differences), more, fewer }.interval(confidence);
        // A verdict that is open may be another one.
        let open = |panel: usize| {
            let tally = &self.summary.tally;
            tally.open_verdicts[panel] as f64 / tally.panels[panel].count().max(1) as f64 / arrangements(panel)
        };
        let (lower, upper) = (limits.lower / by - open(of.fewer), limits.upper / by + open(of.more));
        Some(Estimate { value, lower, upper })
    }

    /// Words for a panel in claims and summaries; of a brake without contacts their number is left out.
    pub fn describe(&self, panel: &Panel) -> String {
        let labels = &self.plan.labels;
        let speed = panel.key.speed.map_or("all speeds", |range| &labels.speeds[range].name);
        let contacts = match labels.panels[panel.key.panel].in_contact {
            0 => String::new(),
            number => format!("{number} in contact, "),
        };
        let (constraints, law) = (&labels.constraints[panel.key.constraints], &labels.laws[panel.key.law].name);
        format!("{constraints}, {law}, {contacts}{speed}")
    }
}

/// True if something is, or may be, in any trial.
fn has_any(found: Proportion) -> bool {
    found.hits() + found.ambiguous() > 0
}
