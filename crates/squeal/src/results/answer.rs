//! The answer of a study in words: which modes squeal, how sure that is, which set of constraints helps by how much. It is said once,
//! for `summary.md` and the page.

use montecarlo::{Estimate, Interval, QuantileSketch};
use output::{Block, Cell, Cells, hertz, printable, significant};
use study::{ModeLabel, SetLinks};

use super::bands::{by_third_octaves, lights};
use super::findings::{Change, ModeRange, OpenCounts, SetFindings, drop_in_words, place, warnings};
use super::measured::{RULE, in_cells};
use super::{Results, set_letter};
use crate::Error;

impl Results {
    /// The answer of the study.
    ///
    /// # Errors
    /// None for the results of a study.
    pub fn answer(&self) -> Result<Vec<Block>, Error> {
        let findings = self.findings()?;
        let mut answer: Vec<Block> = self.doubts().into_iter().map(Block::Warning).collect();
        answer.push(Block::Heading("Which modes squeal".into()));
        let warnings = warnings(self).into_iter().map(|warning| format!("**{}.**", printable(&warning)));
        let sets = findings.iter().enumerate().map(|(set, found)| squealing(self, set, found));
        answer.push(Block::List(warnings.chain(sets).collect()));
        let most = "\u{201c}Most\u{201d} is more than half of the draws, and surely so: the lower limit is.";
        answer.push(Block::Paragraph(most.into()));
        if !self.plan().threshold.is_axis() {
            answer.push(Block::Paragraph(format!("A mode counts with {}.", self.plan().threshold)));
        }
        let bands: Vec<Block> = findings
            .iter()
            .enumerate()
            .filter_map(|(set, found)| by_third_octaves(self, set, found, set_in_words(self, set)))
            .collect();
        if !bands.is_empty() {
            answer.push(Block::Heading("In which bands".into()));
            let has_open_names = (0..findings.len()).any(|set| has_open_names(self, set));
            answer.push(Block::Paragraph(lights(self.has_one_arrangement(), has_open_names)));
            answer.extend(bands);
        }
        let beside = self.beside_measured(&findings);
        if !beside.is_empty() {
            answer.push(Block::Heading("Beside what was measured".into()));
            answer.push(Block::Paragraph(RULE.into()));
            answer.extend(beside.iter().enumerate().map(|(set, of_set)| in_cells(of_set, set_in_words(self, set))));
        }
        answer.push(Block::Heading("What helps".into()));
        answer.extend(helps(self));
        answer.push(Block::Heading("How sure that is".into()));
        answer.extend(how_sure(self, &findings));
        answer.push(Block::Heading("Every mode that is ever unstable".into()));
        answer.extend(findings.iter().enumerate().map(|(set, found)| modes(self, set, found)));
        Ok(answer)
    }

    /// The findings of the samples on each set of constraints.
    pub(super) fn findings(&self) -> Result<Vec<SetFindings<'_>>, Error> {
        (0..self.plan().labels.constraints.len()).map(|set| SetFindings::new(self, set)).collect()
    }

    /// Links of each mode of the first set of constraints that is ever unstable to the modes of each of the others.
    ///
    /// # Errors
    /// None for the results of a study.
    pub(super) fn becoming(&self, links: &[SetLinks]) -> Result<Vec<Block>, Error> {
        let findings = self.findings()?;
        Ok(links.iter().filter(|link| link.from == 0).map(|link| followed(self, link, &findings)).collect())
    }
}

/// Largest number of drawn inputs that are named; chosen: as many as the laws of friction have.
const NAMED: usize = 8;

/// Indices of the scenes of a set of constraints.
fn scenes_of(results: &Results, set: usize) -> impl Iterator<Item = usize> {
    results
        .panels()
        .iter()
        .filter(move |panel| panel.key.constraints == set)
        .flat_map(|panel| panel.scenes.iter().copied())
}

/// True if an evaluation of a set of constraints failed, or has a verdict that is open.
fn is_open(results: &Results, set: usize) -> bool {
    scenes_of(results, set).any(|scene| results.failed(scene) + results.summary.tally.scenes[scene].undecided > 0)
}

