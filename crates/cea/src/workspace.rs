//! Scratch memory and counters of one thread.

use std::iter::Sum;
use std::ops::{Add, AddAssign};

/// Counts what was computed, so that a test can pin the price of a scene.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counters {
    /// Whole spectra computed.
    pub eigenvalue_solves: u64,
    /// Number of whole spectra that a [`QrSolver`](crate::QrSolver) left to [`certified`](crate::certified), up to a hundred times slower.
    pub certified_solves: u64,
    /// Factorisations of `Q(lambda)` or of a pencil.
    pub factorisations: u64,
    /// Right or left eigenvectors computed.
    pub eigenvectors: u64,
    /// Values of secular equations.
    pub secular_values: u64,
    /// Gains whose growing modes secular equations found; those left open cost a spectrum each.
    pub secular_answers: u64,
    /// Modes that were followed by continuation, because MAC left a doubt.
    pub continuations: u64,
}

impl AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        // By its fields, so that a new one is not forgotten.
        let Self {
            eigenvalue_solves,
            certified_solves,
            factorisations,
            eigenvectors,
            secular_values,
            secular_answers,
            continuations,
        } = other;
        self.eigenvalue_solves += eigenvalue_solves;
        self.certified_solves += certified_solves;
        self.factorisations += factorisations;
        self.eigenvectors += eigenvectors;
        self.secular_values += secular_values;
        self.secular_answers += secular_answers;
        self.continuations += continuations;
    }
}

impl AddAssign<certified::Counters> for Counters {
    fn add_assign(&mut self, other: certified::Counters) {
        let certified::Counters { eigenvalue_solves, factorisations, eigenvectors } = other;
        self.eigenvalue_solves += eigenvalue_solves;
        self.factorisations += factorisations;
        self.eigenvectors += eigenvectors;
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

/// Workspace of one thread: counters, and scratch memory where a solver wants it.
#[derive(Debug, Default)]
pub struct Workspace {
    /// Computations so far.
    pub counters: Counters,
    /// Number of `certified_solves` that a solver may come to before it gives up; `None` is any number.
    pub most_certified_solves: Option<u64>,
    /// Memory of the batched solver, kept between batches.
    pub(crate) scratch: Vec<f64>,
}

impl Workspace {
    /// A workspace with counters at zero, whose solvers give up after `most` certified spectra.
    #[must_use]
    pub fn with_most_certified_solves(most: u64) -> Self {
        Self { most_certified_solves: Some(most), ..Self::default() }
    }

    /// Computes by [`certified`], and counts here what that takes.
    pub fn counting<T>(&mut self, compute: impl FnOnce(&mut certified::Counters) -> T) -> T {
        let mut counters = certified::Counters::default();
        let computed = compute(&mut counters);
        self.counters += counters;
        computed
    }
}

#[cfg(test)]
mod tests {
    use super::Counters;

    #[test]
    fn every_count_is_summed() {
        let one = Counters {
            eigenvalue_solves: 1,
            certified_solves: 6,
            factorisations: 2,
            eigenvectors: 3,
            secular_values: 4,
            secular_answers: 7,
            continuations: 5,
        };
        let three = Counters {
            eigenvalue_solves: 3,
            certified_solves: 18,
            factorisations: 6,
            eigenvectors: 9,
            secular_values: 12,
            secular_answers: 21,
            continuations: 15,
        };
        assert_eq!([one; 3].into_iter().sum::<Counters>(), three);
        assert_eq!(one + one + one, three);
    }
}
