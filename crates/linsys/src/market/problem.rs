//! Errors of Matrix Market files.

/// Most rows or columns of a matrix; chosen: 4096 x 4096 takes 128 MB as a dense matrix.
pub const LARGEST_ORDER: usize = 4096;

/// What the first line of a file should be, in messages.
const BANNER: &str = "\"%%MatrixMarket matrix coordinate real general\" or the like";

/// What is wrong with a Matrix Market file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MarketProblem {
    /// No line at all.
    #[error("the file is empty; expected a Matrix Market file, first line {BANNER}")]
    Empty,
    /// The first line is something else.
    #[error("{found:?} is not a Matrix Market banner; expected {BANNER}")]
    Banner {
        /// The first line, shortened.
        found: String,
    },
    /// Numbers without a banner, as Abaqus writes them.
    #[error(
        "{found:?} looks like an Abaqus matrix (numbers without a header), not Matrix Market; expected {BANNER}, \
         then a line with rows, columns and entries, then entries separated by blanks"
    )]
    Abaqus {
        /// The first line, shortened.
        found: String,
    },
    /// A keyword of the banner that is not supported.
    #[error("{what} {found:?} is not supported; allowed: {allowed}")]
    Keyword {
        /// "object", "format", "field" or "symmetry".
        what: &'static str,
        /// The text or number found.
        found: String,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A line with another number of fields.
    #[error("{found} fields where {what} is expected: {allowed}")]
    Fields {
        /// What the line should be.
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
        /// The text or number found.
        found: String,
    },
    /// A number of rows or columns that is 0 or too large.
    #[error("{what} {found} is out of range; allowed: 1 to {LARGEST_ORDER}")]
    Size {
        /// "number of rows" or "number of columns".
        what: &'static str,
        /// The text or number found.
        found: usize,
    },
    /// A symmetric matrix that is not square.
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
        /// "row" or "column".
        what: &'static str,
        /// The text or number found.
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
    /// A value that is not a number of the declared field.
    #[error("value {found:?} is not {allowed}")]
    Value {
        /// The text or number found.
        found: String,
        /// What is allowed.
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
    /// Bytes that are not UTF-8 text.
    #[error("not a text file")]
    NotText,
}
