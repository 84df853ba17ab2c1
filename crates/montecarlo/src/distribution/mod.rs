//! The distribution of one uncertain parameter, as data.

mod bounded_normal;
mod check;
mod ordered;
mod quantile_table;

use std::path::PathBuf;

use rand_distr::{Distribution as _, Open01, StandardNormal, StandardUniform};
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF as _, Normal};

use crate::error::MonteCarloError;
use crate::redraw::redraw_until_at_least;
use crate::stream::StreamRng;

use bounded_normal::BoundedNormal;
use quantile_table::interpolate;

/// Largest value taken of a distribution function, the double next to 1: rounded to 0 or 1 it would have an infinite normal score.
pub(crate) const MOST_PROBABLE: f64 = 1.0 - f64::EPSILON / 2.0;

/// Largest difference of the median of a normal distribution from its mean, as a fraction of the mean, with which the mean itself is given as the median;
/// chosen: six digits, which is what is printed.
const SAME_MEDIAN: f64 = 1e-6;

/// Distribution that a parameter is drawn from. In a file: `{ distribution = "normal", mean = 0.5, deviation = 0.1 }`.
///
/// ```
/// use montecarlo::{Distribution, stream};
///
/// let friction = Distribution::Normal { mean: 0.5, deviation: 0.1, at_least: 0.02, at_most: None };
/// friction.check()?;
/// assert!(friction.draw(&mut stream(1, 0))? >= 0.02);
/// assert!((friction.cumulative(friction.quantile(0.9)) - 0.9).abs() < 1e-10);
///
/// let measured = Distribution::Quantiles { probabilities: vec![0.0, 0.5, 1.0], values: vec![0.25, 0.5, 1.0] };
/// assert_eq!(measured.quantile(0.75), 0.75);
///
/// let slip = Distribution::Uniform { from: 2.0, to: 1.0 }.check().unwrap_err();
/// assert_eq!(slip.to_string(), "to = 1; allowed: at least from = 2");
/// # Ok::<(), montecarlo::MonteCarloError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "distribution", rename_all = "kebab-case", deny_unknown_fields)]
#[non_exhaustive]
pub enum Distribution {
    /// Always the same value.
    Constant {
        /// The value.
        value: f64,
    },
    /// Normal, under the condition that the value lies between the bounds.
    ///
    /// With `at_least` alone a value is redrawn until it reaches the bound, which at least half of the draws do; with
    /// `at_most` a value is the quantile of one uniform number.
    Normal {
        /// Mean without the bounds.
        mean: f64,
        /// Standard deviation without the bounds, > 0.
        deviation: f64,
        /// Smallest value; 0 where a file does not give it, negative infinity for no bound. Where it is the only bound, it
        /// must not exceed the mean.
        #[serde(default)]
        at_least: f64,
        /// Largest value.
        #[serde(default)]
        at_most: Option<f64>,
    },
    /// `median e^{sigma z}` with z standard normal, under the condition that the value lies between the bounds. With a bound, a
    /// value is the quantile of one uniform number.
    LogNormal {
        /// Median without the bounds, > 0.
        median: f64,
        /// Standard deviation of the logarithm without the bounds, > 0.
        sigma: f64,
        /// Smallest value, > 0.
        #[serde(default)]
        at_least: Option<f64>,
        /// Largest value.
        #[serde(default)]
        at_most: Option<f64>,
    },
    /// Uniform.
    Uniform {
        /// Smallest value.
        from: f64,
        /// Largest value.
        to: f64,
    },
    /// The logarithm of the value is uniform.
    LogUniform {
        /// Smallest value, > 0.
        from: f64,
        /// Largest value.
        to: f64,
    },
    /// A table of quantiles with linear interpolation: uniform between two neighbouring values.
    Quantiles {
        /// Probabilities, ascending from 0 to 1.
        probabilities: Vec<f64>,
        /// Quantile at each probability, ascending.
        values: Vec<f64>,
    },
    /// Triangular: a density that rises from the smallest value to the mode and falls to the largest.
    Triangular {
        /// Smallest value.
        from: f64,
        /// Most frequent value.
        mode: f64,
        /// Largest value, > `from`.
        to: f64,
    },
    /// Weibull: `from + scale (-ln(1 - u))^(1 / shape)`, u uniform.
    Weibull {
        /// Shape, > 0: 1 is exponential, 3.6 nearly normal.
        shape: f64,
        /// Scale, > 0: 63 % of the values are below `from + scale`.
        scale: f64,
        /// Smallest value; 0 where a file does not give it.
        #[serde(default)]
        from: f64,
    },
    /// One of a few values, each with a probability in proportion to its weight.
    Discrete {
        /// Values, ascending.
        values: Vec<f64>,
        /// Weight of each value, > 0; equal ones where a file does not give them.
        #[serde(default)]
        weights: Vec<f64>,
    },
    /// Measured values: the quantile function is linear between them in order, the smallest at 0 and the largest at 1 (type 7 of Hyndman
    /// and Fan, The American Statistician 50, 1996).
    Empirical {
        /// Values, ascending; of a file that is given in their place whoever reads the case puts them here.
        #[serde(default)]
        values: Vec<f64>,
        /// File with the values, a column of a CSV file.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        file: Option<PathBuf>,
        /// Heading of that column; the first column without.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        column: Option<String>,
    },
}

