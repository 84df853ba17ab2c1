//! A finished figure: its picture and the table behind it.

use std::path::Path;

use output::{Table, replace};

use super::canvas::Canvas;
use super::error::FigureError;
use super::{pdf, raster, vector};

/// A figure, ready to be written as SVG, PNG, PDF and CSV.
pub struct Figure {
    pub(super) canvas: Canvas,
    pub(super) table: Table,
}

impl Figure {
    /// The picture as an SVG document, with its printed size in millimetres; its text is selectable, not outlines.
    #[must_use]
    pub fn svg(&self) -> String {
        vector::to_svg(&self.canvas)
    }

    /// The picture as PNG, 300 dots per inch.
    ///
    /// # Errors
    /// [`FigureError::PictureSize`] if it has more pixels than fit into memory, [`FigureError::Png`] if it cannot be
    /// encoded.
    pub fn png(&self) -> Result<Vec<u8>, FigureError> {
        raster::to_png(&self.canvas)
    }

    /// The picture as PDF, one page of its printed size, for documents that are printed.
    ///
    /// # Errors
    /// [`FigureError::Pdf`] if it cannot be compressed.
    pub fn pdf(&self) -> Result<Vec<u8>, FigureError> {
        pdf::to_pdf(&self.canvas)
    }

    /// The numbers behind the picture as CSV with a header: one observation per row, floats in their shortest form that
    /// reads back to the same value.
    ///
    /// # Errors
    /// [`FigureError::Csv`] if the table cannot be encoded.
    pub fn csv(&self) -> Result<Vec<u8>, FigureError> {
        Ok(self.table.csv()?)
    }

    /// Writes `stem.svg`, `stem.png`, `stem.pdf` and `stem.csv` into the existing folder `dir`. Each file is written under another
    /// name first and renamed when whole, so that no reader ever sees half of one.
    ///
    /// # Errors
    /// Errors of [`png`](Self::png), [`pdf`](Self::pdf) and [`csv`](Self::csv), with which no file is written; [`FigureError::Write`] with the path of
    /// the file that cannot be written, where the files before it stay.
    pub fn save(&self, dir: &Path, stem: &str) -> Result<(), FigureError> {
        let csv = self.csv()?;
        self.save_pictures(dir, stem)?;
        write(dir, stem, "csv", &csv)
    }

    /// Writes `stem.svg`, `stem.png` and `stem.pdf` as [`save`](Self::save) does, but no CSV: for a figure whose numbers are written elsewhere.
    ///
    /// # Errors
    /// As [`save`](Self::save), but for errors of the CSV.
    pub fn save_pictures(&self, dir: &Path, stem: &str) -> Result<(), FigureError> {
        let (png, pdf) = (self.png()?, self.pdf()?);
        write(dir, stem, "svg", self.svg().as_bytes())?;
        write(dir, stem, "png", &png)?;
        write(dir, stem, "pdf", &pdf)
    }
}

fn write(dir: &Path, stem: &str, extension: &str, bytes: &[u8]) -> Result<(), FigureError> {
    let path = dir.join(format!("{stem}.{extension}"));
    replace(&path, bytes).map_err(|source| FigureError::Write { path, source })
}
