//! The comparison in words.

use std::fmt::Write as _;

use output::{hertz, printable};

use super::{Against, Compared, ComparedStudies, Link, LinkedBy};

/// Most lines of a study; the table has all. Chosen: a screen.
const MOST_LINES: usize = 20;

impl ComparedStudies {
    /// The comparison in words: of each study what changes most first.
    #[must_use]
    pub fn text(&self) -> String {
        self.others
            .iter()
            .map(|other| of_study(other, &self.first.display().to_string()))
            .collect::<Vec<_>>()
            .join("\n")
    }

    /// The same as Markdown.
    #[must_use]
    pub fn summary(&self) -> String {
        let lines = |text: &str| -> String {
            let item = |line: &str| match line.strip_prefix("  ") {
                Some(item) => format!("- {item}\n"),
                None => format!("\n**{line}**\n\n"),
            };
            text.lines().map(item).collect()
        };
        format!(
            "# Studies side by side\n\nDifferences of the occurrence of modes, each with its own 95 % interval: of many modes one in twenty may \
             differ by chance.\n{}",
            lines(&self.text())
        )
    }
}

fn of_study(other: &Against, first: &str) -> String {
    let mut text = printable(&format!("{} against {first}: {}", other.path.display(), other.notes.join("; "))) + "\n";
    // A mode that is linked to none differs by all that it has.
    let of_one = |row: &Compared| {
        let parts = row.occurrences.iter().flatten().filter_map(|of| of.estimate()).map(|part| part.lower);
        parts.fold(0.0, f64::max)
    };
    let size = |row: &Compared| match row.difference {
        Some((difference, _)) => difference.value.map_or(0.0, f64::abs),
        None => of_one(row),
    };
    let mut rows: Vec<&Compared> = other.rows.iter().filter(|row| is_ever(row)).collect();
    rows.sort_by(|a, b| size(b).total_cmp(&size(a)));
    for row in rows.iter().take(MOST_LINES) {
        let scene: Vec<&str> = row.scene.iter().map(String::as_str).filter(|name| !name.is_empty()).collect();
        let _ = writeln!(text, "{}", printable(&format!("  {}: {}", scene.join(", "), in_words(row))));
    }
    if rows.is_empty() {
        text += "  nothing is ever unstable in either\n";
    }
    if rows.len() > MOST_LINES {
        let _ = writeln!(text, "  and {} more with smaller differences, in compare.csv", rows.len() - MOST_LINES);
    }
    text
}

/// True if anything is or may be unstable.
fn is_ever(row: &Compared) -> bool {
    row.occurrences.iter().flatten().any(|of| of.hits() + of.ambiguous() > 0)
}

fn in_words(row: &Compared) -> String {
    let what = match &row.link {
        None => "anything unstable".to_owned(),
        Some(link) => mode_in_words(link),
    };
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
