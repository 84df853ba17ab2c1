//! The result of a run, or of a part of one.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::error::MonteCarloError;
use crate::failures::Failures;
use crate::merge::Merge;

/// The result of consecutive samples; also the state that a checkpoint holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary<T> {
    /// The seed of the sampling.
    pub seed: u64,
    /// Global index of the first sample.
    pub first: u64,
    /// Number of samples.
    pub samples: u64,
    /// Failed draws and evaluations.
    pub failures: Failures,
    /// Statistic of the draws and evaluations that did not fail.
    pub tally: T,
}

impl<T: Merge> Summary<T> {
    /// Global index after the last sample.
    #[must_use]
    pub fn next(&self) -> u64 {
        self.first + self.samples
    }

    /// Merges two parts of one experiment: `later` must begin where this part ends. The caller has to know that both are of the
    /// same experiment.
    ///
    /// # Errors
    /// Another seed, another number of scenes, or a gap or overlap between the two.
    pub fn merge(mut self, later: Self) -> Result<Self, MonteCarloError> {
        for (field, expected, found) in [
            ("the seed", self.seed, later.seed),
            ("the number of scenes", self.failures.by_scene().len() as u64, later.failures.by_scene().len() as u64),
            ("the first sample", self.next(), later.first),
        ] {
            if expected != found {
                return Err(MonteCarloError::NotMergeable { field, expected, found });
            }
        }
        self.append(later);
        Ok(self)
    }

    /// Range of the global indices of the samples.
    #[must_use]
    pub fn range(&self) -> Range<u64> {
        self.first..self.next()
    }

    pub(crate) fn append(&mut self, later: Self) {
        self.samples += later.samples;
        self.failures.merge(later.failures);
        self.tally.merge(later.tally);
    }
}
