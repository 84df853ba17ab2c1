//! Quantiles of many values in bounded memory.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use statrs::distribution::{Binomial, DiscreteCDF};

use crate::box_statistics::{interpolate, rank, rank_not_exceeded};
use crate::confidence::{Confidence, Interval};
use crate::error::MonteCarloError;
use crate::merge::Merge;

/// Number of low bits of an `f64` that its bucket does not depend on; chosen: 10 of the 52 fraction bits remain, which makes 1,024
/// buckets per octave.
const DROPPED: u32 = 42;

/// Counts of values in logarithmic buckets: 1,024 of equal width in each octave, at most 2^-10 of their lower limit wide.
///
/// A value counts as the middle of its bucket, with a relative error of at most
/// [`RELATIVE_ACCURACY`](Self::RELATIVE_ACCURACY); a value below the smallest normal number counts as zero. The state does not
/// depend on the order and grouping of the values. Values that span d decades fill at most 3,402 d + 1 buckets of each
/// sign, whatever their number.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct QuantileSketch {
    count: u64,
    not_finite: u64,
    /// Smallest and largest value, exactly.
    range: Option<Interval>,
    /// Count by key; keys ascend with the values.
    buckets: BTreeMap<u32, u64>,
}

impl QuantileSketch {
    /// Largest distance between the middle of a bucket and a value in it, relative to the value: 2^-11. Chosen: quantiles to
    /// three digits; half of it takes twice as many buckets.
    pub const RELATIVE_ACCURACY: f64 = 1.0 / 2048.0;

    /// Enters one value. NaN and infinities are counted separately, see [`not_finite`](Self::not_finite).
    pub fn record(&mut self, value: f64) {
        if !value.is_finite() {
            self.not_finite += 1;
            return;
        }
        let value = if value.abs() < f64::MIN_POSITIVE { 0.0 } else { value };
        self.count += 1;
        self.widen(Interval { lower: value, upper: value });
        *self.buckets.entry(key(value)).or_default() += 1;
    }

    fn widen(&mut self, by: Interval) {
        self.range = Some(match self.range {
            Some(range) => Interval { lower: range.lower.min(by.lower), upper: range.upper.max(by.upper) },
            None => by,
        });
    }

    /// Number of finite values.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Number of values that were NaN or infinite; they do not enter quantiles.
    #[must_use]
    pub fn not_finite(&self) -> u64 {
        self.not_finite
    }

    /// The smallest and the largest value, exact; `None` without values.
    #[must_use]
    pub fn range(&self) -> Option<Interval> {
        self.range
    }

    /// The quantile at 1/2.
    ///
    /// # Errors
    /// No values.
    pub fn median(&self) -> Result<f64, MonteCarloError> {
        self.quantile(0.5)
    }

    /// The quantile at probability `p`, type 7 as in [`quantile`](crate::quantile), from order statistics with relative errors
    /// of at most [`RELATIVE_ACCURACY`](Self::RELATIVE_ACCURACY).
    ///
    /// # Errors
    /// No values, or `p` outside [0, 1].
    pub fn quantile(&self, p: f64) -> Result<f64, MonteCarloError> {
        let last = self.count.checked_sub(1).ok_or(MonteCarloError::Empty { statistic: "a quantile" })?;
        let (rank, fraction) = rank(last, p)?;
        Ok(interpolate(self.order_statistic(rank), self.order_statistic((rank + 1).min(last)), fraction))
    }

    /// The number that the fraction `p` of all values does not exceed, as [`not_exceeded`](crate::not_exceeded), where those that were NaN or infinite count as
    /// larger than any: infinite if it is one of these.
    ///
    /// # Errors
    /// No values at all, or `p` outside [0, 1].
    pub fn not_exceeded(&self, p: f64) -> Result<f64, MonteCarloError> {
        let rank = rank_not_exceeded(self.count + self.not_finite, p)?;
        Ok(if rank < self.count { self.order_statistic(rank) } else { f64::INFINITY })
    }

    /// A confidence interval for the quantile at `p` of the distribution that the values come from: two order statistics,
    /// chosen by the binomial distribution of the number of values below the quantile (H. A. David, Order Statistics, 2.5).
    /// For any distribution it covers with at least the probability asked for. `None` where the values are too few, or `p` is
    /// too near 0 or 1, for two finite limits.
    ///
    /// # Errors
    /// `p` not strictly between 0 and 1.
    pub fn quantile_interval(&self, p: f64, confidence: Confidence) -> Result<Option<Interval>, MonteCarloError> {
        let refused = MonteCarloError::Probability { name: "the quantile's probability", value: p, range: "in (0, 1)" };
        if !(p > 0.0 && p < 1.0) {
            return Err(refused);
        }
        let below = Binomial::new(p, self.count).map_err(|_| refused)?;
        // The number of values below the quantile is less than `lower`, or at least `upper`, with probability <= tail.
        let lower = below.inverse_cdf(confidence.tail());
        let upper = below.inverse_cdf(1.0 - confidence.tail()) + 1;
        Ok((lower >= 1 && upper <= self.count)
            .then(|| Interval { lower: self.order_statistic(lower - 1), upper: self.order_statistic(upper - 1) }))
    }

    /// The value of a rank from 0: exact for the first and the last rank, the middle of its bucket for the others.
    fn order_statistic(&self, rank: u64) -> f64 {
        let Some(range) = self.range else { return f64::NAN };
        if rank == 0 {
            return range.lower;
        }
        let mut passed = 0;
        let bucket = self.buckets.iter().find(|&(_, &count)| {
            passed += count;
            rank < passed
        });
        match bucket {
            // The middle of a bucket may lie outside the range of the values.
            Some((&key, _)) if rank + 1 < self.count => middle(key).clamp(range.lower, range.upper),
            _ => range.upper,
        }
    }
}

impl Merge for QuantileSketch {
    fn merge(&mut self, later: Self) {
        self.count += later.count;
        self.not_finite += later.not_finite;
        if let Some(range) = later.range {
            self.widen(range);
        }
        for (key, count) in later.buckets {
            *self.buckets.entry(key).or_default() += count;
        }
    }
}

/// The leading bits of a finite value, transformed so that they ascend with the value: the bits of negative numbers are
/// inverted, the sign bit of positive numbers is set.
fn key(value: f64) -> u32 {
    let bits = value.to_bits();
    let ordered = if value.is_sign_negative() { !bits } else { bits | 1 << 63 };
    (ordered >> DROPPED) as u32
}

/// The middle of a bucket; zero has its own bucket.
fn middle(key: u32) -> f64 {
    const SIGN: u32 = 1 << (63 - DROPPED);
    let magnitude = if key >= SIGN { key - SIGN } else { !key & (SIGN - 1) };
    if magnitude == 0 {
        return 0.0;
    }
    let middle = f64::from_bits(u64::from(magnitude) << DROPPED | 1 << (DROPPED - 1));
    if key >= SIGN { middle } else { -middle }
}
