//! Errors of general eigenproblems.

use linsys::LinsysError;
use num_complex::Complex;

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CertifiedError {
    /// The system itself is malformed.
    #[error(transparent)]
    System(#[from] LinsysError),
    /// The QR iteration reached its largest number of steps.
    #[error("the QR iteration did not converge to an eigenvalue within {iterations} steps ({dimension} eigenvalues)")]
    NoConvergence {
        /// Largest number of steps per eigenvalue.
        iterations: usize,
        /// Size of the state matrix.
        dimension: usize,
    },
    /// Eigenvalues that are beyond the range of a double, or whose squares are, which bounds and vectors need.
    #[error(
        "an eigenvalue or its square overflows or underflows: the entries of the scaled matrices span {smallest:.0e} to {largest:.0e}"
    )]
    Range {
        /// Smallest nonzero magnitude.
        smallest: f64,
        /// Largest.
        largest: f64,
    },
    /// A matrix in units in which its entries leave the range of a double.
    #[error(
        "the largest entry of the {matrix} matrix is {largest:e}; allowed: 1e-300 to 1e300 in size, or a matrix of zeros: choose other units"
    )]
    Units {
        /// mass, damping or stiffness.
        matrix: &'static str,
        /// Magnitude of its largest entry.
        largest: f64,
    },
    /// The pencil is singular: every lambda is an eigenvalue.
    #[error(
        "det(lambda^2 M + lambda C + K) {}",
        if *.exactly { "vanishes for every lambda: the problem is singular and has no spectrum" }
        else { "vanishes for every lambda up to rounding of the entries: in doubles the problem cannot be told from a singular \
                one, which has no spectrum" }
    )]
    SingularPencil {
        /// True if the given matrices are singular; otherwise a perturbation of them of the size of a rounding error is.
        exactly: bool,
    },
    /// Inverse iteration found no vector with a small residual: `lambda` is not an eigenvalue.
    #[error("no eigenvector for lambda = {lambda}: relative residual {residual:.1e}")]
    NoEigenvector {
        /// The shift.
        lambda: Complex<f64>,
        /// Smallest normwise backward error reached.
        residual: f64,
    },
}
