//! What can be wrong with a case file, each in one line.

use std::path::PathBuf;

/// Errors of reading a case.
#[derive(Debug, thiserror::Error)]
pub enum CaseError {
    /// The file cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Not TOML, an unknown or missing field, a wrong type.
    #[error("{}: line {line}: {message}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// What the parser says, in one line.
        message: String,
    },
    /// A value that is well-formed and not allowed.
    #[error("{}: {field} = {value}; allowed: {allowed}", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// The field, as `table.key`.
        field: String,
        /// What stands there.
        value: String,
        /// What may stand there.
        allowed: String,
    },
    /// An expression that cannot be read, or whose value is not a finite number.
    #[error("{}: {field} = {source}", path.display())]
    Expression {
        /// The file.
        path: PathBuf,
        /// The field, as `table "name".key`.
        field: String,
        /// What is wrong with it.
        source: Box<super::ExpressionError>,
    },
    /// A file with a matrix that cannot be opened.
    #[error("{}: {field} = {:?}: cannot be read: {source}; allowed: a Matrix Market file, its path from the folder of the \
             case file", path.display(), file.display())]
    MatrixRead {
        /// The case file.
        path: PathBuf,
        /// The field, as `table "name".key`.
        field: String,
        /// The file with the matrix, as the case names it.
        file: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file with a matrix that is not one.
    #[error("{}: {field} = {:?}: {source}", path.display(), file.display())]
    Matrix {
        /// The case file.
        path: PathBuf,
        /// The field, as `table "name".key`.
        field: String,
        /// The file with the matrix, as the case names it.
        file: PathBuf,
        /// What is wrong, with the line.
        source: Box<linsys::LinsysError>,
    },
    /// Matrices that make no system together.
    #[error("{}: {field}: {source}", path.display())]
    System {
        /// The case file.
        path: PathBuf,
        /// The table, as `terms "name"`.
        field: String,
        /// What is wrong.
        source: Box<linsys::LinsysError>,
    },
    /// The lattice refuses its parameters, an arrangement or a constraint.
    #[error("{}: {table}: {source}", path.display())]
    Lattice {
        /// The file.
        path: PathBuf,
        /// The table of the case file.
        table: String,
        /// What is wrong.
        source: osc_model::OscModelError,
    },
}
