//! Case files as commands read them.

use std::path::PathBuf;

use brakes::case::{CaseError, CaseFile};

use crate::prepared::PreparedArgs;
use crate::terminal::note;

/// Commit that the program is built from, where git was there to tell.
#[must_use]
pub fn commit() -> Option<&'static str> {
    option_env!("SQUEAL_COMMIT").filter(|commit| !commit.is_empty())
}

/// The case file of a command, and what is set in it.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct CaseArgs {
    /// The case file (TOML); docs/case-files.md describes its fields
    pub case: PathBuf,
    /// Set a parameter (mu=0.3: the constant) or a field (study.samples=500) as if the file said so; may be repeated
    #[arg(long, value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// Where its reduced brake is
    #[command(flatten)]
    pub prepared: PreparedArgs,
}

impl CaseArgs {
    /// Reads the case file, and says what its user should know of it.
    ///
    /// # Errors
    /// As [`CaseFile::read_with`].
    pub(super) fn read(&self) -> Result<CaseFile, CaseError> {
        let mut case = CaseFile::read_with(&self.case, &self.set)?;
        case.header_mut().commit = commit();
        case.header().notes.iter().for_each(|text| note(text));
        Ok(case)
    }
}
