//! The comparison in words.

use std::collections::BTreeSet;

use montecarlo::Difference;
use output::{hertz, printable};

use super::folder::SceneNames;
use super::{Against, Compared, ComparedStudies, Link, LinkedBy};

/// Most lines of a study; the table has all. Chosen: a screen.
const MOST_LINES: usize = 20;

impl ComparedStudies {
    /// What the numbers are, for whoever reads them.
    pub const ABOUT: &str = "Differences of the occurrence of modes, each with its own 95 % interval: of many modes one in twenty may differ by chance.";

    /// Of each study a heading, and lines on what changes, what changes most first.
    #[must_use]
    pub fn said(&self) -> Vec<(String, Vec<String>)> {
        let first = self.first.display().to_string();
        self.others.iter().map(|other| (heading(other, &first), lines(other))).collect()
    }

    /// The comparison in words.
    #[must_use]
    pub fn text(&self) -> String {
        let one = |(heading, lines): (String, Vec<String>)| {
            let lines: String = lines.iter().map(|line| format!("  {line}\n")).collect();
            format!("{heading}\n{lines}")
        };
        self.said().into_iter().map(one).collect::<Vec<_>>().join("\n")
    }

    /// The same as Markdown.
    #[must_use]
    pub fn summary(&self) -> String {
        let one = |(heading, lines): (String, Vec<String>)| {
            let lines: String = lines.iter().map(|line| format!("- {line}\n")).collect();
            format!("\n**{heading}**\n\n{lines}")
        };
        format!("# Studies side by side\n\n{}\n{}", Self::ABOUT, self.said().into_iter().map(one).collect::<String>())
    }
}

fn heading(other: &Against, first: &str) -> String {
    printable(&format!("{} against {first}: {}", other.path.display(), other.notes.join("; ")))
}

fn lines(other: &Against) -> Vec<String> {
    let rows = other.largest_first();
    let line = |row: &Compared| {
        let swap = other.swapped_with(row).map_or_else(String::new, |partner| {
            format!("; the change of {} cancels it, as where two modes swap their names", partner.name_in_words())
        });
        printable(&format!("{}: {}{swap}", row.scene_in_words(), in_words(row)))
    };
    let mut lines: Vec<String> = Vec::new();
    let mut told: BTreeSet<&SceneNames> = BTreeSet::new();
    for row in rows.iter().take(MOST_LINES) {
        // Whether anything squeals stands before the names of what does.
        if told.insert(&row.scene) {
            lines.extend(rows.iter().find(|any| any.link.is_none() && any.scene == row.scene).map(|any| line(any)));
        }
        if row.link.is_some() {
            lines.push(line(row));
        }
    }
    if rows.is_empty() {
        lines.push("nothing is ever unstable in either".into());
    }
    if rows.len() > MOST_LINES {
        lines.push(format!("and {} more with smaller differences, in compare.csv", rows.len() - MOST_LINES));
    }
    lines
}

/// Largest ratio of the frequencies of two modes that may meet; chosen: a third octave.
const APART: f64 = 1.26;

/// True if two modes are near enough in frequency, in any of the studies, to swap their names.
fn may_meet(a: &Compared, b: &Compared) -> bool {
    let hertz = |of: &Compared| -> Vec<f64> { of.link.iter().flat_map(|link| link.hz).flatten().collect() };
    let others = hertz(b);
    hertz(a).into_iter().any(|x| others.iter().any(|y| x.max(*y) <= APART * x.min(*y)))
}

/// Largest sum of two changes that cancel, as a fraction of the larger one; chosen.
const LEFT: f64 = 0.2;

impl Against {
    /// The mode of the same scene, of much the same frequency, whose change cancels the change of `row`, as where two modes that meet swap their names; `None`
    /// where the change of `row` is not sure, or no sure change cancels it.
    #[must_use]
    pub fn swapped_with(&self, row: &Compared) -> Option<&Compared> {
        let change = sure_change(row)?;
        let of_scene = self.rows.iter().filter(|other| other.scene == row.scene);
        let changes = of_scene.filter_map(|other| Some((other, sure_change(other)?)));
        let cancels = |other: f64| (change + other).abs() <= LEFT * change.abs().max(other.abs());
        changes
            .filter(|(other, change)| cancels(*change) && may_meet(row, other))
            .min_by(|a, b| (change + a.1).abs().total_cmp(&(change + b.1).abs()))
            .map(|(other, _)| other)
    }

    /// What is ever unstable in either study, the largest difference first.
    #[must_use]
    pub fn largest_first(&self) -> Vec<&Compared> {
        // A mode that is linked to none differs by all that it has.
        let of_one = |row: &Compared| {
            let parts = row.occurrences.iter().flatten().filter_map(|of| of.estimate()).map(|part| part.lower);
            parts.fold(0.0, f64::max)
        };
        let size = |row: &Compared| match row.difference {
            Some((difference, _)) => difference.value.map_or(0.0, f64::abs),
            None => of_one(row),
        };
        let mut rows: Vec<&Compared> = self.rows.iter().filter(|row| is_ever(row)).collect();
        rows.sort_by(|a, b| size(b).total_cmp(&size(a)));
        rows
    }
}

impl Compared {
    /// Name of what is compared: modes of both studies with their frequencies, or anything at all.
    #[must_use]
    pub fn name_in_words(&self) -> String {
        self.link.as_ref().map_or_else(|| "anything unstable".to_owned(), mode_in_words)
    }

    /// The scene: constraints, law, speed and contacts.
    #[must_use]
    pub fn scene_in_words(&self) -> String {
        let names: Vec<&str> = self.scene.iter().map(String::as_str).filter(|name| !name.is_empty()).collect();
        names.join(", ")
    }
}

