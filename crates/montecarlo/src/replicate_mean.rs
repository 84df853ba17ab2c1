//! The mean over independent replicates, with the standard error from their scatter.

use crate::confidence::{Confidence, Interval};

/// Mean and standard error of a quantity that was estimated several times independently, for example by randomly shifted or
/// scrambled point sets.
///
/// ```
/// use montecarlo::{Confidence, ReplicateMean};
/// let estimates = [0.41, 0.39, 0.40, 0.44];
/// let mean = ReplicateMean::of(estimates).unwrap();
/// let interval = mean.interval(Confidence::P95);
/// assert!(interval.lower > 0.37 && interval.contains(mean.mean) && interval.upper < 0.45);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReplicateMean {
    /// The mean.
    pub mean: f64,
    /// The standard error of the mean: the standard deviation of the replicates over the square root of their number.
    pub standard_error: f64,
    /// Number of replicates.
    pub replicates: u64,
}

impl ReplicateMean {
    /// The mean of at least two replicates; `None` for fewer, whose scatter is not known.
    #[must_use]
    pub fn of(replicates: impl IntoIterator<Item = f64, IntoIter: Clone>) -> Option<Self> {
        let values = replicates.into_iter();
        let replicates = values.clone().count() as u64;
        if replicates < 2 {
            return None;
        }
        let count = replicates as f64;
        let mean = values.clone().sum::<f64>() / count;
        let variance = values.map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
        Some(Self { mean, standard_error: (variance / count).sqrt(), replicates })
    }

    /// The interval by Student's t with one degree of freedom less than there are replicates.
    #[must_use]
    pub fn interval(&self, confidence: Confidence) -> Interval {
        let half_width = confidence.t(self.replicates - 1) * self.standard_error;
        Interval { lower: self.mean - half_width, upper: self.mean + half_width }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn mean_error_and_interval_are_those_of_the_textbook() {
        // Student (1908), differences of sleep, R: t.test(sleep$extra[11:20] - sleep$extra[1:10]).
        let mean = ReplicateMean::of([1.2, 2.4, 1.3, 1.3, 0.0, 1.0, 1.8, 0.8, 4.6, 1.4]).unwrap();
        assert_relative_eq!(mean.mean, 1.58, max_relative = 1e-12);
        assert_relative_eq!(mean.mean / mean.standard_error, 4.0621, max_relative = 1e-4);
        let interval = mean.interval(Confidence::P95);
        assert_relative_eq!(interval.lower, 0.700_114_2, max_relative = 1e-6);
        assert_relative_eq!(interval.upper, 2.459_885_8, max_relative = 1e-6);
    }

    #[test]
    fn one_replicate_has_no_known_error() {
        assert_eq!(ReplicateMean::of([1.0]), None);
        assert_eq!(ReplicateMean::of([]), None);
    }
}
