//! The probability of each mode, from the names that the study gives to those that grow in failing points of the lines.

use std::collections::BTreeSet;

use ::rare::{Probability, Witness};
use montecarlo::{Confidence, Experiment as _};
use rayon::prelude::*;
use study::{KeptSample, ModeLabel, Scratch, UncertainBrake};

use super::limit_state::SceneState;
use crate::Error;
use crate::kept::Question;

/// Number of samples evaluated together; chosen.
const AT_ONCE: usize = 32;

/// Probability that a mode squeals.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct ModeProbability {
    /// The mode.
    pub mode: ModeLabel,
    /// Probability that it grows. The upper end of the interval has what may be it, because its name is open.
    pub probability: Probability,
    /// Probability of points in which a mode grows that may be this one and has no sure name.
    pub open: f64,
}

/// Answers of the study at some points: the names that each unstable mode may have; none at a point that it finds stable.
pub(super) fn named<B: UncertainBrake>(
    state: &SceneState<'_, B>,
    points: &[&[f64]],
) -> Result<Vec<Vec<Vec<ModeLabel>>>, Error> {
    let scene = state.study.plan().scenes.iter().position(|scene| std::ptr::eq(scene, state.scene)).unwrap_or(0);
    let of_block = |points: &[&[f64]]| -> Result<Vec<Vec<Vec<ModeLabel>>>, Error> {
        let drawn: Vec<B::Sample> = points.iter().map(|point| state.sample(point)).collect();
        let samples: Vec<&B::Sample> = drawn.iter().collect();
        let mut outcomes = Vec::with_capacity(samples.len());
        state.study.evaluate_block(scene, &samples, &mut Scratch::default(), &mut outcomes);
        let names = |outcome| {
            let kept = KeptSample::new(0, &outcome);
            kept.map_or_else(Vec::new, |kept| kept.modes.into_iter().map(|mode| mode.names).collect())
        };
        outcomes.into_iter().map(|outcome| Ok(names(outcome?))).collect()
    };
    let of_block = |points: &[&[f64]]| state.kept.answers(Question::Names, points, of_block);
    let blocks = points.par_chunks(AT_ONCE).map(of_block).collect::<Result<Vec<_>, Error>>()?;
    Ok(blocks.into_iter().flatten().collect())
}

/// The probability of each mode that grows in a witness, from the names in each witness; `lines` are the lines of each design point.
pub(super) fn by_mode(
    witnesses: &[Witness],
    names: &[Vec<Vec<ModeLabel>>],
    unproven: f64,
    lines: usize,
) -> Vec<ModeProbability> {
    let modes: BTreeSet<ModeLabel> = names.iter().flatten().flatten().copied().collect();
    let of_mode = |mode: ModeLabel| {
        let is_sure = |names: &&Vec<ModeLabel>| names[..] == [mode];
        let may_be = |names: &Vec<ModeLabel>| names.contains(&mode) || names.is_empty();
        let sum = |holds: &dyn Fn(&[Vec<ModeLabel>]) -> bool| {
            let points = witnesses.iter().zip(names).filter(|(_, names)| holds(names)).map(|(witness, _)| witness);
            mean_and_error(points)
        };
        let sure = sum(&|names| names.iter().any(|names| is_sure(&names)));
        // A point that the study finds stable is next to an onset: whichever mode's it is.
        let open =
            sum(&|names| !names.iter().any(|names| is_sure(&names)) && (names.is_empty() || names.iter().any(may_be)));
        let interval = Probability::new(sure.value, sure.error, lines, unproven);
        let of_open = Probability::new(open.value, open.error, lines, 0.0).upper;
        let lower = interval.lower.min((lower_limit(&sure) - unproven).max(0.0));
        let probability = Probability { lower, upper: (interval.upper + of_open).min(1.0), ..interval };
        ModeProbability { mode, probability, open: open.value }
    };
    let mut all: Vec<ModeProbability> = modes.into_iter().map(of_mode).collect();
    all.sort_by(|a, b| b.probability.value.total_cmp(&a.probability.value));
    all
}

