//! Errors of a validation.

/// Errors of this crate.
#[derive(Debug, thiserror::Error)]
pub enum ValidationError {
    /// An error of an estimator of occurrences.
    #[error(transparent)]
    Estimator(#[from] squeal::estimators::EstimatorError),
    /// An error of a study.
    #[error(transparent)]
    Study(#[from] squeal::Error),
    /// An error of the samples of a study.
    #[error(transparent)]
    Samples(#[from] squeal::study::Error),
    /// An error of the model, a friction law or the case.
    #[error(transparent)]
    Brake(#[from] brakes::Error),
    /// An error of a solver.
    #[error(transparent)]
    Cea(#[from] cea::CeaError),
    /// An error of a system's matrices.
    #[error(transparent)]
    Linsys(#[from] linsys::LinsysError),
    /// A file that cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: std::path::PathBuf,
        /// Reason why it cannot be read.
        source: std::io::Error,
    },
    /// A file that does not hold a matrix.
    #[error("{}: {source}", path.display())]
    Matrix {
        /// The file.
        path: std::path::PathBuf,
        /// The line and what is wrong there.
        source: Box<formats::FormatsError>,
    },
    /// An error of a figure.
    #[error(transparent)]
    Figure(#[from] figures::FigureError),
    /// A file that cannot be written.
    #[error(transparent)]
    Output(#[from] squeal::output::OutputError),
    /// The case has no scene with a law that is needed.
    #[error("the case has no scene of the law {law:?}")]
    NoScene {
        /// The law.
        law: brakes::case::Law,
    },
    /// An eigenvalue has no derivative.
    #[error("lambda = {lambda} is defective or multiple: it has no Taylor series")]
    Defective {
        /// The eigenvalue.
        lambda: num_complex::Complex<f64>,
    },
    /// A search that did not converge.
    #[error("the search for {what} did not converge: {left:e} left after {steps} steps")]
    NoConvergence {
        /// Name of what was searched for.
        what: &'static str,
        /// The residual left.
        left: f64,
        /// Number of steps taken.
        steps: usize,
    },
}
