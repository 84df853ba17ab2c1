//! What belongs to one thread of work, and the count of what it computed.

/// Counts what was computed, so that a test can pin the price of a scene.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counters {
    /// Whole spectra computed.
    pub eigenvalue_solves: u64,
    /// Those of them that a [`QrSolver`](crate::QrSolver) left to [`certified`](crate::certified), up to a hundred times slower.
    pub certified_solves: u64,
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
    /// How many `certified_solves` a solver may come to before it gives up; `None` is any number.
    pub most_certified_solves: Option<u64>,
    /// Memory of the batched solver, kept between batches.
    pub(crate) scratch: Vec<f64>,
}

impl Workspace {
    /// Counters at zero, for solvers that give up after so many certified spectra.
    #[must_use]
    pub fn with_most_certified_solves(most: u64) -> Self {
        Self { most_certified_solves: Some(most), ..Self::default() }
    }
}