/// Sum over the design points of the mean over their lines, in which a line without a witness counts as 0.
#[derive(Debug, Clone, Copy)]
struct Mean {
    value: f64,
    /// Standard error.
    error: f64,
    /// Sum of the squares of what each witness adds to the mean.
    squares: f64,
}

fn mean_and_error<'a>(witnesses: impl Iterator<Item = &'a Witness>) -> Mean {
    // Sums of the weights and of their squares, and the number of lines, of each design point.
    let mut sums: Vec<[f64; 3]> = Vec::new();
    for Witness { design_point, lines, weight, .. } in witnesses {
        if sums.len() <= *design_point {
            sums.resize(design_point + 1, [0.0, 0.0, 2.0]);
        }
        let [sum, squares, count] = &mut sums[*design_point];
        (*sum, *squares, *count) = (*sum + weight, *squares + weight * weight, *lines as f64);
    }
    let (mut value, mut variance, mut of_witnesses) = (0.0, 0.0, 0.0);
    for [sum, squares, count] in sums {
        let mean = sum / count;
        value += mean;
        variance += ((squares / count - mean * mean) / (count - 1.0)).max(0.0);
        of_witnesses += squares / (count * count);
    }
    Mean { value, error: variance.sqrt(), squares: of_witnesses }
}

/// Lower 95 % limit of a mean of which few witnesses are all that is known: the limit of a sum of weights whose number has a Poisson distribution, with the
/// gamma distribution of Fay and Feuer (Statistics in Medicine 16, 1997, 791). With n = `value^2 / squares`, as many equal witnesses, it is `chi^2(2 n) / 2
/// n` of the value, here by the formula of Wilson and Hilferty, which is nowhere above it: 0.013 of the value for one witness, 0.11 for two.
fn lower_limit(&Mean { value, squares, .. }: &Mean) -> f64 {
    if value <= 0.0 {
        return 0.0;
    }
    let part = squares / (9.0 * value * value);
    value * (1.0 - part - Confidence::P95.z() * part.sqrt()).max(0.0).powi(3)
}

#[cfg(test)]
mod tests {
    use montecarlo::rand::RngExt;

    use super::*;

    /// Modes that squeal on one line in 100 to one in 10 of 48 lines, with weights that differ tenfold: the lower limit is above the truth in at most
    /// one of 40 repetitions, as 95 % intervals are; the limit of the logarithm alone is above the truth in more.
    #[test]
    fn a_mode_that_is_seen_on_a_line_or_two_has_a_low_lower_end() {
        let lines = 48;
        let mut worst_of_logarithm = 0.0_f64;
        for (at, part) in [0.01, 0.02, 0.05, 0.1].into_iter().enumerate() {
            let mut rng = montecarlo::stream(11, at as u64);
            let truth = part * 0.9 / 10.0_f64.ln();
            let (mut above, mut above_by_logarithm, repetitions) = (0, 0, 20_000);
            for _ in 0..repetitions {
                let hits = (0..lines).filter(|_| rng.random_bool(part)).count();
                let mut witness = || {
                    let weight = 10f64.powf(-rng.random_range(0.0..1.0));
                    Witness { point: Vec::new(), design_point: 0, lines, weight }
                };
                let witnesses: Vec<Witness> = (0..hits).map(|_| witness()).collect();
                let names = vec![vec![vec![ModeLabel::of_rank(1)]]; hits];
                let of_mode = by_mode(&witnesses, &names, 0.0, lines);
                above += u32::from(of_mode.iter().any(|mode| mode.probability.lower > truth));
                let mean = mean_and_error(witnesses.iter());
                above_by_logarithm += u32::from(Probability::new(mean.value, mean.error, lines, 0.0).lower > truth);
            }
            let [share, of_logarithm] =
                [above, above_by_logarithm].map(|count| f64::from(count) / f64::from(repetitions));
            assert!(share < 0.025, "{part}: {share}");
            worst_of_logarithm = worst_of_logarithm.max(of_logarithm);
        }
        assert!(worst_of_logarithm > 0.03, "{worst_of_logarithm}");
    }
}
