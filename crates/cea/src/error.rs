//! Errors of an eigenvalue analysis.

use linsys::LinsysError;
use num_complex::Complex;

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CeaError {
    /// The system itself is malformed.
    #[error(transparent)]
    System(#[from] LinsysError),
    /// The standard form needs a symmetric positive definite mass matrix.
    #[error("the mass matrix is not symmetric positive definite (row {row}); the standard form needs one that is")]
    MassNotPositiveDefinite {
        /// The row, from 1, where this shows first.
        row: usize,
    },
    /// The QR iteration reached its largest number of steps.
    #[error("the QR iteration did not converge to an eigenvalue within {iterations} steps ({dimension} eigenvalues)")]
    NoConvergence {
        /// Largest number of steps per eigenvalue.
        iterations: usize,
        /// Size of the state matrix.
        dimension: usize,
    },
    /// A solver that has come to the most certified spectra that its workspace allows.
    #[error(
        "dashpots or internal states are {ratio:.0e} times as fast as the vibrations, and {solves} spectra with more digits than \
         a double's were not enough; allowed: up to 100 times as fast, which needs none"
    )]
    TooStiff {
        /// Norm of the damping, or the fastest internal state, over that of the vibrations.
        ratio: f64,
        /// How many there were.
        solves: u64,
    },
    /// A solver that has not given every eigenvalue.
    #[error(
        "the solver gave {found} eigenvalues of a system that has {expected}; what is missing would count as stable"
    )]
    SpectrumLength {
        /// Eigenvalues given.
        found: usize,
        /// 2 n + s.
        expected: usize,
    },
    /// A solver whose eigenvalues are not those of a real system, sorted.
    #[error(
        "the solver gave {lambda} where an eigenvalue of a real system would not stand; allowed: finite ones, sorted by frequency, complex \
         ones in exact conjugate pairs"
    )]
    SpectrumOrder {
        /// The first that does not fit.
        lambda: Complex<f64>,
    },
    /// A solver that has not given one spectrum for each system.
    #[error("the solver gave {found} spectra of {expected} systems")]
    SpectraCount {
        /// Spectra given.
        found: usize,
        /// Systems.
        expected: usize,
    },
    /// Eigenvalues beyond the range of a double.
    #[error(
        "an eigenvalue overflows or underflows: the entries of the scaled matrices span {smallest:.0e} to {largest:.0e}"
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
        /// Whether the given matrices are singular; otherwise a perturbation of them of the size of a rounding error is.
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
    /// An eigenvalue that has no derivatives.
    #[error("lambda = {lambda} is defective: it has no derivatives")]
    Defective {
        /// The eigenvalue.
        lambda: Complex<f64>,
    },
    /// Channels whose shapes do not fit the system, or a system with internal states, for which channels are not supported.
    #[error("the channels do not fit a system of order {order} with {states} internal states, which must be none")]
    Channels {
        /// Degrees of freedom of the system.
        order: usize,
        /// Its internal states.
        states: usize,
    },
}
