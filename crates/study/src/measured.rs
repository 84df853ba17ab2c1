//! Squeal that was measured on a brake, with which its study is compared.

/// A frequency at which a brake was heard to squeal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredFrequency {
    /// Frequency, Hz.
    pub hz: f64,
    /// Largest distance of a mode that counts as this one, Hz.
    pub tolerance_hz: f64,
}

/// Squeal that was measured on a brake. No sample depends on it.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Measured frequencies, ascending.
    pub frequencies: Vec<MeasuredFrequency>,
    /// Occurrence, 0 to 1: an unstable mode with a larger one counts as squeal.
    pub share: f64,
}
