//! Where a mode begins or ceases to grow.

use serde::Serialize;

/// An onset with the mode that crosses the axis, or of divergence, where a real eigenvalue crosses zero.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweepOnset {
    /// The parameter.
    pub at: f64,
    /// Bound of the error of `at` by rounding.
    pub error: f64,
    /// Im lambda, rad/s; 0 of a divergence.
    pub omega: f64,
    /// Whether the mode starts to grow where the parameter grows, or stops.
    pub starts: bool,
    /// Candidates for the name of the mode, or `divergence`.
    pub mode: String,
}
