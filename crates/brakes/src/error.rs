//! Errors of the brakes that case files make, each one line for its user.

use std::path::PathBuf;

/// Error in making a brake of its case file, or in what that brake computes.
#[non_exhaustive]
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The case file.
    #[error(transparent)]
    Case(#[from] case::CaseError),
    /// A large brake.
    #[error(transparent)]
    Sparse(#[from] sparse::SparseError),
    /// The reduction of a large brake.
    #[error(transparent)]
    Reduction(#[from] reduction::ReductionError),
    /// A brake whose arrangements have bases of their own, where one basis is needed.
    #[error(
        "{study}: each arrangement has a basis of its own; what is attached needs one for all of a set of constraints"
    )]
    SeveralBases {
        /// The case file, or the name of the study.
        study: String,
    },
    /// A file of a prepared brake that cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    PreparedRead {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// A file that is no prepared brake, or was cut or changed.
    #[error("{}: no prepared brake, or a damaged one: {source}; allowed: a file that squeal prepare wrote", path.display())]
    PreparedDamage {
        /// The file.
        path: PathBuf,
        /// The part of the file that is wrong.
        source: montecarlo::Damage,
    },
    /// A prepared brake of another program, or of a processor that rounds differently: its numbers are not those of this one to the last bit.
    #[error("{}: prepared by squeal {found}; allowed: by squeal {expected}", path.display())]
    PreparedElsewhere {
        /// The file.
        path: PathBuf,
        /// Version, commit and rounding of the program that wrote it.
        found: String,
        /// Version, commit and rounding of this program.
        expected: String,
    },
    /// A prepared brake that is not the one of the case.
    #[error("{}: holds {found}; allowed: what squeal prepare writes for this case", path.display())]
    PreparedOther {
        /// The file.
        path: PathBuf,
        /// Contents of the file, in words.
        found: String,
    },
    /// A prepared brake that cannot be written.
    #[error(transparent)]
    PreparedWrite(Box<output::OutputError>),
    /// Friction of which only the tangent at steady sliding is there, so that no motion can be followed in time.
    #[error("{what} has no motion here, only a tangent; allowed: {allowed}")]
    Motion {
        /// Name of the friction, in words.
        what: &'static str,
        /// Friction whose motion is followed, in words.
        allowed: &'static str,
    },
    /// Equations of the motion after the onset.
    #[error(transparent)]
    Cycle(#[from] cycle::Error),
    /// The model, its friction or a study of it.
    #[error(transparent)]
    Study(#[from] study::Error),
    /// A range of a parameter that a brake is made for.
    #[error(transparent)]
    Sweep(#[from] sweep::Error),
}

impl Error {
    /// True if this is the end of work that was [cancelled](montecarlo::Progress::is_cancelled), and no fault.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        match self {
            Self::Study(error) => error.is_cancelled(),
            Self::Sweep(error) => error.is_cancelled(),
            Self::Cycle(cycle::Error::Stopped) => true,
            _ => false,
        }
    }
}

impl From<Error> for study::Error {
    /// The error of the study where it is one; every other becomes an error of the brake.
    fn from(error: Error) -> Self {
        match error {
            Error::Study(error) | Error::Sweep(sweep::Error::Study(error)) => error,
            other => Self::Brake(Box::new(other)),
        }
    }
}

study::from_errors!(
    Error:
    osc_model::OscModelError,
    friction::FrictionError,
    linsys::LinsysError,
    cea::CeaError,
    tracking::TrackingError,
    montecarlo::MonteCarloError
);
