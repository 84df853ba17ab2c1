//! What goes out with a release: pages and lists that are made, files for the archives, and the check that all is there.

mod check;
mod files;
mod licences;
mod made;
mod packages;
mod refusals;

pub use check::{ReleaseCheckArgs, run as check};
pub use files::{ReleaseFilesArgs, run as files};

use std::path::Path;

use crate::error::TaskError;
use made::Made;

/// Makes `docs/refusals.md` and its copy in the program.
///
/// # Errors
/// As [`refusals::pages`].
pub fn make_refusals(root: &Path) -> Result<(), TaskError> {
    refusals::pages(root)?.iter().try_for_each(Made::write)
}

/// Makes `THIRD-PARTY.md`.
///
/// # Errors
/// As [`licences::page`].
pub fn make_licences(root: &Path) -> Result<(), TaskError> {
    licences::page(root)?.write()
}
