//! The seam between a study and the way its eigenvalues are found.

use linsys::SecondOrder;

use crate::{CeaError, Spectrum};

/// Finds all eigenvalues of a second-order system.
///
/// Eigenvectors are another matter: [`right_vector`](crate::right_vector) and
/// [`left_vector`](crate::left_vector) find those that a scene asks for, whatever the solver.
pub trait EigenSolver: Sync {
    /// All 2 n + s eigenvalues.
    ///
    /// # Errors
    /// What the route cannot do (a singular mass matrix, say), or no convergence.
    fn eigenvalues(&self, system: &SecondOrder, work: &mut Workspace) -> Result<Spectrum, CeaError>;

    /// The eigenvalues of several systems of one shape; `out` is cleared and filled in their order.
    ///
    /// The result for a system does not depend on its neighbours, to the last bit.
    fn eigenvalues_of_all(
        &self,
        systems: &[SecondOrder],
        work: &mut Workspace,
        out: &mut Vec<Result<Spectrum, CeaError>>,
    ) {
        out.clear();
        for system in systems {
            let spectrum = self.eigenvalues(system, work);
            out.push(spectrum);
        }
    }
}

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
