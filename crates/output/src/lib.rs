//! Files that are there whole or not at all, tables as CSV, and text that a terminal shows and does not obey.
//!
//! ```
//! let folder = std::env::temp_dir().join(format!("output-{}", std::process::id()));
//! output::make_folder(&folder)?;
//! output::Table::new("modes", ["mode", "hertz"], [vec!["1".into(), "1015.952".into()]]).write(&folder)?;
//! assert_eq!(std::fs::read_to_string(folder.join("modes.csv"))?, "mode,hertz\n1,1015.952\n");
//! # std::fs::remove_dir_all(&folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod document;
mod table;

pub use document::{Block, Cell, Cells};
pub use table::{LongTable, Table};

use std::borrow::Cow;
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// Errors of a file of results.
#[non_exhaustive]
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// A file or folder that cannot be written.
    #[error("{}: cannot be written: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Reason why it cannot be written.
        source: io::Error,
    },
}

/// A number for people, to `digits` significant digits, at least one, without zeros after them; one with a digit more before its point is shown whole.
/// In powers of ten below 1e-3 and from `10^(digits + 1)` on.
///
/// ```
/// let shown = [1e-7, -0.5, 1.0 / 3.0, 1234.5678, 0.0].map(|value| output::significant(value, 6));
/// assert_eq!(shown, ["1e-7", "-0.5", "0.333333", "1234.57", "0"]);
/// ```
#[must_use]
pub fn significant(value: f64, digits: usize) -> String {
    let last = digits.saturating_sub(1);
    let in_powers = format!("{value:.last$e}");
    let (mantissa, exponent) = in_powers.split_once('e').unwrap_or((&in_powers, "0"));
    let power: i32 = exponent.parse().unwrap_or(0);
    let trimmed = |text: &str| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text.to_owned(),
    };
    if power < -3 || power > digits as i32 {
        return format!("{}e{exponent}", trimmed(mantissa));
    }
    let decimals = (last as i32 - power).max(0) as usize;
    trimmed(&format!("{value:.decimals$}"))
}

/// A frequency in Hz with three decimals, below 1 Hz with four significant digits, as in models without units.
#[must_use]
pub fn hertz(frequency: f64) -> String {
    hertz_within(frequency, 0.0)
}

/// A frequency in Hz as by [`hertz`], without the decimals that an error of up to `error` Hz leaves unknown.
///
/// ```
/// let shown = [0.0, 0.02, 3.0].map(|error| output::hertz_within(6083.1234, error));
/// assert_eq!(shown, ["6083.123", "6083.1", "6083"]);
/// ```
#[must_use]
pub fn hertz_within(frequency: f64, error: f64) -> String {
    let below_one = -frequency.abs().log10().floor();
    let most = if below_one.is_finite() { below_one.clamp(0.0, 9.0) + 3.0 } else { 3.0 };
    let decimals = (-(2.0 * error).log10()).floor().clamp(0.0, most) as usize;
    format!("{frequency:.decimals$}")
}

/// Writes `contents` under a temporary name beside `path`, then renames it. Where `path` is a link or a device, the new file stands in its place.
///
/// # Errors
/// [`OutputError::Write`]; what stood at `path` before then still stands there, and nothing is left beside it.
pub fn write(path: &Path, contents: &[u8]) -> Result<(), OutputError> {
    replace(path, contents).map_err(|source| OutputError::Write { path: path.to_owned(), source })
}

