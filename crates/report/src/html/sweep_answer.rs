//! The answer of a sweep in words: which modes grow, and where they begin to, or how much of a map is stable.

use std::collections::BTreeMap;

use output::hertz;
use squeal::sweep::{ChangeOf, DIVERGENCE, Found, Marginal, StabilityMap, Sweep, SweepOnset, named, not_looked_for};
use squeal::tracking::BranchPoint;

use super::text::{capitalised, escaped};

/// Most modes that have a sentence of their own; the table below has all. Chosen: more are not read.
const MOST_MODES: usize = 12;

/// The answer, as HTML.
pub(super) fn answer(found: &Found) -> String {
    let sentences = match found {
        Found::Branches(sweep) => of_branches(sweep),
        Found::Map(map) => of_map(map),
    };
    let counts_divergence = match found {
        Found::Branches(sweep) => sweep.counts_divergence,
        Found::Map(map) => map.counts_divergence,
    };
    let note = (!counts_divergence).then(|| capitalised(not_looked_for(false).trim_end()));
    let items: String =
        note.iter().chain(&sentences).map(|sentence| format!("<li>{}</li>\n", escaped(sentence))).collect();
    format!("<ul class=\"lead\">\n{items}</ul>\n")
}

fn of_branches(sweep: &Sweep) -> Vec<String> {
    let name = &sweep.parameter.name;
    let mut sentences = vec![match sweep.unstable_at_start {
        0 => format!("No mode is unstable at {name} = {}.", sweep.parameter.from),
        1 => format!("One mode is unstable at {name} = {}.", sweep.parameter.from),
        number => format!("{number} modes are unstable at {name} = {}.", sweep.parameter.from),
    }];
    match sweep.diverging_at_start {
        0 => {}
        1 => sentences.push("One of them diverges: a real eigenvalue is above the threshold.".into()),
        number => sentences.push(format!("{number} of them diverge: real eigenvalues above the threshold.")),
    }
    sentences.extend(sweep.doubts().iter().map(|doubt| capitalised(doubt) + "."));
    let marginal = |range: &Marginal| {
        let (modes, from, to) = (range.in_words(), short(range.from), short(range.to));
        let [are, grow, decay] = if range.modes == 1 { ["is", "grows", "decays"] } else { ["are", "grow", "decay"] };
        format!("{modes} {are} on the axis from {name} = {from} to {to}, and neither {grow} nor {decay}.")
    };
    if sweep.threshold.is_axis() {
        sentences.extend(sweep.marginal.iter().take(MOST_MODES).map(marginal));
    }
    let mut onsets: Vec<&SweepOnset> = sweep.onsets.iter().collect();
    onsets.sort_by(|a, b| a.at.total_cmp(&b.at));
    sentences.extend(anything(sweep, &onsets));
    sentences.extend(of_modes(sweep, &onsets));
    for onset in onsets.iter().filter(|onset| onset.of == ChangeOf::Band).take(MOST_MODES) {
        let does = onset.event(&sweep.threshold);
        sentences.push(format!(
            "At {name} = {} mode {} {does}; beside the band it does not count.",
            short(onset.at),
            onset.mode
        ));
    }
    for onset in onsets.iter().filter(|onset| onset.of == ChangeOf::Exchange).take(MOST_MODES) {
        let does = onset.event(&sweep.threshold);
        sentences.push(format!("At {name} = {} {does} (mode {}); both are instability.", short(onset.at), onset.mode));
    }
    let is_open = !(sweep.unresolved.is_empty() && sweep.miscounts.is_empty());
    if onsets.is_empty() && !is_open {
        sentences.push(format!("That stays so up to {name} = {}: no mode crosses.", sweep.parameter.to));
    }
    if !sweep.openings.is_empty() {
        let jumps: usize = sweep.openings.iter().map(|opening| opening.jumping).sum();
        sentences.push(format!(
            "Contact points open or close at {} values of {name}, where branches jump {jumps} times; openings.csv has them.",
            sweep.openings.len()
        ));
    }
    let of_reduced = onsets.iter().filter(|onset| onset.is_reduced).count();
    if of_reduced > 0 {
        let of = if of_reduced == 1 { "One onset is" } else { "Some onsets are" };
        sentences.push(format!(
            "{of} the reduced brake's, because the whole brake's was not found: the table below says which, and to what they are taken to be good."
        ));
    }
    if !sweep.unresolved.is_empty() {
        let ranges = if sweep.unresolved.len() == 1 { "one range" } else { "some ranges" };
        sentences.push(format!("In {ranges}, listed below, a mode comes so near that it may cross or not."));
    }
    sentences
}

