//! Occurrences from a guess that costs nothing, corrected by full solutions: a control variate with a proven interval.
//!
//! For the event Y that a mode is unstable and any guess G of it,
//!
//! ```text
//! P(Y) = P(G) + P(Y and not G) - P(G and not Y)
//! ```
//!
//! The first term is the mean of the guess over scrambled Sobol points, with Student's t of the scramblings. The other
//! two are counted over independent samples, solved in full, with the limits of Clopper and Pearson (Biometrika 26, 1934),
//! which hold for every n. Where guess and truth never differ in n samples their sum is below `-ln(tail) / n`: some
//! thousand solutions do what takes plain Monte Carlo a million.
//!
//! The guess says itself where it is doubtful. *Clear* and *doubtful* samples are strata, counted apart: what happens
//! in few of the doubtful ones weighs little, because there are few of them. A bad guess makes the interval wide, never
//! wrong.

use std::collections::{BTreeMap, BTreeSet};

use friction::Tangent;
use montecarlo::{Confidence, Study as _};

use super::draws::{FrictionPoints, tangent};
use super::stratum::Stratum;
use super::table::Names;
use super::{AccuracyError, Estimated, Occurrence, Table};
use crate::study::{Sample, Scratch, Study, unstable_names};

/// Shares of the error probability, 5 % in all, of the mean of the guess and of the probability of being doubtful.
const GUESS_TAIL: f64 = 0.005;
const SHARE_TAIL: f64 = 0.001;
/// The looks at the counts: the error probability that each may use, and its samples in those of the first.
const LOOKS: [(f64, f64); 3] = [(0.034, 1.0), (0.008, 2.5), (0.002, 4.0)];
/// Part of a look's probability for the clear samples.
const CLEAR: f64 = 0.85;
/// Part of the half width for which the doubtful samples are sized, the part of them in which the guess is then taken to
/// be wrong, and the deviate of their limits.
const FOR_DOUBTS: f64 = 0.2;
const WRONG: f64 = 0.15;
const DEVIATE: f64 = 2.6;
/// Samples solved together: many, so that those whose modes have to be followed fill the solver's lanes.
const BLOCK: usize = 512;
/// Fewest and most doubtful samples of the first look.
const DOUBTFUL_SAMPLES: (f64, f64) = (120.0, 8_000.0);
/// Least part of the half width for the clear samples.
const LEAST_CLEAR: f64 = 0.25;

/// Occurrences of one scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Controlled {
    /// By name, with the half width of the 95 % interval.
    pub modes: BTreeMap<u16, Estimated>,
    /// Upper limit of the occurrence of any mode that is not listed.
    pub unseen: f64,
    /// Samples solved in full.
    pub solved: u64,
    /// Those in which the guess was wrong about any mode: clear ones, doubtful ones.
    pub wrong: [u64; 2],
    /// Probability that the guess is doubtful.
    pub doubtful: f64,
}

impl Controlled {
    /// The largest half width, without what open names leave open: more samples do not close that.
    pub fn half_width(&self) -> f64 {
        let closed = |mode: &Estimated| mode.half_width - 0.5 * (mode.occurrence.upper - mode.occurrence.lower);
        self.modes.values().map(closed).fold(0.5 * self.unseen, f64::max)
    }
}

/// The occurrences of a scene to `half_width` at 95 %, or as near as the last look gets.
///
/// # Errors
/// A sample that cannot be solved.
pub fn controlled(
    study: &Study<'_>,
    scene: usize,
    points: &FrictionPoints,
    seed: u64,
    half_width: f64,
) -> Result<Controlled, AccuracyError> {
    let table = Table::new(study, scene, points)?;
    let guessed = Guessed::new(&table, points);
    let mut samples = Samples::new(study, scene, &table, seed);
    let first = guessed.sizes(half_width);
    let mut result = None;
    for (look, (tail, longer)) in LOOKS.into_iter().enumerate() {
        samples.solve(first.map(|size| (size as f64 * longer).ceil() as u64))?;
        let found = intervals(&guessed, &samples.strata, tail, look == 0);
        let is_narrow = found.half_width() <= half_width;
        result = Some(found);
        if is_narrow {
            break;
        }
    }
    result.ok_or(AccuracyError::NoConvergence { what: "an occurrence", left: 1.0, steps: 0 })
}

