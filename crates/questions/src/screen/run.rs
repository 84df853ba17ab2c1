//! A screening from the candidates to the confirmation of the best.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use cea::EigenSolver;
use montecarlo::{Checkpoint, MonteCarloError, Progress, Sampling, run_with};
use study::identity::{Written, of_study};
use study::{Study, UncertainBrake, samples_together};

use super::candidates::{Candidates, ChangeKind, Sizes};
use super::confirm::ScreenTally;
use super::criterion::Criterion;
use super::growing::growing_modes;
use super::joined::checks_of;
use super::modified::{ChangeSet, Modified};
use super::predict::{Prediction, Probes};
use super::ranking::{KindRanking, Ranked, combinations, search};
use super::screened::{Screen, ScreenedSet};
use super::sounded::Sounded;
use crate::Error;
use crate::cycles::{CycleOptions, Following, UntilStopped, when_cancelled};

/// Version of the counts. It changes when checkpoints of an older program can no longer be continued.
const TALLY_VERSION: u32 = 6;
/// Time between two checkpoints; chosen, as that of a run.
const CHECKPOINT_EVERY: Duration = Duration::from_secs(5);

/// Options of a screening.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ScreenOptions {
    /// Index of the set of constraints that is changed, in the plan.
    pub constraints: usize,
    /// Kinds of changes, each once.
    pub kinds: Vec<ChangeKind>,
    /// Sizes of masses, springs and dashpots.
    pub sizes: Sizes,
    /// Number of places that a set has at most, >= 1.
    pub up_to: usize,
    /// Number of draws of the prediction, >= 1.
    pub draws: u64,
    /// Number of single changes of each kind that are confirmed.
    pub confirmed: usize,
    /// Criterion of the ranking.
    pub criterion: Criterion,
    /// Number of sets of constraints of the plan that are variants, the last ones: as [`Joined`](super::Joined) has them.
    pub variants: usize,
}

impl Default for ScreenOptions {
    /// Options with all kinds of changes of the first set of constraints, in sizes in proportion, singly and in pairs, by eight draws; the
    /// best of each kind is confirmed.
    fn default() -> Self {
        let kinds = ChangeKind::ALL.to_vec();
        Self {
            constraints: 0,
            kinds,
            sizes: Sizes::default(),
            up_to: 2,
            draws: 8,
            confirmed: 1,
            criterion: Criterion::default(),
            variants: 0,
        }
    }
}

impl ScreenOptions {
    /// Settings by which motions are followed until `stop` is set, where the criterion asks for them.
    fn following(&self, stop: Arc<AtomicBool>) -> Option<UntilStopped> {
        (self.criterion == Criterion::Loudness).then(|| (Following::of_screen(CycleOptions::default().stick), stop))
    }

    /// Writes out the options that tell a screening from others of the same brake.
    pub fn written(&self, to: &mut Written) {
        let Self { constraints, kinds, sizes, up_to, draws, confirmed, criterion, variants } = self;
        let Sizes { mass, spring, dashpot, factor } = sizes;
        to.count(*constraints);
        to.list(kinds, |to, kind| to.text(kind.name()));
        [mass, spring, dashpot].into_iter().for_each(|size| to.option(*size, Written::number));
        to.count(*up_to);
        to.text(&draws.to_string());
        to.count(*confirmed);
        to.text(criterion.name());
        // What older folders do not have says nothing.
        if kinds.contains(&ChangeKind::Scale) {
            to.option(*factor, Written::number);
        }
        if *variants > 0 {
            to.count(*variants);
        }
    }
}

/// Ranking of all changes by prediction.
pub struct Ranking {
    /// Prediction for the brake without changes.
    pub unchanged: Prediction,
    /// Ranking of each kind of changes.
    pub kinds: Vec<KindRanking>,
    /// Number of analyses for each set of changes.
    pub analyses_per_set: u64,
    /// Number of draws of the prediction.
    pub draws: u64,
}

/// Ranks the changes of a brake. Progress counts combinations of changes; one that makes a set that is known already costs nothing.
///
/// # Errors
/// A draw without an operating point; a brake that cannot be analysed without changes.
pub fn rank<B: UncertainBrake>(brake: &B, options: &ScreenOptions, progress: &dyn Progress) -> Result<Ranking, Error> {
    let ScreenOptions { constraints, kinds, sizes, up_to, draws, criterion, .. } = options;
    let candidates = Candidates::all(brake, *constraints, kinds, sizes)?;
    progress.begin(candidates.iter().map(|of_kind| combinations(of_kind, *up_to)).sum(), 0);
    let ranking = when_cancelled(progress, |stop| {
        let probes = Probes::new(brake, *constraints, *draws, options.following(stop))?;
        let unchanged = probes.prediction(&[Vec::new()])?;
        let of_kind = |candidates| search(candidates, &probes, *up_to, *criterion, progress);
        let kinds = candidates.into_iter().map(of_kind).collect();
        Ok(Ranking { unchanged, kinds, analyses_per_set: probes.analyses(), draws: *draws })
    });
    progress.end();
    ranking
}