/// A mode with its frequency at its first onset, or, without one, at the lower end of the parameter.
fn in_words(mode: &str, sweep: &Sweep, onsets: &[&SweepOnset]) -> String {
    if mode == DIVERGENCE {
        return "The brake by divergence (a real eigenvalue, no vibration)".into();
    }
    let first = onsets.iter().find(|onset| onset.mode == mode).map(|onset| onset.omega);
    let own = sweep.branches.iter().filter(|branch| branch.mode == mode).flat_map(|branch| branch.points.first());
    let omega = first.or_else(|| own.map(|(_, point)| point.lambda.im).find(|omega| *omega > 0.0)).unwrap_or(0.0);
    format!("Mode {mode} ({} Hz)", hertz(omega / std::f64::consts::TAU))
}

/// Places, ascending, at which the number of unstable eigenvalues changes, each with the change.
type Changes = Vec<(f64, i64)>;

/// Changes of the number of unstable eigenvalues of one name, or of those that diverge, by all onsets in ascending order.
fn changes_of(mode: &str, onsets: &[&SweepOnset]) -> Changes {
    let by = |onset: &&SweepOnset| match (onset.of, onset.mode == mode) {
        // A growing pair becomes two real eigenvalues.
        (ChangeOf::Exchange, _) if mode == DIVERGENCE => Some((onset.at, 2 * onset.by())),
        (ChangeOf::Exchange, true) => Some((onset.at, -onset.by())),
        (_, true) => Some((onset.at, onset.by())),
        (_, false) => None,
    };
    onsets.iter().filter_map(by).collect()
}

/// Number of unstable eigenvalues of each name at one end of a sweep, 0 for its lower and 1 for its upper one, by its branches; `None` where they do not
/// count as many as the spectrum does.
fn unstable_at(sweep: &Sweep, end: usize, diverging: i64) -> Option<BTreeMap<String, i64>> {
    let (at, by_spectrum) = match end {
        0 => (sweep.parameter.from, sweep.unstable_at_start),
        _ => (sweep.parameter.to, sweep.unstable_at_end),
    };
    let mut found = BTreeMap::new();
    for branch in &sweep.branches {
        let last = if end == 0 { branch.points.first() } else { branch.points.last() };
        let is_unstable = |(value, point): &&(f64, BranchPoint)| {
            *value == at && point.lambda.im > 0.0 && sweep.threshold.margin(point.lambda) > 0.0
        };
        if last.filter(is_unstable).is_some() {
            *found.entry(branch.mode.clone()).or_default() += 1;
        }
    }
    let is_all = found.values().sum::<i64>() + diverging == by_spectrum as i64 && sweep.growing_beside == [None; 2];
    found.insert(DIVERGENCE.to_owned(), diverging);
    is_all.then_some(found)
}

/// Ranges in which at least so many are unstable, of a number at the lower end of the parameter and its changes, as words.
fn ranges(name: &str, at_start: i64, changes: &Changes, least: i64) -> String {
    let mut words = Vec::new();
    let (mut number, mut from) = (at_start, None);
    for &(at, by) in changes {
        let was = number >= least;
        number += by;
        match (was, number >= least) {
            (false, true) => from = Some(at),
            (true, false) => words.push(match from.take() {
                Some(start) => format!("from {name} = {} to {}", short(start), short(at)),
                None => format!("up to {name} = {}", short(at)),
            }),
            _ => {}
        }
    }
    if number >= least {
        words.push(from.map_or("over the whole range".into(), |start| format!("from {name} = {} on", short(start))));
    }
    words.join(" and ")
}

/// Ranges in which eigenvalues of one name are unstable, with those in which several are.
fn ranges_of_all(name: &str, at_start: i64, changes: &Changes) -> String {
    let mut number = at_start;
    let numbers = changes.iter().map(|(_, by)| {
        number += by;
        number
    });
    let most = numbers.fold(at_start, i64::max);
    let first = ranges(name, at_start, changes, 1);
    let several = (2..=most).map(|least| {
        let words = ranges(name, at_start, changes, least);
        let words = if words == first { String::new() } else { format!(" {words}") };
        format!(", by {least} eigenvalues{words}")
    });
    several.fold(first.clone(), |all, words| all + &words)
}

/// Onsets of one name where branches do not tell which of them belong to the same eigenvalue: what happens at each.
fn events(name: &str, mode: &str, onsets: &[&SweepOnset], sweep: &Sweep) -> String {
    let own = onsets.iter().filter(|onset| onset.mode == mode);
    let words = own.map(|onset| format!("{} at {name} = {}", onset.event(&sweep.threshold), short(onset.at)));
    words.collect::<Vec<_>>().join(", ")
}