impl Distribution {
    /// The kind by its name in a file, and its numbers in the order of its fields, `None` for a bound that is not there: what tells two
    /// distributions apart.
    #[must_use]
    pub fn written_out(&self) -> (&'static str, Vec<Option<f64>>) {
        match self {
            Self::Constant { value } => ("constant", vec![Some(*value)]),
            Self::Normal { mean, deviation, at_least, at_most } => {
                ("normal", vec![Some(*mean), Some(*deviation), Some(*at_least), *at_most])
            }
            Self::LogNormal { median, sigma, at_least, at_most } => {
                ("log-normal", vec![Some(*median), Some(*sigma), *at_least, *at_most])
            }
            Self::Uniform { from, to } => ("uniform", vec![Some(*from), Some(*to)]),
            Self::LogUniform { from, to } => ("log-uniform", vec![Some(*from), Some(*to)]),
            Self::Quantiles { probabilities, values } => {
                ("quantiles", probabilities.iter().chain(values).map(|number| Some(*number)).collect())
            }
            Self::Triangular { from, mode, to } => ("triangular", vec![Some(*from), Some(*mode), Some(*to)]),
            Self::Weibull { shape, scale, from } => ("weibull", vec![Some(*shape), Some(*scale), Some(*from)]),
            Self::Discrete { values, weights } => {
                ("discrete", values.iter().chain(weights).map(|number| Some(*number)).collect())
            }
            Self::Empirical { values, .. } => ("empirical", values.iter().map(|number| Some(*number)).collect()),
        }
    }

    /// True if some value has a probability of its own, so that the distribution function jumps: of a discrete distribution, of measured values that
    /// repeat, of one value alone.
    #[must_use]
    pub fn has_atoms(&self) -> bool {
        match self {
            Self::Constant { .. } | Self::Discrete { .. } => true,
            Self::Uniform { from, to } | Self::LogUniform { from, to } | Self::Triangular { from, to, .. } => {
                from >= to
            }
            Self::Quantiles { values, .. } | Self::Empirical { values, .. } => {
                values.len() < 2 || values.windows(2).any(|pair| pair[0] == pair[1])
            }
            Self::Normal { .. } | Self::LogNormal { .. } | Self::Weibull { .. } => false,
        }
    }

    /// True if the quantile function jumps, or has but one value: of a discrete distribution, of one value alone. That of measured values that repeat is
    /// flat there, and continuous.
    #[must_use]
    pub fn jumps(&self) -> bool {
        match self {
            Self::Quantiles { values, .. } | Self::Empirical { values, .. } => values.first() == values.last(),
            _ => self.has_atoms(),
        }
    }

