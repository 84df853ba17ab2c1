//! The seam between those who need eigenvalues and the solvers that compute them.

use linsys::SecondOrder;

use crate::{CeaError, Spectrum, Workspace};

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
