//! Running the study of a case from beginning to end, or from where it was stopped.

use std::ops::Range;
use std::path::Path;
use std::time::{Duration, Instant};

use cea::EigenSolver;
use montecarlo::{Checkpoint, MonteCarloError, Progress, Summary, interim_looks, run_with, workers};
use study::identity::of_study;
use study::{ModeNaming, Plan, Study, StudyOptions, StudyTally, UncertainBrake, samples_together};

use crate::Error;
use crate::folder::RunFolder;
use crate::part_manifest::PartManifest;
use crate::results::{Manifest, Results, Stopped, Times, reasons_and_links, time_for_reasons, write_tables};

/// Version of the counts. It changes when checkpoints of an older program can no longer be continued.
const TALLY_VERSION: u32 = 9;
/// Time between two checkpoints; chosen: what is lost at most when a run is killed. Less would write the same file more often.
const CHECKPOINT_EVERY: Duration = Duration::from_secs(5);

/// Function that adds figures and estimates to the tables of a finished study: it writes files into the folder that it is given, from
/// which they are published in the folder of the run when all are whole.
pub type DrawResults<'a, B, E = Error> = dyn FnMut(&Study<'_, B>, &Results, &Path) -> Result<(), E> + Send + 'a;

/// Runs the study of a brake in `dir` and writes its tables and manifest there; `draw` adds figures and estimates.
///
/// `dir` may hold the same study, stopped or finished, with as many samples or fewer: it is continued, and ends in the bytes
/// of a run at once. The state is kept in `checkpoint.json`.
///
/// # Errors
/// A folder that cannot be written, belongs to another study or is in use by another run; a checkpoint that is damaged or
/// has more samples; errors of the study.
pub fn run_study<B: UncertainBrake>(
    brake: &B,
    dir: &Path,
    threads: Option<usize>,
    draw: &mut DrawResults<'_, B>,
) -> Result<Manifest, Error> {
    run_study_with(brake, dir, RunOptions::default().with_threads(threads), draw)
}

/// Receivers of the progress of each stage of a run.
#[derive(Clone, Copy)]
pub struct RunProgress<'a> {
    /// Progress of the steps before the first sample.
    pub preparation: &'a dyn Progress,
    /// Progress of the evaluations.
    pub evaluation: &'a dyn Progress,
    /// Progress of the scenes in which the reasons of growth are computed.
    pub reasons: &'a dyn Progress,
}

impl Default for RunProgress<'_> {
    /// Progress that is told to nobody.
    fn default() -> Self {
        Self { preparation: &(), evaluation: &(), reasons: &() }
    }
}

/// Options of a run of a study. None of them changes an outcome.
#[derive(Clone, Copy)]
#[non_exhaustive]
pub struct RunOptions<'a> {
    /// Solver of spectra: [`cea::BatchSolver`] unless another is given.
    pub solver: &'a dyn EigenSolver,
    /// Number of worker threads; `None` is one per core.
    pub threads: Option<usize>,
    /// Half width to which every occurrence is sampled: instead of the samples of the plan, as many are taken as that needs, see
    /// [`montecarlo::interim_looks`]. The result has the bytes of [`run_study`] with the number of samples at which it stops.
    pub until_half_width: Option<f64>,
    /// Samples are kept, in [`StudyTally::kept`]. A folder has them from its first sample on or never.
    pub keeps_samples: bool,
    /// Options of the preparation.
    pub study: StudyOptions,
    /// Receivers of the progress.
    pub progress: RunProgress<'a>,
}

impl Default for RunOptions<'_> {
    /// Options with one worker a core, the batched solver, the samples of the plan, nobody told.
    fn default() -> Self {
        Self {
            solver: &cea::BatchSolver,
            threads: None,
            until_half_width: None,
            keeps_samples: false,
            study: StudyOptions::default(),
            progress: RunProgress::default(),
        }
    }
}

impl<'a> RunOptions<'a> {
    /// The options with another solver of spectra.
    #[must_use]
    pub fn with_solver(self, solver: &'a dyn EigenSolver) -> Self {
        Self { solver, ..self }
    }

