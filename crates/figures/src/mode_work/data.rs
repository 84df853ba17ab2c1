//! Data of the figure of a mode shape and its net work.

use num_complex::Complex64;

/// A mode under several friction laws.
#[derive(Debug, Clone, Default)]
pub struct ModeWorkFigure {
    /// Title above everything; may be empty.
    pub title: String,
    /// Note below everything; may be empty.
    pub note: String,
    /// Rows of the lattice.
    pub rows: usize,
    /// Columns of the lattice.
    pub columns: usize,
    /// Laws, a column of the figure each.
    pub laws: Vec<LawMode>,
}

/// The mode under one law.
#[derive(Debug, Clone, Default)]
pub struct LawMode {
    /// Name of the law.
    pub law: String,
    /// Caption below the name, for example speed, frequency and growth rate, in lines; may be empty.
    pub caption: String,
    /// The oscillators by rows, then the plate: `rows * columns + 1`.
    pub bodies: Vec<BodyInMode>,
}

/// Motion and net work of one oscillator, or of the plate, in the mode.
#[derive(Debug, Clone, Default)]
pub struct BodyInMode {
    /// Components x, y, z of the eigenvector, in any unit and phase.
    pub displacement: [Complex64; 3],
    /// Directions x, y, z that are held.
    pub constrained: [bool; 3],
    /// Net work of the body over the samples.
    pub work: NetWork,
}

/// Normalised net work of one body (no unit).
#[derive(Debug, Clone, Default)]
pub struct NetWork {
    /// Median over the samples.
    pub median: f64,
    /// 25th and 75th percentile.
    pub quartiles: Option<[f64; 2]>,
}
