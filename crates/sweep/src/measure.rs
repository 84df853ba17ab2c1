//! The smooth function of an eigenvalue that is zero where a mode comes to count as unstable, or ceases to.

use cea::Threshold;
use num_complex::Complex;

/// A function of lambda, above zero where a mode counts.
#[derive(Debug, Clone, Copy)]
pub(super) enum Measure {
    /// The margin beyond the threshold, 1/s.
    Margin(Threshold),
    /// The distance Im lambda - `end` of a growing mode from the lower end of the band, rad/s.
    Above(f64),
    /// The distance `end` - Im lambda of a growing mode from the upper end of the band, rad/s.
    Below(f64),
}

impl Measure {
    /// The value of an eigenvalue.
    pub fn value(&self, lambda: Complex<f64>) -> f64 {
        match self {
            Self::Margin(threshold) => threshold.margin(lambda),
            Self::Above(end) => lambda.im - end,
            Self::Below(end) => end - lambda.im,
        }
    }

    /// The derivative of the value along a path on which lambda changes by `rate`.
    pub fn rate(&self, lambda: Complex<f64>, rate: Complex<f64>) -> f64 {
        match self {
            Self::Margin(threshold) => threshold.margin_rate(lambda, rate),
            Self::Above(_) => rate.im,
            Self::Below(_) => -rate.im,
        }
    }
}
