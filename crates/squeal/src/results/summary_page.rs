//! `summary.md`: which modes squeal, how sure that is, and which set of constraints helps by how much.

use std::path::Path;

use output::{printable, write};
use study::{ModeLabel, SetLinks};

use super::findings::{Change, OpenCounts, SetFindings, drop_in_words, place, warnings};
use super::reasons::{SceneReasons, reasons_in_words};
use super::study_results::Estimate;
use super::summary::hertz;
use super::{Results, set_letter};
use crate::Error;

/// Writes `summary.md`.
pub(super) fn write_summary(
    results: &Results,
    links: &[SetLinks],
    reasons: &[SceneReasons],
    dir: &Path,
) -> Result<(), Error> {
    let labels = &results.plan().labels;
    let doubts: String = results.doubts().iter().map(|doubt| format!("**WARNING: {doubt}**\n\n")).collect();
    let warned: String =
        warnings(results).into_iter().map(|warning| format!("**{}.**\n\n", printable(&warning))).collect();
    let mut text = format!(
        "# {}\n\n{doubts}{warned}{} samples of each arrangement, law and speed range. The occurrence of a mode is the part of the samples in \
         which it is unstable; of a panel (one law, number in contact and speed range) the median over its arrangements. In \
         parentheses are 95 % intervals; samples in which an unstable mode may be this one or another, and those that failed, widen \
         them upwards. Divergence is instability without oscillation: a real eigenvalue that grows.\n",
        results.plan().name,
        results.summary.samples
    );
    if !results.plan().threshold.is_axis() {
        text += &format!("\nA mode counts as unstable with {}.\n", results.plan().threshold);
    }
    let sets = (0..labels.constraints.len())
        .map(|constraints| SetFindings::new(results, constraints))
        .collect::<Result<Vec<_>, Error>>()?;
    for (constraints, findings) in sets.iter().enumerate() {
        text += &squealing(results, constraints, findings);
    }
    text += &open_questions(results);
    if labels.constraints.len() > 1 {
        text += "\n## What helps\n\nUnstable modes per analysis, compared with the first set on the same samples:\n\n";
        for constraints in 1..labels.constraints.len() {
            text += &helped(results, constraints);
        }
        for link in links.iter().filter(|link| link.from == 0) {
            text += &followed(results, link, &sets);
        }
    }
    text += &reasons_in_words(results.plan(), reasons);
    Ok(write(&dir.join("summary.md"), text.as_bytes())?)
}

/// The modes of a set of constraints that are ever unstable, the most robust first.
fn squealing(results: &Results, constraints: usize, findings: &SetFindings<'_>) -> String {
    let unstable = &findings.unstable;
    let names = |list: Vec<String>| if list.is_empty() { "none".to_owned() } else { list.join(", ") };
    let everywhere = unstable.iter().filter(|(_, range)| range.is_likely_everywhere());
    let somewhere = unstable.iter().filter(|(_, range)| range.is_likely_somewhere());
    let label = |name: ModeLabel| results.mode_label(constraints, name);
    let mut text = format!(
        "\n## Set {}\n\nUnstable in more than half of the samples, sure to 95 %: in every panel {}; in some panels {}.\n",
        set_name(results, constraints),
        names(everywhere.map(|(name, _)| label(*name)).collect()),
        names(somewhere.map(|(name, _)| label(*name)).collect())
    );
    if let Some(words) = findings.anything_in_words(with_limits) {
        text += &format!("\n{words}.\n");
    }
    if !unstable.is_empty() {
        text += "\n| mode | Hz | least of a panel | largest of a panel | where | largest of an arrangement |\n";
        text += "| --- | --- | --- | --- | --- | --- |\n";
    }
    for (name, range) in unstable {
        text += &format!(
            "| {} | {} | {} | {} | {} | {} |\n",
            label(*name),
            frequency(results, constraints, *name),
            with_limits(&range.least.0),
            with_limits(&range.most.0),
            if range.most.0.value > 0.0 { place(results, range.most.1) } else { "-".into() },
            with_limits(&range.largest)
        );
    }
    if !findings.stable.is_empty() {
        text += &format!(
            "\nModes that are unstable in no sample: {}; of the samples of an arrangement each is unstable in at most {:.2} % \
             (95 %).\n",
            findings.stable.len(),
            100.0 * findings.stable_upper
        );
    }
    text
}

