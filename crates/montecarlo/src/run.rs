//! The parallel run: blocks are evaluated in any order and merged in the order of their indices.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::time::Duration;

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::block;
use crate::checkpoint::{Checkpoint, Store};
use crate::error::MonteCarloError;
use crate::experiment::{Experiment, Tally};
use crate::failures::Failures;
use crate::progress::Progress;
use crate::sampling::{Sampling, blocks};
use crate::summary::Summary;

/// Most blocks per thread that are being evaluated or wait for an earlier block; chosen: enough that no thread is idle behind a
/// slow block, and few because waiting blocks take memory.
const BLOCKS_AHEAD: usize = 4;
/// Time between two looks whether a run is cancelled; chosen: no one notices so short a time, and so few looks take none.
const LOOK: Duration = Duration::from_millis(50);

/// Runs a sampling to its end, without checkpoint or progress bar. `empty` makes an empty tally.
///
/// # Errors
/// See [`run_with`].
pub fn run<S: Experiment, T: Tally<S>>(
    experiment: &S,
    sampling: &Sampling,
    empty: impl Fn() -> T + Sync,
) -> Result<Summary<T>, MonteCarloError> {
    run_with(experiment, sampling, empty, None, &())
}

/// Runs a sampling to its end, or continues it from a checkpoint to its end. `empty` makes an empty tally.
///
/// Where there is no checkpoint yet it is written before the first evaluation, so that a folder that cannot be written is noticed at once, and last when
/// the run is complete. A run whose checkpoint is complete returns its result without any evaluation. A run whose checkpoint has fewer samples, whether
/// that run was complete or not, is continued; the result is the same bytes as the result of an uninterrupted run.
///
/// # Errors
/// - a sampling of zero samples, threads or samples per block, or with indices beyond 64 bits; an experiment of no
///   scenes;
/// - a checkpoint that is damaged, of another experiment, seed, first sample or number of scenes, or with more samples; or
///   one that cannot be read or written;
/// - an experiment whose `evaluate_block` gives a wrong number of results;
/// - [`MonteCarloError::Cancelled`] where `progress` says so: the state is written to the checkpoint before;
/// - worker threads that cannot be started.
///
/// # Panics
/// A panic of the experiment or the tally is resumed in the calling thread, with its own message.
pub fn run_with<S: Experiment, T: Tally<S>>(
    experiment: &S,
    sampling: &Sampling,
    empty: impl Fn() -> T + Sync,
    checkpoint: Option<&Checkpoint>,
    progress: &dyn Progress,
) -> Result<Summary<T>, MonteCarloError> {
    sampling.check()?;
    let scenes = experiment.scenes();
    if scenes == 0 {
        return Err(MonteCarloError::Zero { what: "scenes" });
    }
    let pool = workers(sampling.threads)?;
    let mut store = checkpoint.map(|checkpoint| Store::new(checkpoint, sampling, scenes));

    let stored = match &store {
        Some(store) => store.load::<S, T>()?,
        None => None,
    };
    let state = match stored {
        Some(state) => state,
        None => {
            let nothing = Failures::new(scenes);
            let state =
                Summary { seed: sampling.seed, first: sampling.first, samples: 0, failures: nothing, tally: empty() };
            if let Some(store) = &mut store {
                store.save(&state)?;
            }
            state
        }
    };

    progress.begin(sampling.samples.saturating_mul(scenes as u64), state.samples * scenes as u64);
    let result = complete(&pool, experiment, sampling, &empty, state, store, progress);
    progress.end();
    result
}

/// Evaluates the samples that are missing from `state`.
fn complete<S: Experiment, T: Tally<S>>(
    pool: &ThreadPool,
    experiment: &S,
    sampling: &Sampling,
    empty: &(impl Fn() -> T + Sync),
    mut state: Summary<T>,
    mut store: Option<Store<'_>>,
    progress: &dyn Progress,
) -> Result<Summary<T>, MonteCarloError> {
    let end = sampling.first + sampling.samples;
    if state.next() == end {
        return Ok(state);
    }
    let stop = &AtomicBool::new(false);
    // The calling thread merges and writes checkpoints; it sleeps on the channel while the pool works.
    let ended = pool.in_place_scope(|scope| {
        let (sender, receiver) = mpsc::channel();
        let mut blocks = blocks(state.next(), end, sampling.block);
        let mut start_block = || {
            if let Some(indices) = blocks.next() {
                let sender = sender.clone();
                scope.spawn(move |_| {
                    let work = || block::evaluate(experiment, sampling.seed, indices, empty(), progress, stop);
                    // The receiver is gone when the run has failed; the result is not needed then.
                    let _ = sender.send(catch_unwind(AssertUnwindSafe(work)));
                });
            }
        };
        for _ in 0..BLOCKS_AHEAD * pool.current_num_threads() {
            start_block();
        }

        let mut early = BTreeMap::new();
        let mut merge = |finished: Result<Option<Summary<T>>, MonteCarloError>| -> Result<bool, MonteCarloError> {
            if let Some(part) = finished? {
                early.insert(part.first, part);
            }
            while let Some(part) = early.remove(&state.next()) {
                state.append(part);
                start_block();
                if let Some(store) = &mut store {
                    store.save_when_due(&state, end)?;
                }
            }
            Ok(state.next() == end)
        };
        loop {
            // Asked after a block has come: what ended the run may have spoiled it.
            let finished = receiver.recv_timeout(LOOK);
            if progress.is_cancelled() {
                stop.store(true, Ordering::Relaxed);
                return Err(MonteCarloError::Cancelled);
            }
            let Ok(finished) = finished else { continue };
            let finished = finished.unwrap_or_else(|panic| {
                stop.store(true, Ordering::Relaxed);
                resume_unwind(panic)
            });
            match merge(finished) {
                Ok(true) => return Ok(()),
                Ok(false) => {}
                Err(error) => {
                    stop.store(true, Ordering::Relaxed);
                    return Err(error);
                }
            }
        }
    });
    if let (Err(MonteCarloError::Cancelled), Some(store)) = (&ended, &mut store) {
        store.save(&state)?;
    }
    ended.map(|()| state)
}

/// Threads for work in parallel; one per core without a number.
///
/// # Errors
/// A system that makes no threads.
pub fn workers(threads: Option<usize>) -> Result<ThreadPool, MonteCarloError> {
    Ok(ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build()?)
}
