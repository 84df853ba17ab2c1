//! Errors of following modes and branches.

use cea::CeaError;
use linsys::LinsysError;

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TrackingError {
    /// An eigenvalue or an eigenvector could not be computed.
    #[error(transparent)]
    Cea(#[from] CeaError),
    /// The search for an onset within a bracket did not converge.
    #[error("the search for an onset between {from} and {to} did not converge: {left:e} left after {steps} steps")]
    OnsetNotConverged {
        /// Lower end of the bracket.
        from: f64,
        /// Upper end of the bracket.
        to: f64,
        /// Length of the last step.
        left: f64,
        /// Number of steps taken.
        steps: usize,
    },
    /// The spectra between two onsets contradict the onsets found.
    #[error("at the parameter {at} {found} modes are unstable; the onsets below it leave {expected}")]
    OnsetsContradicted {
        /// The parameter.
        at: f64,
        /// Unstable modes by the spectrum.
        found: usize,
        /// Unstable modes by counting onsets.
        expected: i64,
    },
    /// The limit of spectra was reached before the branches were told apart.
    #[error("the branches around the parameter {at} are not resolved after {spectra} spectra")]
    Unresolved {
        /// The parameter.
        at: f64,
        /// Spectra computed.
        spectra: usize,
    },
    /// An interval that does not go from a finite number to a larger one.
    #[error("the interval from {from} to {to} must go from a finite number to a larger one")]
    Interval {
        /// Lower end of the interval.
        from: f64,
        /// Upper end of the interval.
        to: f64,
    },
    /// Modes that do not oscillate, or cease to, within an interval in which branches are followed.
    #[error("at the parameter {at} {found} modes oscillate instead of {expected}; branches are followed where all do")]
    ModeCount {
        /// The parameter.
        at: f64,
        /// Oscillating modes at this parameter.
        found: usize,
        /// Oscillating modes at the first parameter.
        expected: usize,
    },
}

/// An error unless `from` and `to` are finite and `from` < `to`.
pub(crate) fn check_interval(from: f64, to: f64) -> Result<(), TrackingError> {
    if from < to && (to - from).is_finite() { Ok(()) } else { Err(TrackingError::Interval { from, to }) }
}

impl From<LinsysError> for TrackingError {
    fn from(error: LinsysError) -> Self {
        Self::Cea(error.into())
    }
}
