//! Matrix Market files (`.mtx`), the exchange format of NIST: <https://math.nist.gov/MatrixMarket/formats.html>.
//!
//! Read: `coordinate` and `array`, `real` and `integer`, `general`, `symmetric` and `skew-symmetric`, as a dense
//! matrix. Entries of a coordinate file that stand twice are added up, as in finite element assembly. A symmetric file
//! holds its lower triangle only, a skew-symmetric one what is strictly below the diagonal. Comments and blank lines
//! may stand anywhere after the banner, keywords in any case, exponents with the D of Fortran.

use nalgebra::DMatrix;

use crate::LinsysError;

/// Most rows or columns of a matrix that is read: 4096 x 4096 takes 128 MB as a dense matrix.
pub const LARGEST_ORDER: usize = 4096;

/// What is wrong with a Matrix Market file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MarketProblem {
    /// No line at all.
    #[error("the file is empty; expected a Matrix Market file, first line {BANNER}")]
    Empty,
    /// The first line is something else.
    #[error("{found:?} is not a Matrix Market banner; expected {BANNER}")]
    Banner {
        /// What stands there, cut.
        found: String,
    },
    /// Numbers without a banner, as Abaqus writes them.
    #[error(
        "{found:?} looks like an Abaqus matrix (numbers without a header), not Matrix Market; expected {BANNER}, \
         then a line with rows, columns and entries, then entries separated by blanks"
    )]
    Abaqus {
        /// The line, cut.
        found: String,
    },
    /// A keyword of the banner that is not read.
    #[error("{what} {found:?} is not supported; allowed: {allowed}")]
    Keyword {
        /// object, format, field or symmetry.
        what: &'static str,
        /// What stands there.
        found: String,
        /// What may stand there.
        allowed: &'static str,
    },
    /// A line with another number of fields.
    #[error("{found} fields where {what} is expected: {allowed}")]
    Fields {
        /// What the line should be.
        what: &'static str,
        /// How many fields it has.
        found: usize,
        /// Its fields.
        allowed: &'static str,
    },
    /// A size or an index that is no whole number.
    #[error("{what} {found:?} is not a whole number")]
    NotWhole {
        /// Which number.
        what: &'static str,
        /// What stands there.
        found: String,
    },
    /// A matrix without entries or larger than any this program can solve.
    #[error("{what} {found} is out of range; allowed: 1 to {LARGEST_ORDER}")]
    Size {
        /// rows or columns.
        what: &'static str,
        /// What stands there.
        found: usize,
    },
    /// Symmetric matrices are square.
    #[error("a {symmetry} matrix of {rows} x {columns}; it must be square")]
    NotSquare {
        /// The symmetry.
        symmetry: &'static str,
        /// Its rows.
        rows: usize,
        /// Its columns.
        columns: usize,
    },
    /// An index beyond the matrix.
    #[error("{what} {found}; allowed: 1 to {largest}")]
    Index {
        /// row or column.
        what: &'static str,
        /// What stands there.
        found: usize,
        /// Number of rows or columns.
        largest: usize,
    },
    /// An entry of the half that the symmetry implies.
    #[error("entry ({row}, {column}) of a {symmetry} matrix; allowed: {allowed}")]
    Triangle {
        /// The symmetry.
        symmetry: &'static str,
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
        /// What may be given.
        allowed: &'static str,
    },
    /// A value that is no number of the field.
    #[error("value {found:?} is not {allowed}")]
    Value {
        /// What stands there.
        found: String,
        /// What may stand there.
        allowed: &'static str,
    },
    /// Fewer entries than announced.
    #[error("the file ends after {found} of {expected} entries")]
    Truncated {
        /// Entries read.
        found: usize,
        /// Entries announced.
        expected: usize,
    },
    /// No size line.
    #[error("the file ends before the line with the size of the matrix")]
    NoSize,
    /// More lines than announced.
    #[error("an entry after the last of {expected}")]
    TooMany {
        /// Entries announced.
        expected: usize,
    },
    /// Bytes that are no text.
    #[error("not a text file")]
    NotText,
}