/// Means over Sobol points, each with the half width of its interval.
struct Guessed {
    /// Of the guess that a mode is surely and perhaps unstable, by name.
    modes: BTreeMap<u16, [(f64, f64); 2]>,
    /// Of the guess being doubtful.
    doubtful: (f64, f64),
}

impl Guessed {
    fn new(table: &Table, points: &FrictionPoints) -> Self {
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
        let mean = |place: usize, tail: f64| student(shares.iter().map(|run| run[place]), tail);
        let of = |bit: usize| [2 * bit, 2 * bit + 1].map(|place| mean(place, GUESS_TAIL));
        Self {
            modes: table.names().iter().enumerate().map(|(bit, &name)| (name, of(bit))).collect(),
            doubtful: mean(2 * count, SHARE_TAIL),
        }
    }

    /// Lower and upper limits of the probabilities of clear and of doubtful samples.
    fn shares(&self) -> [[f64; 2]; 2] {
        let (mean, error) = self.doubtful;
        let [least, most] = [(mean - error).max(0.0), (mean + error).min(1.0)];
        [[1.0 - most, 1.0 - least], [least, most]]
    }

    /// How many clear and doubtful samples will do if the guess is right in every clear one.
    fn sizes(&self, half_width: f64) -> [u64; 2] {
        let error = self.modes.values().flatten().map(|mean| mean.1).fold(0.0, f64::max);
        let [clear, doubtful] = self.shares().map(|share| share[1]);
        let (fewest, most) = DOUBTFUL_SAMPLES;
        let of_doubtful = (WRONG * (DEVIATE * doubtful / (FOR_DOUBTS * half_width)).powi(2)).clamp(fewest, most);
        let for_doubts = (DEVIATE * doubtful * (WRONG / of_doubtful).sqrt()).max(FOR_DOUBTS * half_width);
        let left = (half_width - error - for_doubts).max(LEAST_CLEAR * half_width);
        let of_clear = -(CLEAR * LOOKS[0].0).ln() * clear / left;
        [of_clear, of_doubtful].map(|size| size.ceil() as u64)
    }
}

/// Mean and half width by Student's t.
fn student(values: impl Iterator<Item = f64> + Clone, tail: f64) -> (f64, f64) {
    let count = values.clone().count();
    let mean = values.clone().sum::<f64>() / count as f64;
    let variance = values.map(|value| (value - mean).powi(2)).sum::<f64>() / (count as f64 - 1.0);
    let t = Confidence::new(1.0 - tail).map_or(f64::INFINITY, |level| level.t(count as u64 - 1));
    (mean, t * (variance / count as f64).sqrt())
}

/// The samples of a scene, drawn in the study's order and solved as many of each kind as are asked for.
struct Samples<'a> {
    study: &'a Study<'a>,
    scene: usize,
    table: &'a Table,
    seed: u64,
    next: u64,
    /// Drawn and not solved, with the guess.
    waiting: [Vec<(Sample, Names)>; 2],
    strata: [Stratum; 2],
    scratch: Scratch,
}

impl<'a> Samples<'a> {
    fn new(study: &'a Study<'a>, scene: usize, table: &'a Table, seed: u64) -> Self {
        let (waiting, strata) = Default::default();
        Self { study, scene, table, seed, next: 0, waiting, strata, scratch: Scratch::default() }
    }

