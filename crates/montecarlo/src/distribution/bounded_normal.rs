//! Normal and log-normal distributions under the condition that the value lies between two bounds.

use statrs::distribution::{ContinuousCDF, Normal};

/// Largest probability that a support leaves out at each end; chosen, far below one over any number of samples.
const NEGLIGIBLE_TAIL: f64 = 1e-12;

/// The largest number below 1, used as the largest probability: its standard normal quantile is 8.2, the quantile of 1 is infinite.
const LARGEST_BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

/// A value that is a function of a standard normal deviate z, and its bounds, which may be infinite.
#[derive(Debug, Clone, Copy)]
pub(super) struct BoundedNormal {
    scale: NormalScale,
    at_least: f64,
    at_most: f64,
    /// The bounds as deviates.
    lower: f64,
    upper: f64,
}

#[derive(Debug, Clone, Copy)]
enum NormalScale {
    /// mean + deviation z.
    Linear { mean: f64, deviation: f64 },
    /// median e^(sigma z).
    Logarithmic { median: f64, sigma: f64 },
}

impl NormalScale {
    fn value(self, z: f64) -> f64 {
        match self {
            Self::Linear { mean, deviation } => mean + deviation * z,
            Self::Logarithmic { median, sigma } => median * (sigma * z).exp(),
        }
    }

    /// Inverse of [`value`](Self::value).
    fn deviate(self, value: f64) -> f64 {
        match self {
            Self::Linear { mean, deviation } => (value - mean) / deviation,
            Self::Logarithmic { median, sigma } => (value.max(0.0) / median).ln() / sigma,
        }
    }
}

impl BoundedNormal {
    pub fn normal(mean: f64, deviation: f64, at_least: f64, at_most: Option<f64>) -> Self {
        Self::new(NormalScale::Linear { mean, deviation }, at_least, at_most)
    }

    pub fn log_normal(median: f64, sigma: f64, at_least: Option<f64>, at_most: Option<f64>) -> Self {
        Self::new(NormalScale::Logarithmic { median, sigma }, at_least.unwrap_or(0.0), at_most)
    }

    fn new(scale: NormalScale, at_least: f64, at_most: Option<f64>) -> Self {
        let at_most = at_most.unwrap_or(f64::INFINITY);
        Self { scale, at_least, at_most, lower: scale.deviate(at_least), upper: scale.deviate(at_most) }
    }

    /// The probabilities that the bounds cut off: below the lower and above the upper one.
    pub fn cut_off(self) -> [f64; 2] {
        let normal = Normal::standard();
        [normal.cdf(self.lower), normal.sf(self.upper)]
    }

    /// The probability between the bounds, of the distribution without them.
    pub fn share(self) -> f64 {
        let normal = Normal::standard();
        normal.cdf(self.upper) - normal.cdf(self.lower)
    }

    pub fn cumulative(self, x: f64) -> f64 {
        let normal = Normal::standard();
        let z = self.scale.deviate(x);
        if x <= self.at_least {
            0.0
        } else if x >= self.at_most {
            1.0
        } else if self.lower == f64::NEG_INFINITY {
            normal.cdf(z) / normal.cdf(self.upper)
        } else {
            // The survival function loses no digits above the mean.
            let beyond = normal.sf(self.upper);
            1.0 - (normal.sf(z) - beyond) / (normal.sf(self.lower) - beyond)
        }
    }

    pub fn quantile(self, u: f64) -> f64 {
        let normal = Normal::standard();
        let below = normal.cdf(self.lower);
        let p = (below + u * (normal.cdf(self.upper) - below)).min(LARGEST_BELOW_ONE);
        self.within_bounds(self.scale.value(normal.inverse_cdf(p)))
    }

    /// An interval that contains all but 2e-12 of the probability between the bounds.
    pub fn support(self) -> (f64, f64) {
        // Bounds that keep at least half of the probability at most double the probability of a tail.
        let share = self.share();
        let tail = if share < 0.5 { NEGLIGIBLE_TAIL * share } else { NEGLIGIBLE_TAIL };
        // Computed from the deviate z: in the tails, u near 0 or 1 has too few digits.
        let z = -Normal::standard().inverse_cdf(tail);
        (self.within_bounds(self.scale.value(-z)), self.within_bounds(self.scale.value(z)))
    }

    fn within_bounds(self, value: f64) -> f64 {
        value.max(self.at_least).min(self.at_most)
    }
}
