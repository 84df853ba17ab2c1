//! Errors of an eigenvalue analysis.

use certified::CertifiedError;
use linsys::LinsysError;
use num_complex::Complex;

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CeaError {
    /// The system itself is malformed.
    #[error(transparent)]
    System(#[from] LinsysError),
    /// Error of [`certified`], and for the same reasons of the solvers here: no convergence, no eigenvector, no range.
    #[error(transparent)]
    Certified(#[from] CertifiedError),
    /// The standard form needs a symmetric positive definite mass matrix.
    #[error("the mass matrix is not symmetric positive definite (row {row}); the standard form needs one that is")]
    MassNotPositiveDefinite {
        /// The row, from 1, where this shows first.
        row: usize,
    },
    /// A solver that has come to the most certified spectra that its workspace allows.
    #[error(
        "dashpots or internal states are {ratio:.0e} times as fast as the vibrations, and {solves} spectra with more digits than \
         a double's were not enough; allowed: up to 100 times as fast, which needs none"
    )]
    TooStiff {
        /// Norm of the damping, or the fastest internal state, over that of the vibrations.
        ratio: f64,
        /// Number of spectra with more digits than a double's that there were.
        solves: u64,
    },
    /// A solver that has not given every eigenvalue.
    #[error(
        "the solver gave {found} eigenvalues of a system that has {expected}; what is missing would count as stable"
    )]
    SpectrumLength {
        /// Eigenvalues given.
        found: usize,
        /// Number of eigenvalues expected: 2 n + s.
        expected: usize,
    },
    /// A solver whose eigenvalues are not those of a real system, sorted.
    #[error(
        "the solver gave {lambda} where an eigenvalue of a real system would not stand; allowed: finite ones, sorted by frequency, complex \
         ones in exact conjugate pairs"
    )]
    SpectrumOrder {
        /// Eigenvalue that does not fit, the first one.
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
        /// Number of internal states of the system.
        states: usize,
    },
}
