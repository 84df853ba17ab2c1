//! Writing files so that a reader finds the whole file or none.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use crate::Error;

/// Writes `contents` under a temporary name beside `path`, then renames it.
///
/// # Errors
/// [`Error::Write`]; what stood at `path` before then still stands there, and nothing is left beside it.
pub fn write(path: &Path, contents: &[u8]) -> Result<(), Error> {
    replace(path, contents).map_err(|source| Error::Write { path: path.to_owned(), source })
}

/// [`write`], with the bare error.
pub(crate) fn replace(path: &Path, contents: &[u8]) -> io::Result<()> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".partial");
    let temporary = path.with_file_name(name);
    let written = (|| {
        let mut file = fs::File::create(&temporary)?;
        file.write_all(contents)?;
        file.sync_all()?;
        fs::rename(&temporary, path)
    })();
    // The error to report is the first one; a temporary file that cannot be removed either is beside the point.
    written.inspect_err(|_| drop(fs::remove_file(&temporary)))
}

/// Writes a value as JSON.
///
/// # Errors
/// [`Error::Write`].
pub(crate) fn write_json(path: &Path, value: &impl serde::Serialize) -> Result<(), Error> {
    let failed = |error: serde_json::Error| Error::Write { path: path.to_owned(), source: error.into() };
    write(path, &serde_json::to_vec(value).map_err(failed)?)
}

/// Makes a folder and those above it.
///
/// # Errors
/// [`Error::Write`].
pub fn make_folder(path: &Path) -> Result<(), Error> {
    fs::create_dir_all(path).map_err(|source| Error::Write { path: path.to_owned(), source })
}

/// Writes a table as CSV.
///
/// # Errors
/// [`Error::Write`].
pub fn write_csv(path: &Path, header: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> Result<(), Error> {
    let bytes =
        csv_bytes(header, rows).map_err(|error| Error::Write { path: path.to_owned(), source: error.into() })?;
    write(path, &bytes)
}

/// A table as CSV.
pub(crate) fn csv_bytes<R>(header: &[&str], rows: impl IntoIterator<Item = R>) -> Result<Vec<u8>, csv::Error>
where
    R: IntoIterator<Item: AsRef<[u8]>>,
{
    let mut table = csv::Writer::from_writer(Vec::new());
    table.write_record(header)?;
    for row in rows {
        table.write_record(row)?;
    }
    table.into_inner().map_err(|error| error.into_error().into())
}