/// What the samples leave open.
fn open_questions(results: &Results) -> String {
    let OpenCounts { unstable_modes, ambiguous_modes, divergent, undecided, marginal, failures } =
        OpenCounts::new(results);
    let divergence = results.divergence_in_words().unwrap_or_else(|| format!("{divergent} real eigenvalues diverge."));
    format!(
        "\n## What is left open\n\nOf {unstable_modes} unstable modes found, {ambiguous_modes} have a name that is open, near a \
         coalescence, or none. {divergence} {undecided} verdicts are undecided and count as stable. {marginal} \
         eigenvalues lie on the imaginary axis and neither grow nor decay. {failures} draws or evaluations failed.\n"
    )
}

/// By how much a set of constraints changes the number of unstable modes.
fn helped(results: &Results, constraints: usize) -> String {
    let name = set_name(results, constraints);
    let Some(Change { panels, fewer, more, least, most }) = Change::new(results, constraints) else {
        return format!("- **{name}**: nothing to compare.\n");
    };
    let change = |(panel, d): (_, Estimate)| format!("{} with {}", drop_in_words(&d), place(results, panel));
    format!(
        "- **{name}**: fewer in {fewer} of {panels} panels, more in {more}, no difference that is sure in {}; from {} to {}.\n",
        panels - fewer - more,
        change(least),
        change(most)
    )
}

/// What becomes of each mode of the first set that is ever unstable.
fn followed(results: &Results, link: &SetLinks, sets: &[SetFindings<'_>]) -> String {
    let mut text = format!(
        "\nWhat becomes of the modes of {} under {}, by continuation as the constraints come in; MAC compares the two shapes, \
         occurrences are the least and the largest of a panel:\n\n| mode | Hz | occurrence | becomes | Hz | MAC | occurrence |\n\
         | --- | --- | --- | --- | --- | --- | --- |\n",
        set_name(results, link.from),
        set_name(results, link.to)
    );
    let ends = |constraints: usize, name: ModeLabel| {
        let range = sets[constraints].range(name)?;
        Some(format!("{:.3} to {:.3}", range.least.0.value, range.most.0.value))
    };
    let targets = results.modes_of_set(link.to);
    for (i, (name, mode)) in results.modes_of_set(link.from).into_iter().enumerate() {
        if !sets[link.from].range(name).is_some_and(|range| range.is_ever_unstable) {
            continue;
        }
        let before = format!(
            "| {} | {} | {} |",
            results.mode_label(link.from, name),
            hertz(cea::frequency_hz(mode.lambda)),
            ends(link.from, name).unwrap_or_default()
        );
        let open = if link.becomes[i].len() > 1 { " or another" } else { "" };
        for to in &link.becomes[i] {
            text += &match to {
                None => format!("{before} held{open} | | | |\n"),
                Some(j) => {
                    let (target, mode) = targets[*j];
                    format!(
                        "{before} {}{open} | {} | {:.2} | {} |\n",
                        results.mode_label(link.to, target),
                        hertz(cea::frequency_hz(mode.lambda)),
                        link.mac[(i, *j)],
                        ends(link.to, target).unwrap_or_default()
                    )
                }
            };
        }
    }
    text
}

fn set_name(results: &Results, constraints: usize) -> String {
    let sets = &results.plan().labels.constraints;
    match sets.len() {
        1 => format!("\"{}\"", sets[constraints]),
        _ => format!("{}, \"{}\"", set_letter(constraints), sets[constraints]),
    }
}

fn frequency(results: &Results, constraints: usize, name: ModeLabel) -> String {
    results.frequency(constraints, name).map_or("-".into(), hertz)
}

fn with_limits(e: &Estimate) -> String {
    format!("{:.3} ({:.3} to {:.3})", e.value, e.lower, e.upper)
}
