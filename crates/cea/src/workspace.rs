//! Scratch memory and counters of one thread.

/// Numbers of computations, so that a test can fix the cost of an analysis.
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
    /// Modes that were followed by continuation, because MAC left a doubt.
    pub continuations: u64,
}

/// Counters and scratch memory of one thread.
#[derive(Debug, Default)]
pub struct Workspace {
    /// Computations so far.
    pub counters: Counters,
    /// Memory of the batched solver, kept between batches.
    pub(crate) scratch: Vec<f64>,
}
