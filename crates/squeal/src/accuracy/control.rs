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
//! which hold for every n. Where guess and truth never differ in n samples each is below `-ln(tail) / n`: some thousand
//! solutions do what takes plain Monte Carlo a million. A bad guess makes the interval wide, never wrong.

use std::collections::{BTreeMap, BTreeSet};

use friction::Tangent;
use montecarlo::{Confidence, Study as _};
use statrs::function::beta::beta_reg;

use super::draws::{FrictionPoints, tangent};
use super::sampling::BLOCK;
use super::{AccuracyError, Estimated, Occurrence, Surface};
use crate::study::{Sample, Scratch, Study, unstable_names};

/// Share of the error probability, 5 % in all, that the mean of the guess may use.
const GUESS_TAIL: f64 = 0.005;
/// Numbers of samples after which the intervals are looked at, and the error probability each look may use.
const LOOKS: [(u64, f64); 4] = [(5_000, 0.04), (10_000, 0.002), (20_000, 0.0015), (40_000, 0.0015)];
/// Part of a look's probability that the upper limits use; the lower ones help where guess and truth often differ.
const UPPER: f64 = 0.9;

/// Occurrences of one scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Controlled {
    /// By name, with the half width of the 95 % interval.
    pub modes: BTreeMap<u16, Estimated>,
    /// Upper limit of the occurrence of any mode that is not listed.
    pub unseen: f64,
    /// Samples solved in full.
    pub solved: u64,
    /// Those in which the guess was wrong about any mode.
    pub wrong: u64,
}

impl Controlled {
    /// The largest half width.
    pub fn half_width(&self) -> f64 {
        self.modes.values().map(|mode| mode.half_width).fold(0.5 * self.unseen, f64::max)
    }
}

/// How guess and truth of a mode differed.
#[derive(Debug, Clone, Copy, Default)]
struct Differences {
    /// Guessed unstable: not surely unstable, and surely not.
    not_sure: u64,
    absent: u64,
    /// Guessed stable: surely unstable, and perhaps or surely so.
    sure: u64,
    present: u64,
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
    let surface = Surface::new(study, scene, points)?;
    let guessed = guess(&surface, points);
    let mut counts = Counts { differences: BTreeMap::new(), wrong: 0, scratch: Scratch::default() };
    let mut solved = 0;
    let mut result = None;
    for (samples, tail) in LOOKS {
        counts.compare(study, scene, &surface, seed, solved..samples)?;
        solved = samples;
        let found = intervals(&guessed, &counts, samples, tail);
        let is_narrow = found.half_width() <= half_width;
        result = Some(found);
        if is_narrow {
            break;
        }
    }
    result.ok_or(AccuracyError::NoConvergence { what: "an occurrence", left: 1.0, steps: 0 })
}

/// Mean of the guess and half width of its interval, by name.
fn guess(surface: &Surface, points: &FrictionPoints) -> BTreeMap<u16, (f64, f64)> {
    let runs = points.scramblings.len() as f64;
    let t =
        Confidence::new(1.0 - GUESS_TAIL).map_or(f64::INFINITY, |level| level.t(points.scramblings.len() as u64 - 1));
    let of = |(place, &name): (usize, &u16)| {
        let share = |run: &Vec<Tangent>| {
            run.iter().filter(|point| surface.is_unstable(place, point)).count() as f64 / run.len() as f64
        };
        let shares: Vec<f64> = points.scramblings.iter().map(share).collect();
        let mean = shares.iter().sum::<f64>() / runs;
        let variance = shares.iter().map(|share| (share - mean).powi(2)).sum::<f64>() / (runs - 1.0);
        (name, (mean, t * (variance / runs).sqrt()))
    };
    surface.names().iter().enumerate().map(of).collect()
}

struct Counts {
    differences: BTreeMap<u16, Differences>,
    wrong: u64,
    scratch: Scratch,
}

impl Counts {
    fn compare(
        &mut self,
        study: &Study<'_>,
        scene: usize,
        surface: &Surface,
        seed: u64,
        samples: std::ops::Range<u64>,
    ) -> Result<(), AccuracyError> {
        let (plan, key) = (study.plan(), study.plan().scenes[scene].key);
        let indices: Vec<u64> = samples.collect();
        let mut outcomes = Vec::with_capacity(BLOCK);
        for block in indices.chunks(BLOCK) {
            let draw = |&i: &u64| Ok(Sample::draw(&plan.case, &mut montecarlo::stream(seed, i))?);
            let samples: Vec<Sample> = block.iter().map(draw).collect::<Result<_, crate::Error>>()?;
            study.evaluate_block(scene, &samples.iter().collect::<Vec<_>>(), &mut self.scratch, &mut outcomes);
            for (sample, outcome) in samples.iter().zip(outcomes.drain(..)) {
                let point = tangent(plan, key, sample)?;
                let is_guessed = |(place, _): &(usize, &u16)| surface.is_unstable(*place, &point);
                let guess = surface.names().iter().enumerate().filter(is_guessed).map(|(_, &name)| name).collect();
                self.enter(&guess, &unstable_names(&outcome?.unstable));
            }
        }
        Ok(())
    }

    fn enter(&mut self, guess: &BTreeSet<u16>, truth: &BTreeMap<u16, bool>) {
        let mut is_wrong = false;
        for name in guess.iter().filter(|name| truth.get(name) != Some(&true)) {
            let difference = self.differences.entry(*name).or_default();
            difference.not_sure += 1;
            difference.absent += u64::from(!truth.contains_key(name));
            is_wrong = true;
        }
        for (name, &is_sure) in truth.iter().filter(|(name, _)| !guess.contains(name)) {
            let difference = self.differences.entry(*name).or_default();
            difference.present += 1;
            difference.sure += u64::from(is_sure);
            is_wrong = true;
        }
        self.wrong += u64::from(is_wrong);
    }
}

