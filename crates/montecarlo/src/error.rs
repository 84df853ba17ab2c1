//! What can go wrong in a run, a checkpoint or a statistic.

use std::io;
use std::path::PathBuf;

/// Errors of this crate. A failed evaluation is not among them: it is counted in [`Failures`](crate::Failures).
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MonteCarloError {
    /// The sampling, or the experiment, has none of something it needs.
    #[error("the number of {what} is 0; at least 1 is needed")]
    Zero {
        /// Samples, scenes, threads, samples per block.
        what: &'static str,
    },
    /// The global indices of the sampling do not fit in 64 bits.
    #[error("{samples} samples from index {first} on pass the largest index, {}", u64::MAX)]
    TooManySamples {
        /// First global index.
        first: u64,
        /// How many from there.
        samples: u64,
    },
    /// The thread pool could not be started.
    #[error("cannot start the worker threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// An experiment's `evaluate_block` gave too few or too many results.
    #[error("scene {scene} gave {found} results for {expected} samples from index {first} on")]
    BlockLength {
        /// The scene.
        scene: usize,
        /// Global index of the first sample of the block.
        first: u64,
        /// Samples handed over.
        expected: usize,
        /// Results returned.
        found: usize,
    },
    /// Two summaries that are not two neighbouring parts of one run.
    #[error("the summaries cannot be merged: {field} of the later one is {found}; {expected} is needed")]
    NotMergeable {
        /// What differs.
        field: &'static str,
        /// What fits.
        expected: u64,
        /// What the later summary has.
        found: u64,
    },
    /// A checkpoint could not be read or written. A previous checkpoint, if any, is still there.
    #[error("cannot {action} checkpoint {}: {source}", path.display())]
    CheckpointIo {
        /// Read or write.
        action: &'static str,
        /// The checkpoint, or the temporary file beside it.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A checkpoint is truncated or altered.
    #[error(
        "checkpoint {} is damaged: {damage}; put back an intact copy, or delete it to start from the first sample",
        path.display()
    )]
    CheckpointDamaged {
        /// The checkpoint.
        path: PathBuf,
        /// What is wrong with it.
        damage: Damage,
    },
    /// A checkpoint was written by another run.
    #[error(
        "checkpoint {} belongs to another run: its {field} is {found}, here it is {expected}; choose another folder, \
         or delete the checkpoint to start from the first sample",
        path.display()
    )]
    CheckpointMismatch {
        /// The checkpoint.
        path: PathBuf,
        /// Which part of the run's identity differs.
        field: &'static str,
        /// The value of this run.
        expected: String,
        /// The value in the file.
        found: String,
    },
    /// A checkpoint holds more samples than the run shall have.
    #[error(
        "checkpoint {} holds {found} samples already; samples = {wanted}; allowed: {found} or more, or another folder",
        path.display()
    )]
    CheckpointLonger {
        /// The checkpoint.
        path: PathBuf,
        /// Samples in the file.
        found: u64,
        /// Samples asked for.
        wanted: u64,
    },
    /// A tally that does not survive being written and read, for example because it holds an infinite float.
    #[error("the tally cannot be stored in checkpoint {}: {source}", path.display())]
    NotStorable {
        /// The checkpoint.
        path: PathBuf,
        /// What the encoder or the decoder said.
        source: serde_json::Error,
    },
    /// A statistic of nothing.
    #[error("no values: {statistic} is not defined")]
    Empty {
        /// Which statistic.
        statistic: &'static str,
    },
    /// A value that is NaN or infinite.
    #[error("value {index} is {value}; every value must be finite")]
    NotFinite {
        /// Where, from 0.
        index: usize,
        /// What stands there.
        value: f64,
    },
    /// A probability outside its range.
    #[error("{name} is {value}; it must lie {range}")]
    Probability {
        /// What it is used for.
        name: &'static str,
        /// The value.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// More hits than trials.
    #[error("{hits} hits in {trials} trials")]
    Hits {
        /// Hits, ambiguous ones included.
        hits: u64,
        /// Trials.
        trials: u64,
    },
    /// A distribution whose parameters are not allowed.
    #[error(transparent)]
    Distribution(#[from] DistributionFault),
    /// A truncated distribution that almost never reaches its bound.
    #[error("no draw in {attempts} reached {bound}; the distribution lies below its bound")]
    Redraw {
        /// The bound.
        bound: f64,
        /// Draws made.
        attempts: u32,
    },
}

/// A parameter of a distribution that is not allowed. Who reads it from a file prints the field before the key.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{key} = {value}; allowed: {allowed}")]
pub struct DistributionFault {
    /// Its key, as in a file.
    pub key: &'static str,
    /// What stands there.
    pub value: String,
    /// What may stand there.
    pub allowed: String,
}

/// What is wrong with a checkpoint file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Damage {
    /// The first line is not that of a checkpoint.
    #[error("it does not begin with the header of a checkpoint")]
    Header,
    /// Another version of the format.
    #[error("it has format version {found}, this program reads version {expected}")]
    Version {
        /// In the file.
        found: u32,
        /// What this program writes.
        expected: u32,
    },
    /// Truncated, or something was appended.
    #[error("{found} bytes follow its header, which announces {expected}")]
    Length {
        /// Announced.
        expected: usize,
        /// Present.
        found: usize,
    },
    /// The bytes are not those that were written.
    #[error("its checksum is {found:08x}, its header announces {expected:08x}")]
    Checksum {
        /// Announced.
        expected: u32,
        /// Of the bytes present.
        found: u32,
    },
    /// A state that cannot be one of the run whose identity stands above it: the file was made up.
    #[error("its {field} cannot be that of the run that it names")]
    State {
        /// What does not fit.
        field: &'static str,
    },
    /// Intact bytes that do not describe the state of such a run: the tally's type has changed since.
    #[error("its content is not the state of this run ({0})")]
    Content(serde_json::Error),
}
