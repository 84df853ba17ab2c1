//! Errors of case files, each printed in one line.

use std::path::PathBuf;

/// Errors of reading a case.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CaseError {
    /// The file cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// A scene that is asked for and that the case does not have.
    #[error("{what} = {value}; allowed: {allowed}")]
    Choice {
        /// Field of [`SceneChoice`](super::SceneChoice).
        what: &'static str,
        /// Value that was asked for.
        value: String,
        /// Values that the case has, in words.
        allowed: String,
    },
    /// A file that is not TOML, an unknown or missing field, a wrong type.
    #[error("{}: line {line}: {message}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// The message of the parser, in one line.
        message: String,
    },
    /// A field set from outside that its reader does not know, or whose value is of a wrong type.
    #[error("{}: --set {setting}: {message}", path.display())]
    Setting {
        /// The case file.
        path: PathBuf,
        /// What was set, as `NAME=VALUE`.
        setting: String,
        /// The error of the parser.
        message: String,
    },
    /// A variant of a case that cannot be read.
    #[error("{}: variant {name:?}: {source}", path.display())]
    Variant {
        /// The file with the variants.
        path: PathBuf,
        /// Name of the variant.
        name: String,
        /// Fault of its case.
        source: Box<CaseError>,
    },
    /// A value that is well-formed and not allowed.
    #[error("{}: {field} = {value}; allowed: {allowed}", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// The field, as `table.key`.
        field: String,
        /// The value found.
        value: String,
        /// The values allowed.
        allowed: String,
    },
    /// A contact, a body or a balance of forces that is none.
    #[error("{}: {field}: {source}", path.display())]
    Contact {
        /// The file.
        path: PathBuf,
        /// The table, as `table "name"`.
        field: String,
        /// Error of the contact, the body or the balance.
        source: Box<contact::ContactError>,
    },
    /// An expression that cannot be read, or whose value is not a finite number.
    #[error("{}: {field} = {source}", path.display())]
    Expression {
        /// The file.
        path: PathBuf,
        /// The field, as `table "name".key`.
        field: String,
        /// The error of the expression.
        source: Box<super::ExpressionError>,
    },
    /// A file with a matrix that cannot be opened.
    #[error("{}: {field} = {:?}: cannot be read: {source}; allowed: a file with a matrix, its path from the folder of the \
             case file", path.display(), file.display())]
    MatrixRead {
        /// The case file.
        path: PathBuf,
        /// The field, as `table "name".key`.
        field: String,
        /// The file with the matrix, as the case names it.
        file: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// A file that does not contain a matrix.
    #[error("{}: {field} = {:?}: {source}", path.display(), file.display())]
    Matrix {
        /// The case file.
        path: PathBuf,
        /// The field, as `table "name".key`.
        field: String,
        /// The file with the matrix, as the case names it.
        file: PathBuf,
        /// The error, with the line.
        source: Box<formats::FormatsError>,
    },
    /// Rows in the case file of which nothing says whether they are a triangle, or which contradict what is said.
    #[error("{}: {field}: {source}", path.display())]
    Rows {
        /// The case file.
        path: PathBuf,
        /// The field, as `table "name".key`.
        field: String,
        /// The contradiction.
        source: Box<formats::FormatsError>,
    },
    /// Matrices that make no system together.
    #[error("{}: {field}: {source}", path.display())]
    System {
        /// The case file.
        path: PathBuf,
        /// The table, as `terms "name"`.
        field: String,
        /// The error of the matrices.
        source: Box<linsys::LinsysError>,
    },
    /// Sparse matrices that make no system together.
    #[error("{}: {field}: {source}", path.display())]
    Sparse {
        /// The case file.
        path: PathBuf,
        /// The table, as `terms "name"`.
        field: String,
        /// The error of the matrices.
        source: Box<sparse::SparseError>,
    },
    /// The lattice refuses its parameters, an arrangement or a constraint.
    #[error("{}: {table}: {source}", path.display())]
    Lattice {
        /// The file.
        path: PathBuf,
        /// The table of the case file.
        table: String,
        /// The error of the lattice.
        source: osc_model::OscModelError,
    },
}

impl From<CaseError> for study::Error {
    fn from(error: CaseError) -> Self {
        Self::Brake(Box::new(error))
    }
}
