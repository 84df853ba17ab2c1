//! The confidence interval of an occurrence, from the mean of a prediction and the counts of its errors.

use std::collections::{BTreeMap, BTreeSet};

use linsys::ChannelGain;
use montecarlo::{Confidence, Interval, ReplicateMean};

use super::evaluations::Evaluations;
use super::friction_points::FrictionPoints;
use super::sampling::mean_of_scramblings;
use super::stratum::Stratum;
use super::{Estimated, OccurrenceBounds, Surrogate};
use crate::ModeLabel;

/// Error probability of the interval for the probability of an uncertain prediction; chosen, as a share of the 5 % of all looks.
pub(super) const UNCERTAIN_SHARE_TAIL: f64 = 0.001;
/// Error probability of each interim look at the counts, and its number of samples as a multiple of the number at the first.
/// Chosen: with [`UNCERTAIN_SHARE_TAIL`] the probabilities sum to 0.05 (Boole's inequality).
pub(super) const INTERIM_LOOKS: [(f64, f64); 4] = [(0.030, 1.0), (0.013, 1.7), (0.004, 3.0), (0.002, 6.0)];
/// Fraction of the error probability of a look that belongs to the clear samples; the rest belongs to Student's t. Chosen.
const CLEAR_TAIL_PART: f64 = 0.7;

/// Occurrences of one scene by a control variate.
#[derive(Debug, Clone, PartialEq)]
pub struct ControlVariateEstimate {
    /// The occurrence of each mode by name, with 95 % limits.
    pub modes: BTreeMap<ModeLabel, Estimated>,
    /// Upper limit of the occurrence of any mode that is not listed.
    pub unseen: f64,
    /// Numbers of systems solved.
    pub evaluations: Evaluations,
    /// Numbers of clear and of uncertain samples in which the prediction was wrong about any mode.
    pub wrong: [u64; 2],
    /// Probability that the prediction is uncertain.
    pub uncertain: f64,
}

impl ControlVariateEstimate {
    /// Largest half width, without the part that is due to open names: more samples do not reduce that.
    pub fn half_width(&self) -> f64 {
        self.modes.values().map(Estimated::half_width).fold(self.unseen, f64::max)
    }
}

/// Means of a prediction over Sobol points, with the standard errors that follow from the scatter of the scramblings.
pub(super) struct PredictionMeans {
    /// Probabilities of the predictions that a mode is certainly, and possibly, unstable, by name.
    pub modes: BTreeMap<ModeLabel, [ReplicateMean; 2]>,
    /// The probability of an uncertain prediction.
    pub uncertain: ReplicateMean,
}

impl PredictionMeans {
    pub fn new(surrogate: &Surrogate, points: &FrictionPoints) -> Self {
        let count = surrogate.names().len();
        let hits: Vec<Vec<u32>> = points.scramblings.iter().map(|run| hits(surrogate, run)).collect();
        let of_each = points.scramblings.first().map_or(0, Vec::len) as u32;
        let mean = |place: usize| mean_of_scramblings(hits.iter().map(|run| f64::from(run[place])), of_each);
        let of = |bit: usize| [2 * bit, 2 * bit + 1].map(mean);
        Self {
            modes: surrogate.names().iter().enumerate().map(|(bit, &name)| (name, of(bit))).collect(),
            uncertain: mean(2 * count),
        }
    }

    /// Student's t at an error probability.
    pub fn t(&self, tail: f64) -> f64 {
        Confidence::new(1.0 - tail).map_or(f64::INFINITY, |level| level.t(self.uncertain.replicates - 1))
    }

    /// Half the width of the interval of the probability of an uncertain prediction.
    fn uncertain_error(&self) -> f64 {
        self.t(UNCERTAIN_SHARE_TAIL) * self.uncertain.standard_error
    }

    /// Upper limits of the probabilities of a clear and of an uncertain prediction.
    pub fn largest_shares(&self) -> [f64; 2] {
        let (mean, error) = (self.uncertain.mean, self.uncertain_error());
        [1.0 - mean + error, mean + error].map(|limit| limit.min(1.0))
    }
}

