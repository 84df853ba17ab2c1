//! The interval of an occurrence from the mean of a guess and from the counts of what it gets wrong.

use std::collections::{BTreeMap, BTreeSet};

use friction::Tangent;
use montecarlo::{Confidence, ReplicateMean};

use super::draws::FrictionPoints;
use super::stratum::Stratum;
use super::{Controlled, Estimated, Occurrence, Table};

/// Error probability, of 5 % in all, of the probability of being doubtful.
pub(super) const SHARE_TAIL: f64 = 0.001;

/// Means over Sobol points, each with its standard error.
pub(super) struct Guessed {
    /// Of the guess that a mode is surely and perhaps unstable, by name.
    pub modes: BTreeMap<u16, [(f64, f64); 2]>,
    /// Of the guess being doubtful.
    pub doubtful: (f64, f64),
    /// Number of scramblings, whose scatter these errors are.
    pub scramblings: u64,
}

impl Guessed {
    pub fn new(table: &Table, points: &FrictionPoints) -> Self {
        let count = table.names().len();
        let shares = |run: &Vec<Tangent>| {
            let mut hits = vec![0_u32; 2 * count + 1];
            for tangent in run {
                let guess = table.guess(tangent);
                for bit in 0..count {
                    hits[2 * bit] += (guess.unstable.sure >> bit & 1) as u32;
                    hits[2 * bit + 1] += (guess.unstable.perhaps >> bit & 1) as u32;
                }
                hits[2 * count] += u32::from(guess.is_doubtful);
            }
            hits.into_iter().map(|hits| f64::from(hits) / run.len() as f64).collect::<Vec<_>>()
        };
        let shares: Vec<Vec<f64>> = points.scramblings.iter().map(shares).collect();
        let mean = |place: usize| mean(shares.iter().map(|run| run[place]));
        let of = |bit: usize| [2 * bit, 2 * bit + 1].map(mean);
        Self {
            modes: table.names().iter().enumerate().map(|(bit, &name)| (name, of(bit))).collect(),
            doubtful: mean(2 * count),
            scramblings: shares.len() as u64,
        }
    }

    /// Student's t at an error probability.
    pub fn t(&self, tail: f64) -> f64 {
        Confidence::new(1.0 - tail).map_or(f64::INFINITY, |level| level.t(self.scramblings - 1))
    }

    /// Half the width of the interval of the probability of a doubtful guess.
    fn share_error(&self) -> f64 {
        self.t(SHARE_TAIL) * self.doubtful.1
    }

    /// Upper limits of the probabilities of a clear and of a doubtful guess.
    pub fn shares(&self) -> [f64; 2] {
        let (mean, error) = (self.doubtful.0, self.share_error());
        [1.0 - mean + error, mean + error].map(|limit| limit.min(1.0))
    }
}

/// Mean over the scramblings and its standard error; of a single one the error is not known.
fn mean(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    ReplicateMean::of(values).map_or((f64::NAN, f64::INFINITY), |mean| (mean.mean, mean.standard_error))
}

