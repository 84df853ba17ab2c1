//! Modes of the paper's case: which is the most robust, how each is called, its shape and its net work.

use num_complex::Complex;

use super::super::results::{Estimate, Results};
use super::scenes::{full_contact, law_of};
use crate::Error;
use crate::case::Paper;
use crate::study::{ModeLabel, ModeNaming, Reference, Scene};

/// Modes under a constraint set by the smallest median occurrence over all panels, largest first.
pub(in super::super) fn most_robust(
    results: &Results<'_>,
    constraints: usize,
) -> Result<Vec<(ModeLabel, Estimate)>, Error> {
    let panels: Vec<_> = results.panels().iter().filter(|p| p.key.constraints == constraints).collect();
    let of_panel: Vec<_> = panels.iter().map(|panel| results.occurrences(panel)).collect();
    let mut names: Vec<ModeLabel> = of_panel.iter().flat_map(|modes| modes.keys().copied()).collect();
    names.sort_unstable();
    names.dedup();
    let mut robust = Vec::new();
    for name in names {
        let mut least = Estimate { value: f64::INFINITY, lower: f64::INFINITY, upper: f64::INFINITY };
        for modes in &of_panel {
            let median = match modes.get(&name) {
                Some(occurrences) => results.median(occurrences)?,
                None => Estimate { value: 0.0, lower: 0.0, upper: 0.0 },
            };
            if median.value < least.value {
                least = median;
            }
        }
        robust.push((name, least));
    }
    robust.sort_by(|a, b| b.1.value.total_cmp(&a.1.value));
    Ok(robust)
}

/// A mode's name with its place among all 2 n eigenvalues, as the paper may count.
pub(in super::super) fn title(results: &Results<'_>, name: ModeLabel) -> String {
    let (first, second) = cea::pair_numbers(results.rank_of(name));
    match results.labels {
        ModeNaming::Tracked => format!("tracked mode {name} ({first}/{second} of all eigenvalues)"),
        ModeNaming::Rank => format!("rank {name} ({first}/{second} of all eigenvalues)"),
        ModeNaming::Pair => format!("mode {name}"),
    }
}

/// The mode that bears the paper's number, which counts all 2 n eigenvalues.
pub(in super::super) fn paper_mode(results: &Results<'_>, paper: &Paper) -> ModeLabel {
    if results.labels == ModeNaming::Pair { paper.mode } else { ModeLabel::new(paper.mode.number().div_ceil(2)) }
}

/// Amplitudes of a mode shape, over all degrees of freedom of the lattice.
pub(in super::super) fn shape(
    results: &Results<'_>,
    scene: &Scene,
    reference: &Reference,
    name: ModeLabel,
) -> Option<Vec<Complex<f64>>> {
    let at = match results.labels {
        ModeNaming::Tracked => reference.names.iter().position(|names| *names == [name])?,
        ModeNaming::Rank | ModeNaming::Pair => results.rank_of(name).checked_sub(1)?,
    };
    let mode = reference.modes.get(at)?;
    Some(results.plan().brake(scene).dofs.expand(&mode.shape).iter().copied().collect())
}

/// Median net work of each oscillator under a mode in one scene; `None` where the mode is never unstable.
fn median_work(results: &Results<'_>, scene: usize, name: ModeLabel) -> Result<Option<Vec<f64>>, Error> {
    let tracked = results.tracked_name(scene, name);
    let Some(sketches) = tracked.and_then(|name| results.summary.tally.scenes[scene].net_work.get(&name)) else {
        return Ok(None);
    };
    Ok(Some(sketches.iter().map(|sketch| sketch.median()).collect::<Result<_, _>>()?))
}

/// By how much the least median net work of the `dominant` oscillators (from 1) exceeds the largest of the others, in units of the
/// largest, under each law.
pub(super) fn work_dominance(
    results: &Results<'_>,
    constraints: usize,
    name: ModeLabel,
    dominant: &[usize],
) -> Result<Vec<(String, f64)>, Error> {
    let mut margins = Vec::new();
    for (at, scene, _) in full_contact(results, constraints) {
        if let Some(work) = median_work(results, at, name)? {
            // The plate comes last.
            let oscillators = work.len() - 1;
            let work = &work[..oscillators];
            let largest = work.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
            let is_dominant = |i: &usize| dominant.contains(&(i + 1));
            let least = (0..oscillators).filter(is_dominant).map(|i| work[i]).fold(f64::INFINITY, f64::min);
            let others = (0..oscillators).filter(|i| !is_dominant(i));
            let rest = others.map(|i| work[i]).fold(f64::NEG_INFINITY, f64::max);
            margins.push((law_of(results, scene), (least - rest) / largest));
        }
    }
    Ok(margins)
}