fn intervals(guessed: &BTreeMap<u16, (f64, f64)>, counts: &Counts, samples: u64, tail: f64) -> Controlled {
    // Two upper and two lower limits make an interval.
    let at_most = |hits: u64| upper_limit(hits, samples, 0.5 * UPPER * tail);
    let at_least = |hits: u64| lower_limit(hits, samples, 0.5 * (1.0 - UPPER) * tail);
    let share = |hits: u64| hits as f64 / samples as f64;
    let names: BTreeSet<u16> = guessed.keys().chain(counts.differences.keys()).copied().collect();
    let estimate = |name: u16| {
        let (mean, error) = guessed.get(&name).copied().unwrap_or_default();
        let d = counts.differences.get(&name).copied().unwrap_or_default();
        let lowest = mean - error - at_most(d.not_sure) + at_least(d.sure);
        let highest = mean + error + at_most(d.present) - at_least(d.absent);
        let lower = mean + share(d.sure) - share(d.not_sure);
        let upper = mean + share(d.present) - share(d.absent);
        let occurrence = Occurrence { lower: lower.clamp(0.0, 1.0), upper: upper.clamp(0.0, 1.0) };
        (name, Estimated { occurrence, half_width: 0.5 * (highest.min(1.0) - lowest.max(0.0)) })
    };
    Controlled {
        modes: names.into_iter().map(estimate).collect(),
        unseen: at_most(0),
        solved: samples,
        wrong: counts.wrong,
    }
}

/// The probability at which at most `hits` in `trials` has the probability `tail`.
fn upper_limit(hits: u64, trials: u64, tail: f64) -> f64 {
    if hits >= trials {
        return 1.0;
    }
    let (mut low, mut high) = (hits as f64 / trials as f64, 1.0);
    while high - low > 1e-9 * high {
        let middle = 0.5 * (low + high);
        // P(more than `hits`).
        if beta_reg(hits as f64 + 1.0, (trials - hits) as f64, middle) < 1.0 - tail {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

fn lower_limit(hits: u64, trials: u64, tail: f64) -> f64 {
    if hits == 0 { 0.0 } else { 1.0 - upper_limit(trials - hits, trials, tail) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn limits_are_those_of_clopper_and_pearson() {
        // R. G. Newcombe, Stat. Med. 17 (1998) 857, table I, method 5.
        for (hits, trials, lower, upper) in
            [(81, 263, 0.2527, 0.3676), (15, 148, 0.0578, 0.1617), (0, 20, 0.0, 0.1684), (1, 29, 0.0009, 0.1776)]
        {
            assert_abs_diff_eq!(lower_limit(hits, trials, 0.025), lower, epsilon = 5e-5);
            assert_abs_diff_eq!(upper_limit(hits, trials, 0.025), upper, epsilon = 5e-5);
        }
        assert_abs_diff_eq!(upper_limit(0, 5_000, 0.02), 1.0 - 0.02_f64.powf(1.0 / 5_000.0), epsilon = 1e-10);
        assert_eq!(upper_limit(7, 7, 0.02), 1.0);
    }

    #[test]
    fn a_bad_guess_makes_the_interval_wide_and_not_wrong() {
        // Guessed in every sample, true in three of ten.
        let mut counts = Counts { differences: BTreeMap::new(), wrong: 0, scratch: Scratch::default() };
        for i in 0..10_000 {
            let truth = if i % 10 < 3 { BTreeMap::from([(7, true)]) } else { BTreeMap::new() };
            counts.enter(&BTreeSet::from([7]), &truth);
        }
        let found = intervals(&BTreeMap::from([(7, (1.0, 0.0))]), &counts, 10_000, 0.045);
        let mode = found.modes[&7];
        assert_eq!((found.wrong, mode.occurrence.lower, mode.occurrence.upper), (7_000, 1.0 - 0.7, 1.0 - 0.7));
        // Plain Monte Carlo: 1.96 sqrt(0.21 / 10000) = 0.0090.
        assert!(mode.half_width > 0.0090 && mode.half_width < 0.014, "{}", mode.half_width);
    }

    #[test]
    fn an_open_name_widens_the_occurrence() {
        let mut counts = Counts { differences: BTreeMap::new(), wrong: 0, scratch: Scratch::default() };
        for i in 0..10_000 {
            counts.enter(&BTreeSet::from([7]), &BTreeMap::from([(7, i % 100 != 0)]));
        }
        let occurrence = intervals(&BTreeMap::from([(7, (1.0, 0.0))]), &counts, 10_000, 0.045).modes[&7].occurrence;
        assert_eq!((occurrence.lower, occurrence.upper), (0.99, 1.0));
    }

    #[test]
    fn the_limits_keep_their_promise_for_any_probability() {
        // P(upper limit < p) summed over all numbers of hits that have too small a limit.
        let n = 50_u64;
        for p in [0.01, 0.1, 0.37, 0.8] {
            let mut term = (1.0_f64 - p).powi(50);
            let (mut above, mut below) = (0.0, 0.0);
            for k in 0..=n {
                above += if upper_limit(k, n, 0.02) < p { term } else { 0.0 };
                below += if lower_limit(k, n, 0.02) > p { term } else { 0.0 };
                term *= (n - k) as f64 / (k + 1) as f64 * p / (1.0 - p);
            }
            assert!(above <= 0.02 && below <= 0.02, "{p}: {above} {below}");
        }
    }
}
