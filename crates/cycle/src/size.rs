//! Sizes of states and of their differences, relative to the scales of their entries.

/// Size of a state, relative to the scales.
pub(crate) fn amplitude(x: &[f64], scales: &[f64]) -> f64 {
    x.iter().zip(scales).fold(0.0, |size, (x, scale)| largest(size, x / scale))
}

/// The larger of a magnitude and that of a number; not a number where either is not.
pub(crate) fn largest(size: f64, x: f64) -> f64 {
    // As integers, magnitudes have the same order, and what is no number is above all.
    f64::from_bits(size.to_bits().max(x.abs().to_bits()))
}

/// Largest difference of two states, relative to the scales; not a number where one of theirs is not.
pub(crate) fn distance(x: &[f64], other: &[f64], scales: &[f64]) -> f64 {
    x.iter().zip(other).zip(scales).fold(0.0, |size, ((x, y), scale)| largest(size, (x - y) / scale))
}
