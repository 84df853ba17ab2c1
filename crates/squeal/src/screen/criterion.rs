//! Criteria of a screening: by what changes are ranked, and their effect told.

use serde::Serialize;

use super::confirm::Confirmed;
use super::predict::Prediction;
use crate::results::Estimate;

/// Quantity by which changes are ranked; less is better.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Criterion {
    /// Number of unstable modes in one analysis, on average.
    #[default]
    Occurrence,
    /// Fraction of the analyses in which anything is unstable.
    Probability,
    /// Quantile at 95 %, over the draws, of the largest growth rate that a draw has in any arrangement, law and speed range, 1/s.
    GrowthQuantile,
    /// Quantile at 95 %, over the draws, of the loudness of the loudest motion that a draw has in any arrangement, law and speed range: root mean square of
    /// the velocities of all displacements together, m/s; 0 where nothing is unstable.
    Loudness,
}

/// Estimate of a quantity that was not asked for.
const UNKNOWN: Estimate = Estimate { value: f64::NAN, lower: f64::NEG_INFINITY, upper: f64::INFINITY };

/// Form of a criterion's numbers for people.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Form {
    /// Factor of the numbers.
    pub times: f64,
    /// Digits after the point.
    pub decimals: usize,
    /// Unit of what is left, with a space before it; empty of counts.
    pub unit: &'static str,
    /// Words after a drop: of what it is less.
    pub fewer: &'static str,
    /// Analyses over which it is taken, in words.
    pub over: &'static str,
}

impl Criterion {
    /// All criteria.
    pub const ALL: [Self; 4] = [Self::Occurrence, Self::Probability, Self::GrowthQuantile, Self::Loudness];

    /// Name in options and JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Occurrence => "occurrence",
            Self::Probability => "probability",
            Self::GrowthQuantile => "growth-quantile",
            Self::Loudness => "loudness",
        }
    }

    /// Predicted value.
    #[must_use]
    pub fn predicted(self, prediction: &Prediction) -> f64 {
        match self {
            Self::Occurrence => prediction.unstable,
            Self::Probability => prediction.squealing,
            Self::GrowthQuantile => prediction.growth_quantile,
            Self::Loudness => prediction.loudness_quantile.unwrap_or(f64::NAN),
        }
    }

    /// Order of predictions: the least value first, of equal ones the least sum of growth rates.
    pub(super) fn order(self, a: &Prediction, b: &Prediction) -> std::cmp::Ordering {
        self.predicted(a).total_cmp(&self.predicted(b)).then(a.growth.total_cmp(&b.growth))
    }

    /// Confirmed value, with its 95 % interval.
    #[must_use]
    pub fn left(self, confirmed: &Confirmed) -> Estimate {
        match self {
            Self::Occurrence => confirmed.unstable,
            Self::Probability => confirmed.squealing,
            Self::GrowthQuantile => confirmed.growth_quantile,
            Self::Loudness => confirmed.loudness_quantile.unwrap_or(UNKNOWN),
        }
    }

    /// Confirmed drop against the brake without changes, on the same draws, with its 95 % interval.
    #[must_use]
    pub fn drop(self, confirmed: &Confirmed) -> Estimate {
        match self {
            Self::Occurrence => confirmed.drop,
            Self::Probability => confirmed.squealing_drop,
            Self::GrowthQuantile => confirmed.growth_quantile_drop,
            Self::Loudness => confirmed.loudness_quantile_drop.unwrap_or(UNKNOWN),
        }
    }

    /// Size of the confirmed drop, whichever its sign; -1 where it is not known.
    pub(super) fn effect(self, confirmed: &Confirmed) -> f64 {
        let drop = self.drop(confirmed).value;
        if drop.is_nan() { -1.0 } else { drop.abs() }
    }

    /// Form of its numbers for people.
    #[must_use]
    pub fn form(self) -> Form {
        match self {
            Self::Occurrence => Form {
                times: 1.0,
                decimals: 3,
                unit: "",
                fewer: "unstable modes fewer in one analysis",
                over: "on average over all arrangements, laws and speed ranges",
            },
            Self::Probability => Form {
                times: 100.0,
                decimals: 1,
                unit: " %",
                fewer: "percentage points fewer analyses with anything unstable",
                over: "on average over all arrangements, laws and speed ranges",
            },
            Self::GrowthQuantile => Form {
                times: 1.0,
                decimals: 1,
                unit: " 1/s",
                fewer: "1/s less growth that 95 % of the draws do not exceed",
                over: "of each draw the fastest mode in any arrangement, law and speed range",
            },
            Self::Loudness => Form {
                times: 1.0,
                decimals: 3,
                unit: " m/s",
                fewer: "m/s less loudness that 95 % of the draws do not exceed",
                over: "rms velocity of all displacements together, of each draw its loudest motion in any arrangement, law and speed range",
            },
        }
    }
}
