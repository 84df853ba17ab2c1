//! Case files as commands read them.

use std::path::Path;

use brakes::case::{CaseError, CaseFile};

use crate::terminal::note;

/// Commit that the program is built from, where git was there to tell.
#[must_use]
pub fn commit() -> Option<&'static str> {
    option_env!("SQUEAL_COMMIT").filter(|commit| !commit.is_empty())
}

/// Reads a case file, and says what its user should know of it.
///
/// # Errors
/// As [`CaseFile::read`].
pub(super) fn read(path: &Path) -> Result<CaseFile, CaseError> {
    let mut case = CaseFile::read(path)?;
    case.header_mut().commit = commit();
    case.header().notes.iter().for_each(|text| note(text));
    Ok(case)
}
