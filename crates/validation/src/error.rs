//! What can stand in the way of a validation.

/// Errors of this crate.
#[derive(Debug, thiserror::Error)]
pub enum ValidationError {
    /// An estimator of occurrences.
    #[error(transparent)]
    Estimator(#[from] squeal::estimators::EstimatorError),
    /// The model, a law or the case.
    #[error(transparent)]
    Study(#[from] squeal::Error),
    /// A solver.
    #[error(transparent)]
    Cea(#[from] cea::CeaError),
    /// Matrices that make no system.
    #[error(transparent)]
    Linsys(#[from] linsys::LinsysError),
    /// A case without scenes of a law that is needed.
    #[error("the case has no scene of the law {law:?}")]
    NoScene {
        /// The law.
        law: squeal::case::Law,
    },
    /// An eigenvalue without a derivative.
    #[error("lambda = {lambda} is defective or multiple: it has no Taylor series")]
    Defective {
        /// The eigenvalue.
        lambda: num_complex::Complex<f64>,
    },
    /// A search that did not converge.
    #[error("the search for {what} did not converge: {left:e} left after {steps} steps")]
    NoConvergence {
        /// What was searched.
        what: &'static str,
        /// Residual.
        left: f64,
        /// Steps taken.
        steps: usize,
    },
}
