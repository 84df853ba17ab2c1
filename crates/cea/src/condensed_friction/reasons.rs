//! Reasons why the secular equation is not used: for any gain of a structure, or for one gain.

use num_complex::Complex;

/// Reason why a structure with feedback is left to spectra.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoSecular {
    /// A structure with `most` ports or more: a spectrum costs less than the secular equation.
    #[error("{ports} ports; with {order} degrees of freedom spectra cost less from {most} on")]
    ManyPorts {
        /// Number of ports.
        ports: usize,
        /// Degrees of freedom.
        order: usize,
        /// Least number of ports with which spectra cost less.
        most: usize,
    },
    /// The structure has internal states of its own.
    #[error("the structure has {states} internal states of its own; its response is not a sum over modes")]
    InternalStates {
        /// Number of internal states.
        states: usize,
    },
    /// The structure has overdamped modes, or modes that diverge.
    #[error("{oscillating} of {order} modes of the structure oscillate; all must")]
    Overdamped {
        /// Modes that oscillate.
        oscillating: usize,
        /// Degrees of freedom.
        order: usize,
    },
    /// A multiple eigenvalue of the structure has fewer vectors than members.
    #[error("the eigenvalue {lambda} of the structure is defective")]
    Defective {
        /// The eigenvalue, rad/s.
        lambda: Complex<f64>,
    },
    /// The sum over the modes differs from the response by a factorisation of Q; so also where B^T Q^-1 B is not symmetric.
    #[error("the modes of the structure do not add up to its response at lambda = {lambda}")]
    ResponseDiffers {
        /// The point at which the two were compared, rad/s.
        lambda: Complex<f64>,
    },
}

/// Reason why the modes with one gain have to be found by a spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, thiserror::Error)]
#[non_exhaustive]
pub enum LeftOpen {
    /// There is no anchor.
    #[error("no anchor to start from")]
    NoAnchor,
    /// The error bounds of two or more eigenvalues overlap, and corrections do not change that.
    #[error("the bounds of the eigenvalues do not come apart")]
    NotSeparated,
    /// Error bounds still overlap after the largest number of rounds of corrections.
    #[error("the guesses have not converged after {rounds} rounds")]
    RoundsExhausted {
        /// Number of rounds made.
        rounds: usize,
    },
    /// A wanted mode did not converge within its error bound.
    #[error("a wanted mode did not converge within its bound")]
    NoConvergence,
    /// A mode is so near the axis that rounding errors leave open whether it grows.
    #[error("a mode is too near the axis for its side to be certain")]
    NearAxis,
}