/// Options of the confirmation of the best of a ranking.
#[non_exhaustive]
pub struct Confirmation<'a> {
    /// Solver of spectra: [`cea::BatchSolver`] unless another is given.
    pub solver: &'a dyn EigenSolver,
    /// Number of draws, >= 2.
    pub samples: u64,
    /// Number of worker threads, on which the result does not depend.
    pub threads: Option<usize>,
    /// Path of the file in which the state is kept, so that a run that was stopped goes on.
    pub checkpoint: Option<PathBuf>,
    /// Progress of the steps before the first sample.
    pub preparation: &'a dyn Progress,
    /// Progress of the evaluations.
    pub evaluation: &'a dyn Progress,
}

impl<'a> Confirmation<'a> {
    /// A confirmation by this many draws, >= 2, on one worker a core, without a checkpoint; nobody is told.
    #[must_use]
    pub fn new(samples: u64) -> Self {
        Self { solver: &cea::BatchSolver, samples, threads: None, checkpoint: None, preparation: &(), evaluation: &() }
    }

    /// The confirmation with another solver of spectra.
    #[must_use]
    pub fn with_solver(self, solver: &'a dyn EigenSolver) -> Self {
        Self { solver, ..self }
    }

    /// The confirmation with a number of worker threads; `None` is one a core.
    #[must_use]
    pub fn with_threads(self, threads: Option<usize>) -> Self {
        Self { threads, ..self }
    }

    /// The confirmation with a file in which its state is kept.
    #[must_use]
    pub fn with_checkpoint(self, checkpoint: Option<PathBuf>) -> Self {
        Self { checkpoint, ..self }
    }

    /// The confirmation with receivers of the progress of the steps before the first sample and of the evaluations, which can
    /// [cancel](Progress::is_cancelled) it.
    #[must_use]
    pub fn with_progress(self, preparation: &'a dyn Progress, evaluation: &'a dyn Progress) -> Self {
        Self { preparation, evaluation, ..self }
    }
}

/// Confirms the best of a ranking by a study of all scenes: the brake as it is, its other sets of constraints, the best single
/// changes of each kind, and of each larger size the best set and the best symmetric one, all on the same draws.
///
/// # Errors
/// Those of the study.
pub fn confirm<B: UncertainBrake>(
    brake: &B,
    ranking: Ranking,
    options: &ScreenOptions,
    how: &Confirmation<'_>,
) -> Result<Screen, Error> {
    let mut sets = screened(brake, &ranking, options);
    let to_confirm: Vec<usize> = (0..sets.len()).filter(|&at| sets[at].confirmation.is_some()).collect();
    let changes: Vec<ChangeSet> = to_confirm.iter().map(|&at| sets[at].changes.clone()).collect();
    let modified = Modified::new(brake, &changes)?;
    let pool = montecarlo::workers(how.threads)?;
    let study = pool.install(|| Study::with_progress(&modified, how.solver, how.preparation))?;
    let plan = study.plan();
    let mut sampling = Sampling::new(plan.seed, how.samples);
    sampling.threads = how.threads;
    sampling.block = samples_together(how.samples);
    let empty = || ScreenTally::empty(plan);
    let checkpoint = how.checkpoint.as_ref().map(|path| Checkpoint {
        path: path.clone(),
        every: CHECKPOINT_EVERY,
        fingerprint: of_study(&modified).given("format", TALLY_VERSION).into_line(),
    });
    let other = |error| match error {
        MonteCarloError::CheckpointMismatch { path, field: "experiment", found, expected } => {
            Error::OtherStudy { path, found, wanted: expected }
        }
        other => other.into(),
    };
    // A sample whose motions are stopped is one of a block that the run, which is cancelled, leaves out.
    let summary = when_cancelled(how.evaluation, |stop| {
        let sounded = Sounded { study: &study, following: options.following(stop) };
        run_with(&sounded, &sampling, empty, checkpoint.as_ref(), how.evaluation).map_err(other)
    })?;
    for (confirmation, &at) in to_confirm.iter().enumerate() {
        sets[at].confirmed = summary.tally.confirmed(plan, confirmation, how.samples);
    }
    let count = to_confirm.len();
    let of_set = |set: usize| (0..count).map(|less| summary.tally.difference(plan, set, less, how.samples)).collect();
    let differences = (0..count).map(of_set).collect();
    let failures =
        summary.failures.draws() * plan.scenes.len() as u64 + summary.failures.by_scene().iter().sum::<u64>();
    // Variants by their effect, the largest first.
    let effect = |set: &ScreenedSet| set.confirmed.as_ref().map_or(-1.0, |found| options.criterion.effect(found));
    let first = sets.iter().position(ScreenedSet::is_variant).unwrap_or(0);
    sets[first..first + options.variants].sort_by(|a, b| effect(b).total_cmp(&effect(a)));
    Ok(Screen {
        criterion: options.criterion,
        sets,
        differences,
        unchanged: ranking.unchanged,
        failed: ranking.kinds.iter().flat_map(|of_kind| of_kind.failed.clone()).collect(),
        predicted_sets: ranking.kinds.iter().map(|of_kind| of_kind.sets).sum(),
        combinations: ranking.kinds.iter().map(|of_kind| of_kind.combinations).sum(),
        analyses_per_set: ranking.analyses_per_set,
        prediction_draws: ranking.draws,
        samples: how.samples,
        scenes: plan.scenes.len() as u64,
        failures,
        growing: growing_modes(&study, 0)?,
        doubts: doubts_of(brake, options),
    })
}