    /// A value drawn from the distribution.
    ///
    /// # Errors
    /// No draw reached the bound of a normal distribution; after [`check`](Self::check) at least half of all draws do.
    pub fn draw(&self, rng: &mut StreamRng) -> Result<f64, MonteCarloError> {
        Ok(match *self {
            Self::Constant { value } => value,
            Self::Normal { mean, deviation, at_least, at_most: None } => {
                let deviates = StandardNormal.map(|z: f64| mean + deviation * z);
                redraw_until_at_least(&deviates, at_least, rng)?
            }
            Self::LogNormal { median, sigma, at_least: None, at_most: None } => {
                let z: f64 = StandardNormal.sample(rng);
                median * (sigma * z).exp()
            }
            Self::Normal { .. } | Self::LogNormal { .. } => self.quantile(Open01.sample(rng)),
            Self::Uniform { .. }
            | Self::LogUniform { .. }
            | Self::Quantiles { .. }
            | Self::Triangular { .. }
            | Self::Weibull { .. }
            | Self::Discrete { .. }
            | Self::Empirical { .. } => self.quantile(StandardUniform.sample(rng)),
        })
    }

    /// The median of what is drawn: of the distribution between its bounds, if it has bounds. It is the mean of a normal distribution as it was given,
    /// to the last digit, where its lower bound is the only one and moves the median by less than a millionth of it.
    #[must_use]
    pub fn median(&self) -> f64 {
        match *self {
            Self::LogNormal { median, at_least: None, at_most: None, .. } => median,
            Self::Uniform { from, to } => 0.5 * (from + to),
            Self::Normal { mean, at_most: None, .. } => {
                let median = self.quantile(0.5);
                if (median - mean).abs() <= SAME_MEDIAN * mean.abs() { mean } else { median }
            }
            _ => self.quantile(0.5),
        }
    }

    /// The smallest value that can be drawn, and the key that gives it; `None` where every value > 0 can be drawn.
    #[must_use]
    pub fn least(&self) -> Option<(&'static str, f64)> {
        match *self {
            Self::Constant { value } => Some(("value", value)),
            Self::Normal { at_least, .. } => Some(("at_least", at_least)),
            Self::LogNormal { at_least, .. } => at_least.map(|at_least| ("at_least", at_least)),
            Self::Uniform { from, .. }
            | Self::LogUniform { from, .. }
            | Self::Triangular { from, .. }
            | Self::Weibull { from, .. } => Some(("from", from)),
            Self::Quantiles { ref values, .. }
            | Self::Discrete { ref values, .. }
            | Self::Empirical { ref values, .. } => values.first().map(|&least| ("values", least)),
        }
    }

    /// The distribution function, P(X <= x).
    #[must_use]
    pub fn cumulative(&self, x: f64) -> f64 {
        match *self {
            Self::Constant { value } => f64::from(x >= value),
            Self::Normal { mean, deviation, at_least, at_most } => {
                BoundedNormal::normal(mean, deviation, at_least, at_most).cumulative(x)
            }
            Self::LogNormal { median, sigma, at_least, at_most } => {
                BoundedNormal::log_normal(median, sigma, at_least, at_most).cumulative(x)
            }
            Self::Uniform { from, to } if to > from => ((x - from) / (to - from)).clamp(0.0, 1.0),
            Self::LogUniform { from, to } if to > from => {
                if x <= from {
                    0.0
                } else {
                    ((x / from).ln() / (to / from).ln()).min(1.0)
                }
            }
            Self::Uniform { from, .. } | Self::LogUniform { from, .. } => f64::from(x >= from),
            Self::Quantiles { ref probabilities, ref values } => interpolate(values, probabilities, x),
            Self::Triangular { from, .. } if x <= from => 0.0,
            Self::Triangular { to, .. } if x >= to => 1.0,
            Self::Triangular { from, mode, to } if x < mode => (x - from).powi(2) / ((to - from) * (mode - from)),
            Self::Triangular { from, mode, to } => 1.0 - (to - x).powi(2) / ((to - from) * (to - mode)),
            Self::Weibull { shape, scale, from } => -(-((x - from).max(0.0) / scale).powf(shape)).exp_m1(),
            Self::Discrete { ref values, ref weights } => {
                let below = values.partition_point(|value| *value <= x);
                share(weights, below, values.len())
            }
            Self::Empirical { ref values, .. } => ordered::cumulative(values, x),
        }
    }

