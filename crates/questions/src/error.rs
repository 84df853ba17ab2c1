//! Errors of questions about a brake, each one line for its user.

use std::path::PathBuf;

/// Error between a brake and an answer.
#[non_exhaustive]
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// An error of the study.
    #[error(transparent)]
    Study(#[from] study::Error),
    /// A sweep over parameters.
    #[error(transparent)]
    Sweep(Box<sweep::Error>),
    /// A scene in which nothing is drawn.
    #[error(
        "{study}: {scene}: nothing is drawn in this scene; allowed: a brake that names what it draws, with one distribution that is not constant"
    )]
    NoInputs {
        /// Path of the case file, or name of the study.
        study: String,
        /// Constraints, law, contacts and speed.
        scene: String,
    },
    /// Samples of a scene of which each failed.
    #[error("{scene}: each of {count} {what} failed, the first because: {reason}")]
    EachFailed {
        /// Constraints, law, contacts and speed.
        scene: String,
        /// `draws` or `rows of the design`.
        what: &'static str,
        /// Number of samples.
        count: u64,
        /// Reason why the first failed.
        reason: String,
    },
    /// A scene in which nothing grows, whose motion after the onset is asked for.
    #[error(
        "{scene}: no mode oscillates and grows, so that no motion follows; allowed: a scene that squeals, which `squeal cea` shows"
    )]
    NeverSqueals {
        /// Constraints, law, contacts and speed.
        scene: String,
    },
    /// A reduced brake that grows outside the band that its basis was made for, whose motion after the onset is asked for.
    #[error(
        "{scene}: the reduced brake grows outside its band too, {growth:.4e} 1/s at {hz:.4} Hz, which its motion would have and its basis was not made for; \
         allowed: a brake of which all that grows oscillates in the band, reduction.frequencies"
    )]
    GrowsOutside {
        /// Constraints, law, contacts and speed.
        scene: String,
        /// Frequency of what grows fastest outside, Hz.
        hz: f64,
        /// Growth rate of that, 1/s.
        growth: f64,
    },
    /// The motion after the onset.
    #[error(transparent)]
    Cycle(#[from] cycle::Error),
    /// Options of the probability of squeal that is rare.
    #[error(transparent)]
    Rare(#[from] ::rare::Error),
    /// The probability of squeal that is rare, of a study.
    #[error("{study}: {source}")]
    RareOf {
        /// Path of the case file, or name of the study.
        study: String,
        /// Cause.
        source: ::rare::Error,
    },
    /// A probability that is larger than a bound which is certified.
    #[error(
        "the probability is {lower:.2e} or more by samples and {bound:.2e} or less by the certificate of stability: one of them is wrong; allowed: \
         estimates that agree"
    )]
    BoundContradicted {
        /// Lower end of the interval by samples.
        lower: f64,
        /// Certified bound.
        bound: f64,
    },
    /// A vibration of which rounding leaves too few digits to tell whether it grows.
    #[error(
        "rounding leaves the vibration of {hz} Hz of a draw too few digits to tell whether it grows; allowed: ties up to some 1e6 times as stiff as what \
         vibrates beside them",
        hz = output::hertz(omega / std::f64::consts::TAU)
    )]
    Blunt {
        /// Im lambda, rad/s.
        omega: f64,
    },
    /// A reduced brake of whose errors nothing is known, where a sign is asked for that they decide.
    #[error(
        "{study}: {scene}: {why}, so that no sign of growth is known; allowed: a reduction that agrees with the whole brake, which reduction.growth and reduction.training change"
    )]
    UnknownError {
        /// Path of the case file, or name of the study.
        study: String,
        /// Constraints, law, contacts and speed.
        scene: String,
        /// Reason, in words.
        why: &'static str,
    },
    /// A computation by real systems, of a reduced brake whose loss factors have dashpots in their place there.
    #[error(
        "{study}: {needed_by} is by the matrices of the reduced brake, which have dashpots in the place of loss_factor, and so other onsets and growth; allowed: damping by rayleigh, {{ value, at_hz }} or viscoelastic in its place, or what uses the modes of samples: squeal run, influence, screen"
    )]
    LossFactors {
        /// Path of the case file, or name of the study.
        study: String,
        /// Name of the computation.
        needed_by: &'static str,
    },
    /// A capability that a computation needs, and the type of the brake does not give.
    #[error("{needed_by} needs {capability} of the brake, which its type does not give")]
    NotGiven {
        /// The method of [`UncertainBrake`](study::UncertainBrake) that is `None`.
        capability: &'static str,
        /// Computation that needs the capability.
        needed_by: &'static str,
    },
    /// A variant of a case that cannot be compared with it.
    #[error("variant {name:?}: {what} = {found}; allowed: {allowed}")]
    Variant {
        /// Name of the variant.
        name: String,
        /// What differs.
        what: &'static str,
        /// What the variant has.
        found: String,
        /// What is allowed, in words.
        allowed: String,
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
    /// An input that a computation cannot take.
    #[error("the input {input:?} is {value}; allowed: {allowed}")]
    Input {
        /// Name of the input.
        input: String,
        /// Fault of the input, in words.
        value: String,
        /// Inputs allowed, in words.
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

impl From<sweep::Error> for Error {
    /// The error of the study or of an argument where it is one.
    fn from(error: sweep::Error) -> Self {
        match error {
            sweep::Error::Study(error) => Self::Study(error),
            sweep::Error::NotGiven { capability, needed_by } => Self::NotGiven { capability, needed_by },
            sweep::Error::Argument { argument, value, allowed } => Self::Argument { argument, value, allowed },
            other => Self::Sweep(Box::new(other)),
        }
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