/// The occurrences, with the error probabilities of the clear samples and of Student's t. In the first look one limit of
/// how often guess and truth differ in clear samples will do.
pub(super) fn intervals(guessed: &Guessed, strata: &[Stratum; 2], tails: [f64; 2], is_first: bool) -> Controlled {
    let [clear, doubtful] = strata;
    let (share, most) = (guessed.doubtful.0, guessed.shares());
    let t = guessed.t(tails[1]);
    let names: BTreeSet<u16> =
        guessed.modes.keys().chain(strata.iter().flat_map(|stratum| stratum.differences.keys())).copied().collect();
    // Half the width by Student's t of one end of an occurrence: the guess and the doubtful samples.
    let by_student = |name: u16, guess: f64, shift: f64| {
        let variance = (most[1] * doubtful.deviation(name)).powi(2) + guess.powi(2);
        t * variance.sqrt() + shift.abs() * guessed.share_error()
    };
    // What is surely on the other side counts with the share that is sure.
    let weighted = |limit: f64| limit * if limit > 0.0 { most[0] } else { 1.0 - most[1] };
    let limits = |name: u16| clear.limits(name, tails[0], is_first).map(weighted);
    let estimate = |name: u16| {
        let [lower, upper] = guessed.modes.get(&name).copied().unwrap_or_default();
        let [down, up] = limits(name);
        let (in_clear, in_doubtful) = (clear.shift(name), doubtful.shift(name));
        let centre = |end: usize, mean: f64| mean + share * in_doubtful[end];
        let (least, greatest) = (centre(0, lower.0), centre(1, upper.0));
        let lowest = least - by_student(name, lower.1, in_doubtful[0]) - down;
        let highest = greatest + by_student(name, upper.1, in_doubtful[1]) + up;
        let [lower, upper] = [least + (1.0 - share) * in_clear[0], greatest + (1.0 - share) * in_clear[1]]
            .map(|end| end.clamp(0.0, 1.0));
        let half_width = 0.5 * (highest.min(1.0) - lowest.max(0.0));
        (name, Estimated { occurrence: Occurrence { lower, upper }, half_width })
    };
    Controlled {
        modes: names.into_iter().map(estimate).collect(),
        unseen: limits(0)[1] + by_student(0, 0.0, 0.0),
        solved: clear.samples + doubtful.samples,
        wrong: [clear.wrong, doubtful.wrong],
        doubtful: share,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::control::FIRST_TAILS;
    use approx::assert_abs_diff_eq;

    /// The intervals of a guess that is always `guess`, in one stratum.
    fn found(guess: bool, truths: impl Iterator<Item = Option<bool>>) -> Controlled {
        let guess = if guess { BTreeMap::from([(7, true)]) } else { BTreeMap::new() };
        let mut clear = Stratum::default();
        truths.for_each(|truth| clear.enter(&guess, &truth.map(|is_sure| (7, is_sure)).into_iter().collect()));
        let mean = (guess.len() as f64, 0.0);
        let guessed = Guessed { modes: BTreeMap::from([(7, [mean; 2])]), doubtful: (0.0, 0.0), scramblings: 32 };
        intervals(&guessed, &[clear, Stratum { samples: 1, ..Stratum::default() }], [0.032, 0.013], false)
    }

    #[test]
    fn a_bad_guess_makes_the_interval_wide_and_not_wrong() {
        // Guessed in every sample, true in three of ten.
        let found = found(true, (0..10_000).map(|i| (i % 10 < 3).then_some(true)));
        let mode = found.modes[&7];
        assert_eq!((found.wrong, mode.occurrence.lower, mode.occurrence.upper), ([7_000, 0], 1.0 - 0.7, 1.0 - 0.7));
        // Plain Monte Carlo: 1.96 sqrt(0.21 / 10000) = 0.0090.
        assert!(mode.half_width > 0.0090 && mode.half_width < 0.014, "{}", mode.half_width);
    }

    #[test]
    fn an_open_name_widens_the_occurrence() {
        let occurrence = found(true, (0..10_000).map(|i| Some(i % 100 != 0))).modes[&7].occurrence;
        assert_eq!((occurrence.lower, occurrence.upper), (0.99, 1.0));
    }

    #[test]
    fn what_is_open_is_no_error_of_the_estimator() {
        let found = found(false, (0..10_000).map(|i| (i % 100 == 0).then_some(false)));
        let mode = found.modes[&7];
        assert_eq!((mode.occurrence.lower, mode.occurrence.upper), (0.0, 0.01));
        assert!(found.half_width() < mode.half_width - 0.0049, "{found:?}");
    }

    #[test]
    fn few_doubtful_samples_weigh_little() {
        // One sample in a hundred is doubtful, and the guess is wrong in a third of them.
        let guess = BTreeMap::new();
        let truth = |wrong: bool| if wrong { BTreeMap::from([(7, true)]) } else { BTreeMap::new() };
        let (mut clear, mut doubtful) = (Stratum::default(), Stratum::default());
        (0..5_000).for_each(|_| clear.enter(&guess, &truth(false)));
        (0..300).for_each(|i| doubtful.enter(&guess, &truth(i % 3 == 0)));
        let guessed = Guessed { modes: BTreeMap::new(), doubtful: (0.01, 0.0), scramblings: 32 };
        let found = intervals(&guessed, &[clear, doubtful], FIRST_TAILS, true);
        let mode = found.modes[&7];
        assert_abs_diff_eq!(mode.occurrence.lower, 0.01 / 3.0, epsilon = 1e-15);
        assert!(mode.half_width < 0.0018 && found.wrong == [0, 100], "{found:?}");
    }

    /// How often the intervals of an occurrence miss it, and their mean half width. The guess is wrong in a part `wrong` of
    /// the doubtful samples, and in a part `slip` of the clear ones; without such, these are as good as all known.
    fn missed(wrong: f64, slip: f64, runs: u32) -> (u32, f64) {
        use rand::{RngExt, SeedableRng};

        let (guess, doubtful) = (0.3, 0.02);
        let truth = guess + (1.0 - 2.0 * guess) * (doubtful * wrong + (1.0 - doubtful) * slip);
        let mut rng = rand::rngs::SmallRng::seed_from_u64(1);
        let (mut missed, mut width) = (0, 0.0);
        for _ in 0..runs {
            let mut share = |p: f64| {
                let one = |_| (0..500).filter(|_| rng.random_bool(p)).count() as f64 / 500.0;
                mean((0..32).map(one).collect::<Vec<_>>().into_iter())
            };
            let (modes, doubtful) = (BTreeMap::from([(7, [share(guess); 2])]), share(doubtful));
            let guessed = Guessed { modes, doubtful, scramblings: 32 };
            let named = |is_unstable: bool| is_unstable.then_some((7, true)).into_iter().collect();
            let mut stratum = |count: usize, wrong: f64| {
                let mut stratum = Stratum::default();
                for _ in 0..count {
                    let guess = rng.random_bool(guess);
                    stratum.enter(&named(guess), &named(guess != rng.random_bool(wrong)));
                }
                stratum
            };
            let known = Stratum { samples: 1_000_000, ..Stratum::default() };
            let strata = [if slip > 0.0 { stratum(2_000, slip) } else { known }, stratum(200, wrong)];
            let found = intervals(&guessed, &strata, FIRST_TAILS, true).modes[&7];
            let centre = 0.5 * (found.occurrence.lower + found.occurrence.upper);
            missed += u32::from((centre - truth).abs() > found.half_width);
            width += found.half_width / f64::from(runs);
        }
        (missed, width)
    }

    #[test]
    fn intervals_hold_as_often_as_they_say() {
        let (seldom, width) = missed(0.12, 2e-4, 200);
        assert!(seldom <= 8 && width < 0.014, "{seldom} {width}");
        // By Student's t alone: 0.9 % and hardly more.
        for wrong in [0.0, 0.03, 0.12, 0.5] {
            let (seldom, width) = missed(wrong, 0.0, 500);
            assert!(seldom <= 11 && width < 0.012, "{wrong}: {seldom} {width}");
        }
    }
}
