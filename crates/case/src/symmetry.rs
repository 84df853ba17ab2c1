//! Symmetry entry of a term: how its files, or rows in the case, store its matrices.

use formats::{Kind, Symmetry, Wanted};
use serde::Deserialize;

use crate::CaseError;
use crate::check::{Check, field};

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

impl EachTable {
    fn of(self, kind: Kind) -> Option<Word> {
        match kind {
            Kind::Mass => self.mass,
            Kind::Damping => self.damping,
            Kind::Stiffness => self.stiffness,
        }
    }
}

impl Check<'_> {
    /// An error for a word on a matrix that a term does not have; `has` tells of mass, damping and stiffness.
    pub fn symmetry(&self, term: &str, said: Option<SymmetryEntry>, has: [bool; 3]) -> Result<(), CaseError> {
        let Some(SymmetryEntry::Each(table)) = said else { return Ok(()) };
        let kinds = [Kind::Mass, Kind::Damping, Kind::Stiffness].into_iter().zip(has);
        let mut without = kinds.filter(|(kind, has)| !has && table.of(*kind).is_some());
        match without.next() {
            None => Ok(()),
            Some((kind, _)) => {
                let allowed = "words on matrices that the term has";
                Err(self.value(
                    &field("terms", term, "symmetry"),
                    format!("a word on its {kind}, which it lacks"),
                    allowed,
                ))
            }
        }
    }
}

/// The matrix of this kind in a file or in rows, stored as the term has it.
pub(crate) fn wanted(said: Option<SymmetryEntry>, kind: Kind) -> Wanted<'static> {
    let (symmetry, otherwise) = match said {
        None => (None, None),
        Some(SymmetryEntry::All(word)) => (None, Some(word.into())),
        Some(SymmetryEntry::Each(table)) => (table.of(kind).map(Symmetry::from), None),
    };
    Wanted { kind: Some(kind), symmetry, otherwise, ..Wanted::default() }
}
