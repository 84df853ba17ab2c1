//! The answer of a sweep in words: which modes grow, and where they begin to, or how much of a map is stable.

use output::hertz;
use squeal::sweep::{ChangeOf, DIVERGENCE, Found, Marginal, StabilityMap, Sweep, SweepOnset, named, not_looked_for};

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
    let mut modes: Vec<&str> = Vec::new();
    let exchanges = onsets.extract_if(.., |onset| onset.of == ChangeOf::Exchange).collect::<Vec<_>>();
    for onset in &onsets {
        if !modes.contains(&onset.mode.as_str()) {
            modes.push(&onset.mode);
        }
    }
    for &mode in modes.iter().take(MOST_MODES) {
        let own: Vec<&SweepOnset> = onsets.iter().copied().filter(|onset| onset.mode == mode).collect();
        sentences.push(format!("{} is unstable {}.", in_words(mode, &own), ranges(name, &own)));
    }
    for onset in onsets.iter().filter(|onset| onset.of == ChangeOf::Band).take(MOST_MODES) {
        let does = onset.event(&sweep.threshold);
        sentences.push(format!(
            "At {name} = {} mode {} {does}; beside the band it does not count.",
            short(onset.at),
            onset.mode
        ));
    }
    if modes.len() > MOST_MODES {
        sentences.push(format!(
            "{} more modes become unstable or stable; the table below has them.",
            modes.len() - MOST_MODES
        ));
    }
    for onset in exchanges.iter().take(MOST_MODES) {
        let does = onset.event(&sweep.threshold);
        sentences.push(format!("At {name} = {} {does} (mode {}); both are instability.", short(onset.at), onset.mode));
    }
    let is_open = !(sweep.unresolved.is_empty() && sweep.miscounts.is_empty());
    if modes.is_empty() && exchanges.is_empty() && !is_open {
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

/// A mode with its frequency at its first onset.
fn in_words(mode: &str, onsets: &[&SweepOnset]) -> String {
    if mode == DIVERGENCE {
        return "The brake by divergence (a real eigenvalue, no vibration)".into();
    }
    let omega = onsets.first().map_or(0.0, |onset| onset.omega);
    format!("Mode {mode} ({} Hz)", hertz(omega / std::f64::consts::TAU))
}

/// Ranges in which a mode is unstable, by its onsets in ascending order.
fn ranges(name: &str, onsets: &[&SweepOnset]) -> String {
    let mut words = Vec::new();
    let mut from: Option<f64> = None;
    for onset in onsets {
        match (onset.starts, from.take()) {
            (true, _) => from = Some(onset.at),
            (false, Some(start)) => words.push(format!("from {} to {}", short(start), short(onset.at))),
            (false, None) => words.push(format!("up to {name} = {}", short(onset.at))),
        }
    }
    words.extend(from.map(|start| format!("from {name} = {} on", short(start))));
    words.join(" and ")
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
