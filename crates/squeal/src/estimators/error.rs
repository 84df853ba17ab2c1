//! Errors of estimators.

/// Errors of this module.
#[derive(Debug, thiserror::Error)]
pub enum EstimatorError {
    /// An error of the model, a friction law, a solver or the case.
    #[error(transparent)]
    Study(#[from] crate::Error),
    /// A scene whose systems are not an affine function of one uncertain parameter.
    #[error("the exact integral needs {needed}; the scene has {found}")]
    NotOneParameter {
        /// The requirement that the scene does not meet.
        needed: &'static str,
        /// The property of the scene.
        found: String,
    },
    /// Real eigenvalues, although branches are followed only where all modes oscillate.
    #[error("at mu = {mu} the structure has {real} real eigenvalues; branches are followed where all modes oscillate")]
    NotOscillating {
        /// The friction coefficient.
        mu: f64,
        /// Real eigenvalues there.
        real: usize,
    },
    /// Branches that are not resolved, or whose onsets are not found or contradict the spectra.
    #[error(transparent)]
    Tracking(#[from] tracking::TrackingError),
    /// Quasi-Monte Carlo over more dimensions than a draw shared by all contacts has.
    #[error("quasi-Monte Carlo needs one draw shared by all contacts; the case has a draw for each")]
    NotShared,
    /// A number of Sobol points or scramblings that is not allowed.
    #[error("{points} points in {scramblings} scramblings; allowed: 1 to 65536 points, 2 scramblings or more")]
    Points {
        /// Points of each scrambling.
        points: u32,
        /// Number of scramblings.
        scramblings: u32,
    },
}

impl From<cea::CeaError> for EstimatorError {
    fn from(error: cea::CeaError) -> Self {
        Self::Study(error.into())
    }
}
