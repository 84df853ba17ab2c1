//! A small experiment with three scenes, float and integer outcomes, failed draws and failed evaluations.

#![allow(clippy::unwrap_used, clippy::panic)] // Test code, which the lints do not recognise outside test functions.

use montecarlo::{
    Checkpoint, Experiment, IntegerMean, Merge, MonteCarloError, Proportion, QuantileSketch, Runs, Sampling, StreamRng,
    Summary, Tally, Trial, run_with,
};
use rand::{Rng, RngExt};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::time::Duration;

pub const SCENES: usize = 3;

/// The experiment with a panic at one index.
pub struct Walk {
    pub panics_at: Option<u64>,
    pub pause: Duration,
}

pub const WALK: Walk = Walk { panics_at: None, pause: Duration::ZERO };

pub struct Step {
    pub size: f64,
    pub bits: u64,
}

impl Experiment for Walk {
    type Sample = Step;
    type Outcome = f64;
    type Error = String;
    type Scratch = Vec<f64>;

    fn scenes(&self) -> usize {
        SCENES
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<Step, String> {
        if self.panics_at == Some(rng.get_stream()) {
            panic!("sample {} reached", rng.get_stream());
        }
        let bits = rng.next_u64();
        if bits.is_multiple_of(37) {
            return Err(format!("{bits} is a multiple of 37"));
        }
        Ok(Step { size: rng.random_range(-1.0..3.0), bits })
    }

    fn evaluate(&self, scene: usize, sample: &Step, scratch: &mut Vec<f64>) -> Result<f64, String> {
        std::thread::sleep(self.pause);
        if sample.bits % 11 == scene as u64 {
            return Err(format!("{} fails in scene {scene}", sample.bits));
        }
        scratch.push(sample.size);
        Ok((scene as f64 + sample.size).sin())
    }
}

/// One statistic of every kind, and the samples in the order in which they were entered.
#[derive(Default, Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Counts {
    pub positive: [Proportion; SCENES],
    pub positive_scenes: IntegerMean,
    pub values: QuantileSketch,
    pub samples: Vec<(u64, f64)>,
}

impl Merge for Counts {
    fn merge(&mut self, later: Self) {
        for (mine, more) in self.positive.iter_mut().zip(later.positive) {
            mine.merge(more);
        }
        self.positive_scenes.merge(later.positive_scenes);
        self.values.merge(later.values);
        self.samples.extend(later.samples);
    }
}

impl Tally<Walk> for Counts {
    fn record(&mut self, runs: &Runs<'_, Walk>) {
        let mut positive = 0;
        for (proportion, result) in self.positive.iter_mut().zip(runs.results) {
            let Ok(value) = result else { continue };
            let trial = match value {
                v if v.abs() < 0.01 => Trial::Ambiguous,
                v if *v > 0.0 => Trial::Yes,
                _ => Trial::No,
            };
            positive += i32::from(trial == Trial::Yes);
            proportion.record(trial);
            self.values.record(*value);
        }
        self.positive_scenes.record(positive);
        self.samples.push((runs.index, runs.sample.size));
    }
}

pub fn sampling(samples: u64, threads: usize) -> Sampling {
    Sampling { threads: Some(threads), ..Sampling::new(2026, samples) }
}

/// A checkpoint in a folder, written after every block.
pub fn checkpoint(folder: &Path) -> Checkpoint {
    Checkpoint { path: folder.join("run.checkpoint"), every: Duration::ZERO, fingerprint: "walk 1".to_string() }
}

pub fn walk(sampling: &Sampling, checkpoint: Option<&Checkpoint>) -> Result<Summary<Counts>, MonteCarloError> {
    run_with(&WALK, sampling, Counts::default, checkpoint, &())
}

pub fn bytes(summary: &Summary<Counts>) -> String {
    serde_json::to_string(summary).unwrap()
}
