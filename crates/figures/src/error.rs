//! Errors of the data of a figure, and of the folder it goes to.

use std::path::PathBuf;

/// Errors of the figures.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// A value is NaN or infinite.
    #[error("the figure's {what} is {value}; it must be finite")]
    NotFinite {
        /// Name of the value.
        what: String,
        /// The value found.
        value: f64,
    },
    /// A value lies outside of its axis: a percentage below 0 or above 100, a negative number on a logarithmic axis.
    #[error("the figure's {what} is {value}; allowed is {allowed}")]
    OutOfRange {
        /// Name of the value.
        what: String,
        /// The value found.
        value: f64,
        /// Description of the values that are allowed.
        allowed: &'static str,
    },
    /// Two lists that belong together differ in length.
    #[error("the figure has {found} {what}; expected {expected}")]
    Length {
        /// Name of what is counted.
        what: String,
        /// Number found.
        found: usize,
        /// Number expected.
        expected: usize,
    },
    /// An index points beyond its list.
    #[error("the figure's {what} is {index}; there are {count}")]
    Index {
        /// Name of the index.
        what: String,
        /// The index, from 0.
        index: usize,
        /// The length of the list.
        count: usize,
    },
    /// There is nothing to draw.
    #[error("the figure has no {what}")]
    Empty {
        /// Name of what is missing.
        what: &'static str,
    },
    /// The values of a box have no quartiles.
    #[error(transparent)]
    Statistics(#[from] montecarlo::MonteCarloError),
    /// The font in the program cannot be read.
    #[error("the font of the figures cannot be read: {0}")]
    Font(#[from] skrifa::raw::ReadError),
    /// The picture is too large to be rasterised.
    #[error("a picture of {width} x {height} pixels cannot be drawn")]
    PictureSize {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// The picture cannot be written as PNG.
    #[error("the picture cannot be written as PNG: {0}")]
    Png(#[from] png::EncodingError),
    /// The picture cannot be written as PDF.
    #[error("the picture cannot be written as PDF: {0}")]
    Pdf(std::io::Error),
    /// The numbers of the figure cannot be written as CSV.
    #[error("the table of the figure cannot be written as CSV: {0}")]
    Csv(#[from] csv::Error),
    /// A file cannot be written.
    #[error("{}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Reason why the file cannot be written.
        source: std::io::Error,
    },
}

/// `value`, if it is finite.
pub(super) fn finite(value: f64, what: impl FnOnce() -> String) -> Result<f64, FigureError> {
    if value.is_finite() { Ok(value) } else { Err(FigureError::NotFinite { what: what(), value }) }
}
