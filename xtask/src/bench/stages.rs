//! The time of a study by stages: some of its samples in all scenes, on one thread.

use std::time::Duration;

use brakes::{LatticeBrake, LatticeSample};
use cea::BatchSolver;
use serde::Serialize;
use squeal::montecarlo::{Experiment as _, Runs, Tally as _, stream};
use squeal::study::{Scratch, Spent, Study, StudyTally, timed};

use crate::error::TaskError;

/// Number of samples, evaluated together as in a run; chosen.
const SAMPLES_TIMED: u64 = 128;

/// Stage of a study, with its time.
#[derive(Debug, Clone, Serialize)]
pub struct Stage {
    /// Name of the stage.
    pub stage: &'static str,
    /// Processor time per sample solved, in all its sectors, microseconds.
    pub us: f64,
    /// Part of the whole time.
    pub share: f64,
}

/// The stages of the first block of the study.
///
/// # Errors
/// Those of the study.
pub fn stages(brake: &LatticeBrake) -> Result<Vec<Stage>, TaskError> {
    let study = Study::new(brake, &BatchSolver)?;
    let plan = &brake.plan;
    let [mut drawing, mut evaluation, mut tallying] = [Duration::ZERO; 3];
    let draw = || -> Result<Vec<LatticeSample>, squeal::study::Error> {
        (0..SAMPLES_TIMED).map(|index| study.draw(&mut stream(plan.seed, index))).collect()
    };
    let samples = timed(&mut drawing, draw)?;
    let borrowed: Vec<&LatticeSample> = samples.iter().collect();
    let (mut scratch, mut out) = (Scratch::default(), Vec::new());
    let mut results: Vec<Vec<_>> = samples.iter().map(|_| Vec::new()).collect();
    for scene in 0..study.scenes() {
        timed(&mut evaluation, || study.evaluate_block(scene, &borrowed, &mut scratch, &mut out));
        for (of_sample, result) in results.iter_mut().zip(out.drain(..)) {
            of_sample.push(result);
        }
    }
    let mut tally = StudyTally::empty(plan);
    timed(&mut tallying, || {
        for ((index, sample), results) in (0..).zip(&samples).zip(&results) {
            tally.record(&Runs::<'_, Study<'_, LatticeBrake>> { index, sample, results });
        }
    });
    let outcomes = results.iter().flatten().flatten();
    let solved = outcomes.filter(|outcome| !outcome.is_certified).count() as f64;

    let Spent { states, search, assembly, spectra, shapes, names, outcomes } = scratch.spent();
    let stages = [
        ("drawing", drawing),
        ("sliding states, certificates", states),
        ("growing modes by secular equations", search),
        ("assembly for spectra", assembly),
        ("spectra and verdicts of what is left", spectra),
        ("shapes of growing modes", shapes),
        ("names, continuations included", names),
        ("ranks and net work", outcomes),
        ("tally", tallying),
    ];
    let whole = (drawing + evaluation + tallying).as_secs_f64();
    let rest = whole - stages.iter().map(|(_, spent)| spent.as_secs_f64()).sum::<f64>();
    let row = |(stage, seconds): (_, f64)| Stage { stage, us: 1e6 * seconds / solved, share: seconds / whole };
    Ok(stages.into_iter().map(|(stage, spent)| (stage, spent.as_secs_f64())).chain([("rest", rest)]).map(row).collect())
}
