//! Occurrences from a guess that costs nothing, corrected by full solutions: a control variate with an interval.
//!
//! For the event Y that a mode is unstable and any guess G of it,
//!
//! ```text
//! P(Y) = P(G) + P(Y and not G) - P(G and not Y)
//! ```
//!
//! The first term is the mean of the guess over scrambled Sobol points; the other two are counted over independent samples,
//! solved in full. The guess says itself where it is doubtful. *Clear* and *doubtful* samples are strata, counted apart: what
//! happens in few of the doubtful ones weighs little, because there are few of them.
//!
//! In clear samples guess and truth hardly ever differ: there the limits of Clopper and Pearson (Biometrika 26, 1934) hold
//! for every n, and where they never differ in n samples their sum is below `-ln(tail) / n`. The mean of the guess and the
//! many differences in doubtful samples are sums of much that is small and independent; they share one interval by Student's
//! t. Some thousand solutions do what takes plain Monte Carlo a million. A bad guess makes the interval wide, never wrong.

use std::collections::BTreeMap;

use montecarlo::Experiment as _;

use super::draws::{FrictionPoints, tangent};
use super::interval::{Guessed, intervals};
use super::stratum::Stratum;
use super::table::Names;
use super::{AccuracyError, Estimated, Table};
use crate::study::{Sample, Scratch, Study, unstable_names};

/// The looks at the counts: the error probability that each may use, and its samples in those of the first.
const LOOKS: [(f64, f64); 4] = [(0.030, 1.0), (0.013, 1.7), (0.004, 3.0), (0.002, 6.0)];
/// Part of a look's probability for the clear samples; Student's t has the rest.
const CLEAR: f64 = 0.7;
#[cfg(test)]
pub(super) const FIRST_TAILS: [f64; 2] = tails(LOOKS[0].0);
/// Part of the half width for which the first look is sized.
const AIM: f64 = 0.95;
/// Parts of that for Student's t, of which the cheapest is taken, and the price of a doubtful sample in clear ones.
const BY_STUDENT: [f64; 7] = [0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.85];
const PRICE: f64 = 2.0;
/// Part of all samples, and of the doubtful ones, in which the guess about a mode is taken to be wrong beforehand.
const WRONG: [f64; 2] = [3e-4, 0.05];
/// Samples that tell it better where many are doubtful. They count for nothing else.
const PILOT: u64 = 400;
/// Standard error that tables are made for, as a part of the half width.
const FOR_DOUBTS: f64 = 0.13;
/// Fewest doubtful samples.
const FEWEST_DOUBTFUL: f64 = 120.0;
/// Samples solved together: many, so that those whose modes have to be followed fill the solver's lanes.
const BLOCK: usize = 2048;
/// Draws for a block after which it stays as small as it is: some tables leave hardly any doubt.
const MOST_DRAWS: usize = 4_000_000;

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
    let for_doubts = (FOR_DOUBTS * half_width).powi(2);
    let table = Table::new(study, scene, points, |share| variance(share, wrong(share)) / for_doubts)?;
    let guessed = Guessed::new(&table, points);
    let mut samples = Samples::new(study, scene, &table, seed);
    let mut first = sizes(&guessed, wrong(guessed.doubtful.0), half_width);
    if first[1] > 2 * PILOT {
        let mut pilot = Stratum::default();
        samples.solve(1, PILOT, &mut pilot)?;
        first = sizes(&guessed, pilot.most_wrong(), half_width);
    }
    let mut strata = <[Stratum; 2]>::default();
    let mut result = None;
    for (look, (tail, longer)) in LOOKS.into_iter().enumerate() {
        for (kind, (size, stratum)) in first.into_iter().zip(&mut strata).enumerate() {
            samples.solve(kind, (size as f64 * longer).ceil() as u64, stratum)?;
        }
        let found = intervals(&guessed, &strata, tails(tail), look == 0);
        let is_narrow = found.half_width() <= half_width;
        result = Some(found);
        if is_narrow {
            break;
        }
    }
    result.ok_or(AccuracyError::NoConvergence { what: "an occurrence", left: 1.0, steps: 0 })
}

/// A look's error probabilities of the clear samples and of Student's t.
const fn tails(tail: f64) -> [f64; 2] {
    [CLEAR * tail, (1.0 - CLEAR) * tail]
}

/// In which part of the doubtful samples, `share` of all, the guess is taken to be wrong.
fn wrong(share: f64) -> f64 {
    (WRONG[0] / share + WRONG[1]).min(0.5)
}

/// The variance of an occurrence by one doubtful sample, `share` of all.
fn variance(share: f64, wrong: f64) -> f64 {
    share * share * wrong
}

/// How many clear and doubtful samples will do if the guess is right in every clear one and `wrong` in a part of the others.
fn sizes(guessed: &Guessed, wrong: f64, half_width: f64) -> [u64; 2] {
    let [clear, doubtful] = guessed.shares();
    let [tail, of_student] = tails(LOOKS[0].0);
    let (t, width) = (guessed.t(of_student), AIM * half_width);
    let of_guess = guessed.modes.values().flatten().map(|mean| mean.1).fold(0.0, f64::max).powi(2);
    let with = |part: f64| {
        // What the guess alone takes more of cannot be helped.
        let left = ((part * width / t).powi(2) - of_guess).max(0.1 * of_guess);
        let of_doubtful = (variance(doubtful, wrong) / left).max(FEWEST_DOUBTFUL);
        let by_student = t * (of_guess + variance(doubtful, wrong) / of_doubtful).sqrt();
        let of_clear = -tail.ln() * clear / (width - by_student).max(0.1 * width);
        [of_clear, of_doubtful]
    };
    let price = |sizes: &[f64; 2]| sizes[0] + PRICE * sizes[1];
    let cheapest = BY_STUDENT.map(with).into_iter().min_by(|a, b| price(a).total_cmp(&price(b)));
    cheapest.unwrap_or_default().map(|size| size.ceil() as u64)
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
    scratch: Scratch,
}

impl<'a> Samples<'a> {
    fn new(study: &'a Study<'a>, scene: usize, table: &'a Table, seed: u64) -> Self {
        Self { study, scene, table, seed, next: 0, waiting: Default::default(), scratch: Scratch::default() }
    }

    /// Solves clear (0) or doubtful (1) samples until a stratum has so many, or as many as are found.
    fn solve(&mut self, kind: usize, size: u64, stratum: &mut Stratum) -> Result<(), AccuracyError> {
        while stratum.samples < size {
            self.draw(kind, (size - stratum.samples).min(BLOCK as u64) as usize)?;
            let wanted = self.waiting[kind].len().min((size - stratum.samples) as usize);
            if wanted == 0 {
                break;
            }
            let block: Vec<_> = self.waiting[kind].drain(..wanted).collect();
            let samples: Vec<&Sample> = block.iter().map(|(sample, _)| sample).collect();
            let mut outcomes = Vec::with_capacity(BLOCK);
            self.study.evaluate_block(self.scene, &samples, &mut self.scratch, &mut outcomes);
            for (&(_, guess), outcome) in block.iter().zip(outcomes) {
                stratum.enter(&self.table.named(guess), &unstable_names(&outcome?.unstable));
            }
        }
        Ok(())
    }

    /// Draws samples until so many of a kind wait.
    fn draw(&mut self, kind: usize, wanted: usize) -> Result<(), AccuracyError> {
        let (plan, key) = (self.study.plan(), self.study.plan().scenes[self.scene].key);
        for _ in 0..MOST_DRAWS {
            if self.waiting[kind].len() >= wanted {
                break;
            }
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
        Ok(())
    }
}
