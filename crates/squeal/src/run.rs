//! Running the study of a case from beginning to end, or from where it was stopped.

use std::fs::{File, TryLockError};
use std::io::ErrorKind;
use std::path::Path;
use std::time::{Duration, Instant};

use montecarlo::{Checkpoint, run_with};

use crate::Error;
use crate::output::{make_folder, write};
use crate::report::{Manifest, Results, Times, write_tables};
use crate::study::{Study, StudyTally, UncertainBrake};

/// Changes when checkpoints of an older program can no longer be continued.
const TALLY_VERSION: u32 = 5;
/// The file that says whose folder it is.
const MARKER: &str = "study.txt";
/// The file that is locked while a run works in the folder. It stays there; the lock ends with the process.
const LOCK: &str = "run.lock";
/// Time between two checkpoints.
const CHECKPOINT_EVERY: Duration = Duration::from_secs(5);

/// Who is told how far a run has come: a bar on the terminal where the program is compiled, else nobody.
#[cfg(feature = "program")]
type RunProgress = montecarlo::Bar;
#[cfg(not(feature = "program"))]
type RunProgress = ();

/// What adds figures and estimates to the tables of a finished study, in the folder that it is given.
pub type DrawResults<'a, B> = dyn FnMut(&Study<'_, B>, &Results<'_>, &Path) -> Result<(), Error> + Send + 'a;

/// Runs the study of a brake in `dir` and writes its tables and manifest there; `draw` adds figures and estimates.
///
/// `dir` may hold the same study, stopped or finished, with as many samples or fewer: it is continued, and ends in the bytes
/// of a run at once. The state is kept in `checkpoint.json`.
///
/// # Errors
/// A folder that cannot be written, belongs to another study or is in use by another run; a checkpoint that is damaged or
/// has more samples; those of the study.
pub fn run_study<B: UncertainBrake>(
    brake: &B,
    dir: &Path,
    threads: Option<usize>,
    draw: &mut DrawResults<'_, B>,
) -> Result<Manifest, Error> {
    let plan = brake.plan();
    let identity = format!("{} seed {} format {TALLY_VERSION}", plan.identity, plan.seed);
    // Asked again under the lock; here, so that a folder of another study is refused before any work.
    holds_study(dir, &identity)?;
    let mut seconds = Times::default();

    let start = Instant::now();
    let solver = cea::BatchSolver;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
    let study = install(pool.as_ref().ok(), || Study::new(brake, &solver))?;
    seconds.references = start.elapsed().as_secs_f64();

    // Not before the study is known to work: a case that has no reference modes leaves no folder behind.
    make_folder(dir)?;
    let _lock = locked(dir)?;
    if !holds_study(dir, &identity)? {
        write(&dir.join(MARKER), format!("{identity}\n").as_bytes())?;
    }
    let start = Instant::now();
    let mut sampling = montecarlo::Sampling::new(plan.seed, plan.samples);
    sampling.threads = threads;
    sampling.block = block(plan.samples);
    let checkpoint = Checkpoint { path: dir.join("checkpoint.json"), every: CHECKPOINT_EVERY, fingerprint: identity };
    let summary = run_with(&study, &sampling, || StudyTally::empty(plan), Some(&checkpoint), &RunProgress::default())?;
    seconds.samples = start.elapsed().as_secs_f64();

    let start = Instant::now();
    let results = Results::new(&study, summary);
    write_tables(&results, dir)?;
    install(pool.as_ref().ok(), || draw(&study, &results, dir))?;
    seconds.report = start.elapsed().as_secs_f64();
    let manifest = Manifest::new(&results, threads, seconds);
    write(&dir.join("manifest.json"), manifest.json().as_bytes())?;
    Ok(manifest)
}

/// Work on the threads of a pool, or of the program where there is none.
fn install<T: Send>(pool: Option<&rayon::ThreadPool>, work: impl FnOnce() -> T + Send) -> T {
    match pool {
        Some(pool) => pool.install(work),
        None => work(),
    }
}

/// Samples evaluated together, on which no result depends: as many as fill the lanes of the solver again and again, but few enough for many threads.
fn block(samples: u64) -> u64 {
    (samples / 8).next_multiple_of(8).clamp(8, 128)
}

/// Takes the lock of a folder, until the file is dropped.
fn locked(dir: &Path) -> Result<File, Error> {
    let path = dir.join(LOCK);
    let failed = |source| Error::Write { path: path.clone(), source };
    let file = File::create(&path).map_err(failed)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(Error::InUse { path: dir.to_owned() }),
        // A file system without locks protects from nothing, but holds results as well as others.
        Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => Ok(file),
        Err(TryLockError::Error(source)) => Err(failed(source)),
    }
}

/// Whether `dir` is the folder of this study already; `false` is a new or empty one.
fn holds_study(dir: &Path, identity: &str) -> Result<bool, Error> {
    let other = |found: &str| {
        Err(Error::OtherStudy { path: dir.to_owned(), found: found.to_owned(), wanted: identity.to_owned() })
    };
    let unreadable = |source| Error::Read { path: dir.to_owned(), source };
    match std::fs::read_to_string(dir.join(MARKER)) {
        Ok(found) if found.trim() == identity => return Ok(true),
        Ok(found) => return other(found.trim()),
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        Err(source) => return Err(unreadable(source)),
    }
    match std::fs::read_dir(dir) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
        Err(source) => Err(unreadable(source)),
        Ok(entries) => {
            for entry in entries {
                // A run that was killed while it wrote the marker leaves the lock, and the beginning of a marker.
                let name = entry.map_err(unreadable)?.file_name();
                if name != LOCK && name != "study.txt.partial" {
                    return other("other files");
                }
            }
            Ok(false)
        }
    }
}

/// How long a study takes, roughly: some samples are timed.
///
/// # Errors
/// Those of the study.
pub fn estimate<B: UncertainBrake>(brake: &B) -> Result<Duration, Error> {
    let (plan, start) = (brake.plan(), Instant::now());
    let study = Study::new(brake, &cea::BatchSolver)?;
    let references = start.elapsed();
    let few = 2 * 8;
    let samples = few.min(plan.samples);
    let start = Instant::now();
    run_with(&study, &montecarlo::Sampling::new(plan.seed, samples), || StudyTally::empty(plan), None, &())?;
    Ok(references + start.elapsed().mul_f64(plan.samples as f64 / samples as f64))
}
