//! Faults at a place of a file.

use std::fmt;

use crate::shortened::cut;

/// First line expected in a Matrix Market file, in messages.
const BANNER: &str = "\"%%MatrixMarket matrix coordinate real general\" or the like";

/// A fault at a place of a file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Problem {
    /// No line at all.
    #[error("the file is empty; expected a Matrix Market file, first line {BANNER}")]
    Empty,
    /// The first line of a Matrix Market file is something else.
    #[error("{found:?} is not a Matrix Market banner; expected {BANNER}")]
    Banner {
        /// The first line, shortened.
        found: String,
    },
    /// Numbers without a banner where Matrix Market is expected.
    #[error(
        "{found:?} looks like an Abaqus matrix (numbers without a header), not Matrix Market; expected {BANNER}, \
         then a line with rows, columns and entries, then entries separated by blanks"
    )]
    Abaqus {
        /// The first line, shortened.
        found: String,
    },
    /// A keyword or code that is not supported.
    #[error("{what} {found:?} is not supported; allowed: {allowed}")]
    Keyword {
        /// Meaning of the keyword, such as the type of a matrix.
        what: &'static str,
        /// The text or number found.
        found: String,
        /// Texts or numbers that are allowed.
        allowed: &'static str,
    },
    /// A line with another number of fields.
    #[error("{found} fields where {what} is expected: {allowed}")]
    Fields {
        /// Description of the line that is expected.
        what: &'static str,
        /// Number of fields of the line.
        found: usize,
        /// The fields that it should have.
        allowed: &'static str,
    },
    /// A size or an index that is not a whole number.
    #[error("{what} {found:?} is not a whole number")]
    NotWhole {
        /// Name of the number.
        what: &'static str,
        /// The text found.
        found: String,
    },
    /// A number of rows or columns that is 0 or too large.
    #[error("{what} {found} is out of range; allowed: 1 to {largest}")]
    Size {
        /// "number of rows" or "number of columns".
        what: &'static str,
        /// The number found.
        found: usize,
        /// The largest allowed: [`crate::Limits::order`].
        largest: usize,
    },
    /// A symmetric matrix that is not square.
    #[error("a {symmetry} matrix of {rows} x {columns}; it must be square")]
    NotSquare {
        /// The symmetry.
        symmetry: &'static str,
        /// Rows of the matrix.
        rows: usize,
        /// Columns of the matrix.
        columns: usize,
    },
    /// An index beyond the matrix.
    #[error("{what} {found}; allowed: 1 to {largest}")]
    Index {
        /// "row" or "column".
        what: &'static str,
        /// The index found.
        found: usize,
        /// Number of rows or columns.
        largest: usize,
    },
    /// An entry of the half of the matrix that follows from the symmetry.
    #[error("entry ({row}, {column}) of a {symmetry} matrix; allowed: {allowed}")]
    Triangle {
        /// The symmetry.
        symmetry: &'static str,
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
        /// The entries allowed.
        allowed: &'static str,
    },
    /// A symmetric matrix of which both triangles are given, so that mirroring would count entries twice.
    #[error(
        "the matrix {matrix:?} gives both ({row}, {column}) and its mirror image, {pairs} such pairs; allowed: {allowed}"
    )]
    BothTriangles {
        /// The matrix.
        matrix: String,
        /// Row of the first such entry: its label, or its number from 1.
        row: String,
        /// Column of the first such entry: its label, or its number from 1.
        column: String,
        /// Number of pairs that are given twice.
        pairs: usize,
        /// Ways to give the matrix that are allowed.
        allowed: &'static str,
    },
    /// Complex numbers whose imaginary parts are not all zero.
    #[error("{}", Complex(*.largest))]
    Complex {
        /// The largest imaginary part that was met.
        largest: f64,
    },
    /// A value that is not a number of the declared kind.
    #[error("value {found:?} is not {allowed}")]
    Value {
        /// The text or number found.
        found: String,
        /// Description of the values that are allowed.
        allowed: &'static str,
    },
    /// A field whose contents are not what the format allows.
    #[error("{what} is {found}; allowed: {allowed}")]
    Field {
        /// Name of the field.
        what: &'static str,
        /// Description of what was found.
        found: String,
        /// Description of what is allowed.
        allowed: String,
    },
    /// Fewer entries than announced.
    #[error("the file ends after {found} of {expected} entries")]
    Truncated {
        /// Entries read.
        found: usize,
        /// Entries announced.
        expected: usize,
    },
    /// The file ends within something.
    #[error("the file ends within {what}")]
    End {
        /// Part of the file that was being read.
        what: &'static str,
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
    /// More than a limit of [`crate::Limits`] allows.
    #[error("more than {most} {what}; the limit can be raised")]
    Limit {
        /// Name of what is limited.
        what: &'static str,
        /// The limit.
        most: u64,
    },
    /// Bytes of no text.
    #[error("not a text file: a zero byte; allowed: text in UTF-8 or Latin-1")]
    NotText,
    /// Text in two bytes a character.
    #[error("text in UTF-16; allowed: text in UTF-8 or Latin-1")]
    Utf16,
    /// A line that no program writes.
    #[error("a line of more than {most} bytes")]
    LongLine {
        /// The most allowed.
        most: usize,
    },
    /// The bytes cannot be had: a corrupt compressed stream, or the disk.
    #[error("cannot be read: {what}")]
    Read {
        /// Message of the reader.
        what: String,
    },
}

/// Message that complex numbers are not read, with the largest imaginary part.
struct Complex(f64);

impl fmt::Display for Complex {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "complex numbers with imaginary parts up to {:.1e}; those of a stiffness are structural damping, for which \
             lambda^2 M + lambda C + K has no place; allowed: imaginary parts that are all 0",
            self.0
        )
    }
}

impl Problem {
    pub(crate) fn field(what: &'static str, found: impl fmt::Display, allowed: impl Into<String>) -> Self {
        Self::Field { what, found: cut(&found.to_string()), allowed: allowed.into() }
    }
}
