//! Step-size control: steps as long as they can be trusted, and the errors of the predictor that say so.
//!
//! With d the distance to the next branch point, an eigenvalue there is a smooth function plus a square root; a step s errs
//! by `s / 4 d` times as much by the trapezoidal rule for `d lambda / d t` as by the tangent alone, whatever value and slope
//! of the smooth function. A step is taken where that ratio is small; one that would jump to another mode has a ratio near 1.

use num_complex::Complex;

/// Largest ratio of the error of the trapezoidal rule to that of the tangent in a step that is taken; chosen: such a step is
/// 1.2 times the distance to the next branch point.
const LARGEST_ERROR_RATIO: f64 = 0.3;
/// The next step aims at the largest ratio divided by this; chosen, so that most steps are taken at once.
const RATIO_SAFETY: f64 = 1.5;
/// Least and largest factor from a step that was taken to the next; chosen.
const GROWTH: (f64, f64) = (0.6, 2.0);
/// Least and largest factor from a step that was refused to the next; chosen.
const REDUCTION: (f64, f64) = (0.25, 0.6);
/// Error of the tangent, relative to the eigenvalue, below which it counts as this much: the corrector leaves errors of
/// its own, whose ratio says nothing.
pub(crate) const NEGLIGIBLE_ERROR: f64 = 1e-5;
/// Attempts at most, taken or refused; chosen, far beyond what any path needs that gets to its end.
const MOST_ATTEMPTS: usize = 48;

/// A place on a path, and the step that is tried next.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StepControl {
    /// Part of the path that lies behind.
    pub t: f64,
    step: f64,
    attempts: usize,
}

impl StepControl {
    pub fn new(t: f64, step: f64) -> Self {
        Self { t, step, attempts: 0 }
    }

    /// The next step, which does not lead beyond the end.
    pub fn step(&self) -> f64 {
        self.step.min(1.0 - self.t)
    }

    /// Whether a step with this ratio of errors is taken.
    pub fn accepts(ratio: f64) -> bool {
        ratio <= LARGEST_ERROR_RATIO
    }

    /// Takes the next step if its ratio of errors is known and small, and makes it shorter if not.
    pub fn advance(&mut self, ratio: Option<f64>) {
        self.attempts += 1;
        let step = self.step();
        match ratio {
            Some(ratio) if Self::accepts(ratio) => {
                self.t += step;
                self.step = step * (LARGEST_ERROR_RATIO / (RATIO_SAFETY * ratio)).clamp(GROWTH.0, GROWTH.1);
            }
            other => {
                // The larger of a NaN and a number is the number.
                let ratio = other.unwrap_or(f64::INFINITY).max(LARGEST_ERROR_RATIO);
                self.step = step * (LARGEST_ERROR_RATIO / (RATIO_SAFETY * ratio)).clamp(REDUCTION.0, REDUCTION.1);
            }
        }
    }

    /// Whether it does not go on, at the end or for steps shorter than this.
    pub fn is_over(&self, shortest: f64) -> bool {
        self.t == 1.0 || self.step < shortest || self.attempts >= MOST_ATTEMPTS
    }
}

/// By how much two predictors miss the end of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PredictorErrors {
    /// The tangent at the beginning.
    pub tangent: f64,
    /// The trapezoidal rule for the derivatives at both ends.
    pub trapezoid: f64,
}

impl PredictorErrors {
    /// Of a function with these values and derivatives at the ends of a step.
    pub fn new(ends: [Complex<f64>; 2], rates: [Complex<f64>; 2], step: f64) -> Self {
        let moved = ends[1] - ends[0];
        Self {
            tangent: (moved - rates[0] * step).norm(),
            trapezoid: (moved - (rates[0] + rates[1]) * (0.5 * step)).norm(),
        }
    }

    /// The ratio that decides on a step; errors of the tangent below `negligible` count as this.
    pub fn ratio(&self, negligible: f64) -> f64 {
        self.trapezoid / self.tangent.max(negligible)
    }
}
