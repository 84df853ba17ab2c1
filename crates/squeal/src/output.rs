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
        // What a killed run left there goes; the new file is made anew, so that a link is not followed to a file elsewhere.
        match fs::remove_file(&temporary) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
        let mut file = fs::File::create_new(&temporary)?;
        file.write_all(contents)?;
        file.sync_all()?;
        fs::rename(&temporary, path)
    })();
    // The error to report is the first one; a temporary file that cannot be removed either is beside the point.
    written.inspect_err(|_| drop(fs::remove_file(&temporary)))
}

/// Makes a folder and those above it.
///
/// # Errors
/// [`Error::Write`].
pub fn make_folder(path: &Path) -> Result<(), Error> {
    fs::create_dir_all(path).map_err(|source| Error::Write { path: path.to_owned(), source })
}

/// A time in words, to two digits at most: it is an estimate.
pub(crate) fn in_words(seconds: f64) -> String {
    match seconds {
        s if s < 1.5 => "a second".into(),
        s if s < 100.0 => format!("{s:.0} s"),
        s if s < 6000.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
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
