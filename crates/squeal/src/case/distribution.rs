//! The distribution of one uncertain parameter.

use montecarlo::{MonteCarloError, StreamRng, redraw_until_at_least};
use rand_distr::{Distribution as _, StandardNormal, StandardUniform};
use serde::Deserialize;

/// How a parameter is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(tag = "distribution", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Distribution {
    /// Always this.
    Constant {
        /// The value.
        value: f64,
    },
    /// Normal, redrawn until it is at least `at_least`.
    Normal {
        /// Mean before the bound.
        mean: f64,
        /// Standard deviation before the bound, > 0.
        deviation: f64,
        /// Smallest value, at most the mean.
        #[serde(default)]
        at_least: f64,
    },
    /// `median e^{sigma z}` with z standard normal.
    LogNormal {
        /// Median, > 0.
        median: f64,
        /// Standard deviation of the logarithm, > 0.
        sigma: f64,
    },
    /// Uniform.
    Uniform {
        /// Smallest value.
        from: f64,
        /// Largest value.
        to: f64,
    },
}

impl Distribution {
    /// One value.
    ///
    /// # Errors
    /// No draw reached the bound of a normal distribution; validation makes sure that half of them do, or more.
    pub fn draw(&self, rng: &mut StreamRng) -> Result<f64, MonteCarloError> {
        let mut standard_normal = || -> f64 { StandardNormal.sample(rng) };
        Ok(match *self {
            Self::Constant { value } => value,
            Self::Normal { mean, deviation, at_least } => {
                let deviates = StandardNormal.map(|z: f64| mean + deviation * z);
                redraw_until_at_least(&deviates, at_least, rng)?
            }
            Self::LogNormal { median, sigma } => median * (sigma * standard_normal()).exp(),
            Self::Uniform { from, to } => {
                let u: f64 = StandardUniform.sample(rng);
                from + (to - from) * u
            }
        })
    }

    /// The median; of the unbounded distribution where there is a bound, which lies below the mean.
    pub fn median(&self) -> f64 {
        match *self {
            Self::Constant { value } => value,
            Self::Normal { mean, .. } => mean,
            Self::LogNormal { median, .. } => median,
            Self::Uniform { from, to } => 0.5 * (from + to),
        }
    }

    /// The smallest value that can be drawn and the key that sets it; `None` for any value > 0.
    pub(super) fn least(&self) -> Option<(&'static str, f64)> {
        match *self {
            Self::Constant { value } => Some(("value", value)),
            Self::Normal { at_least, .. } => Some(("at_least", at_least)),
            Self::LogNormal { .. } => None,
            Self::Uniform { from, .. } => Some(("from", from)),
        }
    }

    /// What is wrong with the parameters, if anything: (key, value, allowed).
    pub(super) fn fault(&self) -> Option<(&'static str, f64, String)> {
        let positive =
            |key, value: f64| (!(value > 0.0 && value.is_finite())).then(|| (key, value, "a number > 0".into()));
        let finite = |key, value: f64| (!value.is_finite()).then(|| (key, value, "a finite number".into()));
        match *self {
            Self::Constant { value } => finite("value", value),
            Self::Normal { mean, deviation, at_least } => finite("mean", mean)
                .or_else(|| positive("deviation", deviation))
                .or_else(|| finite("at_least", at_least))
                .or_else(|| (at_least > mean).then(|| ("at_least", at_least, format!("at most the mean, {mean}")))),
            Self::LogNormal { median, sigma } => positive("median", median).or_else(|| positive("sigma", sigma)),
            Self::Uniform { from, to } => finite("from", from)
                .or_else(|| finite("to", to))
                .or_else(|| (to < from).then(|| ("to", to, format!("at least from = {from}")))),
        }
    }
}
