//! What belongs to one thread of work, and the count of what it computed.

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

/// What belongs to one thread of work: counters now, scratch memory where a solver wants it.
#[derive(Debug, Default)]
pub struct Workspace {
    /// What was computed so far.
    pub counters: Counters,
    /// Memory of the batched solver, kept between batches.
    pub(crate) scratch: Vec<f64>,
}
