//! Rules by which modes are named, and known again.

use serde::{Deserialize, Serialize};

use super::ModeLabel;

/// Rule by which modes are named.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ModeNaming {
    /// Shape: the frequency rank of the mode that it continues, all in contact at median parameters.
    Tracked,
    /// Frequency rank in its own sample, 1 to n.
    Rank,
    /// Rank among all 2 n eigenvalues of its own sample: frequency rank r is named 2 r - 1.
    Pair,
    /// Frequency rank in its own sample from the highest frequency down.
    RankDown,
    /// Rank among all 2 n eigenvalues of its own sample from the highest frequency down.
    PairDown,
}

impl ModeNaming {
    /// Word of this naming in a case file.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Tracked => "tracked",
            Self::Rank => "rank",
            Self::Pair => "pair",
            Self::RankDown => "rank-down",
            Self::PairDown => "pair-down",
        }
    }

    /// The name of the mode of frequency rank `rank`, of a brake with `modes` modes.
    #[must_use]
    pub fn name(self, rank: ModeLabel, modes: usize) -> ModeLabel {
        let counted = |rank: usize| match self {
            Self::Pair | Self::PairDown => (2 * rank).saturating_sub(1),
            Self::Tracked | Self::Rank | Self::RankDown => rank,
        };
        if rank.is_mode() { ModeLabel::of_rank(counted(self.turned(rank.number().into(), modes))) } else { rank }
    }

    /// The frequency rank of the mode that has a name or, among all 2 n eigenvalues, either of its two numbers; 0 or a number above `modes` where there is
    /// no such mode.
    #[must_use]
    pub fn rank(self, name: ModeLabel, modes: usize) -> usize {
        let number = usize::from(name.number());
        let counted = match self {
            Self::Pair | Self::PairDown => number.div_ceil(2),
            Self::Tracked | Self::Rank | Self::RankDown => number,
        };
        self.turned(counted, modes)
    }

    /// A rank counted from the end that names are counted from, or the other way round.
    fn turned(self, rank: usize, modes: usize) -> usize {
        match self {
            Self::Tracked | Self::Rank | Self::Pair => rank,
            Self::RankDown | Self::PairDown => (modes + 1).saturating_sub(rank),
        }
    }
}

/// Rule by which a mode that is named by its shape is known again in another configuration and in a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ModeIdentity {
    /// Continuation from one system to the other, through every change of its shape.
    #[default]
    Continuation,
    /// Modal assurance criterion (MAC) of more than one half with its shape at the origin of names.
    Mac,
}
