//! What an estimate is asked for.

use crate::Error;

/// Options of an estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Standard error to reach, relative to the probability, > 0.
    pub relative: f64,
    /// Number of evaluations that may be spent, including the evaluations of the search and of the points elsewhere. The search and the first lines, some
    /// thousand evaluations together, are made whatever the number is.
    pub budget: u64,
    /// Number of random directions, beside both of every input, from which design points are looked for.
    pub directions: usize,
    /// Seed of the random streams.
    pub seed: u64,
}

impl Default for Options {
    /// A standard error of 10 %, 2,000 evaluations, 32 directions and seed 1.
    fn default() -> Self {
        Self { relative: 0.1, budget: 2_000, directions: 32, seed: 1 }
    }
}

impl Options {
    /// Budgets that are allowed; chosen: more is no estimate of something rare.
    pub const BUDGETS: std::ops::RangeInclusive<u64> = 100..=10_000_000;

    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Option`].
    pub fn check(&self) -> Result<(), Error> {
        let refused = |name, value: String, allowed| Err(Error::Option { name, value, allowed });
        if !(self.relative > 0.0 && self.relative < 1.0) {
            return refused("relative", self.relative.to_string(), "a number between 0 and 1");
        }
        if !Self::BUDGETS.contains(&self.budget) {
            return refused("budget", self.budget.to_string(), "100 to 10000000 evaluations");
        }
        Ok(())
    }
}