    /// The quantile at probability `u`, 0 < u < 1.
    #[must_use]
    pub fn quantile(&self, u: f64) -> f64 {
        match *self {
            Self::Constant { value } => value,
            Self::Normal { mean, deviation, at_least, at_most } => {
                BoundedNormal::normal(mean, deviation, at_least, at_most).quantile(u)
            }
            Self::LogNormal { median, sigma, at_least, at_most } => {
                BoundedNormal::log_normal(median, sigma, at_least, at_most).quantile(u)
            }
            Self::Uniform { from, to } => from + (to - from) * u,
            Self::LogUniform { from, to } => (from * (to / from).powf(u)).min(to),
            Self::Quantiles { ref probabilities, ref values } => interpolate(probabilities, values, u),
            Self::Triangular { from, mode, to } => {
                let (whole, rising) = (to - from, mode - from);
                match u * whole < rising {
                    true => from + (u * whole * rising).sqrt(),
                    false => to - ((1.0 - u) * whole * (to - mode)).sqrt(),
                }
            }
            Self::Weibull { shape, scale, from } => from + scale * (-(-u).ln_1p()).powf(1.0 / shape),
            Self::Discrete { ref values, ref weights } => {
                let is_below = |place: &usize| share(weights, place + 1, values.len()) < u;
                let place = (0..values.len()).take_while(is_below).count();
                values.get(place).or(values.last()).copied().unwrap_or(f64::NAN)
            }
            Self::Empirical { ref values, .. } => ordered::quantile(values, u),
        }
    }

    /// The value with a normal score z, `F^-1(Phi(z))`: for a standard normal number z the value has this distribution.
    #[must_use]
    pub fn of_score(&self, score: f64) -> f64 {
        match *self {
            Self::LogNormal { median, sigma, at_least: None, at_most: None } => median * (sigma * score).exp(),
            _ => self.quantile_of_score(score),
        }
    }

    /// The quantile at the probability of a normal score, which is neither 0 nor 1.
    pub(crate) fn quantile_of_score(&self, score: f64) -> f64 {
        self.quantile(Normal::standard().cdf(score).clamp(f64::MIN_POSITIVE, MOST_PROBABLE))
    }

    /// An interval that contains all but 2e-12 of the probability.
    #[must_use]
    pub fn support(&self) -> (f64, f64) {
        match *self {
            Self::Constant { value } => (value, value),
            Self::Normal { mean, deviation, at_least, at_most } => {
                BoundedNormal::normal(mean, deviation, at_least, at_most).support()
            }
            Self::LogNormal { median, sigma, at_least, at_most } => {
                BoundedNormal::log_normal(median, sigma, at_least, at_most).support()
            }
            Self::Uniform { from, to } | Self::LogUniform { from, to } | Self::Triangular { from, to, .. } => {
                (from, to)
            }
            Self::Weibull { .. } => (self.quantile(1e-12), self.quantile(1.0 - 1e-12)),
            Self::Quantiles { ref values, .. }
            | Self::Discrete { ref values, .. }
            | Self::Empirical { ref values, .. } => {
                (values.first().copied().unwrap_or(f64::NAN), values.last().copied().unwrap_or(f64::NAN))
            }
        }
    }
}

/// The probability of the first of several values with these weights, equal ones without.
fn share(weights: &[f64], first: usize, values: usize) -> f64 {
    match weights {
        [] => first as f64 / values as f64,
        weights if first >= weights.len() => 1.0,
        weights => weights[..first].iter().sum::<f64>() / weights.iter().sum::<f64>(),
    }
}
