//! What the figure of a mode shape and its net work shows.

use num_complex::Complex64;

/// One mode under several friction laws.
#[derive(Debug, Clone, Default)]
pub struct ModeWorkFigure {
    /// Above everything; may be empty.
    pub title: String,
    /// Below everything; may be empty.
    pub note: String,
    /// Rows of the lattice.
    pub rows: usize,
    /// Columns of the lattice.
    pub columns: usize,
    /// One column of the figure each.
    pub laws: Vec<LawMode>,
}

/// The mode under one law.
#[derive(Debug, Clone, Default)]
pub struct LawMode {
    /// Its name.
    pub law: String,
    /// Below the name, for example speed, frequency and growth rate, in lines; may be empty.
    pub caption: String,
    /// The oscillators by rows, then the plate: `rows * columns + 1`.
    pub bodies: Vec<BodyInMode>,
}

/// What one oscillator, or the plate, does in the mode.
#[derive(Debug, Clone, Default)]
pub struct BodyInMode {
    /// Components x, y, z of the eigenvector, in any unit and phase.
    pub displacement: [Complex64; 3],
    /// Which of x, y, z are held.
    pub constrained: [bool; 3],
    /// Its net work over the samples.
    pub work: NetWork,
}

/// Normalised net work of one body (no unit).
#[derive(Debug, Clone, Default)]
pub struct NetWork {
    /// Over the samples.
    pub median: f64,
    /// 25th and 75th percentile.
    pub quartiles: Option<[f64; 2]>,
}
