//! Errors of runs, checkpoints and statistics.

use std::io;
use std::path::PathBuf;

/// Errors of this crate. A failed evaluation is not among them: it is counted in [`Failures`](crate::Failures).
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MonteCarloError {
    /// A run that [`Progress::is_cancelled`](crate::Progress::is_cancelled) ended. What it had is in its checkpoint, if it has one.
    #[error("cancelled")]
    Cancelled,
    /// A number of the sampling or of the experiment is 0.
    #[error("the number of {what} is 0; at least 1 is needed")]
    Zero {
        /// Name of what the number counts: samples, scenes, threads, or samples per block.
        what: &'static str,
    },
    /// The global indices of the sampling do not fit in 64 bits.
    #[error("{samples} samples from index {first} on pass the largest index, {}", u64::MAX)]
    TooManySamples {
        /// First global index.
        first: u64,
        /// Number of samples.
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
    /// Two summaries that are not consecutive parts of one run.
    #[error("the summaries cannot be merged: {field} of the later one is {found}; {expected} is needed")]
    NotMergeable {
        /// The number that differs.
        field: &'static str,
        /// The number that would fit.
        expected: u64,
        /// The number of the later summary.
        found: u64,
    },
    /// Parts of a run that lack samples.
    #[error("no part has the samples {from}..{to}; allowed: parts that have all samples 0..{samples} once")]
    PartsMissing {
        /// Global index of the first sample that is missing.
        from: u64,
        /// Global index after the last of them.
        to: u64,
        /// Number of samples of the run.
        samples: u64,
    },
    /// Parts of a run that have samples in common.
    #[error("{part} and {other}: both have the samples {from}..{to}; allowed: parts that have each sample once")]
    PartsOverlap {
        /// Name of a part.
        part: String,
        /// Name of the other.
        other: String,
        /// Global index of the first sample that both have.
        from: u64,
        /// Global index after the last of them.
        to: u64,
    },
    /// A checkpoint could not be read or written. A previous checkpoint, if any, is still there.
    #[error("cannot {action} checkpoint {}: {source}", path.display())]
    CheckpointIo {
        /// "read" or "write".
        action: &'static str,
        /// The checkpoint, or the temporary file beside it.
        path: PathBuf,
        /// The error of the operating system.
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
        /// Fault of the checkpoint.
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
        /// Part of the run's identity that differs.
        field: &'static str,
        /// The value of this run.
        expected: String,
        /// The value in the file.
        found: String,
    },
    /// A checkpoint holds more samples than the run is asked for.
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
    /// A tally that cannot be written and read back, for example because it holds an infinite float.
    #[error("the tally cannot be stored in checkpoint {}: {source}", path.display())]
    NotStorable {
        /// The checkpoint.
        path: PathBuf,
        /// The error of the encoder or the decoder.
        source: serde_json::Error,
    },
    /// A statistic of no values.
    #[error("no values: {statistic} is not defined")]
    Empty {
        /// Name of the statistic.
        statistic: &'static str,
    },
    /// A value that is NaN or infinite.
    #[error("value {index} is {value}; every value must be finite")]
    NotFinite {
        /// Index of the value, from 0.
        index: usize,
        /// The value.
        value: f64,
    },
    /// A probability outside its range.
    #[error("{name} is {value}; it must lie {range}")]
    Probability {
        /// Name of the probability.
        name: &'static str,
        /// The value.
        value: f64,
        /// The allowed range.
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

/// A parameter of a distribution that is not allowed. A reader of a file adds the field before the key.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{key} = {value}; allowed: {allowed}")]
pub struct DistributionFault {
    /// The key of the parameter, as in a file.
    pub key: &'static str,
    /// The value found.
    pub value: String,
    /// The values allowed.
    pub allowed: String,
}

/// Fault of a checkpoint file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Damage {
    /// The first line is not that of a checkpoint.
    #[error("it does not begin with the header of such a file")]
    Header,
    /// Another version of the format.
    #[error("it has format version {found}, this program reads version {expected}")]
    Version {
        /// Version of the file.
        found: u32,
        /// Version that this program reads and writes.
        expected: u32,
    },
    /// The file was truncated, or bytes were appended to it.
    #[error("{found} bytes follow its header, which announces {expected}")]
    Length {
        /// Bytes announced in the header.
        expected: usize,
        /// Bytes present.
        found: usize,
    },
    /// The bytes are not those that were written.
    #[error("its checksum is {found:08x}, its header announces {expected:08x}")]
    Checksum {
        /// Checksum announced in the header.
        expected: u32,
        /// Checksum of the bytes present.
        found: u32,
    },
    /// A state that cannot be one of the run whose identity stands above it: the file was made up.
    #[error("its {field} cannot be that of the run that it names")]
    State {
        /// Part of the state that does not fit.
        field: &'static str,
    },
    /// Intact bytes that do not describe the state of such a run: the tally's type has changed since.
    #[error("its content is not the state of this run ({0})")]
    Content(serde_json::Error),
}
