//! Why the secular equation is not used: for a structure at all, or for one gain.

use num_complex::Complex;

/// Why a structure with feedback is left to spectra.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoSecular {
    /// A spectrum costs less than the determinants.
    #[error("{ports} ports; with {order} degrees of freedom spectra cost less from {most} on")]
    ManyPorts {
        /// How many there are.
        ports: usize,
        /// Degrees of freedom.
        order: usize,
        /// Most ports that the equation is used for, plus one.
        most: usize,
    },
    /// The structure has internal states of its own.
    #[error("the structure has {states} internal states of its own; its response is not a sum over modes")]
    InternalStates {
        /// How many.
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
    /// The sum over the modes is not what a factorisation of Q says; also where B^T Q^-1 B is not symmetric.
    #[error("the modes of the structure do not add up to its response at lambda = {lambda}")]
    ResponseDiffers {
        /// Where the two were compared, rad/s.
        lambda: Complex<f64>,
    },
}

/// Why the modes with one gain are left to a spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, thiserror::Error)]
#[non_exhaustive]
pub enum LeftOpen {
    /// No anchor is left from which all eigenvalues could be guessed.
    #[error("no anchor to start from")]
    NoAnchor,
    /// The bounds of some eigenvalues do not come apart, whatever is corrected.
    #[error("the bounds of the eigenvalues do not come apart")]
    NotSeparated,
    /// Corrections would go on.
    #[error("the guesses have not converged after {rounds} rounds")]
    RoundsExhausted {
        /// How many were made.
        rounds: usize,
    },
    /// A wanted mode did not converge within its own bound.
    #[error("a wanted mode did not converge within its bound")]
    NoConvergence,
    /// A mode is too near the axis for its side to be certain in spite of rounding.
    #[error("a mode is too near the axis for its side to be certain")]
    NearAxis,
}
