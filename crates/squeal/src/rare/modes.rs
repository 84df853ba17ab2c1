//! The probability of each mode, from the names that the study gives to those that grow in failing points of the lines.

use std::collections::BTreeSet;

use ::rare::{Probability, Witness};
use montecarlo::Experiment as _;
use rayon::prelude::*;
use study::{KeptSample, ModeLabel, Scratch, UncertainBrake};

use super::limit_state::SceneState;
use crate::Error;

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

/// What the study says of some points: the names that each unstable mode may have; nothing of a point that it finds stable.
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
    let blocks = points.par_chunks(AT_ONCE).map(of_block).collect::<Result<Vec<_>, Error>>()?;
    Ok(blocks.into_iter().flatten().collect())
}

/// The probability of each mode that grows in some witness, from the names in each; `lines` are those of each design point.
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
        let interval = Probability::new(sure.0, sure.1, lines, unproven);
        let of_open = Probability::new(open.0, open.1, lines, 0.0).upper;
        let probability = Probability { upper: (interval.upper + of_open).min(1.0), ..interval };
        ModeProbability { mode, probability, open: open.0 }
    };
    let mut all: Vec<ModeProbability> = modes.into_iter().map(of_mode).collect();
    all.sort_by(|a, b| b.probability.value.total_cmp(&a.probability.value));
    all
}

/// The mean over the lines of some witnesses, all other lines with 0, and its standard error.
fn mean_and_error<'a>(witnesses: impl Iterator<Item = &'a Witness>) -> (f64, f64) {
    // Sums of the weights and of their squares, and the number of lines, of each design point.
    let mut sums: Vec<[f64; 3]> = Vec::new();
    for Witness { design_point, lines, weight, .. } in witnesses {
        if sums.len() <= *design_point {
            sums.resize(design_point + 1, [0.0, 0.0, 2.0]);
        }
        let [sum, squares, count] = &mut sums[*design_point];
        (*sum, *squares, *count) = (*sum + weight, *squares + weight * weight, *lines as f64);
    }
    let moments = sums.iter().map(|[sum, squares, count]| {
        let mean = sum / count;
        (mean, ((squares / count - mean * mean) / (count - 1.0)).max(0.0))
    });
    let (mean, variance) = moments.fold((0.0, 0.0), |all, (mean, variance)| (all.0 + mean, all.1 + variance));
    (mean, variance.sqrt())
}
