//! The gain of a feedback.

use num_complex::Complex;

use super::response::Point;

/// The gain of a feedback: `Q(lambda) = Q_0(lambda) + B (mu R + lambda (slope + lag / (lambda + decay)) B^T)`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Gain {
    /// Proportional gain mu; p in the equations.
    pub mu: f64,
    /// Slope of the feedback force over the velocity, Ns/m: the constant part of v(lambda) in the secular equation.
    pub slope: f64,
    /// Stiffness that the internal states of the feedback add, N/m; 0 for a feedback without internal states.
    pub lag: f64,
    /// Decay rate of the internal states, 1/s.
    pub decay: f64,
}

impl Gain {
    /// v(lambda) = `slope + lag / (lambda + decay)`.
    pub(super) fn complex_slope(&self, lambda: Complex<f64>) -> Complex<f64> {
        if self.lag == 0.0 { Complex::from(self.slope) } else { self.slope + self.lag / (lambda + self.decay) }
    }

    /// The feedback at an eigenvalue.
    pub(super) fn at(&self, sigma: Complex<f64>) -> Point {
        Point { sigma, mu: self.mu, slope: self.complex_slope(sigma) }
    }

    pub(super) fn in_units(&self, unit: f64) -> Self {
        Self { lag: self.lag / unit, decay: self.decay / unit, ..*self }
    }
}
