//! The manifest of a part of a study.

use serde::{Deserialize, Serialize};

/// One of several parts of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// Number of the part, from 1.
    pub number: u64,
    /// Number of parts.
    pub of: u64,
    /// Global index of the first sample of all parts: samples before it are elsewhere.
    pub from: u64,
}

/// Manifest of a complete part: its study, its range of samples and what made it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PartManifest {
    /// Version of the program.
    pub version: String,
    /// Commit of the program, where it is known.
    pub commit: Option<String>,
    /// Class of processors and libraries on which numbers are rounded alike.
    pub rounding: String,
    /// Identity of the study.
    pub identity: String,
    /// Seed of the random streams.
    pub seed: u64,
    /// Global index of the first sample.
    pub from: u64,
    /// Global index after the last sample.
    pub to: u64,
    /// Number of samples of the study.
    pub of: u64,
    /// Shard that it is; `None` of a part of an earlier program.
    #[serde(default)]
    pub shard: Option<Shard>,
    /// Digest of what all samples share: the reference modes and their systems, to the last bit.
    pub prepared: String,
    /// Number of worker threads; `None` is one per core.
    pub threads: Option<usize>,
    /// Wall-clock time, s.
    pub seconds: f64,
    /// Number of evaluations.
    pub evaluations: u64,
    /// Number of draws and evaluations that failed.
    pub failures: u64,
}

impl PartManifest {
    /// The program that made the part, in words.
    #[must_use]
    pub fn maker(&self) -> String {
        made_by(&self.version, self.commit.as_deref())
    }
}

/// A program in words.
pub(crate) fn made_by(version: &str, commit: Option<&str>) -> String {
    format!("squeal {version} ({})", commit.unwrap_or("commit not known"))
}