    /// The options with a number of worker threads; `None` is one a core.
    #[must_use]
    pub fn with_threads(self, threads: Option<usize>) -> Self {
        Self { threads, ..self }
    }

    /// The options with a study that is prepared in another way.
    #[must_use]
    pub fn with_study(self, study: StudyOptions) -> Self {
        Self { study, ..self }
    }

    /// The options with receivers of the progress, which can [cancel](Progress::is_cancelled) the run.
    #[must_use]
    pub fn with_progress(self, progress: RunProgress<'a>) -> Self {
        Self { progress, ..self }
    }

    /// The options with a half width to which every occurrence is sampled.
    #[must_use]
    pub fn until_half_width(self, until_half_width: Option<f64>) -> Self {
        Self { until_half_width, ..self }
    }

    /// The options with samples that are kept, or not.
    #[must_use]
    pub fn keeping_samples(self, keeps_samples: bool) -> Self {
        Self { keeps_samples, ..self }
    }
}

/// Run as by [`run_study`], with options, and errors of the caller's own from `draw`.
///
/// # Errors
/// As [`run_study`].
pub fn run_study_with<B: UncertainBrake, E: From<Error> + Send>(
    brake: &B,
    dir: &Path,
    options: RunOptions<'_>,
    draw: &mut DrawResults<'_, B, E>,
) -> Result<Manifest, E> {
    run_from(brake, dir, options, &mut |_, _| Ok((Vec::new(), None)), draw)
}

/// Identity of the counts of a study.
pub(crate) fn identity<B: UncertainBrake>(brake: &B, keeps_samples: bool) -> String {
    let identity = of_study(brake).given("format", TALLY_VERSION);
    if keeps_samples { identity.given("samples", "kept") } else { identity }.into_line()
}

/// Checkpoint in a folder.
pub(crate) fn checkpoint(dir: &Path, identity: String) -> Checkpoint {
    Checkpoint { path: dir.join("checkpoint.json"), every: CHECKPOINT_EVERY, fingerprint: identity }
}

/// Samples of a range of global indices, continued from a checkpoint.
pub(crate) fn sampled<B: UncertainBrake>(
    study: &Study<'_, B>,
    range: Range<u64>,
    options: &RunOptions<'_>,
    checkpoint: &Checkpoint,
) -> Result<Summary<StudyTally>, MonteCarloError> {
    let (plan, samples) = (study.plan(), range.end - range.start);
    let mut sampling = montecarlo::Sampling::new(plan.seed, samples);
    (sampling.first, sampling.threads, sampling.block) = (range.start, options.threads, samples_together(samples));
    let empty = || if options.keeps_samples { StudyTally::keeping_samples(plan) } else { StudyTally::empty(plan) };
    run_with(study, &sampling, empty, Some(checkpoint), options.progress.evaluation)
}