/// True if a number that changes so is never below zero, and in the end is the one that is known.
fn agrees(at_start: i64, changes: &Changes, at_end: Option<i64>) -> bool {
    let mut number = at_start;
    let is_possible = changes.iter().all(|(_, by)| {
        number += by;
        number >= 0
    });
    is_possible && at_end.is_none_or(|at_end| number == at_end)
}

/// Sentence on where the brake is unstable, by whatever modes; `None` where nothing is, and where that is in doubt.
fn anything(sweep: &Sweep, onsets: &[&SweepOnset]) -> Option<String> {
    let changes: Changes = onsets.iter().map(|onset| (onset.at, onset.by())).collect();
    let at_start = sweep.unstable_at_start as i64;
    let is_sure = sweep.miscounts.is_empty() && sweep.unresolved.is_empty();
    let is_any = at_start > 0 || !changes.is_empty();
    let is_known = is_any && is_sure && agrees(at_start, &changes, Some(sweep.unstable_at_end as i64));
    is_known.then(|| format!("The brake is unstable {}.", ranges(&sweep.parameter.name, at_start, &changes, 1)))
}

/// Sentences on the modes, each with the ranges in which it is unstable, or with its onsets where its branches do not tell these.
fn of_modes(sweep: &Sweep, onsets: &[&SweepOnset]) -> Vec<String> {
    let name = &sweep.parameter.name;
    let diverging = sweep.diverging_at_start as i64;
    let at_start = unstable_at(sweep, 0, diverging);
    let diverging_at_end = diverging + changes_of(DIVERGENCE, onsets).iter().map(|(_, by)| by).sum::<i64>();
    let at_end = unstable_at(sweep, 1, diverging_at_end);
    let mut modes: Vec<&str> = Vec::new();
    let with_onsets = onsets.iter().filter(|onset| onset.of != ChangeOf::Exchange).map(|onset| onset.mode.as_str());
    let all_along = at_start.iter().flatten().filter(|(_, number)| **number > 0).map(|(mode, _)| mode.as_str());
    for mode in with_onsets.chain(all_along) {
        if !modes.contains(&mode) {
            modes.push(mode);
        }
    }
    let sentence = |&mode: &&str| {
        let changes = changes_of(mode, onsets);
        let number = |at: &Option<BTreeMap<String, i64>>| at.as_ref().map(|all| all.get(mode).copied().unwrap_or(0));
        let words = match number(&at_start) {
            Some(first) if agrees(first, &changes, number(&at_end)) => {
                format!("is unstable {}", ranges_of_all(name, first, &changes))
            }
            _ => events(name, mode, onsets, sweep),
        };
        format!("{} {words}.", in_words(mode, sweep, onsets))
    };
    let more = modes.len().saturating_sub(MOST_MODES);
    let more =
        (more > 0).then(|| format!("{more} more modes are unstable somewhere; the table below has their onsets."));
    modes.iter().take(MOST_MODES).map(sentence).filter(|words| !words.ends_with(" .")).chain(more).collect()
}

fn of_map(map: &StabilityMap) -> Vec<String> {
    let mut shares = map.shares();
    let mut sentences = vec![match shares.remove(&0) {
        Some((share, _)) => format!("No mode is unstable on {:.1} % of the map.", 100.0 * share),
        None => "No part of the map is stable.".into(),
    }];
    let words = |(number, (share, _)): (usize, (f64, usize))| format!("{number} on {:.1} %", 100.0 * share);
    let elsewhere: Vec<String> = shares.into_iter().map(words).collect();
    if !elsewhere.is_empty() {
        sentences.push(format!("Unstable modes elsewhere: {}.", elsewhere.join(", ")));
    }
    sentences.extend(map.share_in_words().map(|words| capitalised(&words) + "."));
    if let Some(lines) = &map.lines {
        let [name, across] = [lines.along, 1 - lines.along].map(|axis| &map.parameters[axis].name);
        sentences.push(format!(
            "{}, so that the boundary is not followed: it is exact along {name} on {} lines (changes.csv), and over {across} within 1/{} of the range.",
            if lines.openings > 0 { "Contact points open and close in the ranges" } else { "Growing modes enter the band or leave it" },
            lines.lines,
            2 * (lines.lines - 1)
        ));
    }
    let mut crossing: Vec<String> = Vec::new();
    for curve in &map.curves {
        let name = named(&curve.mode);
        if !crossing.contains(&name) {
            crossing.push(name);
        }
    }
    if !crossing.is_empty() {
        sentences.push(format!("Becomes unstable across a curve of its own: {}.", crossing.join(", ")));
    }
    sentences
}

/// The value to six digits.
pub(super) fn short(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
