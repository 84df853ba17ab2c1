//! Where commands look for a prepared brake and keep it, and the line that says so.

use std::path::{Path, PathBuf};

use brakes::case::CaseFile;
use brakes::{Prepared, PreparedCounts};
use output::printable;

use crate::Error;

/// Name of the folder beside a case in which its prepared brake is kept.
const FOLDER: &str = ".squeal";

/// Where a command looks for the prepared brake of its case, and keeps it.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct PreparedArgs {
    /// File that squeal prepare wrote, in which the reduced brake of finite elements is looked for first
    #[arg(long, value_name = "FILE")]
    pub prepared: Option<PathBuf>,
    /// Neither read nor keep the reduced brake of finite elements in the folder .squeal beside the case
    #[arg(long)]
    pub no_cache: bool,
}

impl PreparedArgs {
    /// Where pieces of the brake of a case are.
    ///
    /// # Errors
    /// A file of pieces that cannot be read, or for a case that nothing is prepared of.
    pub(super) fn open(&self, case: &CaseFile) -> Result<Prepared, Error> {
        let CaseFile::FiniteElements(finite_elements) = case else {
            return match &self.prepared {
                Some(path) => Err(none_prepared("--prepared", path)),
                None => Ok(Prepared::default()),
            };
        };
        let prepared = Prepared::default();
        let prepared = if let Some(path) = &self.prepared { prepared.from_file(path)? } else { prepared };
        let beside = finite_elements.header.path.parent().unwrap_or(Path::new(""));
        Ok(if self.no_cache { prepared } else { prepared.in_folder(beside.join(FOLDER)) })
    }
}

/// Refusal to prepare what takes no time.
pub(super) fn none_prepared(option: &'static str, value: &Path) -> Error {
    let allowed = "with cases of finite elements; others need no preparation".to_owned();
    Error::Option { option, value: value.display().to_string(), allowed }
}

/// Line on where a brake was read from and where it is kept; `None` where nothing was asked for.
pub(super) fn in_words(prepared: &Prepared, PreparedArgs { prepared: file, .. }: &PreparedArgs) -> Option<String> {
    let PreparedCounts { from_file, from_folder, made, damaged, interim, not_kept } = prepared.counts();
    let (pieces, place) = (from_file + from_folder + made, |path: &Path| printable(&path.display().to_string()));
    let folder = prepared.folder().map(place);
    let mut parts = Vec::new();
    if let Some(file) = file {
        parts.push(format!("{from_file} of {pieces} pieces read from {}", place(file)));
    }
    if let Some(folder) = folder.as_ref().filter(|_| from_folder > 0) {
        parts.push(format!("{from_folder} of {pieces} pieces read from {folder}"));
    }
    if interim > 0 {
        let points = if interim == 1 { "operating point" } else { "operating points" };
        parts.push(format!("modes at {interim} {points} taken over from a preparation that was stopped"));
    }
    let damaged = if damaged == 0 { String::new() } else { format!(", {damaged} in the place of damaged ones") };
    match (made, &folder, &not_kept) {
        (0, _, _) => {}
        (_, Some(folder), None) => parts.push(format!("{made} made and kept in {folder}{damaged}")),
        (_, Some(folder), Some(why)) => parts.push(format!("{made} made, which cannot be kept in {folder}: {why}")),
        (_, None, _) => parts.push(format!("{made} made")),
    }
    (!parts.is_empty()).then(|| format!("Prepared brake: {}", parts.join(", ")))
}
