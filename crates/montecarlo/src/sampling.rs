//! Samples that are drawn, and the number of threads.

use std::ops::Range;

use crate::error::MonteCarloError;

/// Samples to draw, and division of the work. The result depends on `seed`, `first` and `samples` only.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sampling {
    /// Seed of the random streams.
    pub seed: u64,
    /// Global index of the first sample: 0, or where another part of the same run ended.
    pub first: u64,
    /// Number of samples.
    pub samples: u64,
    /// Samples per unit of work, evaluated together in each scene. Blocks begin at multiples of this number. All
    /// outcomes of one block, in every scene, are in memory at once for each thread.
    pub block: u64,
    /// Number of worker threads; `None` means one per core.
    pub threads: Option<usize>,
}

impl Sampling {
    /// `samples` samples from index 0, in blocks of 8, on all cores.
    #[must_use]
    pub fn new(seed: u64, samples: u64) -> Self {
        Self { seed, first: 0, samples, block: 8, threads: None }
    }

    /// An error for 0 samples, samples per block or threads, and for indices beyond 64 bits.
    pub(crate) fn check(&self) -> Result<(), MonteCarloError> {
        for (what, zero) in [
            ("samples", self.samples == 0),
            ("samples per block", self.block == 0),
            ("threads", self.threads == Some(0)),
        ] {
            if zero {
                return Err(MonteCarloError::Zero { what });
            }
        }
        match self.first.checked_add(self.samples) {
            Some(_) => Ok(()),
            None => Err(MonteCarloError::TooManySamples { first: self.first, samples: self.samples }),
        }
    }
}

/// The parts into which the multiples of `block` divide `from..end`.
pub(crate) fn blocks(from: u64, end: u64, block: u64) -> impl Iterator<Item = Range<u64>> {
    let mut next = from;
    std::iter::from_fn(move || {
        if next == end {
            return None;
        }
        let start = next;
        next = (start - start % block).saturating_add(block).min(end);
        Some(start..next)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn blocks_cover_the_indices_once_and_begin_at_multiples(from in 0u64..100, samples in 0u64..100, block in 1u64..20) {
            let cut: Vec<_> = blocks(from, from + samples, block).collect();
            let covered: Vec<u64> = cut.iter().cloned().flatten().collect();
            prop_assert_eq!(covered, (from..from + samples).collect::<Vec<_>>());
            prop_assert!(cut.iter().skip(1).all(|b| b.start % block == 0));
        }
    }

    #[test]
    fn the_last_index_can_be_reached() {
        let mut cut = blocks(u64::MAX - 3, u64::MAX, 8);
        assert_eq!((cut.next(), cut.next()), (Some(u64::MAX - 3..u64::MAX), None));
    }

    #[test]
    fn empty_plans_are_refused() {
        let good = Sampling::new(1, 5);
        let message = |sampling: Sampling| sampling.check().map_err(|e| e.to_string());
        assert_eq!(message(good.clone()), Ok(()));
        for (sampling, text) in [
            (Sampling { samples: 0, ..good.clone() }, "the number of samples is 0; at least 1 is needed"),
            (Sampling { block: 0, ..good.clone() }, "the number of samples per block is 0; at least 1 is needed"),
            (Sampling { threads: Some(0), ..good.clone() }, "the number of threads is 0; at least 1 is needed"),
            (
                Sampling { first: u64::MAX, ..good },
                "5 samples from index 18446744073709551615 on pass the largest index, 18446744073709551615",
            ),
        ] {
            assert_eq!(message(sampling), Err(text.to_string()));
        }
    }
}
