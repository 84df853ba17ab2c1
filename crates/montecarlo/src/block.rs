//! The unit of work: a few consecutive samples in all scenes.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::error::MonteCarloError;
use crate::experiment::{Experiment, Runs, Tally};
use crate::failures::{Failure, Failures};
use crate::progress::Progress;
use crate::stream::stream;
use crate::summary::Summary;

/// Draws the samples of `indices`, evaluates them in all scenes and enters them in `tally`, which is empty.
///
/// Returns `None` where `stop` was set meanwhile: the run has failed in another block, and this one is not needed.
pub(crate) fn evaluate<S: Experiment, T: Tally<S>>(
    experiment: &S,
    seed: u64,
    indices: Range<u64>,
    mut tally: T,
    progress: &dyn Progress,
    stop: &AtomicBool,
) -> Result<Option<Summary<T>>, MonteCarloError> {
    let scenes = experiment.scenes();
    let mut failures = Failures::new(scenes);

    let drawn: Vec<_> = indices.clone().map(|index| (index, experiment.draw(&mut stream(seed, index)))).collect();
    let samples: Vec<_> = drawn.iter().filter_map(|(_, draw)| draw.as_ref().ok()).collect();
    let mut results: Vec<Vec<_>> = samples.iter().map(|_| Vec::with_capacity(scenes)).collect();

    let mut scratch = S::Scratch::default();
    let mut out = Vec::with_capacity(samples.len());
    for scene in 0..scenes {
        if stop.load(Ordering::Relaxed) {
            return Ok(None);
        }
        if !samples.is_empty() {
            experiment.evaluate_block(scene, &samples, &mut scratch, &mut out);
        }
        if out.len() != samples.len() {
            let (expected, found) = (samples.len(), out.len());
            return Err(MonteCarloError::BlockLength { scene, first: indices.start, expected, found });
        }
        for (of_sample, result) in results.iter_mut().zip(out.drain(..)) {
            of_sample.push(result);
        }
        progress.advance(indices.end - indices.start);
    }

    let mut results = results.iter();
    for (index, draw) in &drawn {
        match draw {
            Err(error) => failures.record(Failure { index: *index, scene: None, message: error.to_string() }),
            Ok(sample) => {
                let of_sample = results.next().map_or(&[][..], Vec::as_slice);
                for (scene, result) in of_sample.iter().enumerate() {
                    if let Err(error) = result {
                        let scene = Some(scene);
                        failures.record(Failure { index: *index, scene, message: error.to_string() });
                    }
                }
                tally.record(&Runs { index: *index, sample, results: of_sample });
            }
        }
    }
    Ok(Some(Summary { seed, first: indices.start, samples: indices.end - indices.start, failures, tally }))
}