/// Numbers of points at which each mode is predicted to be certainly, and possibly, unstable; last, the number at
/// which the prediction is uncertain.
fn hits(surrogate: &Surrogate, points: &[ChannelGain]) -> Vec<u32> {
    let count = surrogate.names().len();
    let mut hits = vec![0_u32; 2 * count + 1];
    for gain in points {
        let prediction = surrogate.predict(gain);
        for bit in 0..count {
            hits[2 * bit] += (prediction.unstable.sure >> bit & 1) as u32;
            hits[2 * bit + 1] += (prediction.unstable.perhaps >> bit & 1) as u32;
        }
        hits[2 * count] += u32::from(prediction.is_uncertain);
    }
    hits
}

/// The occurrences at one look, with the error probabilities `tails` of the clear samples and of Student's t. The first look
/// uses one limit of the probability that prediction and reference differ in a clear sample.
pub(super) fn intervals(
    means: &PredictionMeans,
    strata: &[Stratum; 2],
    tails: [f64; 2],
    is_first: bool,
    evaluations: Evaluations,
) -> ControlVariateEstimate {
    let [clear, uncertain] = strata;
    let names: BTreeSet<ModeLabel> =
        means.modes.keys().chain(strata.iter().flat_map(|stratum| stratum.differences.keys())).copied().collect();
    let look = InterimLook { means, clear, uncertain, largest_shares: means.largest_shares(), tails, is_first };
    ControlVariateEstimate {
        modes: names.into_iter().map(|name| (name, look.estimate(name))).collect(),
        unseen: look.limits(None)[1] + look.by_student(None, 0.0, 0.0),
        evaluations,
        wrong: [clear.wrong, uncertain.wrong],
        uncertain: means.uncertain.mean,
    }
}

/// Counts at one interim look.
struct InterimLook<'a> {
    means: &'a PredictionMeans,
    clear: &'a Stratum,
    uncertain: &'a Stratum,
    largest_shares: [f64; 2],
    tails: [f64; 2],
    is_first: bool,
}

impl InterimLook<'_> {
    fn estimate(&self, name: ModeLabel) -> Estimated {
        let share = self.means.uncertain.mean;
        let predicted = self.means.modes.get(&name);
        let [mean, error] = [|mean: &ReplicateMean| mean.mean, |mean: &ReplicateMean| mean.standard_error]
            .map(|of| predicted.map_or([0.0; 2], |ends| ends.each_ref().map(of)));
        let name = Some(name);
        let [down, up] = self.limits(name);
        let (in_clear, in_uncertain) = (self.clear.shift(name), self.uncertain.shift(name));
        let (least, greatest) = (mean[0] + share * in_uncertain[0], mean[1] + share * in_uncertain[1]);
        let lowest = least - self.by_student(name, error[0], in_uncertain[0]) - down;
        let highest = greatest + self.by_student(name, error[1], in_uncertain[1]) + up;
        let [lower, upper] = [least + (1.0 - share) * in_clear[0], greatest + (1.0 - share) * in_clear[1]]
            .map(|end| end.clamp(0.0, 1.0));
        let limits = Interval { lower: lowest.clamp(0.0, 1.0), upper: highest.clamp(0.0, 1.0) };
        Estimated { occurrence: OccurrenceBounds { lower, upper }, limits }
    }

    /// Half width by Student's t at one end of an occurrence, from the standard error `of_mean` of the mean of the prediction
    /// and from the uncertain samples, which correct this mean by `shift` times their share; without a name, of a mode that
    /// was never seen.
    fn by_student(&self, name: Option<ModeLabel>, of_mean: f64, shift: f64) -> f64 {
        let variance = (self.largest_shares[1] * self.uncertain.deviation(name)).powi(2) + of_mean.powi(2);
        self.means.t(self.tails[1]) * variance.sqrt() + shift.abs() * self.means.uncertain_error()
    }

    /// Limits of the correction by clear samples of the ends of an occurrence, down and up; without a name, of a mode that was
    /// never seen.
    fn limits(&self, name: Option<ModeLabel>) -> [f64; 2] {
        self.clear.limits(name, self.tails[0], self.is_first).map(|limit| self.weighted(limit))
    }

    /// A limit among clear samples as a limit among all samples: a positive one with the largest share that clear samples may
    /// have, a negative one with the smallest.
    fn weighted(&self, limit: f64) -> f64 {
        limit * if limit > 0.0 { self.largest_shares[0] } else { 1.0 - self.largest_shares[1] }
    }
}

