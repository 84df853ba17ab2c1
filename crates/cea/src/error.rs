//! What can go wrong in an eigenvalue analysis.

use linsys::LinsysError;
use num_complex::Complex;

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CeaError {
    /// The system itself is malformed.
    #[error(transparent)]
    System(#[from] LinsysError),
    /// The mass matrix is singular to working precision, so the standard form does not exist.
    #[error(
        "the mass matrix is singular (reciprocal condition number {reciprocal_condition:.1e}); the standard form needs its inverse"
    )]
    SingularMass {
        /// An estimate of 1 / cond(M).
        reciprocal_condition: f64,
    },
    /// The QR iteration stopped at its cap.
    #[error("the QR iteration did not converge within {iterations} steps for {dimension} eigenvalues")]
    NoConvergence {
        /// Iterations done.
        iterations: usize,
        /// Size of the state matrix.
        dimension: usize,
    },
    /// Inverse iteration found no vector with a small residual: `lambda` is not an eigenvalue.
    #[error("no eigenvector for lambda = {lambda}: relative residual {residual:.1e}")]
    NoEigenvector {
        /// The shift.
        lambda: Complex<f64>,
        /// Smallest normwise backward error reached.
        residual: f64,
    },
    /// Two sets of modes that should correspond do not have the same number of members.
    #[error("{left} modes cannot be matched to {right}")]
    ModeCount {
        /// Modes on one side.
        left: usize,
        /// Modes on the other.
        right: usize,
    },
}
