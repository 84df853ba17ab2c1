//! The trait of the solvers that compute all eigenvalues of a system.

use linsys::SecondOrder;

use crate::{CeaError, Spectrum, Workspace};

/// Finds all eigenvalues of a second-order system.
///
/// Eigenvectors are computed separately, by [`right_vector`](crate::right_vector) and [`left_vector`](crate::left_vector).
pub trait EigenSolver: Sync {
    /// All 2 n + s eigenvalues.
    ///
    /// # Errors
    /// A system that the solver does not support (one with a singular mass matrix, for example), or no convergence.
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
