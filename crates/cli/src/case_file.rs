//! Case files as commands read them.

use std::path::Path;

use brakes::case::{CaseError, CaseFile};

use crate::terminal::note;

/// Reads a case file, and says what its user should know of it.
///
/// # Errors
/// As [`CaseFile::read`].
pub(super) fn read(path: &Path) -> Result<CaseFile, CaseError> {
    let case = CaseFile::read(path)?;
    case.header().notes.iter().for_each(|text| note(text));
    Ok(case)
}
