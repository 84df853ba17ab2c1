//! Errors of reductions.

use cea::{CeaError, NoRealModes};
use linsys::LinsysError;
use sparse::SparseError;

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReductionError {
    /// A tolerance that is not above 0 and below 1.
    #[error("the tolerance of a reduction is {value}; it must be above 0 and below 1")]
    Tolerance {
        /// Value of the tolerance.
        value: f64,
    },
    /// A rectangle that contains no mode of the large system at any point that was looked at.
    #[error("no mode of the large system is in the rectangle")]
    NoModes,
    /// A dense decomposition did not converge, or its matrix has an entry that is not finite.
    #[error("the {what} could not be computed")]
    Decomposition {
        /// Name of the computation.
        what: &'static str,
    },
    /// Loss factors of a structure without real modes, of which dashpots could stand for them.
    #[error("loss factors need real modes of the structure, and {source}")]
    NoDashpots {
        /// Reason why there are none.
        source: NoRealModes,
    },
    /// The large system, or a search in it.
    #[error(transparent)]
    Sparse(#[from] SparseError),
    /// The dense solver of the reduced system failed.
    #[error(transparent)]
    Dense(#[from] CeaError),
    /// An operating point that does not belong to the reduced system, or a projection of it that is not finite.
    #[error(transparent)]
    System(#[from] LinsysError),
}
