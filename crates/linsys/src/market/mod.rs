//! Matrix Market files (`.mtx`), the exchange format of NIST: <https://math.nist.gov/MatrixMarket/formats.html>.
//!
//! The reader takes `coordinate` and `array`, `real` and `integer`, `general`, `symmetric` and `skew-symmetric` files and
//! returns a dense matrix. Repeated entries of a coordinate file are added up, as in finite element assembly. A symmetric file
//! holds the lower triangle with the diagonal, a skew-symmetric file the lower triangle without it. Comments and blank lines
//! may follow anywhere after the banner, keywords may be in any case, exponents may have the D of Fortran.

mod problem;
#[cfg(test)]
mod tests;

use nalgebra::DMatrix;

use crate::LinsysError;
pub use problem::{LARGEST_ORDER, MarketProblem};

#[derive(Clone, Copy, PartialEq, Eq)]
enum Symmetry {
    General,
    Symmetric,
    Skew,
}

impl Symmetry {
    fn name(self) -> &'static str {
        match self {
            Self::General => "general",
            Self::Symmetric => "symmetric",
            Self::Skew => "skew-symmetric",
        }
    }
}

/// The format that the first line of a file declares.
struct Banner {
    coordinate: bool,
    integer: bool,
    symmetry: Symmetry,
}

/// The matrix in the text of a Matrix Market file.
///
/// ```
/// let text = "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 2.0\n2 1 -1.0\n2 2 2.0\n";
/// let k = linsys::read_market(text.as_bytes())?;
/// assert_eq!(k, nalgebra::dmatrix![2.0, -1.0; -1.0, 2.0]);
/// # Ok::<(), linsys::LinsysError>(())
/// ```
///
/// # Errors
/// [`LinsysError::Market`] with the number of the line and the problem.
pub fn read_market(text: &[u8]) -> Result<DMatrix<f64>, LinsysError> {
    let text = text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text);
    let mut lines = Lines { rest: text.split(|&b| b == b'\n'), number: 0 };
    parse(&mut lines).map_err(|problem| LinsysError::Market { line: lines.number.max(1), problem })
}

/// The lines that are neither blank nor comments; `number` counts all lines.
struct Lines<'a, I: Iterator<Item = &'a [u8]>> {
    rest: I,
    number: usize,
}

impl<'a, I: Iterator<Item = &'a [u8]>> Lines<'a, I> {
    fn next_raw(&mut self) -> Result<Option<&'a str>, MarketProblem> {
        let Some(bytes) = self.rest.next() else { return Ok(None) };
        self.number += 1;
        std::str::from_utf8(bytes).map(|line| Some(line.trim())).map_err(|_| MarketProblem::NotText)
    }

    fn next(&mut self) -> Result<Option<&'a str>, MarketProblem> {
        loop {
            match self.next_raw()? {
                Some(line) if line.is_empty() || line.starts_with('%') => {}
                other => return Ok(other),
            }
        }
    }
}

/// A text for a message, shortened where it is long.
fn cut(text: &str) -> String {
    /// Most characters of a line that a message shows; chosen to keep it in one line.
    const LONGEST_SHOWN: usize = 60;
    if text.chars().count() <= LONGEST_SHOWN {
        return text.to_owned();
    }
    text.chars().take(LONGEST_SHOWN).chain("...".chars()).collect()
}

fn parse<'a, I: Iterator<Item = &'a [u8]>>(lines: &mut Lines<'a, I>) -> Result<DMatrix<f64>, MarketProblem> {
    let mut first = "";
    while first.is_empty() {
        first = lines.next_raw()?.ok_or(MarketProblem::Empty)?;
    }
    let banner = read_banner(first)?;
    let size = lines.next()?.ok_or(MarketProblem::NoSize)?;
    let (rows, columns, entries) = read_size(size, &banner)?;
    let mut matrix = DMatrix::zeros(rows, columns);
    let places: Box<dyn Iterator<Item = (usize, usize)>> = match banner.symmetry {
        Symmetry::General => Box::new((0..columns).flat_map(move |j| (0..rows).map(move |i| (i, j)))),
        Symmetry::Symmetric => Box::new((0..columns).flat_map(move |j| (j..rows).map(move |i| (i, j)))),
        Symmetry::Skew => Box::new((0..columns).flat_map(move |j| (j + 1..rows).map(move |i| (i, j)))),
    };
    let mut places = places.take(entries);
    for found in 0..entries {
        let line = lines.next()?.ok_or(MarketProblem::Truncated { found, expected: entries })?;
        let mut fields = line.split_whitespace();
        let (i, j) = if banner.coordinate {
            let count = line.split_whitespace().count();
            let what = || MarketProblem::Fields { what: "an entry", found: count, allowed: "row, column, value" };
            if count != 3 {
                return Err(what());
            }
            let row = index("row", fields.next().ok_or_else(what)?, rows)?;
            (row, index("column", fields.next().ok_or_else(what)?, columns)?)
        } else {
            places.next().ok_or(MarketProblem::TooMany { expected: entries })?
        };
        let count = if banner.coordinate { 1 } else { line.split_whitespace().count() };
        let (Some(field), 1) = (fields.next(), count) else {
            return Err(MarketProblem::Fields { what: "an entry", found: count, allowed: "one value a line" });
        };
        let value = value(field, banner.integer)?;
        place(&mut matrix, (i, j), value, banner.symmetry)?;
    }
    match lines.next()? {
        Some(_) => Err(MarketProblem::TooMany { expected: entries }),
        None => Ok(matrix),
    }
}

