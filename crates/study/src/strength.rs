//! Strength of unstable modes: how fast they grow, how negative their damping is, and at which frequency.

use std::f64::consts::TAU;

use montecarlo::{Merge, QuantileSketch};
use num_complex::Complex;
use serde::{Deserialize, Serialize};

/// Eigenvalues lambda of a mode over the evaluations in which it is unstable.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Strength {
    /// Growth rates Re lambda, 1/s.
    pub growth: QuantileSketch,
    /// Damping ratios -Re lambda / |lambda|, negative.
    pub damping_ratio: QuantileSketch,
    /// Frequencies Im lambda / 2 pi, Hz.
    pub frequency_hz: QuantileSketch,
}

impl Strength {
    pub(crate) fn record(&mut self, lambda: Complex<f64>) {
        self.growth.record(lambda.re);
        self.damping_ratio.record(-lambda.re / lambda.norm());
        self.frequency_hz.record(lambda.im / TAU);
    }
}

impl Merge for Strength {
    fn merge(&mut self, later: Self) {
        self.growth.merge(later.growth);
        self.damping_ratio.merge(later.damping_ratio);
        self.frequency_hz.merge(later.frequency_hz);
    }
}
