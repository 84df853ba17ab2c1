//! How fast a way is gone: steps as long as they can be trusted.

use num_complex::Complex;

/// Steps that are taken have at most this ratio of errors, and the next one aims at two thirds of it.
const RATIO: f64 = 0.3;
/// Attempts after which a trace is lost.
const MOST_ATTEMPTS: usize = 48;

/// A place on a way, and the step that is tried next.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pace {
    /// Part of the way gone.
    pub at: f64,
    step: f64,
    attempts: usize,
}

impl Pace {
    pub fn new(at: f64, step: f64) -> Self {
        Self { at, step, attempts: 0 }
    }

    /// The next step, which does not lead beyond the end.
    pub fn step(&self) -> f64 {
        self.step.min(1.0 - self.at)
    }

    /// Whether a step with this ratio of errors is taken.
    pub fn trusts(ratio: f64) -> bool {
        ratio <= RATIO
    }

    /// Takes the next step if its ratio of errors is known and small, and makes it shorter if not.
    pub fn go(&mut self, ratio: Option<f64>) {
        self.attempts += 1;
        let step = self.step();
        match ratio {
            Some(ratio) if Self::trusts(ratio) => {
                self.at += step;
                self.step = step * (RATIO / (1.5 * ratio)).clamp(0.6, 2.0);
            }
            other => {
                // The larger of a NaN and a number is the number.
                let ratio = other.unwrap_or(f64::INFINITY).max(RATIO);
                self.step = step * (RATIO / (1.5 * ratio)).clamp(0.25, 0.6);
            }
        }
    }

    /// Whether it does not go on, at the end or for steps shorter than this.
    pub fn is_over(&self, shortest: f64) -> bool {
        self.at == 1.0 || self.step < shortest || self.attempts >= MOST_ATTEMPTS
    }
}

/// By how much the tangent and the trapezoidal rule miss a function of which both ends of a step and its derivatives there
/// are known.
pub(super) fn misses(ends: [Complex<f64>; 2], rates: [Complex<f64>; 2], step: f64) -> [f64; 2] {
    let moved = ends[1] - ends[0];
    [(moved - rates[0] * step).norm(), (moved - (rates[0] + rates[1]) * (0.5 * step)).norm()]
}
