//! Symmetry entry of a term: how its files store its matrices.

use formats::{Kind, Symmetry, Wanted};
use serde::Deserialize;

/// Entry on how the matrices of a term are stored: one word for all of them, or one for each.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(
    untagged,
    expecting = "expected \"whole\", \"upper\", \"lower\" or \"triangle\", or one of them for each matrix, as { damping = \"whole\" }"
)]
pub(crate) enum SymmetryEntry {
    All(Word),
    Each(EachTable),
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Word {
    Whole,
    Upper,
    Lower,
    Triangle,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct EachTable {
    mass: Option<Word>,
    damping: Option<Word>,
    stiffness: Option<Word>,
}

impl From<Word> for Symmetry {
    fn from(word: Word) -> Self {
        match word {
            Word::Whole => Self::Whole,
            Word::Upper => Self::Upper,
            Word::Lower => Self::Lower,
            Word::Triangle => Self::Triangle,
        }
    }
}

/// The matrix of this kind in a file, stored as the term has it.
pub(crate) fn wanted(said: Option<SymmetryEntry>, kind: Kind) -> Wanted<'static> {
    let (symmetry, otherwise) = match said {
        None => (None, None),
        Some(SymmetryEntry::All(word)) => (None, Some(word.into())),
        Some(SymmetryEntry::Each(EachTable { mass, damping, stiffness })) => {
            let word = match kind {
                Kind::Mass => mass,
                Kind::Damping => damping,
                Kind::Stiffness => stiffness,
            };
            (word.map(Symmetry::from), None)
        }
    };
    Wanted { kind: Some(kind), symmetry, otherwise, ..Wanted::default() }
}
