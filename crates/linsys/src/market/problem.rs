//! What can be wrong with a Matrix Market file.

/// Most rows or columns of a matrix that is read; chosen: 4096 x 4096 takes 128 MB as a dense matrix.
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
