//! The parallel run: blocks in any order, merged in theirs.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::block;
use crate::checkpoint::{Checkpoint, Store};
use crate::error::MonteCarloError;
use crate::failures::Failures;
use crate::plan::{Plan, blocks};
use crate::progress::Progress;
use crate::study::{Study, Tally};
use crate::summary::Summary;

/// Blocks that may be under way or waiting for an earlier one, per thread: enough that no thread idles behind a slow
/// block, few enough that memory stays bounded.
const BLOCKS_AHEAD: usize = 4;

/// Runs a plan to its end, without checkpoint or progress bar. `empty` makes an empty tally.
///
/// # Errors
/// See [`run_with`].
pub fn run<S: Study, T: Tally<S>>(
    study: &S,
    plan: &Plan,
    empty: impl Fn() -> T + Sync,
) -> Result<Summary<T>, MonteCarloError> {
    run_with(study, plan, empty, None, &())
}

/// Runs a plan to its end, or from where its checkpoint stands to its end. `empty` makes an empty tally.
///
/// The checkpoint is first written before the first evaluation, so that a folder that cannot be written is found at once,
/// and last when the run is complete; a run whose checkpoint is complete returns its result without evaluating anything.
///
/// # Errors
/// - a plan of zero samples, threads or samples per block, or with indices beyond 64 bits; a study of no scenes;
/// - a checkpoint that is damaged, or of another study, seed, number of samples, block or scenes, or that cannot be read
///   or written;
/// - a study whose `evaluate_block` gives a wrong number of results.
///
/// # Panics
/// A panic of the study or the tally goes on in the calling thread, with its own message.
pub fn run_with<S: Study, T: Tally<S>>(
    study: &S,
    plan: &Plan,
    empty: impl Fn() -> T + Sync,
    checkpoint: Option<&Checkpoint>,
    progress: &dyn Progress,
) -> Result<Summary<T>, MonteCarloError> {
    plan.check()?;
    let scenes = study.scenes();
    if scenes == 0 {
        return Err(MonteCarloError::Zero { what: "scenes" });
    }
    let pool = ThreadPoolBuilder::new().num_threads(plan.threads.unwrap_or(0)).build()?;
    let mut store = checkpoint.map(|checkpoint| Store::new(checkpoint, plan, scenes));

    let stored = match &store {
        Some(store) => store.load()?,
        None => None,
    };
    let state = match stored {
        Some(state) => state,
        None => {
            let nothing = Failures::new(scenes);
            let state = Summary { seed: plan.seed, first: plan.first, samples: 0, failures: nothing, tally: empty() };
            if let Some(store) = &mut store {
                store.save(&state)?;
            }
            state
        }
    };

    progress.begin(plan.samples.saturating_mul(scenes as u64), state.samples * scenes as u64);
    let result = complete(&pool, study, plan, &empty, state, store, progress);
    progress.end();
    result
}

/// Evaluates what is missing from `state`.
fn complete<S: Study, T: Tally<S>>(
    pool: &ThreadPool,
    study: &S,
    plan: &Plan,
    empty: &(impl Fn() -> T + Sync),
    mut state: Summary<T>,
    mut store: Option<Store<'_>>,
    progress: &dyn Progress,
) -> Result<Summary<T>, MonteCarloError> {
    let end = plan.first + plan.samples;
    if state.next() == end {
        return Ok(state);
    }
    let stop = &AtomicBool::new(false);
    // The calling thread merges and writes checkpoints; it sleeps on the channel while the pool works.
    pool.in_place_scope(|scope| {
        let (sender, receiver) = mpsc::channel();
        let mut blocks = blocks(state.next(), end, plan.block);
        let mut start_block = || {
            if let Some(indices) = blocks.next() {
                let sender = sender.clone();
                scope.spawn(move |_| {
                    let work = || block::evaluate(study, plan.seed, indices, empty(), progress, stop);
                    // The receiver is gone when the run has failed; the result is then of no use.
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
        for finished in &receiver {
            let finished = finished.unwrap_or_else(|panic| {
                stop.store(true, Ordering::Relaxed);
                resume_unwind(panic)
            });
            match merge(finished) {
                Ok(true) => break,
                Ok(false) => {}
                Err(error) => {
                    stop.store(true, Ordering::Relaxed);
                    return Err(error);
                }
            }
        }
        Ok(())
    })?;
    Ok(state)
}
