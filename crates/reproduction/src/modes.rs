//! Modes of the paper's case: how often each is unstable, how each is called, its shape and its net work.

use std::collections::{BTreeMap, BTreeSet};

use brakes::case::Paper;
use montecarlo::QuantileSketch;
use num_complex::Complex;
use squeal::results::{Estimate, Results};
use squeal::study::{ModeLabel, ModeNaming, Panel, Reference, Scene};

use super::limits::{Judgement, Limits, least};
use super::scenes::{UNCONSTRAINED, full_contact, law_of};
use crate::Error;

/// The modes that are ever unstable in any of `panels`.
pub(super) fn unstable_modes(results: &Results, panels: &[&Panel]) -> BTreeSet<ModeLabel> {
    panels.iter().flat_map(|panel| results.occurrences(panel).into_keys()).collect()
}

/// Number of occurrences that `modes` modes have in `panels`: one for each scene.
pub(super) fn number_of_occurrences(modes: usize, panels: &[&Panel]) -> usize {
    modes * panels.iter().map(|panel| panel.scenes.len()).sum::<usize>()
}

/// The median occurrence of each mode in each of `panels`.
pub(super) fn medians(
    results: &Results,
    modes: &BTreeSet<ModeLabel>,
    panels: &[&Panel],
    limits: &Limits,
) -> Result<BTreeMap<ModeLabel, Vec<Estimate>>, Error> {
    let of_panels = |mode: ModeLabel| -> Result<Vec<Estimate>, Error> {
        panels.iter().map(|panel| limits.median(&results.occurrences_of(panel, mode))).collect()
    };
    modes.iter().map(|&mode| Ok((mode, of_panels(mode)?))).collect()
}

/// Modes under a constraint set by the smallest median occurrence over all panels, largest first.
pub(crate) fn most_robust(
    results: &Results,
    constraints: usize,
    judgement: Judgement,
) -> Result<Vec<(ModeLabel, Estimate)>, Error> {
    let panels: Vec<_> = results.panels().iter().filter(|p| p.key.constraints == constraints).collect();
    let modes = unstable_modes(results, &panels);
    let limits = judgement.of(number_of_occurrences(modes.len(), &panels));
    let medians = medians(results, &modes, &panels, &limits)?.into_iter();
    let mut robust: Vec<(ModeLabel, Estimate)> = medians.map(|(mode, of_panels)| (mode, least(of_panels))).collect();
    robust.sort_by(|a, b| b.1.value.total_cmp(&a.1.value));
    Ok(robust)
}

/// The label of a mode without constraints, with its place among all 2 n eigenvalues, as the paper may count.
pub(crate) fn title(results: &Results, name: ModeLabel) -> String {
    title_in(results, UNCONSTRAINED, name)
}

/// The label of a mode of a set of constraints, with its place among all 2 n eigenvalues.
pub(crate) fn title_in(results: &Results, constraints: usize, name: ModeLabel) -> String {
    let (first, second) = cea::pair_numbers(results.rank_of(constraints, name));
    let label = results.mode_label(constraints, name);
    match results.labels {
        ModeNaming::Tracked => format!("tracked mode {label} ({first}/{second} of all eigenvalues)"),
        ModeNaming::Rank => format!("rank {label} ({first}/{second} of all eigenvalues)"),
        ModeNaming::Pair => format!("mode {label}"),
        ModeNaming::RankDown => format!("rank {label} from the top ({first}/{second} of all eigenvalues)"),
        ModeNaming::PairDown => format!("mode {label} from the top ({first}/{second} of all eigenvalues)"),
    }
}

/// The modes without constraints that bear the paper's number among all 2 n eigenvalues, counted from the lowest frequency and from the
/// highest.
pub(crate) fn paper_modes(results: &Results, paper: &Paper) -> [ModeLabel; 2] {
    [ModeNaming::Pair, ModeNaming::PairDown].map(|counting| numbered(results, UNCONSTRAINED, paper.mode, counting))
}

