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
use std::ffi::OsStr;
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

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

/// Writes `contents` under a temporary name beside `path`, then renames it. Where `path` is a link or a device, the new file stands in its place. Each writing has a
/// name of its own, so that of several processes and threads that write one file the last one's stands there, whole.
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
    static WRITTEN: AtomicU64 = AtomicU64::new(0);
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}-{}{TEMPORARY}", std::process::id(), WRITTEN.fetch_add(1, Ordering::Relaxed)));
    let temporary = path.with_file_name(name);
    let written = (|| {
        // What a killed process of the same number left there goes; the new file is made anew, so that a link is not followed to a file elsewhere.
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

/// End of the temporary names of [`replace`], `FILE.PROCESS-NUMBER.partial`.
const TEMPORARY: &str = ".partial";

/// True for a temporary name of [`replace`].
pub fn is_temporary(name: &OsStr) -> bool {
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let own = name.to_str().and_then(|name| name.strip_suffix(TEMPORARY)?.rsplit_once('.')?.1.split_once('-'));
    own.is_some_and(|(process, number)| is_number(process) && is_number(number))
}

/// Removes the temporary files of a folder that were last written `age` ago or before: those of processes that were killed.
pub fn remove_temporary(folder: &Path, age: Duration) {
    let Ok(files) = fs::read_dir(folder) else { return };
    let is_old = |file: &fs::DirEntry| {
        let written = file.metadata().and_then(|file| file.modified());
        written.is_ok_and(|written| written.elapsed().unwrap_or_default() >= age)
    };
    for file in files.flatten().filter(|file| is_temporary(&file.file_name()) && is_old(file)) {
        // One that stays takes nothing but room.
        let _ = fs::remove_file(file.path());
    }
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

/// True for a text that a spreadsheet takes for a formula, with any apostrophes before it. Numbers are none.
fn is_formula(cell: &[u8]) -> bool {
    let is_number = || str::from_utf8(cell).is_ok_and(|text| text.parse::<f64>().is_ok());
    let apostrophes = cell.iter().take_while(|byte| **byte == b'\'').count();
    matches!(cell[apostrophes..], [b'=' | b'+' | b'-' | b'@' | b'\t' | b'\r', _, ..]) && !is_number()
}

/// A cell as it stands in a CSV file, where no spreadsheet takes it for a formula: a text that begins as one gets an apostrophe before it, which they take for the
/// mark of a text.
fn guarded(cell: &[u8]) -> Cow<'_, [u8]> {
    if is_formula(cell) { Cow::Owned([b"'", cell].concat()) } else { Cow::Borrowed(cell) }
}

/// A cell as it was before it was put into a CSV file: without the apostrophe that it has there against spreadsheets.
///
/// ```
/// assert_eq!(["'-z", "''-z", "-1", "'a"].map(output::unguarded), ["-z", "'-z", "-1", "'a"]);
/// ```
#[must_use]
pub fn unguarded(cell: &str) -> &str {
    cell.strip_prefix('\'').filter(|text| is_formula(text.as_bytes())).unwrap_or(cell)
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
        table.write_field(guarded(cell.as_ref()))?;
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

    /// Every text of up to five of the characters that matter, so with any number of apostrophes before it.
    #[test]
    fn every_cell_comes_back_from_a_csv_file() {
        let mut cells = vec![String::new()];
        for _ in 0..5 {
            let longer = |cell: &String| ["'", "-", "=", "1", "z"].map(|next| format!("{cell}{next}"));
            cells = cells.iter().flat_map(longer).chain([String::new()]).collect();
        }
        for cell in cells {
            let inside = guarded(cell.as_bytes()).into_owned();
            assert!(cell.parse::<f64>().is_ok() || cell.len() < 2 || !b"-=".contains(&inside[0]), "{cell}");
            assert_eq!(unguarded(str::from_utf8(&inside).unwrap()), cell);
        }
    }

    /// Letters that processes write with two threads each, whole files of one letter, while another reads.
    #[test]
    fn a_file_that_several_processes_write_is_whole_at_any_time() {
        const LETTER: &str = "OUTPUT_TEST_LETTER";
        const LENGTH: usize = 1 << 20;
        let folder = std::env::temp_dir().join("output-several-processes");
        let path = std::env::var_os("OUTPUT_TEST_PATH").map_or_else(|| folder.join("file"), PathBuf::from);
        if let Ok(letter) = std::env::var(LETTER) {
            let contents = letter.repeat(LENGTH);
            let write = || (0..20).for_each(|_| write(&path, contents.as_bytes()).unwrap());
            std::thread::scope(|both| [(); 2].map(|()| both.spawn(write)).map(|one| one.join().unwrap()));
            return;
        }
        make_folder(&folder).unwrap();
        write(&path, "z".repeat(LENGTH).as_bytes()).unwrap();
        let child = |letter: &str| {
            let mut child = std::process::Command::new(std::env::current_exe().unwrap());
            child.args(["--exact", "tests::a_file_that_several_processes_write_is_whole_at_any_time"]);
            child.env(LETTER, letter).env("OUTPUT_TEST_PATH", &path).stdout(std::process::Stdio::null());
            child.spawn().unwrap()
        };
        let mut children = ["a", "b", "c"].map(child);
        loop {
            let ended = children.each_mut().map(|child| child.try_wait().unwrap());
            let read = fs::read(&path).unwrap();
            assert!(read.len() == LENGTH && read.iter().all(|letter| *letter == read[0]), "half a file");
            if ended.iter().all(Option::is_some) {
                assert!(ended.into_iter().flatten().all(|end| end.success()), "a writer ended with an error");
                break;
            }
        }
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1, "a temporary file is left");
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn temporary_files_of_killed_processes_are_removed_by_their_age_and_no_others() {
        let folder = std::env::temp_dir().join(format!("output-temporary-{}", std::process::id()));
        make_folder(&folder).unwrap();
        let (old, new) = ("results.csv.17-0.partial", "results.csv.18-3.partial");
        let others = ["film.partial", "results.partial", "a.1-.partial", "a.x-1.partial", "a.1-2.part"];
        for name in others.into_iter().chain([old, new]) {
            let file = fs::File::create(folder.join(name)).unwrap();
            let days = if name == new { 0 } else { 2 };
            file.set_modified(std::time::SystemTime::now() - Duration::from_secs(86_400 * days)).unwrap();
        }
        let left = || {
            let names = fs::read_dir(&folder).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap());
            names.collect::<std::collections::BTreeSet<_>>()
        };
        let of = |names: &[&str]| others.iter().chain(names).map(|&name| name.to_owned()).collect();
        remove_temporary(&folder, Duration::from_secs(86_400));
        assert_eq!(left(), of(&[new]));
        remove_temporary(&folder, Duration::ZERO);
        assert_eq!(left(), of(&[]));
        fs::remove_dir_all(&folder).unwrap();
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