fn read_banner(line: &str) -> Result<Banner, MarketProblem> {
    let lower = line.to_lowercase();
    let mut words = lower.split_whitespace();
    if words.next() != Some("%%matrixmarket") {
        let numbers = line.split([',', ' ', '\t', ';']).filter(|f| !f.is_empty());
        let abaqus = numbers.clone().count() >= 2 && numbers.clone().all(|f| f.parse::<f64>().is_ok());
        let found = cut(line);
        let keyword = line.starts_with('*');
        return Err(if abaqus || keyword { MarketProblem::Abaqus { found } } else { MarketProblem::Banner { found } });
    }
    let mut keyword = |what: &'static str, allowed: &'static str| {
        let found = cut(words.next().unwrap_or_default());
        match allowed.split(", ").position(|word| word == found) {
            Some(at) => Ok(at),
            None => Err(MarketProblem::Keyword { what, found, allowed }),
        }
    };
    keyword("object", "matrix")?;
    let coordinate = keyword("format", "coordinate, array")? == 0;
    let integer = keyword("field", "real, integer")? == 1;
    let symmetry = match keyword("symmetry", "general, symmetric, skew-symmetric")? {
        0 => Symmetry::General,
        1 => Symmetry::Symmetric,
        _ => Symmetry::Skew,
    };
    if words.next().is_some() {
        return Err(MarketProblem::Banner { found: cut(line) });
    }
    Ok(Banner { coordinate, integer, symmetry })
}

fn read_size(line: &str, banner: &Banner) -> Result<(usize, usize, usize), MarketProblem> {
    let fields: Vec<&str> = line.split_whitespace().collect();
    let (expected, allowed) = if banner.coordinate { (3, "rows, columns, entries") } else { (2, "rows, columns") };
    if fields.len() != expected {
        return Err(MarketProblem::Fields { what: "the size", found: fields.len(), allowed });
    }
    let order = |what, field| match whole(what, field)? {
        found if (1..=LARGEST_ORDER).contains(&found) => Ok(found),
        found => Err(MarketProblem::Size { what, found }),
    };
    let (rows, columns) = (order("number of rows", fields[0])?, order("number of columns", fields[1])?);
    if banner.symmetry != Symmetry::General && rows != columns {
        return Err(MarketProblem::NotSquare { symmetry: banner.symmetry.name(), rows, columns });
    }
    let entries = match (banner.coordinate, banner.symmetry) {
        (true, _) => whole("number of entries", fields[2])?,
        (false, Symmetry::General) => rows * columns,
        (false, Symmetry::Symmetric) => rows * (rows + 1) / 2,
        (false, Symmetry::Skew) => rows * (rows - 1) / 2,
    };
    Ok((rows, columns, entries))
}

fn whole(what: &'static str, field: &str) -> Result<usize, MarketProblem> {
    field.parse().map_err(|_| MarketProblem::NotWhole { what, found: cut(field) })
}

/// An index from 1 in the file, from 0 here.
fn index(what: &'static str, field: &str, largest: usize) -> Result<usize, MarketProblem> {
    match whole(what, field)? {
        found if (1..=largest).contains(&found) => Ok(found - 1),
        found => Err(MarketProblem::Index { what, found, largest }),
    }
}

fn value(field: &str, integer: bool) -> Result<f64, MarketProblem> {
    let bad = |allowed| MarketProblem::Value { found: cut(field), allowed };
    if integer {
        return field.parse::<i64>().map(|v| v as f64).map_err(|_| bad("an integer, as the banner says"));
    }
    let value: f64 = match field.parse() {
        Ok(value) => value,
        Err(_) => field.replace(['D', 'd'], "e").parse().map_err(|_| bad("a number"))?,
    };
    if value.is_finite() { Ok(value) } else { Err(bad("a finite number")) }
}

fn place(
    matrix: &mut DMatrix<f64>,
    (i, j): (usize, usize),
    value: f64,
    symmetry: Symmetry,
) -> Result<(), MarketProblem> {
    let refuse = |allowed| MarketProblem::Triangle { symmetry: symmetry.name(), row: i + 1, column: j + 1, allowed };
    match symmetry {
        Symmetry::Symmetric if i < j => return Err(refuse("entries on or below the diagonal")),
        Symmetry::Skew if i <= j => return Err(refuse("entries below the diagonal")),
        _ => {}
    }
    matrix[(i, j)] += value;
    if i != j {
        match symmetry {
            Symmetry::General => {}
            Symmetry::Symmetric => matrix[(j, i)] += value,
            Symmetry::Skew => matrix[(j, i)] -= value,
        }
    }
    if matrix[(i, j)].is_finite() {
        Ok(())
    } else {
        let found = format!("{:e}, the sum at ({}, {})", matrix[(i, j)], i + 1, j + 1);
        Err(MarketProblem::Value { found, allowed: "a finite number" })
    }
}
