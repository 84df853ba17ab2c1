//! Labels of modes: the numbers that they are called by.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The number that a mode is called by, and counted under: a frequency rank, from 1, or what [`ModeNaming`] makes of one.
///
/// In tables and files it stands as that number alone. Two labels are of no mode and stand as a word: [`ModeLabel::DIVERGENCE`] and
/// [`ModeLabel::UNNAMED`].
///
/// [`ModeNaming`]: super::ModeNaming
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ModeLabel(u16);

impl ModeLabel {
    /// Label of a motion that does not oscillate and has no frequency rank: a real eigenvalue beyond the threshold, static instability.
    pub const DIVERGENCE: Self = Self(u16::MAX);
    /// Label of unstable modes without a name, because no mode where names come from continues as one of them.
    pub const UNNAMED: Self = Self(u16::MAX - 1);

    /// True if it is the label of a mode.
    #[must_use]
    pub const fn is_mode(self) -> bool {
        self.0 < Self::UNNAMED.0
    }

    /// The label with a number.
    #[must_use]
    pub const fn new(number: u16) -> Self {
        Self(number)
    }

    /// The label of a frequency rank, from 1. A dense solver has far fewer modes than the 65,533 that have labels.
    #[must_use]
    pub const fn of_rank(rank: usize) -> Self {
        Self(rank as u16)
    }

    /// Candidates for the name of a mode as tables have them: `16`, of an open name all as in `16|20`, `?` without one.
    #[must_use]
    pub fn candidates(names: &[Self]) -> String {
        let names: Vec<String> = names.iter().map(ToString::to_string).collect();
        if names.is_empty() { "?".into() } else { names.join("|") }
    }

    /// Number of the label.
    #[must_use]
    pub const fn number(self) -> u16 {
        self.0
    }
}

impl fmt::Display for ModeLabel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::DIVERGENCE => f.pad("divergence"),
            Self::UNNAMED => f.pad("unnamed"),
            Self(number) => number.fmt(f),
        }
    }
}