    /// Until there are `sizes` clear and doubtful ones.
    fn solve(&mut self, sizes: [u64; 2]) -> Result<(), AccuracyError> {
        let (plan, key) = (self.study.plan(), self.study.plan().scenes[self.scene].key);
        for (kind, size) in sizes.into_iter().enumerate() {
            while self.strata[kind].samples < size {
                let wanted = ((size - self.strata[kind].samples) as usize).min(BLOCK);
                while self.waiting[kind].len() < wanted {
                    let sample = Sample::draw(&plan.case, &mut montecarlo::stream(self.seed, self.next));
                    let sample = sample.map_err(crate::Error::from)?;
                    self.next += 1;
                    let guess = self.table.guess(&tangent(plan, key, &sample)?);
                    let waiting = &mut self.waiting[usize::from(guess.is_doubtful)];
                    // One kind is rare: not all of the other are needed.
                    if waiting.len() < BLOCK {
                        waiting.push((sample, guess.unstable));
                    }
                }
                let block: Vec<_> = self.waiting[kind].drain(..wanted).collect();
                let samples: Vec<&Sample> = block.iter().map(|(sample, _)| sample).collect();
                let mut outcomes = Vec::with_capacity(BLOCK);
                self.study.evaluate_block(self.scene, &samples, &mut self.scratch, &mut outcomes);
                for (&(_, guess), outcome) in block.iter().zip(outcomes) {
                    self.strata[kind].enter(&self.table.named(guess), &unstable_names(&outcome?.unstable));
                }
            }
        }
        Ok(())
    }
}

fn intervals(guessed: &Guessed, strata: &[Stratum; 2], tail: f64, is_first: bool) -> Controlled {
    let shares = guessed.shares();
    let share = [1.0 - guessed.doubtful.0, guessed.doubtful.0];
    let tails = [CLEAR * tail, (1.0 - CLEAR) * tail];
    let differences = strata.iter().flat_map(|stratum| stratum.differences.keys());
    let names: BTreeSet<u16> = guessed.modes.keys().chain(differences).copied().collect();
    let estimate = |name: u16| {
        let [(mut lower, below), (mut upper, above)] = guessed.modes.get(&name).copied().unwrap_or_default();
        let (mut lowest, mut highest) = (lower - below, upper + above);
        for (kind, stratum) in strata.iter().enumerate() {
            let [down, up] = stratum.limits(name, tails[kind], is_first && kind == 0);
            // What is surely on the other side counts with the share that is sure.
            let weighted = |limit: f64| limit * shares[kind][usize::from(limit > 0.0)];
            lowest -= weighted(down);
            highest += weighted(up);
            let shift = stratum.shift(name);
            lower += share[kind] * shift[0];
            upper += share[kind] * shift[1];
        }
        let occurrence = Occurrence { lower: lower.clamp(0.0, 1.0), upper: upper.clamp(0.0, 1.0) };
        (name, Estimated { occurrence, half_width: 0.5 * (highest.min(1.0) - lowest.max(0.0)) })
    };
    let unseen = (0..2).map(|kind| shares[kind][1] * strata[kind].limits(0, tails[kind], is_first && kind == 0)[1]);
    Controlled {
        modes: names.into_iter().map(estimate).collect(),
        unseen: unseen.sum(),
        solved: strata.iter().map(|stratum| stratum.samples).sum(),
        wrong: [0, 1].map(|kind: usize| strata[kind].wrong),
        doubtful: guessed.doubtful.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    /// The intervals of a guess that is always `guess`, in one stratum.
    fn found(guess: bool, truths: impl Iterator<Item = Option<bool>>) -> Controlled {
        let guess = if guess { BTreeMap::from([(7, true)]) } else { BTreeMap::new() };
        let mut clear = Stratum::default();
        truths.for_each(|truth| clear.enter(&guess, &truth.map(|is_sure| (7, is_sure)).into_iter().collect()));
        let mean = (guess.len() as f64, 0.0);
        let guessed = Guessed { modes: BTreeMap::from([(7, [mean; 2])]), doubtful: (0.0, 0.0) };
        intervals(&guessed, &[clear, Stratum { samples: 1, ..Stratum::default() }], 0.045, false)
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
        let guessed = Guessed { modes: BTreeMap::new(), doubtful: (0.01, 0.0) };
        let found = intervals(&guessed, &[clear, doubtful], LOOKS[0].0, true);
        let mode = found.modes[&7];
        assert_abs_diff_eq!(mode.occurrence.lower, 0.01 / 3.0, epsilon = 1e-15);
        assert!(mode.half_width < 0.0018 && found.wrong == [0, 100], "{found:?}");
    }
}
