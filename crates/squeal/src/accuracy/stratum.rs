//! How often guess and truth differ among samples of one kind, with limits that hold for any number of them.

use std::collections::{BTreeMap, BTreeSet};

use montecarlo::{exact_lower_limit, exact_upper_limit};

/// Part of a probability that the upper of four limits use; the lower ones help where guess and truth often differ.
const UPPER: f64 = 0.9;

/// Differences that are counted in any case.
const NOT_SEEN: f64 = 4.0;

/// In how many samples guess and truth of a mode differed.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Differences {
    /// Surely unstable: in truth and not by the guess, by the guess and not in truth.
    sure: [u64; 2],
    /// The same of perhaps unstable.
    perhaps: [u64; 2],
    /// Either.
    any: u64,
}

/// Counts of samples of one kind: those of which the guess is clear, or doubtful.
#[derive(Debug, Clone, Default)]
pub(super) struct Stratum {
    pub samples: u64,
    /// By name.
    pub differences: BTreeMap<u16, Differences>,
    /// Those in which the guess was wrong about any mode.
    pub wrong: u64,
}

impl Stratum {
    /// Guess and truth of one sample, by name: whether it is sure that the mode is unstable, or open.
    pub fn enter(&mut self, guess: &BTreeMap<u16, bool>, truth: &BTreeMap<u16, bool>) {
        let names: BTreeSet<u16> =
            guess.keys().chain(truth.keys()).copied().filter(|name| guess.get(name) != truth.get(name)).collect();
        for name in &names {
            let difference = self.differences.entry(*name).or_default();
            let mut count = |counts: fn(&mut Differences) -> &mut [u64; 2], guess: bool, truth: bool| {
                counts(difference)[0] += u64::from(truth && !guess);
                counts(difference)[1] += u64::from(guess && !truth);
            };
            let (guess, truth) = (guess.get(name), truth.get(name));
            count(|d| &mut d.sure, guess == Some(&true), truth == Some(&true));
            count(|d| &mut d.perhaps, guess.is_some(), truth.is_some());
            difference.any += 1;
        }
        self.samples += 1;
        self.wrong += u64::from(!names.is_empty());
    }

    /// By how much the probability of a mode among such samples may be below and above that of the guess.
    pub fn limits(&self, name: u16, tail: f64, is_joint: bool) -> [f64; 2] {
        let d = self.differences.get(&name).copied().unwrap_or_default();
        if is_joint {
            // One limit of the probability that guess and truth differ, whichever way.
            return [exact_upper_limit(d.any, self.samples, tail); 2];
        }
        let at_most = |hits: u64| exact_upper_limit(hits, self.samples, 0.5 * UPPER * tail);
        let at_least = |hits: u64| exact_lower_limit(hits, self.samples, 0.5 * (1.0 - UPPER) * tail);
        [at_most(d.sure[1]) - at_least(d.sure[0]), at_most(d.perhaps[0]) - at_least(d.perhaps[1])]
    }

    /// The largest part of the samples in which the guess about a mode was wrong, and a standard deviation more.
    pub fn most_wrong(&self) -> f64 {
        let any = self.differences.values().map(|d| d.any).max().unwrap_or(0).max(1) as f64;
        (any + any.sqrt()) / self.samples.max(1) as f64
    }

    /// Standard error of such a shift. Some differences are counted that were not seen, so that few do not pass for none: for
    /// none this is the upper limit of Wilson's interval at two deviations.
    pub fn deviation(&self, name: u16) -> f64 {
        let any = self.differences.get(&name).map_or(0, |d| d.any);
        let samples = self.samples.max(1) as f64;
        ((any as f64 + NOT_SEEN) / (samples + NOT_SEEN) / samples).sqrt()
    }

    /// By how much that of a mode surely, and of a mode perhaps unstable seems to be above the guess.
    pub fn shift(&self, name: u16) -> [f64; 2] {
        let d = self.differences.get(&name).copied().unwrap_or_default();
        [d.sure, d.perhaps].map(|[more, less]| (more as f64 - less as f64) / self.samples.max(1) as f64)
    }
}