/// True if an unstable mode of a set of constraints has a name that is open, or none: how strong it is no name tells.
fn has_open_names(results: &Results, set: usize) -> bool {
    scenes_of(results, set).any(|scene| results.summary.tally.scenes[scene].ambiguous_modes > 0)
}

/// Sentence on the unstable modes of a set of constraints.
fn squealing(results: &Results, set: usize, found: &SetFindings<'_>) -> String {
    let is_single = has_one_panel(results, set);
    let list = |wanted: &dyn Fn(&ModeRange<'_>) -> bool, range_in_words: &dyn Fn(&ModeRange<'_>) -> String| {
        let of = found.unstable.iter().filter(|(_, range)| wanted(range));
        let words = of.map(|(name, range)| {
            format!("{}, {}{}", mode_in_words(results, set, *name), range_in_words(range), grows(results, set, *name))
        });
        words.collect::<Vec<_>>().join("; ")
    };
    let everywhere = list(&|range| range.is_likely_everywhere(), &|range| {
        let more = if is_single { "" } else { " or more" };
        format!("{}{more}", with_limits(&range.least.0))
    });
    let somewhere = list(&|range| range.is_likely_somewhere(), &|range| {
        format!("up to {} with {}", with_limits(&range.most.0), place(results, range.most.1))
    });
    let no_mode_was = if is_single { "no mode was" } else { "in no panel was any mode" };
    let [surely, sure] = if is_open(results, set) { ["surely ", "any sure "] } else { [""; 2] };
    // What is listed may be open alone.
    let is_nothing_sure =
        found.anything[1].value == 0.0 && found.unstable.iter().all(|(_, range)| range.largest.value == 0.0);
    let words = match (everywhere.as_str(), somewhere.as_str()) {
        ("", "") if is_nothing_sure && results.has_band_modes => {
            format!("{no_mode_was} {surely}unstable")
        }
        ("", "") if is_nothing_sure => {
            format!("{no_mode_was} {surely}unstable, nor was there {sure}divergence")
        }
        ("", "") if is_single => "no single mode squeals in most of the draws, for sure".to_owned(),
        (all, _) if is_single => format!("most of the draws squeal with {all}"),
        ("", "") => "in no panel does any single mode squeal in most of the draws, for sure".to_owned(),
        ("", some) => format!("no mode squeals in most of the draws in every panel, but in some panels do {some}"),
        (all, "") => format!("in every panel most of the draws squeal with {all}"),
        (all, some) => {
            format!("in every panel most of the draws squeal with {all}. In some panels they do with {some}")
        }
    };
    let words = match worst(results, set, found) {
        Some(worst) => format!("{words}. {worst}"),
        None => words,
    };
    // What is unstable without a mode's name stands before what modes with names do.
    let words = match found.anything_in_words(with_limits) {
        Some(anything) => format!("{anything}. {}", capitalised(&words)),
        None => words,
    };
    format!("**{}**: {words}.", set_in_words(results, set))
}

/// Words for the fastest growing mode, where no sentence on likely modes names it. Where an unstable mode has an open name or none, it is the fastest of the others
/// alone, and that is said.
fn worst(results: &Results, set: usize, found: &SetFindings<'_>) -> Option<String> {
    let growth = |name: ModeLabel| Some(results.strength(set, name)?.growth.range()?.upper);
    let by_growth = |a: &(f64, _), b: &(f64, _)| a.0.total_cmp(&b.0);
    let all = found.unstable.iter().filter_map(|(name, range)| Some((growth(*name)?, (*name, range))));
    let (_, (name, range)) = all.max_by(by_growth)?;
    let is_named = range.is_likely_everywhere() || range.is_likely_somewhere();
    (!is_named).then(|| {
        let (mode, occurrence) = (mode_in_words(results, set, name), with_limits(&range.most.0));
        let place = match has_one_panel(results, set) {
            true => String::new(),
            false => format!(" with {}", place(results, range.most.1)),
        };
        let among = if has_open_names(results, set) { " of the modes whose names are sure" } else { "" };
        format!(
            "The fastest growing{among} is {mode}, in {occurrence} of the draws{place}{}",
            grows(results, set, name)
        )
    })
}

