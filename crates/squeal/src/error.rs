//! Errors, each one line for its user.

use std::path::PathBuf;

/// Error between a study and its results.
#[non_exhaustive]
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// An error of the study.
    #[error(transparent)]
    Study(#[from] study::Error),
    /// A question about a brake.
    #[error(transparent)]
    Question(Box<questions::Error>),
    /// An error of an estimator of occurrences.
    #[error(transparent)]
    Estimator(Box<study::estimators::EstimatorError>),
    /// A draw that cannot be solved, where occurrences are estimated to a half width.
    #[error(
        "no occurrence to a half width, as a draw cannot be solved: {source}; or plain sampling, which counts draws that fail"
    )]
    Unsolved {
        /// Fault of the draw.
        source: Box<study::Error>,
    },
    /// An argument that does not fit the brake.
    #[error("{argument} = {value}; allowed: {allowed}")]
    Argument {
        /// Name of the argument.
        argument: &'static str,
        /// Value given.
        value: String,
        /// Values allowed, in words.
        allowed: String,
    },
    /// A folder that belongs to another study.
    #[error(
        "{}: holds {}; allowed: a new or empty folder, or that of the same study",
        path.display(), study::identity::difference(found, wanted)
    )]
    OtherStudy {
        /// The folder.
        path: PathBuf,
        /// Identity of the study that the folder holds, or its contents otherwise.
        found: String,
        /// Identity of the study to be run.
        wanted: String,
    },
    /// A part of a study that is not complete.
    #[error("{}: {found}; allowed: complete parts; {command} goes on", path.display())]
    PartIncomplete {
        /// Folder of the part.
        path: PathBuf,
        /// Samples that it has, in words.
        found: String,
        /// Command that continues it.
        command: String,
    },
    /// Parts of a study that lack samples.
    #[error("no part has the samples {missing}; allowed: parts that have all samples 0..{samples} once")]
    PartsMissing {
        /// Ranges of the samples that are missing, in words.
        missing: String,
        /// Number of samples of the study.
        samples: u64,
    },
    /// A part of a study that was made by another program, or where numbers are rounded otherwise.
    #[error("{}: {difference}; allowed: parts of one program and one kind of processor, or --mixed", path.display())]
    PartDiffers {
        /// Folder of the part.
        path: PathBuf,
        /// Difference from another part, or from this machine, in words.
        difference: String,
    },
    /// Estimates in a folder that are truncated or altered, or of another version of the program.
    #[error(
        "estimates {} are damaged: {damage}; put back an intact copy, or delete them to estimate anew",
        path.display()
    )]
    EstimatesDamaged {
        /// The file.
        path: PathBuf,
        /// Damage of the file.
        damage: montecarlo::Damage,
    },
    /// A folder that cannot be compared with another.
    #[error("{}: {found}; allowed: folders of finished studies with one threshold, one band and scenes in common", path.display())]
    NotComparable {
        /// The folder.
        path: PathBuf,
        /// Obstacle, in words.
        found: String,
    },
    /// A folder that another run writes to.
    #[error("{}: {by} is writing there; allowed: another folder, or wait until it has ended", path.display())]
    InUse {
        /// The folder.
        path: PathBuf,
        /// Other run, with its process and age where they are known.
        by: String,
    },
    /// A folder that was removed or taken by another run while this one worked.
    #[error(
        "{}: is no longer the folder of this run: it was removed or made anew meanwhile; allowed: another folder, or the same \
         again, when nobody works there",
        path.display()
    )]
    FolderLost {
        /// The folder.
        path: PathBuf,
    },
    /// A file or folder that cannot be written.
    #[error(transparent)]
    Output(#[from] output::OutputError),
    /// A file that cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
}

impl Error {
    /// True if this is the end of work that was [cancelled](montecarlo::Progress::is_cancelled), and no fault.
    pub fn is_cancelled(&self) -> bool {
        matches!(self, Self::Study(error) if error.is_cancelled())
    }
}

impl From<questions::Error> for Error {
    /// The error of the study, of an argument or of a file where it is one.
    fn from(error: questions::Error) -> Self {
        match error {
            questions::Error::Study(error) => Self::Study(error),
            questions::Error::Argument { argument, value, allowed } => Self::Argument { argument, value, allowed },
            questions::Error::OtherStudy { path, found, wanted } => Self::OtherStudy { path, found, wanted },
            questions::Error::Output(error) => Self::Output(error),
            questions::Error::Read { path, source } => Self::Read { path, source },
            other => Self::Question(Box::new(other)),
        }
    }
}

impl From<sweep::Error> for Error {
    fn from(error: sweep::Error) -> Self {
        questions::Error::from(error).into()
    }
}

study::from_errors!(
    Error:
    osc_model::OscModelError,
    friction::FrictionError,
    linsys::LinsysError,
    cea::CeaError,
    work::WorkError,
    tracking::TrackingError,
    montecarlo::MonteCarloError,
    study::Contradiction
);