/// Change of the occurrence of a mode, where it is sure; the whole occurrence of a mode that is linked to no mode of the other study.
fn sure_change(row: &Compared) -> Option<f64> {
    row.link.as_ref()?;
    let value = |at: usize| row.occurrences[at].and_then(|of| of.estimate()).map(|part| part.lower);
    let change = match (row.difference, value(0), value(1)) {
        (Some((Difference { value, interval }, _)), ..) => {
            value.filter(|_| interval.lower > 0.0 || interval.upper < 0.0)?
        }
        (None, Some(first), _) => -first,
        (None, None, second) => second?,
    };
    (change != 0.0).then_some(change)
}

/// True if anything is or may be unstable.
fn is_ever(row: &Compared) -> bool {
    row.occurrences.iter().flatten().any(|of| of.hits() + of.ambiguous() > 0)
}

fn in_words(row: &Compared) -> String {
    let what = row.name_in_words();
    let value = |at: usize| row.occurrences[at].and_then(|of| of.estimate()).map(|part| part.lower);
    let [first, second] = [value(0), value(1)].map(|of| of.map_or_else(|| "?".into(), |of| format!("{of:.4}")));
    match row.difference {
        Some((difference, how)) => {
            let (lower, upper) = (difference.interval.lower, difference.interval.upper);
            let sure = if lower > 0.0 {
                "more often"
            } else if upper < 0.0 {
                "less often"
            } else {
                "no sure difference"
            };
            let value = difference.value.unwrap_or(f64::NAN);
            format!(
                "{what}: {first} -> {second}, {value:+.4} (95 %, {}: {lower:+.4} to {upper:+.4}): {sure}",
                how.name()
            )
        }
        None if row.occurrences[0].is_some() => format!("{what}: {first} -> linked to no mode there"),
        None => format!("{what}: linked to no mode before -> {second}"),
    }
}

fn mode_in_words(Link { modes, hz, by }: &Link) -> String {
    let named = |at: usize| match (&modes[at], hz[at]) {
        (Some(name), Some(hz)) => Some(format!("{name} ({} Hz)", hertz(hz))),
        (name, _) => name.clone(),
    };
    let how = match by {
        Some(LinkedBy::Shape { mac }) => format!(", MAC {mac:.3}"),
        Some(LinkedBy::Frequency) => ", by frequency".into(),
        Some(LinkedBy::Name) | None => String::new(),
    };
    match (named(0), named(1)) {
        (Some(first), Some(second)) if hz[0].is_some() => format!("mode {first} -> {second}{how}"),
        (Some(name), Some(_)) => {
            if name == "unnamed" {
                "modes without a name".into()
            } else {
                name
            }
        }
        (Some(name), None) | (None, Some(name)) => format!("mode {name}"),
        (None, None) => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use montecarlo::{Confidence, Proportion, independent_difference};

    use super::*;
    use crate::compare::Pairing;

    /// Modes by the numbers of 1000 samples in which they are unstable, before and after; `None` where linked to nothing.
    fn against(counts: &[[Option<u64>; 2]]) -> Against {
        let scene: SceneNames = ["none", "law", "all", "1", "all"].map(str::to_owned);
        let row = |(at, counts): (usize, &[Option<u64>; 2])| {
            let modes = counts.map(|count| count.map(|_| (at + 1).to_string()));
            let occurrences = counts.map(|count| count.map(|hits| Proportion::of_counts(hits, 0, 1000)));
            let [first, second] = &occurrences;
            let difference = first.as_ref().zip(second.as_ref());
            let difference =
                difference.map(|(a, b)| (independent_difference(a, b, Confidence::P95), Pairing::Independent));
            let link = Link { modes, hz: counts.map(|count| count.map(|_| 100.0)), by: None };
            Compared { scene: scene.clone(), link: Some(link), occurrences, difference }
        };
        Against { path: "b".into(), notes: Vec::new(), rows: counts.iter().enumerate().map(row).collect() }
    }

    #[test]
    fn changes_that_cancel_within_a_scene_are_said_to_be_a_swap() {
        for (counts, swapped) in [
            (
                &[[Some(400), Some(10)], [Some(12), Some(395)], [Some(300), Some(310)]][..],
                &[Some(1), Some(0), None][..],
            ),
            (&[[Some(400), None], [None, Some(410)]], &[Some(1), Some(0)]),
            (&[[Some(400), Some(200)], [Some(100), Some(150)]], &[None, None]),
            (&[[Some(400), Some(200)], [Some(100), Some(100)]], &[None, None]),
            // Within chance there is nothing to cancel.
            (&[[Some(400), Some(395)], [Some(100), Some(105)]], &[None, None]),
        ] {
            let against = against(counts);
            for (row, partner) in against.rows.iter().zip(swapped) {
                let found = against.swapped_with(row).map(Compared::name_in_words);
                assert_eq!(found, partner.map(|at: usize| against.rows[at].name_in_words()), "{counts:?}");
                // Far apart in frequency they swap nothing.
                let mut apart = self::against(counts);
                for (row, hz) in apart.rows.iter_mut().zip([100.0, 150.0, 225.0]) {
                    let link = row.link.as_mut().unwrap();
                    link.hz = link.hz.map(|of| of.map(|_| hz));
                }
                assert!(apart.rows.iter().all(|row| apart.swapped_with(row).is_none()));
                assert_eq!(
                    lines(&against).iter().any(|line| line.contains("cancels it")),
                    swapped.iter().any(Option::is_some)
                );
            }
        }
    }
}