/// The mode that has the paper's number, counted from the lowest and from the highest frequency, in words, each with what `has` says of it.
///
/// # Errors
/// Errors of `has`.
pub(super) fn of_paper_modes(
    results: &Results,
    paper: &Paper,
    has: impl Fn(ModeLabel) -> Result<String, Error>,
) -> Result<String, Error> {
    let [up, down] = paper_modes(results, paper);
    let words = |name| Ok::<_, Error>(format!("{} with {}", title(results, name), has(name)?));
    Ok(format!("the paper's number is {} from the lowest frequency, {} from the highest", words(up)?, words(down)?))
}

/// The mode of a set of constraints that has `number` when modes are counted by `counting`.
pub(super) fn numbered(results: &Results, constraints: usize, number: ModeLabel, counting: ModeNaming) -> ModeLabel {
    let rank = counting.rank(number, results.modes_under(constraints));
    results.name(constraints, ModeLabel::of_rank(rank))
}

/// Amplitudes of a mode shape, over all degrees of freedom of the lattice.
pub(crate) fn shape(
    results: &Results,
    scene: &Scene,
    reference: &Reference,
    name: ModeLabel,
) -> Option<Vec<Complex<f64>>> {
    let at = match results.labels {
        ModeNaming::Tracked => reference.names.iter().position(|names| *names == [name])?,
        _ => results.rank_of(scene.key.constraints, name).checked_sub(1)?,
    };
    let mode = reference.modes.get(at)?;
    Some(results.plan().brake(scene).dofs.expand(&mode.shape).iter().copied().collect())
}

/// Margin by which the least median net work of the `dominant` oscillators (from 1) exceeds the largest of the others, in units of
/// the largest, under each law; the limits are of the sign, in the same units. Empty for a mode that is never unstable.
pub(super) fn work_dominance(
    results: &Results,
    constraints: usize,
    name: ModeLabel,
    dominant: &[usize],
    limits: &Limits,
) -> Result<Vec<(String, Estimate)>, Error> {
    let mut margins = Vec::new();
    for (at, scene, _) in full_contact(results, constraints) {
        let tracked = results.tracked_name(at, name);
        let net_work = &results.summary.tally.scenes[at].net_work;
        if let Some(sketches) = tracked.and_then(|name| net_work.get(&name)) {
            margins.push((law_of(results, scene), margin(sketches, dominant, limits)?));
        }
    }
    Ok(margins)
}

/// Oscillators of the brake under a constraint set; the plate comes after them.
pub(super) fn brake_oscillators(results: &Results, constraints: usize) -> usize {
    results.plan().origins.get(constraints).map_or(0, |origin| origin.brake.bodies.len() - 1)
}

/// The margin of the dominant oscillators in one scene, from a sketch of each body.
fn margin(sketches: &[QuantileSketch], dominant: &[usize], limits: &Limits) -> Result<Estimate, Error> {
    // The plate comes last.
    let oscillators = &sketches[..sketches.len() - 1];
    let work = oscillators.iter().map(|sketch| limits.sketched_median(sketch)).collect::<Result<Vec<_>, _>>()?;
    let largest = work.iter().map(|e| e.value).fold(f64::MIN_POSITIVE, f64::max);
    let is_dominant = |(i, _): &(usize, &Estimate)| dominant.contains(&(i + 1));
    let of_dominant = least(work.iter().enumerate().filter(is_dominant).map(|(_, e)| *e));
    let others = || work.iter().enumerate().filter(|e| !is_dominant(e));
    let rest = |of: fn(&Estimate) -> f64| others().map(|(_, e)| of(e)).fold(f64::NEG_INFINITY, f64::max);
    Ok(Estimate {
        value: (of_dominant.value - rest(|e| e.value)) / largest,
        lower: (of_dominant.lower - rest(|e| e.upper)) / largest,
        upper: (of_dominant.upper - rest(|e| e.lower)) / largest,
    })
}