/// Doubt of every change of a reduced brake but a variant.
const ON_ITS_BASIS: &str = "changed brakes are computed on the basis of the brake as it is. A mode that a change brings into the band, or bends beyond that basis, is missing from what is \
     predicted and confirmed, and limits leave that out: as large masses and stiff springs do. --variants has the change in a case of its own, with a basis of its own";

/// Doubts of a brake, each once: of brakes that are joined their plan has those by their checks.
fn doubts_of<B: UncertainBrake>(brake: &B, options: &ScreenOptions) -> Vec<String> {
    let plan = brake.plan();
    let of_holds = plan.doubt_of_holds.iter().filter(|_| options.kinds.contains(&ChangeKind::Constraint));
    let mut doubts: Vec<String> = plan.doubts.iter().chain(of_holds).cloned().collect();
    let more: Vec<String> = checks_of(brake).into_iter().filter(|doubt| !doubts.contains(doubt)).collect();
    doubts.extend(more);
    let are_changes = options.kinds.iter().any(|kind| *kind != ChangeKind::Variant);
    doubts.extend((brake.mode_source().is_some() && are_changes).then(|| ON_ITS_BASIS.to_owned()));
    doubts
}

/// Sets that a screening has in its tables, all of them; those to be confirmed have their indices.
fn screened<B: UncertainBrake>(brake: &B, ranking: &Ranking, options: &ScreenOptions) -> Vec<ScreenedSet> {
    let (plan, mut sets) = (brake.plan(), Vec::new());
    let names = &plan.labels.constraints;
    let others = (0..names.len()).filter(|&set| set != options.constraints);
    for (confirmation, of) in [options.constraints].into_iter().chain(others).enumerate() {
        let is_variant = of >= names.len() - options.variants;
        sets.push(ScreenedSet {
            kind: is_variant.then_some(ChangeKind::Variant),
            places: names[of].clone(),
            count: if is_variant { 1 } else { held(brake, of).saturating_sub(held(brake, options.constraints)) },
            sizes: Vec::new(),
            prediction: (confirmation == 0).then_some(ranking.unchanged),
            changes: ChangeSet { name: names[of].clone(), of, changes: Vec::new() },
            confirmation: Some(confirmation),
            confirmed: None,
        });
    }
    let mut confirmed = sets.len();
    for KindRanking { candidates, singles, best, symmetric, .. } in &ranking.kinds {
        let mut add = |ranked: &Ranked, is_confirmed: bool| {
            let places = candidates.name(&ranked.singles);
            let confirmation = is_confirmed.then_some(confirmed);
            confirmed += usize::from(is_confirmed);
            sets.push(ScreenedSet {
                kind: Some(candidates.kind),
                count: ranked.singles.len(),
                sizes: candidates.sizes(&ranked.singles, plan.units),
                prediction: Some(ranked.prediction),
                changes: ChangeSet {
                    name: format!("{} {places}", candidates.kind.name()),
                    of: options.constraints,
                    changes: candidates.changes(&ranked.singles),
                },
                places,
                confirmation,
                confirmed: None,
            });
        };
        for (best, symmetric) in best.iter().zip(symmetric).skip(1).rev() {
            add(best, true);
            symmetric.iter().filter(|other| other.singles != best.singles).for_each(|other| add(other, true));
        }
        singles.iter().enumerate().for_each(|(rank, ranked)| add(ranked, rank < options.confirmed));
    }
    sets
}

/// Number of degrees of freedom that a set of constraints of a brake holds.
fn held<B: UncertainBrake>(brake: &B, constraints: usize) -> usize {
    let plan = brake.plan();
    let dofs =
        plan.scenes.iter().find(|scene| scene.key.constraints == constraints).map(|scene| &plan.brake(scene).dofs);
    dofs.map_or(0, |dofs| dofs.total() - dofs.free().len())
}
