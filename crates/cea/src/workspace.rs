//! What belongs to one thread of work, and the count of what it computed.

use std::iter::Sum;
use std::ops::{Add, AddAssign};

/// Counts what was computed, so that a test can pin the price of a scene.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counters {
    /// Whole spectra computed.
    pub eigenvalue_solves: u64,
    /// Factorisations of `Q(lambda)` or of a pencil.
    pub factorisations: u64,
    /// Right or left eigenvectors computed.
    pub eigenvectors: u64,
    /// Values of secular equations.
    pub secular_values: u64,
    /// Modes that had to be followed by continuation, because MAC alone left a doubt.
    pub continuations: u64,
}

impl AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        // By its fields, so that a new one is not forgotten.
        let Self { eigenvalue_solves, factorisations, eigenvectors, secular_values, continuations } = other;
        self.eigenvalue_solves += eigenvalue_solves;
        self.factorisations += factorisations;
        self.eigenvectors += eigenvectors;
        self.secular_values += secular_values;
        self.continuations += continuations;
    }
}

impl Add for Counters {
    type Output = Self;

    fn add(mut self, other: Self) -> Self {
        self += other;
        self
    }
}

impl Sum for Counters {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), Self::add)
    }
}

/// What belongs to one thread of work: counters now, scratch memory where a solver wants it.
#[derive(Debug, Default)]
pub struct Workspace {
    /// What was computed so far.
    pub counters: Counters,
    /// Memory of the batched solver, kept between batches.
    pub(crate) scratch: Vec<f64>,
}

#[cfg(test)]
mod tests {
    use super::Counters;

    #[test]
    fn every_count_is_summed() {
        let one =
            Counters { eigenvalue_solves: 1, factorisations: 2, eigenvectors: 3, secular_values: 4, continuations: 5 };
        let three = Counters {
            eigenvalue_solves: 3,
            factorisations: 6,
            eigenvectors: 9,
            secular_values: 12,
            continuations: 15,
        };
        assert_eq!([one; 3].into_iter().sum::<Counters>(), three);
        assert_eq!(one + one + one, three);
    }
}
