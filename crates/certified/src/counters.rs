//! Counters of what was computed.

/// Counts what was computed, so that a test can pin the price of it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counters {
    /// Whole spectra computed.
    pub eigenvalue_solves: u64,
    /// Factorisations of `Q(lambda)`.
    pub factorisations: u64,
    /// Right or left eigenvectors computed.
    pub eigenvectors: u64,
}
