//! Errors of a study, each one line for its user.

/// Error of a study, from its brake to its samples.
#[non_exhaustive]
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// An error of the model of a brake.
    #[error(transparent)]
    Model(#[from] osc_model::OscModelError),
    /// An error of a friction law.
    #[error(transparent)]
    Friction(#[from] friction::FrictionError),
    /// An error of an eigenvalue analysis.
    #[error(transparent)]
    Cea(#[from] cea::CeaError),
    /// Work in a mode.
    #[error(transparent)]
    Work(#[from] work::WorkError),
    /// Modes or branches that could not be followed.
    #[error(transparent)]
    Tracking(#[from] tracking::TrackingError),
    /// The Monte Carlo run.
    #[error(transparent)]
    MonteCarlo(#[from] montecarlo::MonteCarloError),
    /// A brake whose own median parameters have no modes to name the others after.
    #[error("{study}: at median parameters, where modes are named: {source}")]
    Median {
        /// The case file, or the name of the study.
        study: String,
        /// Cause.
        source: Box<Error>,
    },
    /// A scene whose reference modes cannot be found.
    #[error("{scene}: {source}")]
    Scene {
        /// Constraints, law, contacts and speed, as far as they matter.
        scene: String,
        /// Cause.
        source: Box<Error>,
    },
    /// A computation that would take more memory than there is.
    #[error("{what} take roughly {needed}, and {budget} are there; what would fit: {fits}, or more memory")]
    TooLarge {
        /// Name of the computation.
        what: String,
        /// Memory that it needs, in words.
        needed: String,
        /// Memory that is there, in words.
        budget: String,
        /// Smaller computation that would fit, in words.
        fits: String,
    },
    /// A fault of a brake of a user's own type, which forgets something or says it twice and differently.
    #[error(transparent)]
    Contradiction(#[from] crate::Contradiction),
    /// A sample that another brake has drawn.
    #[error("the sample is one of another brake; allowed: those that this brake draws")]
    OtherSample,
    /// An error of a brake of a user's own type.
    #[error("{0}")]
    Brake(Box<dyn std::error::Error + Send + Sync>),
    /// An eigenvalue of the full model that is not found next to one of the reduced.
    #[error("{0}")]
    WholeEigenvalue(Box<dyn std::error::Error + Send + Sync>),
    /// A system or an operating point.
    #[error(transparent)]
    System(#[from] linsys::LinsysError),
}

impl Error {
    /// True if this is the end of work that was [cancelled](montecarlo::Progress::is_cancelled), and no fault.
    pub fn is_cancelled(&self) -> bool {
        matches!(self, Self::MonteCarlo(montecarlo::MonteCarloError::Cancelled))
    }
}

/// Conversions of errors that a study knows into an error of a crate above it, which has a variant `Study` of [`Error`].
#[macro_export]
macro_rules! from_errors {
    ($above:ty: $($error:ty),+ $(,)?) => {
        $(impl From<$error> for $above {
            fn from(error: $error) -> Self {
                Self::Study(error.into())
            }
        })+
    };
}
