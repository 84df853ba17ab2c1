//! What a mode is called.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The number that a mode is called by, and counted under: a frequency rank, from 1, or what [`ModeNaming`] makes of one.
///
/// In tables and files it stands as that number alone.
///
/// [`ModeNaming`]: super::ModeNaming
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ModeLabel(u16);

impl ModeLabel {
    /// The label with a number.
    #[must_use]
    pub const fn new(number: u16) -> Self {
        Self(number)
    }

    /// The label of a frequency rank, from 1. A dense solver has far fewer modes than the 65,535 that have labels.
    #[must_use]
    pub(crate) const fn of_rank(rank: usize) -> Self {
        Self(rank as u16)
    }

    /// Its number.
    #[must_use]
    pub const fn number(self) -> u16 {
        self.0
    }
}

impl fmt::Display for ModeLabel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}