/// The error probabilities of clear samples and of Student's t in a look with the error probability `tail`.
pub(super) const fn tails(tail: f64) -> [f64; 2] {
    [CLEAR_TAIL_PART * tail, (1.0 - CLEAR_TAIL_PART) * tail]
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    const MODE: ModeLabel = ModeLabel::new(7);

    /// A mean without error.
    fn known(mean: f64) -> ReplicateMean {
        ReplicateMean { mean, standard_error: 0.0, replicates: 32 }
    }

    /// The intervals of a prediction that is the same in all samples, all of them clear.
    fn found(predicted: bool, references: impl Iterator<Item = Option<bool>>) -> ControlVariateEstimate {
        let predicted = if predicted { BTreeMap::from([(MODE, true)]) } else { BTreeMap::new() };
        let mut clear = Stratum::default();
        references.for_each(|reference| {
            clear.enter(&predicted, &reference.map(|is_sure| (MODE, is_sure)).into_iter().collect())
        });
        let means = PredictionMeans {
            modes: BTreeMap::from([(MODE, [known(predicted.len() as f64); 2])]),
            uncertain: known(0.0),
        };
        intervals(
            &means,
            &[clear, Stratum { samples: 1, ..Stratum::default() }],
            [0.032, 0.013],
            false,
            Evaluations::default(),
        )
    }

    #[test]
    fn a_bad_prediction_makes_the_interval_wide_and_not_wrong() {
        // Predicted in every sample, true in three of ten.
        let found = found(true, (0..10_000).map(|i| (i % 10 < 3).then_some(true)));
        let mode = found.modes[&MODE];
        assert_eq!((found.wrong, mode.occurrence.lower, mode.occurrence.upper), ([7_000, 0], 1.0 - 0.7, 1.0 - 0.7));
        // Plain Monte Carlo: 1.96 sqrt(0.21 / 10000) = 0.0090.
        assert!(mode.half_width() > 0.0090 && mode.half_width() < 0.0145, "{mode:?}");
    }

    #[test]
    fn an_open_name_widens_the_occurrence() {
        let occurrence = found(true, (0..10_000).map(|i| Some(i % 100 != 0))).modes[&MODE].occurrence;
        assert_eq!((occurrence.lower, occurrence.upper), (0.99, 1.0));
    }

    #[test]
    fn what_is_open_is_no_error_of_the_estimator() {
        let found = found(false, (0..10_000).map(|i| (i % 100 == 0).then_some(false)));
        let mode = found.modes[&MODE];
        assert_eq!((mode.occurrence.lower, mode.occurrence.upper, mode.limits.lower), (0.0, 0.01, 0.0));
        assert!(found.half_width() < 0.005 && mode.limits.upper > 0.01, "{found:?}");
    }

    #[test]
    fn at_the_edge_the_half_width_is_the_distance_to_the_one_limit_left() {
        // Never unstable: the interval is as wide as its half width.
        let never = found(true, (0..1_000).map(|_| None)).modes[&MODE];
        assert_eq!((never.occurrence.lower, never.limits.lower), (0.0, 0.0));
        assert!(never.limits.upper > 0.003 && never.half_width() == never.limits.upper, "{never:?}");
        let always = found(true, (0..1_000).map(|_| Some(true))).modes[&MODE];
        assert_eq!((always.occurrence.lower, always.limits.upper), (1.0, 1.0));
        assert_eq!(always.half_width(), 1.0 - always.limits.lower);
    }

    #[test]
    fn few_uncertain_samples_weigh_little() {
        // One sample in a hundred is uncertain, and the prediction is wrong in a third of them.
        let predicted = BTreeMap::new();
        let reference = |wrong: bool| if wrong { BTreeMap::from([(MODE, true)]) } else { BTreeMap::new() };
        let (mut clear, mut uncertain) = (Stratum::default(), Stratum::default());
        (0..5_000).for_each(|_| clear.enter(&predicted, &reference(false)));
        (0..300).for_each(|i| uncertain.enter(&predicted, &reference(i % 3 == 0)));
        let means = PredictionMeans { modes: BTreeMap::new(), uncertain: known(0.01) };
        let found = intervals(&means, &[clear, uncertain], tails(INTERIM_LOOKS[0].0), true, Evaluations::default());
        let mode = found.modes[&MODE];
        assert_abs_diff_eq!(mode.occurrence.lower, 0.01 / 3.0, epsilon = 1e-15);
        assert!(mode.half_width() < 0.0018 && found.wrong == [0, 100], "{found:?}");
    }
}