/// [`write()`], with the bare error.
///
/// # Errors
/// Refusals of the file system.
pub fn replace(path: &Path, contents: &[u8]) -> io::Result<()> {
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
/// [`OutputError::Write`].
pub fn make_folder(path: &Path) -> Result<(), OutputError> {
    fs::create_dir_all(path).map_err(|source| OutputError::Write { path: path.to_owned(), source })
}

/// Text as one line that a terminal shows and does not obey: control characters become escapes, line breaks spaces, and of a
/// number of very many digits the first are left.
pub fn printable(text: &str) -> String {
    /// More digits than any number needs: 17, and a decimal power.
    const MOST_DIGITS: usize = 24;
    let (mut line, mut digits) = (String::with_capacity(text.len()), 0);
    let tell_cut_digits = |line: &mut String, digits: usize| {
        if digits > MOST_DIGITS {
            *line += &format!("...({digits} digits)");
        }
    };
    for c in text.chars() {
        if c.is_ascii_digit() {
            digits += 1;
            if digits <= MOST_DIGITS {
                line.push(c);
            }
            continue;
        }
        tell_cut_digits(&mut line, digits);
        digits = 0;
        match c {
            '\n' => line.push(' '),
            c if c.is_control() || moves_others(c) => line.extend(c.escape_default()),
            c => line.push(c),
        }
    }
    tell_cut_digits(&mut line, digits);
    line
}

/// A time in words, roughly, as it is an estimate: whole seconds below 100 s, whole minutes below 100 min, else hours with one decimal.
pub fn in_words(seconds: f64) -> String {
    match seconds {
        s if s < 1.5 => "a second".into(),
        s if s < 100.0 => format!("{s:.0} s"),
        s if s < 6000.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// A size of memory in words, roughly, as it is an estimate: tens of MB, at least one, below 1 GB, else GB with one decimal.
pub fn bytes_in_words(bytes: f64) -> String {
    match bytes / 1e6 {
        megabytes if megabytes < 10.0 => "10 MB".into(),
        megabytes if megabytes < 1e3 => format!("{:.0} MB", (megabytes / 10.0).round() * 10.0),
        megabytes => format!("{:.1} GB", megabytes / 1e3),
    }
}

/// A cell that no spreadsheet takes for a formula: a text that begins as one gets an apostrophe before it, which they take for the mark of a
/// text. Numbers stay as they are.
fn harmless(cell: &[u8]) -> Cow<'_, [u8]> {
    let is_number = || str::from_utf8(cell).is_ok_and(|text| text.parse::<f64>().is_ok());
    match cell {
        [b'=' | b'+' | b'-' | b'@' | b'\t' | b'\r', _, ..] if !is_number() => Cow::Owned([b"'", cell].concat()),
        _ => Cow::Borrowed(cell),
    }
}

/// True for a character that changes where others stand, or ends a line, without being seen: marks of the direction of writing, and
/// separators of lines and paragraphs.
pub fn moves_others(c: char) -> bool {
    matches!(c, '\u{061c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A table as CSV.
///
/// # Errors
/// A table that cannot be encoded.
pub fn csv_bytes<R>(header: &[impl AsRef<str>], rows: impl IntoIterator<Item = R>) -> Result<Vec<u8>, csv::Error>
where
    R: IntoIterator<Item: AsRef<[u8]>>,
{
    let mut table = csv::Writer::from_writer(Vec::new());
    write_row(&mut table, header.iter().map(|name| name.as_ref().as_bytes()))?;
    for row in rows {
        write_row(&mut table, row)?;
    }
    table.into_inner().map_err(|error| error.into_error().into())
}

/// Writes a row of a table, in which no text is taken for a formula.
fn write_row<W: std::io::Write>(
    table: &mut csv::Writer<W>,
    row: impl IntoIterator<Item: AsRef<[u8]>>,
) -> Result<(), csv::Error> {
    for cell in row {
        table.write_field(harmless(cell.as_ref()))?;
    }
    table.write_record(None::<&[u8]>)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_frequencies_keep_four_digits() {
        for (frequency, text) in
            [(1015.9524, "1015.952"), (1.5, "1.500"), (0.2254613, "0.2255"), (1.1779e-4, "0.0001178"), (0.0, "0.000")]
        {
            assert_eq!(hertz(frequency), text);
        }
    }

    #[test]
    fn a_table_holds_no_formula_and_all_its_numbers() {
        let names = ["=cmd|' /C calc'!A0", "+1+1", "-2+3", "@SUM(A1)", "\t=1", "a=b", "-", ""];
        let numbers = ["-1.5e-3", "+2", "-inf", "NaN", "0", "-0"];
        let bytes = csv_bytes(&names, [names.to_vec(), [&numbers[..], &["x", "y"]].concat()]).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        let rows: Vec<&str> = text.lines().collect();
        assert_eq!(rows[0], "'=cmd|' /C calc'!A0,'+1+1,'-2+3,'@SUM(A1),'\t=1,a=b,-,");
        assert_eq!(rows[1], rows[0]);
        assert_eq!(rows[2], "-1.5e-3,+2,-inf,NaN,0,-0,x,y");
    }

    #[test]
    fn characters_that_move_others_are_seen() {
        let moving = ('\u{202a}'..='\u{202e}').chain('\u{2066}'..='\u{2069}').chain(['\u{2028}', '\u{2029}']);
        for c in moving {
            assert!(moves_others(c) && printable(&format!("a{c}b")).is_ascii(), "{:x}", u32::from(c));
        }
        assert_eq!(printable("µ, é, 摩擦"), "µ, é, 摩擦");
    }
}

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
