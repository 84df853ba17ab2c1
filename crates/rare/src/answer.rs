//! The answer of an estimate: a probability with its interval, and what it rests on.

use montecarlo::Confidence;

use crate::line_sampling::Witness;
use crate::search::DesignPoint;

/// A probability with its interval.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Probability {
    /// Best estimate.
    pub value: f64,
    /// Standard error of it.
    pub standard_error: f64,
    /// Lower end of the 95 % interval, with what is not proven subtracted; >= 0.
    pub lower: f64,
    /// Upper end, with what is not proven added; <= 1.
    pub upper: f64,
}

/// An estimate.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Probability of failure.
    pub probability: Probability,
    /// Probability that is not proven, which widens the interval: ends of lines, and regions elsewhere of too small a probability to be a contradiction.
    pub unproven: f64,
    /// Design points, the nearest first.
    pub design_points: Vec<DesignPoint>,
    /// Failing points, one of each line that fails anywhere.
    pub witnesses: Vec<Witness>,
    /// Number of lines.
    pub lines: usize,
    /// Number of points elsewhere, and how many of them fail; of a system of one input the number of points of the scan, and 0.
    pub elsewhere: [usize; 2],
    /// Number of plain samples, none of which failed; 0 where failure was found.
    pub plain: usize,
    /// Widest step of the scan of the only input, in standard deviations, so that narrower failure may be missed; `None` of several inputs, and where no
    /// failure was found.
    pub scanned: Option<f64>,
    /// Number of evaluations in all.
    pub evaluations: u64,
    /// True if the standard error that was asked for is reached.
    pub is_reached: bool,
}

impl Probability {
    /// A mean over `lines` lines with its standard error. The interval is an interval of the logarithm, as lines have long tails upwards.
    #[must_use]
    pub fn new(value: f64, standard_error: f64, lines: usize, unproven: f64) -> Self {
        let deviate = Confidence::P95.t(lines.saturating_sub(1).max(1) as u64);
        let factor = if value > 0.0 { (deviate * standard_error / value).exp() } else { 1.0 };
        Self {
            value,
            standard_error,
            lower: (value / factor - unproven).max(0.0),
            upper: (value * factor + unproven).min(1.0),
        }
    }
}