const BANNER: &str = "\"%%MatrixMarket matrix coordinate real general\" or the like";

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
/// [`LinsysError::Market`] with the line and what is wrong there.
pub fn read_market(text: &[u8]) -> Result<DMatrix<f64>, LinsysError> {
    let text = text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text);
    let mut lines = Lines { rest: text.split(|&b| b == b'\n'), number: 0 };
    parse(&mut lines).map_err(|problem| LinsysError::Market { line: lines.number.max(1), problem })
}

/// Lines that are neither blank nor comments, counted with those that are.
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

fn cut(text: &str) -> String {
    const MOST: usize = 60;
    if text.chars().count() <= MOST { text.to_owned() } else { text.chars().take(MOST).chain("...".chars()).collect() }
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

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;
    use proptest::prelude::*;

    fn read(text: &str) -> Result<DMatrix<f64>, LinsysError> {
        read_market(text.as_bytes())
    }

    fn problem(text: &str) -> (usize, String) {
        match read(text) {
            Err(LinsysError::Market { line, problem }) => (line, problem.to_string()),
            other => panic!("{other:?} for {text:?}"),
        }
    }

    const REAL: &str = "%%MatrixMarket matrix coordinate real general\n";

    #[test]
    fn reads_every_supported_kind() {
        let general = "%%MatrixMarket MATRIX Coordinate Real General\r\n% a comment\r\n\r\n2 3 4\r\n1 1 1.5e0\r\n\
                       2 3 -2D-1\r\n% another\r\n1 1 0.5\r\n1 2 +7\r\n\r\n";
        assert_eq!(read(general).unwrap(), dmatrix![2.0, 7.0, 0.0; 0.0, 0.0, -0.2]);
        let symmetric = "%%MatrixMarket matrix coordinate integer symmetric\n2 2 2\n1 1 3\n2 1 -4";
        assert_eq!(read(symmetric).unwrap(), dmatrix![3.0, -4.0; -4.0, 0.0]);
        let skew = "%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 1\n2 1 5\n";
        assert_eq!(read(skew).unwrap(), dmatrix![0.0, -5.0; 5.0, 0.0]);
        let array = "%%MatrixMarket matrix array real general\n2 2\n1\n2\n3\n4\n";
        assert_eq!(read(array).unwrap(), dmatrix![1.0, 3.0; 2.0, 4.0]);
        let array = "%%MatrixMarket matrix array real symmetric\n2 2\n1\n2\n3\n";
        assert_eq!(read(array).unwrap(), dmatrix![1.0, 2.0; 2.0, 3.0]);
        let array = "%%MatrixMarket matrix array integer skew-symmetric\n3 3\n1\n2\n3\n";
        assert_eq!(read(array).unwrap(), dmatrix![0.0, -1.0, -2.0; 1.0, 0.0, -3.0; 2.0, 3.0, 0.0]);
        assert_eq!(read(&format!("{REAL}2 2 0\n")).unwrap(), DMatrix::zeros(2, 2));
    }

    #[test]
    fn says_in_one_line_what_is_wrong_and_what_is_allowed() {
        let body = |rest: &str| problem(&format!("{REAL}{rest}"));
        let cases = [
            (problem(""), 1, "empty"),
            (problem("\n \n"), 3, "empty"),
            (problem("hello\n1 1 1\n"), 1, "not a Matrix Market banner"),
            (problem("1,1, 2.5e+03\n1,2, 7\n"), 1, "Abaqus"),
            (problem("1  1  2.5e+03\n"), 1, "Abaqus"),
            (problem("** ABAQUS\n*MATRIX, TYPE=MASS\n"), 1, "Abaqus"),
            (problem("%%MatrixMarket vector coordinate real general\n"), 1, "allowed: matrix"),
            (
                problem("%%MatrixMarket matrix coordinate complex general\n"),
                1,
                "\"complex\" is not supported; allowed: real",
            ),
            (problem("%%MatrixMarket matrix coordinate pattern general\n"), 1, "allowed: real, integer"),
            (problem("%%MatrixMarket matrix coordinate real hermitian\n"), 1, "allowed: general, symmetric"),
            (problem("%%MatrixMarket matrix coordinate real\n"), 1, "symmetry"),
            (problem("%%MatrixMarket matrix coordinate real general extra\n"), 1, "not a Matrix Market banner"),
            (problem("%%MatrixMarket matrix array real general\n2 2 4\n"), 2, "rows, columns"),
            (problem("%%MatrixMarket matrix array real general\n1 2\n1 2\n"), 3, "one value a line"),
            (problem("%%MatrixMarket matrix array real symmetric\n2 3\n"), 2, "must be square"),
            (problem("%%MatrixMarket matrix coordinate real symmetric\n2 2 1\n1 2 1\n"), 3, "on or below"),
            (problem("%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 1\n1 1 0\n"), 3, "below the diagonal"),
            (problem("%%MatrixMarket matrix coordinate integer general\n1 1 1\n1 1 1.5\n"), 3, "an integer"),
            (body(""), 2, "before the line with the size"),
            (body("2 2\n"), 2, "rows, columns, entries"),
            (body("0 0 0\n"), 2, "allowed: 1 to 4096"),
            (body("1000000000 1000000000 1\n"), 2, "allowed: 1 to 4096"),
            (body("99999999999999999999999 1 1\n"), 2, "whole number"),
            (body("-1 1 1\n"), 2, "whole number"),
            (body("1 1 18446744073709551615\n1 1 1\n"), 4, "ends after 1 of"),
            (body("2 2 2\n1 1 1.0\n"), 4, "ends after 1 of 2"),
            (body("2 2 1\n1 1 1.0\n2 2 1.0\n"), 4, "after the last of 1"),
            (body("2 2 1\n3 1 1.0\n"), 3, "row 3; allowed: 1 to 2"),
            (body("2 2 1\n1 0 1.0\n"), 3, "column 0; allowed: 1 to 2"),
            (body("2 2 1\n1 1\n"), 3, "row, column, value"),
            (body("2 2 1\n1 1 1.0 2.0\n"), 3, "4 fields"),
            (body("2 2 1\n1 1 abc\n"), 3, "\"abc\" is not a number"),
            (body("2 2 1\n1 1 NaN\n"), 3, "finite"),
            (body("2 2 1\n1 1 -inf\n"), 3, "finite"),
            (body("2 2 1\n1 1 1e999\n"), 3, "finite"),
            (body("1 1 2\n1 1 1.7e308\n1 1 1.7e308\n"), 4, "the sum at (1, 1)"),
        ];
        for ((line, message), at, part) in cases {
            assert_eq!(line, at, "{message}");
            assert!(message.contains(part) && !message.contains('\n'), "{message:?} lacks {part:?}");
        }
        let binary = read_market(b"%%MatrixMarket \xff\xfe\n").unwrap_err();
        assert_eq!(binary.to_string(), "line 1: not a text file");
        let long = problem(&"x".repeat(10_000)).1;
        assert!(long.len() < 300);
    }

    proptest! {
        #[test]
        fn what_is_written_is_read_again(values in prop::collection::vec(prop::num::f64::NORMAL, 12)) {
            let matrix = DMatrix::from_vec(3, 4, values);
            let mut text = format!("{REAL}3 4 12\n");
            for j in 0..4 {
                for i in 0..3 {
                    text += &format!("{} {} {:e}\n", i + 1, j + 1, matrix[(i, j)]);
                }
            }
            prop_assert_eq!(read(&text).unwrap(), matrix);
        }

        #[test]
        fn no_text_makes_it_panic(text in "[%MatrixMket corinaelgsymdu\n\r\t0-9.,eED+*-]{0,200}", tail in ".{0,40}") {
            let _ = read(&text);
            let _ = read(&format!("{REAL}{text}{tail}"));
        }
    }
}
