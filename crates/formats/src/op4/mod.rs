//! Nastran's `OUTPUT4` files (`.op4`): text and binary of either byte order with words of 4 or 8 bytes, dense, sparse and
//! `BIGMAT`.
//!
//! A file holds matrices one after the other. Each has a header (columns, rows, form, type, name), its columns in growing order,
//! and a column beyond the last that ends it. A column is one stretch of rows, or strings of rows, each with a header of its own:
//! `L * 65536 + row` in one word, or `L` and `row` in two where the number of rows is negative (`BIGMAT`) or above 65535; L - 1
//! is the number of words of the string. Types: 1, 2 real in single and double precision; 3, 4 complex, read where all imaginary parts are 0. Forms read:
//! 1 square, 2 rectangular, 6 symmetric; a symmetric matrix is stored whole. Where words have 8 bytes every real number is one word,
//! whatever the type.

pub(crate) mod binary;
pub(crate) mod text;

use crate::builder::{Builder, Found, Head, Stated};
use crate::limits::Limits;
use crate::numbers::order;
use crate::problem::Problem;

/// Fewest rows of a matrix whose strings have long headers whatever the sign of that number.
const LONG_HEADERS: u64 = 65_536;

/// A matrix whose header was read.
struct Open {
    name: String,
    rows: usize,
    columns: usize,
    symmetric: bool,
    complex: bool,
    /// Words of a number, or of one part of a complex one.
    words: usize,
    /// The header of a string has two words.
    bigmat: bool,
    refused: Option<String>,
    last_column: usize,
    builder: Builder,
}

impl Open {
    fn new([columns, rows, form, kind]: [i64; 4], name: String, limits: &Limits) -> Result<Self, Problem> {
        let size = |what, found: i64| match usize::try_from(found) {
            Ok(found) => order(what, found, limits.order),
            Err(_) => Err(Problem::field(what, found, format!("1 to {}", limits.order))),
        };
        let bigmat = rows < 0 || rows.unsigned_abs() >= LONG_HEADERS;
        let (columns, rows) =
            (size("number of columns", columns)?, size("number of rows", rows.checked_abs().unwrap_or(rows))?);
        let (words, complex) = match kind {
            1 => (1, false),
            2 => (2, false),
            3 => (1, true),
            4 => (2, true),
            found => {
                let allowed = "1 or 2 real, 3 or 4 complex";
                return Err(Problem::Keyword { what: "type of a matrix", found: found.to_string(), allowed });
            }
        };
        let refused = match form {
            1 | 2 | 6 => None,
            form => Some(format!("form {form}; read are 1 square, 2 rectangular, 6 symmetric")),
        };
        if form == 6 && rows != columns {
            return Err(Problem::NotSquare { symmetry: "symmetric", rows, columns });
        }
        let name = if name.is_empty() { "matrix".to_owned() } else { name };
        let (symmetric, last_column, builder) = (form == 6, 0, Builder::new(limits));
        Ok(Self { name, rows, columns, symmetric, complex, words, bigmat, refused, last_column, builder })
    }

    /// Begins a column, numbered from 1; false where it is the one beyond the last.
    fn column(&mut self, number: i64) -> Result<bool, Problem> {
        let found = usize::try_from(number).unwrap_or(0);
        if found == 0 || found <= self.last_column || found > self.columns + 1 {
            let allowed = format!("{} to {}, growing", self.last_column + 1, self.columns + 1);
            return Err(Problem::field("column", number, allowed));
        }
        self.last_column = found;
        Ok(found <= self.columns)
    }

    /// Checks a stretch of numbers that begins in a row from 1, of the column begun last.
    fn stretch(&self, row: i64, numbers: usize) -> Result<usize, Problem> {
        let first = usize::try_from(row).unwrap_or(0);
        let rows = if self.complex { numbers.div_ceil(2) } else { numbers };
        let last = first.saturating_add(rows);
        if first == 0 || last > self.rows + 1 {
            return Err(Problem::field(
                "rows of a column",
                format!("{row} on, {rows} of them"),
                format!("1 to {}", self.rows),
            ));
        }
        Ok(first - 1)
    }

    /// Adds the number `at` of a stretch that begins in `row`, from 0.
    fn put(&mut self, row: usize, at: usize, value: f64) -> Result<(), Problem> {
        let (at, is_imaginary) = if self.complex { (at / 2, at % 2 == 1) } else { (at, false) };
        if self.refused.is_some() || value == 0.0 {
            return Ok(());
        }
        if is_imaginary {
            return self.builder.note_imaginary(value);
        }
        self.builder.push(row + at, self.last_column - 1, value)
    }

    /// The numbers in a string of a length that its header gives with 1 added.
    fn numbers_of(&self, length: i64) -> Result<usize, Problem> {
        let words = usize::try_from(length.saturating_sub(1)).unwrap_or(0);
        if words == 0 || words % self.words != 0 {
            let allowed = format!("1 more than a positive multiple of {}", self.words);
            return Err(Problem::field("length of a string", length, allowed));
        }
        Ok(words / self.words)
    }

    fn finish(self, found: &mut Found) -> Result<(), Problem> {
        if let Some(reason) = self.refused {
            found.leave_out(&self.name, reason);
            return Ok(());
        }
        let head = Head::unlabelled(self.name.clone(), None, (self.rows, self.columns));
        // A symmetric matrix is stored whole; where one side of it is empty nobody knows what the writer meant.
        let stated = if self.symmetric { Stated::SymmetricArray } else { Stated::General };
        found.keep(&self.name, self.builder.finish(stated, head))
    }
}

/// Splits the header `L * 65536 + row` of a string.
fn short_header(word: i64) -> (i64, i64) {
    (word / 65_536, word % 65_536)
}
