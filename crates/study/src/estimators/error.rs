//! Errors of estimators.

/// Errors of this module.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
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
    /// Branches that are not resolved, modes that do not oscillate, onsets that are not found or contradict the spectra.
    #[error(transparent)]
    Tracking(tracking::TrackingError),
    /// A scene whose samples are no functions of a point of the unit cube, or whose friction is not one gain in all contacts.
    #[error("this estimator needs samples by quantiles, and friction that is the same in all contacts")]
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

impl From<tracking::TrackingError> for EstimatorError {
    fn from(error: tracking::TrackingError) -> Self {
        match error {
            tracking::TrackingError::Cea(error) => error.into(),
            other => Self::Tracking(other),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tracking::TrackingError;

    #[test]
    fn an_error_of_a_solver_is_none_of_tracking() {
        let of_solver = cea::CeaError::from(linsys::LinsysError::Empty);
        assert!(matches!(TrackingError::from(of_solver).into(), EstimatorError::Study(crate::Error::Cea(_))));
        let unresolved = TrackingError::Unresolved { at: 0.5, spectra: 7 };
        assert!(matches!(unresolved.into(), EstimatorError::Tracking(TrackingError::Unresolved { .. })));
    }
}
