//! Failed draws and evaluations: all are counted, the first 1,000 are listed.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::merge::Merge;

/// Most failures that are listed; chosen, so that a checkpoint stays small.
const MOST_LISTED: usize = 1_000;

/// A failed draw or evaluation.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    /// Global index of the sample.
    pub index: u64,
    /// The scene; `None` where the draw failed, so that the sample is missing from every scene.
    pub scene: Option<usize>,
    /// The experiment's error as text.
    pub message: String,
}

/// Failures of a run: counts per scene, and a list of the first 1,000 by sample and scene.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failures {
    draws: u64,
    scenes: Vec<u64>,
    listed: Vec<Failure>,
}

impl Failures {
    pub(crate) fn new(scenes: usize) -> Self {
        Self { draws: 0, scenes: vec![0; scenes], listed: Vec::new() }
    }

    pub(crate) fn record(&mut self, failure: Failure) {
        match failure.scene {
            None => self.draws += 1,
            Some(scene) => self.scenes[scene] += 1,
        }
        if self.listed.len() < MOST_LISTED {
            self.listed.push(failure);
        }
    }

    /// True if these can be the failures of the samples of these indices in `scenes` scenes.
    pub(crate) fn may_be_of(&self, scenes: usize, samples: Range<u64>) -> bool {
        let count = samples.end - samples.start;
        let of_scene = |&failed: &u64| self.draws.checked_add(failed).is_some_and(|failed| failed <= count);
        let is_listed =
            |failure: &Failure| samples.contains(&failure.index) && failure.scene.is_none_or(|scene| scene < scenes);
        let total = self.scenes.iter().try_fold(self.draws, |sum, &failed| sum.checked_add(failed));
        self.scenes.len() == scenes
            && self.scenes.iter().all(of_scene)
            && self.listed.iter().all(is_listed)
            && self.listed.windows(2).all(|pair| pair[0].index <= pair[1].index)
            && total.is_some_and(|total| self.listed.len() as u64 == total.min(MOST_LISTED as u64))
    }

    /// Failed draws; each is missing from every scene.
    #[must_use]
    pub fn draws(&self) -> u64 {
        self.draws
    }

    /// Failed evaluations per scene, failed draws not included.
    #[must_use]
    pub fn by_scene(&self) -> &[u64] {
        &self.scenes
    }

    /// Failed draws and failed evaluations together.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.draws + self.scenes.iter().sum::<u64>()
    }

    /// The first failures, at most 1,000, by sample and scene.
    #[must_use]
    pub fn listed(&self) -> &[Failure] {
        &self.listed
    }
}

impl Merge for Failures {
    fn merge(&mut self, later: Self) {
        self.draws += later.draws;
        for (mine, more) in self.scenes.iter_mut().zip(&later.scenes) {
            *mine += more;
        }
        let room = MOST_LISTED - self.listed.len();
        self.listed.extend(later.listed.into_iter().take(room));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn failures(indices: std::ops::Range<u64>) -> Failures {
        let mut failures = Failures::new(2);
        for index in indices {
            let scene = (index % 3 != 0).then_some((index % 2) as usize);
            failures.record(Failure { index, scene, message: format!("sample {index}") });
        }
        failures
    }

    #[test]
    fn parts_merge_to_the_whole_and_only_the_list_is_bounded() {
        for cut in [0, 1, 400, 999, 1_000, 1_001, 1_500] {
            let mut merged = failures(0..cut);
            merged.merge(failures(cut..1_500));
            assert_eq!(merged, failures(0..1_500));
        }
        let whole = failures(0..1_500);
        assert_eq!(whole.total(), 1_500);
        assert_eq!((whole.draws(), whole.by_scene()), (500, &[500, 500][..]));
        assert_eq!(whole.listed().len(), 1_000);
        assert_eq!(whole.listed()[999].index, 999);
    }
}
