//! Criteria of a screening: by what changes are ranked, and their effect told.

use montecarlo::Estimate;
use serde::Serialize;

use super::confirm::Confirmed;
use super::predict::Prediction;

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

/// A number >= 0 without its last 20 bits, 2e-10 of it: sums that are equal but for rounding are equal then.
fn without_rounding(number: f64) -> f64 {
    f64::from_bits((number.to_bits() + (1 << 19)) & !((1 << 20) - 1))
}

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
        let value = |prediction: &Prediction| without_rounding(self.predicted(prediction));
        let growth = |prediction: &Prediction| without_rounding(prediction.growth);
        value(a).total_cmp(&value(b)).then(growth(a).total_cmp(&growth(b)))
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

#[cfg(test)]
mod tests {
    use std::cmp::Ordering;

    use super::*;

    /// Counts of unstable modes in three panels, weighted, in all ways of adding them up; whole numbers tell which are equal.
    #[test]
    fn equal_numbers_of_modes_are_ranked_by_growth_however_they_are_summed() {
        let counts = (0..64_u32).map(|all| [all % 4, all / 4 % 4, all / 16]);
        let sums: Vec<(u32, f64)> = counts
            .map(|[a, b, c]| {
                let of = |part: f64, count: u32| part * f64::from(count);
                (a + 2 * b + 3 * c, of(0.1, a) + of(0.2, b) + of(0.3, c))
            })
            .collect();
        assert!([0.6, 0.1 + 0.2 + 0.3].iter().all(|sum| sums.contains(&(6, *sum))) && 0.6 != 0.1 + 0.2 + 0.3);
        for &(whole, unstable) in &sums {
            for &(other_whole, other) in &sums {
                let of = |unstable: f64, growth: f64| Prediction { unstable, growth, ..Prediction::default() };
                let order =
                    |growths: [f64; 2]| Criterion::Occurrence.order(&of(unstable, growths[0]), &of(other, growths[1]));
                assert_eq!(order([1.0, 2.0]), whole.cmp(&other_whole).then(Ordering::Less), "{unstable} {other}");
                assert_eq!(order([0.1 + 0.2, 0.3]), whole.cmp(&other_whole), "{unstable} {other}");
            }
        }
        let infinite = Prediction { loudness_quantile: Some(f64::INFINITY), ..Prediction::default() };
        assert_eq!(Criterion::Loudness.order(&infinite, &infinite), Ordering::Equal);
    }
}
