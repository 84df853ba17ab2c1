//! Samples of a study, kept where they are asked for: in which anything was unstable, what, and how fast it grows.
//!
//! Inputs are not among them: a sample is drawn again from the seed and its index.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::{ModeLabel, Outcome};

/// The samples of one scene. A sample in neither list is stable.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct KeptSamples {
    /// Unstable samples, ascending in the index.
    pub unstable: Vec<KeptSample>,
    /// Samples in which nothing surely is unstable and a verdict is open, ascending in the index.
    pub open: Vec<KeptSample>,
    /// Indices of the samples whose evaluation failed, ascending. Samples whose draw failed are in no list.
    pub failed: Vec<u64>,
}

/// A sample in which anything is unstable, or may be.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct KeptSample {
    /// Index of the sample.
    pub index: u64,
    /// The largest growth rate of an unstable mode or of a divergence, 1/s; 0 where nothing surely is unstable.
    pub growth: f64,
    /// The unstable modes, ascending in frequency. Divergence is the last.
    pub modes: Vec<KeptMode>,
    /// Names that each mode may have whose verdict is open. Divergence is the last.
    pub may_be: Vec<Vec<ModeLabel>>,
}

/// An unstable mode of a sample, or its divergence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct KeptMode {
    /// Names that it may have.
    pub names: Vec<ModeLabel>,
    /// Growth rate Re lambda, 1/s.
    pub growth: f64,
    /// Angular frequency Im lambda, rad/s; 0 of divergence.
    pub omega: f64,
}

impl KeptSample {
    /// A sample with its outcome; `None` of one in which nothing is unstable or may be.
    pub fn new(index: u64, outcome: &Outcome) -> Option<Self> {
        let modes = outcome.unstable.iter().map(|mode| KeptMode {
            names: mode.names.clone(),
            growth: mode.lambda.re,
            omega: mode.lambda.im,
        });
        let names = vec![ModeLabel::DIVERGENCE];
        let divergence = (outcome.divergent > 0).then_some(KeptMode { names, growth: outcome.divergence, omega: 0.0 });
        let open = outcome.open.iter().map(|mode| mode.names.clone());
        let may_diverge = (outcome.undecided_real > 0).then_some(vec![ModeLabel::DIVERGENCE]);
        let kept = || Self {
            index,
            growth: outcome.growth,
            modes: modes.chain(divergence).collect(),
            may_be: open.chain(may_diverge).collect(),
        };
        (outcome.is_unstable() || outcome.undecided > 0).then(kept)
    }
}

impl KeptSamples {
    /// Enters a sample; without an outcome one that failed.
    pub(super) fn record(&mut self, index: u64, outcome: Option<&Outcome>) {
        match outcome {
            Some(outcome) if outcome.may_be_unstable() => self.open.extend(KeptSample::new(index, outcome)),
            Some(outcome) => self.unstable.extend(KeptSample::new(index, outcome)),
            None => self.failed.push(index),
        }
    }

    pub(super) fn merge(&mut self, later: Self) {
        self.unstable.extend(later.unstable);
        self.open.extend(later.open);
        self.failed.extend(later.failed);
    }

    /// Sample `index`, in which anything is unstable or may be; `None` if it was stable or failed.
    #[must_use]
    pub fn sample(&self, index: u64) -> Option<&KeptSample> {
        let found = |samples: &'_ Vec<KeptSample>| samples.binary_search_by_key(&index, |sample| sample.index).ok();
        found(&self.unstable).map(|at| &self.unstable[at]).or_else(|| found(&self.open).map(|at| &self.open[at]))
    }

    /// True if nothing surely is unstable in sample `index`, and a verdict is open.
    #[must_use]
    pub fn is_open(&self, index: u64) -> bool {
        self.open.binary_search_by_key(&index, |sample| sample.index).is_ok()
    }

    /// True if the evaluation of sample `index` failed.
    #[must_use]
    pub fn has_failed(&self, index: u64) -> bool {
        self.failed.binary_search(&index).is_ok()
    }

    /// True if these can be the samples of a run of the indices `samples`, of which `unstable` were unstable and `open` may be.
    pub(super) fn may_be_of(&self, samples: &Range<u64>, [unstable, open]: [u64; 2]) -> bool {
        [self.unstable.len() as u64, self.open.len() as u64] == [unstable, open]
            && ascend(self.unstable.iter().map(|sample| sample.index), samples)
            && ascend(self.open.iter().map(|sample| sample.index), samples)
            && ascend(self.failed.iter().copied(), samples)
    }
}

/// True if the indices ascend and all lie in `samples`.
fn ascend(mut indices: impl Iterator<Item = u64>, samples: &Range<u64>) -> bool {
    let mut least = samples.start;
    indices.all(|index| {
        let is_next = (least..samples.end).contains(&index);
        least = index + 1;
        is_next
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_those_of_a_range() {
        let kept = |unstable: &[u64], failed: &[u64]| {
            let sample = |&index: &u64| KeptSample { index, growth: 1.0, modes: Vec::new(), may_be: Vec::new() };
            KeptSamples { unstable: unstable.iter().map(sample).collect(), open: Vec::new(), failed: failed.to_vec() }
        };
        for (start, is_there) in [(0, true), (100, true), (u64::MAX - 50, true)] {
            let found = kept(&[start, start + 3, start + 9], &[start + 1]);
            assert_eq!(found.may_be_of(&(start..start + 10), [3, 0]), is_there);
            // One index too few at either end.
            assert!(!found.may_be_of(&(start..start + 9), [3, 0]));
            assert!(!found.may_be_of(&(start + 1..start + 10), [3, 0]));
            assert!(!found.may_be_of(&(start..start + 10), [2, 0]));
        }
        assert!(!kept(&[4, 3], &[]).may_be_of(&(0..10), [2, 0]));
        assert!(!kept(&[3], &[7, 7]).may_be_of(&(0..10), [1, 0]));
        // One that is open and of which nothing is known.
        assert!(!kept(&[3], &[]).may_be_of(&(0..10), [1, 1]));
        let open = kept(&[5], &[]).unstable;
        assert!(KeptSamples { open, ..kept(&[3], &[]) }.may_be_of(&(0..10), [1, 1]));
    }
}
