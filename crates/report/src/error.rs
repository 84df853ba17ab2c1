//! Errors of pictures and pages, each one line for its user.

use std::path::PathBuf;

/// Errors between what was found and its pictures and pages.
#[non_exhaustive]
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// An error of the results.
    #[error(transparent)]
    Study(#[from] squeal::Error),
    /// An error of a figure.
    #[error(transparent)]
    Figure(#[from] figures::FigureError),
    /// A file that cannot be written.
    #[error(transparent)]
    Output(#[from] output::OutputError),
    /// A mode that does not fit the mesh, as the owner of the mesh says.
    #[error("{0}")]
    Mesh(Box<dyn std::error::Error + Send + Sync>),
    /// A table that cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Reason why it cannot be read.
        source: std::io::Error,
    },
}
