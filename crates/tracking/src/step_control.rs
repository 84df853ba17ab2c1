//! Step-size control by the ratio of two predictor errors: the error of the trapezoidal rule over the error of the tangent.
//!
//! At a distance d from the next branch point, an eigenvalue is a smooth function plus a square root. Over a step s the error of
//! the trapezoidal rule for `d lambda / d t` is then `s / 4 d` times the error of the tangent, whatever the value and slope
//! of the smooth function. A step is taken where this ratio is small; a step that jumps to another mode has a ratio near 1.

use num_complex::Complex;

use crate::tuning::tuning;

/// A point of a path, and the step that is tried next.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StepControl {
    /// Position on the path, 0 at its beginning and 1 at its end.
    pub t: f64,
    step: f64,
    attempts: usize,
}

impl StepControl {
    pub fn new(t: f64, step: f64) -> Self {
        Self { t, step, attempts: 0 }
    }

    /// The next step, which does not lead beyond t = 1.
    pub fn step(&self) -> f64 {
        self.step.min(1.0 - self.t)
    }

    /// True if a step with this ratio of errors is taken.
    pub fn accepts(ratio: f64) -> bool {
        ratio <= tuning().largest_error_ratio
    }

    /// Takes the next step if its error ratio is known and small, and makes the step shorter if not.
    pub fn advance(&mut self, ratio: Option<f64>) {
        self.attempts += 1;
        let (step, tuning) = (self.step(), tuning());
        let next = |ratio: f64| tuning.largest_error_ratio / (tuning.ratio_safety * ratio);
        match ratio {
            Some(ratio) if Self::accepts(ratio) => {
                self.t += step;
                self.step = step * next(ratio).clamp(tuning.reduction, tuning.growth);
            }
            other => {
                // `f64::max` of a NaN and a number is the number.
                let ratio = other.unwrap_or(f64::INFINITY).max(tuning.largest_error_ratio);
                self.step = step * next(ratio).clamp(tuning.least_reduction, tuning.reduction);
            }
        }
    }

    /// True if no step follows: t = 1, the step is below `shortest`, or the attempts are used up.
    pub fn is_over(&self, shortest: f64) -> bool {
        self.t == 1.0 || self.step < shortest || self.attempts >= tuning().most_attempts
    }
}

/// Distances of two predictions from the corrected value at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PredictorErrors {
    /// The tangent at the beginning.
    pub tangent: f64,
    /// The trapezoidal rule for the derivatives at both ends.
    pub trapezoid: f64,
}

impl PredictorErrors {
    /// The errors for a function with the values `ends` and the derivatives `rates` at the two ends of a step.
    pub fn new(ends: [Complex<f64>; 2], rates: [Complex<f64>; 2], step: f64) -> Self {
        let moved = ends[1] - ends[0];
        Self {
            tangent: (moved - rates[0] * step).norm(),
            trapezoid: (moved - (rates[0] + rates[1]) * (0.5 * step)).norm(),
        }
    }

    /// The error ratio that decides on a step; errors of the tangent below `negligible` count as `negligible`.
    pub fn ratio(&self, negligible: f64) -> f64 {
        self.trapezoid / self.tangent.max(negligible)
    }
}