/// Function that may give the samples of a study that were taken elsewhere, with the parts that they belong to, from the checkpoint of the folder.
type Begin<'a, B> =
    dyn FnMut(&Study<'_, B>, &Checkpoint) -> Result<(Vec<PartManifest>, Option<Summary<StudyTally>>), Error> + 'a;

/// A run of which `begin` may give samples that were taken elsewhere; the manifest lists the parts that it returns.
pub(crate) fn run_from<B: UncertainBrake, E: From<Error> + Send>(
    brake: &B,
    dir: &Path,
    options: RunOptions<'_>,
    begin: &mut Begin<'_, B>,
    draw: &mut DrawResults<'_, B, E>,
) -> Result<Manifest, E> {
    let RunOptions { solver, threads, until_half_width, keeps_samples, study: prepared, progress } = options;
    let plan = brake.plan();
    let identity = identity(brake, keeps_samples);
    RunFolder::check(dir, &identity)?;
    let mut seconds = Times::default();

    let start = Instant::now();
    let pool = workers(threads).map_err(Error::from)?;
    let study =
        pool.install(|| Study::with_options(brake, solver, prepared, progress.preparation)).map_err(Error::from)?;
    seconds.references = start.elapsed().as_secs_f64();

    // Not before the study is known to work: a case that has no reference modes leaves no folder behind, nor do parts of another study.
    let checkpoint = checkpoint(dir, identity.clone());
    let (parts, state) = begin(&study, &checkpoint)?;
    let folder = RunFolder::take(dir, &identity)?;
    let start = Instant::now();
    if let Some(state) = state {
        checkpoint.write(&state).map_err(Error::from)?;
    }
    let sampled_to = |samples: u64| sampled(&study, 0..samples, &options, &checkpoint);
    let (summary, stopped) = match until_half_width {
        None => (sampled_to(plan.samples).map_err(Error::from)?, None),
        Some(half_width) => {
            let (summary, stopped) = sampled_until(half_width, plan, sampled_to)?;
            (summary, Some(stopped))
        }
    };
    seconds.samples = start.elapsed().as_secs_f64();

    let start = Instant::now();
    let results = Results::new(&study, summary);
    let (reasons, links) = pool.install(|| reasons_and_links(&study, progress.reasons))?;
    progress.reasons.go_on().map_err(Error::from)?;
    folder.publish(|stage| {
        write_tables(&results, &reasons, &links, stage)?;
        pool.install(|| draw(&study, &results, stage))
    })?;
    seconds.report = start.elapsed().as_secs_f64();
    let routes = study.routes().into_iter().collect();
    let manifest = Manifest { stopped, parts, routes, ..Manifest::new(&results, threads, seconds) };
    folder.write("manifest.json", manifest.json().as_bytes())?;
    Ok(manifest)
}

/// Samples until every occurrence is known to a half width, or to the last look.
fn sampled_until(
    half_width: f64,
    plan: &Plan,
    sampled: impl Fn(u64) -> Result<Summary<StudyTally>, MonteCarloError>,
) -> Result<(Summary<StudyTally>, Stopped), Error> {
    let all = interim_looks(half_width);
    let last = all.len() - 1;
    for (at, look) in all.iter().enumerate() {
        let summary = match sampled(look.samples) {
            // A run that was stopped, or extended: it has passed this look.
            Err(MonteCarloError::CheckpointLonger { .. }) if at < last => continue,
            Err(MonteCarloError::CheckpointLonger { found, .. }) => sampled(found)?,
            other => other?,
        };
        let is_tracked = plan.mode_labels == ModeNaming::Tracked;
        let reached = summary.tally.distance(&summary.failures, is_tracked, look.confidence);
        if reached <= half_width || at == last {
            return Ok((summary, Stopped { half_width, reached, look: at + 1, looks: all.len() }));
        }
    }
    Err(MonteCarloError::Zero { what: "looks" }.into())
}

/// Time that a study takes, roughly, by its stages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExpectedTime {
    /// Time of what all samples share; each part of a study takes it anew.
    pub preparation: Duration,
    /// Time of the samples.
    pub samples: Duration,
    /// Time of the report.
    pub report: Duration,
}

impl ExpectedTime {
    /// Time of all stages.
    #[must_use]
    pub fn total(&self) -> Duration {
        self.preparation + self.samples + self.report
    }
}

/// Time, roughly, that a study takes: a few samples are timed, and the reasons of one mode.
///
/// # Errors
/// Those of the study.
pub fn expected_time<B: UncertainBrake>(
    brake: &B,
    preparation: &dyn Progress,
    evaluation: &dyn Progress,
) -> Result<ExpectedTime, Error> {
    let (plan, start, pool) = (brake.plan(), Instant::now(), workers(None)?);
    let study = pool.install(|| Study::with_progress(brake, &cea::BatchSolver, preparation))?;
    let preparation = start.elapsed();
    let few = 2 * 8;
    let samples = few.min(plan.samples);
    let start = Instant::now();
    run_with(&study, &montecarlo::Sampling::new(plan.seed, samples), || StudyTally::empty(plan), None, evaluation)?;
    let samples = start.elapsed().mul_f64(plan.samples as f64 / samples as f64);
    Ok(ExpectedTime { preparation, samples, report: time_for_reasons(&study, pool.current_num_threads()) })
}
