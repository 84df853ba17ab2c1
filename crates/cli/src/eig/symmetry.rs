//! The value of `--symmetry`.

use formats::{Kind, Symmetry, Wanted};

/// Statement of a user on how files store M, C and K.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SaidSymmetry {
    /// Matrix that the statement is on; `None`: all whose files do not say so themselves.
    pub of: Option<Kind>,
    /// Symmetry that the user states.
    pub symmetry: Symmetry,
}

/// Parses one of the values of the option.
///
/// # Errors
/// A text that is refused, with what is allowed.
pub(super) fn parse(text: &str) -> Result<SaidSymmetry, String> {
    let symmetry = |text: &str| Symmetry::named(text.trim());
    let kind = |text: &str| {
        [Kind::Mass, Kind::Damping, Kind::Stiffness].into_iter().find(|kind| kind.to_string() == text.trim())
    };
    let said = match text.split_once('=') {
        None => symmetry(text).map(|symmetry| SaidSymmetry { of: None, symmetry }),
        Some((of, said)) => kind(of).zip(symmetry(said)).map(|(of, symmetry)| SaidSymmetry { of: Some(of), symmetry }),
    };
    said.ok_or_else(|| {
        "allowed: whole, upper, lower or triangle, or of one matrix as damping=whole, several with commas between"
            .to_owned()
    })
}

/// The matrix of this kind, stored as `said` has it.
pub(super) fn wanted(said: &[SaidSymmetry], kind: Kind) -> Wanted<'static> {
    let last = |of: Option<Kind>| said.iter().rev().find(|said| said.of == of).map(|said| said.symmetry);
    Wanted { kind: Some(kind), symmetry: last(Some(kind)), otherwise: last(None), ..Wanted::default() }
}