/// Changes by each set of constraints, the one with the largest least drop first.
fn helps(results: &Results) -> Vec<Block> {
    let sets = results.plan().labels.constraints.len();
    let mut changes: Vec<(usize, Change<'_>)> =
        (1..sets).filter_map(|set| Some((set, Change::new(results, set)?))).collect();
    if changes.is_empty() {
        let none = "The study has one set of constraints, and so nothing that it could compare.";
        return vec![Block::Paragraph(none.into())];
    }
    changes.sort_by(|a, b| b.1.least.1.value.total_cmp(&a.1.least.1.value));
    let said = |(set, Change { panels, fewer, more, least, most }): (usize, Change<'_>)| {
        if panels == 1 {
            let sure = if fewer + more == 1 { "surely" } else { "no sure difference" };
            return format!("**{}**: **{}**, {sure}.", set_in_words(results, set), drop_in_words(&least.1));
        }
        let change = |(panel, d): (_, Estimate)| format!("**{}** with {}", drop_in_words(&d), place(results, panel));
        format!(
            "**{}**: fewer in {fewer} of {panels} panels, more in {more}, no sure difference in {}; from {} to {}.",
            set_in_words(results, set),
            panels - fewer - more,
            change(least),
            change(most)
        )
    };
    let order = match has_one_panel(results, 0) {
        true => "",
        false => ", from the panel with the smallest effect to that with the largest",
    };
    vec![
        Block::Paragraph(format!(
            "Unstable modes in one analysis, compared with {} on the same samples{order}:",
            set_in_words(results, 0)
        )),
        Block::List(changes.into_iter().map(said).collect()),
    ]
}

/// Words for the inputs that are drawn, by their names.
fn drawn_in_words(names: &[String]) -> String {
    let mut shown: Vec<String> = names.iter().take(NAMED).map(|name| printable(name)).collect();
    if names.len() > NAMED {
        shown.push(format!("{} more", names.len() - NAMED));
    }
    match shown.split_last() {
        None => "all that is uncertain".into(),
        Some((only, [])) => only.clone(),
        Some((last, others)) => format!("{} and {last}", others.join(", ")),
    }
}

fn how_sure(results: &Results, findings: &[SetFindings<'_>]) -> Vec<Block> {
    let OpenCounts { unstable_modes, ambiguous_modes, divergent, undecided, marginal, failures } =
        OpenCounts::new(results);
    let quiet: usize = findings.iter().map(|found| found.stable.len()).sum();
    let upper = findings.iter().map(|found| found.stable_upper).fold(0.0, f64::max);
    let [each, of] = match results.has_one_arrangement() {
        true => ["", ""],
        false => [" for each arrangement of contacts, friction law and speed range", " of an arrangement"],
    };
    let meaning = format!(
        "Nobody knows every number of a brake exactly, so the analysis was repeated with {} random draws of {}{each}. The share of the draws in \
         which a mode is unstable is its **occurrence**. Each occurrence has limits in parentheses: if the whole study were repeated with other draws, \
         about 95 of 100 such limits would enclose the true share.",
        results.summary.samples,
        drawn_in_words(&results.drawn)
    );
    let panels = " A **panel** is one friction law with one number of contacts and one speed range; its occurrence is the median over its \
                  arrangements.";
    let meaning = if has_one_panel(results, 0) { meaning } else { meaning + panels };
    let mut items = Vec::new();
    if quiet > 0 && undecided > 0 {
        items.push(format!(
            "Modes that were surely unstable in no draw: {quiet}. As verdicts are open, no upper limit of their occurrence is known; those of tables leave \
             open verdicts out."
        ));
    } else if quiet > 0 {
        items.push(format!(
            "Modes that were unstable in no draw: {quiet}. Each of them is unstable in at most {:.2}\u{a0}% of the draws{of} (95\u{a0}%).",
            100.0 * upper
        ));
    }
    items.push(format!(
        "Of {unstable_modes} unstable modes found, {ambiguous_modes} have a name that is open, where two modes met, or none. They widen the \
         limits upwards."
    ));
    items.push(
        results.divergence_in_words().unwrap_or_else(|| {
            format!("{divergent} real eigenvalues grow: divergence, instability without oscillation.")
        }),
    );
    items.push(format!(
        "{undecided} verdicts are undecided and count as stable. {marginal} eigenvalues lie on the imaginary axis and neither grow nor \
         decay. {failures} draws or evaluations failed; they may be unstable, and widen the limits upwards."
    ));
    items.push("Unstable means that a small vibration grows. How loud it gets does not follow from that: squeal cycle computes it, or says what of the brake it does not cover.".into());
    vec![Block::Paragraph(meaning), Block::List(items)]
}

/// The modes of a set of constraints that are ever unstable, the most robust first.
fn modes(results: &Results, set: usize, found: &SetFindings<'_>) -> Block {
    let caption = set_in_words(results, set);
    if found.unstable.is_empty() {
        return Block::Paragraph(format!("{caption}: none."));
    }
    let is_single = has_one_panel(results, set);
    let has_arrangements = results.panels().iter().any(|panel| panel.key.constraints == set && panel.arrangements > 1);
    let occurrence = |e: &Estimate| Cell { text: with_limits(e), value: Some(e.value) };
    let row = |(name, range): &(ModeLabel, ModeRange<'_>)| {
        let unstable = results.unstable_hertz(set, *name).filter(|hz| hz.range.is_some());
        let at_medians = results.frequency(set, *name);
        let mut cells = vec![
            results.mode_label(set, *name).into(),
            Cell {
                text: unstable.map_or("-".into(), |hz| hz.to_string()),
                value: Some(unstable.map_or(0.0, |hz| hz.median)),
            },
            Cell { text: at_medians.map_or("-".into(), hertz), value: Some(at_medians.unwrap_or(0.0)) },
        ];
        let strength = results.strength(set, *name);
        cells.extend(median_and_end(strength.as_ref().map(|strength| &strength.growth), |range| range.upper));
        cells.extend(median_and_end(strength.as_ref().map(|strength| &strength.damping_ratio), |range| range.lower));
        cells.push(occurrence(&range.least.0));
        if !is_single {
            cells.push(occurrence(&range.most.0));
        }
        if has_arrangements {
            cells.push(occurrence(&range.largest));
        }
        if !is_single {
            let place = if range.most.0.value > 0.0 { place(results, range.most.1) } else { "-".into() };
            cells.push(place.into());
        }
        cells
    };
    let mut columns = vec![
        "Mode",
        "Hz where unstable",
        "Hz at medians",
        "Median growth, 1/s",
        "Largest",
        "Median damping ratio",
        "Worst",
    ];
    columns.push(if is_single { "Occurrence" } else { "Least of a panel" });
    if !is_single {
        columns.push("Largest of a panel");
    }
    if has_arrangements {
        columns.push("Largest of an arrangement");
    }
    if !is_single {
        columns.push("Panel with most");
    }
    let rows = found.unstable.iter().map(row).collect();
    Block::Table(Cells { caption, columns: columns.into_iter().map(str::to_owned).collect(), rows })
}

/// Median of what was found in unstable draws, and one end of its range.
fn median_and_end(sketch: Option<&QuantileSketch>, end: impl Fn(Interval) -> f64) -> [Cell; 2] {
    let cell = |value: Option<f64>| Cell {
        text: value.map_or_else(|| "-".into(), |value| significant(value, 3)),
        value: Some(value.unwrap_or(0.0)),
    };
    [cell(sketch.and_then(|sketch| sketch.median().ok())), cell(sketch.and_then(QuantileSketch::range).map(end))]
}

/// Words on how fast a mode grows at most, and how negative its damping gets; empty where that is not known.
fn grows(results: &Results, set: usize, name: ModeLabel) -> String {
    let strength = results.strength(set, name);
    let ends =
        strength.and_then(|strength| Some((strength.growth.range()?.upper, strength.damping_ratio.range()?.lower)));
    ends.map_or_else(String::new, |(growth, damping)| {
        format!(", growing by up to {}\u{a0}1/s (damping ratio {})", significant(growth, 3), significant(damping, 3))
    })
}

/// True if a set of constraints has one panel, so that nothing need be said of panels.
fn has_one_panel(results: &Results, set: usize) -> bool {
    results.panels().iter().filter(|panel| panel.key.constraints == set).count() == 1
}

impl Results {
    /// True if each set of constraints has one panel with one arrangement, so that nothing need be said of either.
    pub fn has_one_arrangement(&self) -> bool {
        let mut sets = 0..self.plan().labels.constraints.len();
        self.panels().iter().all(|panel| panel.arrangements == 1) && sets.all(|set| has_one_panel(self, set))
    }
}

fn followed(results: &Results, link: &SetLinks, sets: &[SetFindings<'_>]) -> Block {
    let caption = format!(
        "What becomes of the modes of {} under {}, by continuation as the constraints come in; MAC compares the two shapes, occurrences are \
         the least and the largest of a panel",
        set_in_words(results, link.from),
        set_in_words(results, link.to)
    );
    let ends = |constraints: usize, name: ModeLabel| {
        let range = sets[constraints].range(name)?;
        Some(format!("{} to {}", percent(range.least.0.value), percent(range.most.0.value)))
    };
    let targets = results.modes_of_set(link.to);
    let mut rows = Vec::new();
    for (i, (name, mode)) in results.modes_of_set(link.from).into_iter().enumerate() {
        if !sets[link.from].range(name).is_some_and(|range| range.is_ever_unstable) {
            continue;
        }
        let before = [
            results.mode_label(link.from, name),
            hertz(cea::frequency_hz(mode.lambda)),
            ends(link.from, name).unwrap_or_default(),
        ];
        let open = if link.becomes[i].len() > 1 { " or another" } else { "" };
        for to in &link.becomes[i] {
            let after = match to {
                None => [format!("held{open}"), String::new(), String::new(), String::new()],
                Some(j) => {
                    let (target, mode) = targets[*j];
                    [
                        format!("{}{open}", results.mode_label(link.to, target)),
                        hertz(cea::frequency_hz(mode.lambda)),
                        format!("{:.2}", link.mac[(i, *j)]),
                        ends(link.to, target).unwrap_or_default(),
                    ]
                }
            };
            rows.push(before.iter().cloned().chain(after).map(Cell::from).collect());
        }
    }
    let columns = ["mode", "Hz at medians", "occurrence", "becomes", "Hz at medians", "MAC", "occurrence"];
    Block::Table(Cells { caption, columns: columns.map(str::to_owned).to_vec(), rows })
}

fn mode_in_words(results: &Results, set: usize, name: ModeLabel) -> String {
    if !name.is_mode() {
        return results.in_words(set, name);
    }
    let label = format!("mode {}", results.mode_label(set, name));
    results.hertz_in_words(set, name).map_or(label.clone(), |hz| format!("{label} ({hz})"))
}

fn set_in_words(results: &Results, set: usize) -> String {
    let sets = &results.plan().labels.constraints;
    match sets.len() {
        1 => format!("Constraints \u{201c}{}\u{201d}", sets[set]),
        _ => format!("Set {}, \u{201c}{}\u{201d}", set_letter(set), sets[set]),
    }
}

/// The text with a capital first letter, as a sentence begins.
fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// A fraction of the samples in percent.
fn percent(part: f64) -> String {
    format!("{:.1}\u{a0}%", 100.0 * part)
}

fn with_limits(e: &Estimate) -> String {
    format!("{} ({:.1} to {:.1})", percent(e.value), 100.0 * e.lower, 100.0 * e.upper)
}

#[cfg(test)]
mod tests {
    use super::{NAMED, drawn_in_words};

    #[test]
    fn inputs_are_named_as_far_as_there_are_few() {
        let names: Vec<String> = (1..=NAMED + 3).map(|number| format!("mu@{number}")).collect();
        assert_eq!(drawn_in_words(&[]), "all that is uncertain");
        assert_eq!(drawn_in_words(&names[..1]), "mu@1");
        assert_eq!(drawn_in_words(&names[..3]), "mu@1, mu@2 and mu@3");
        assert_eq!(drawn_in_words(&names), "mu@1, mu@2, mu@3, mu@4, mu@5, mu@6, mu@7, mu@8 and 3 more");
    }
}
