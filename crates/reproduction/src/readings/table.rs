//! The table of readings, for machines and for people.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use output::Table;

use super::product::{AXES, COUNTINGS, Combination, PaperModes};
use super::row::{BY_MAC, Card, Row, TRACKED};
use crate::Error;

/// The claims whose modes the paper numbers.
const NUMBERED: [&str; 3] = ["C4", "C8", "C10"];
/// The claims about these modes.
const OF_NUMBERED: [&str; 5] = ["C4", "C5", "C6", "C8", "C10"];
/// Rows of the coarse product in the digest.
const SHOWN: usize = 20;

/// A scorecard of one combination.
#[derive(Clone, Copy)]
pub struct Entry<'a> {
    combination: &'a Combination,
    row: &'a Row,
    /// The scorecard; `None` for a study that was refused.
    card: Option<&'a Card>,
}

impl<'a> Entry<'a> {
    /// The entries of a row: one for each way of naming modes, one without a scorecard where the study was refused.
    pub fn all(combination: &'a Combination, row: &'a Row) -> Vec<Self> {
        if row.cards.is_empty() {
            return vec![Self { combination, row, card: None }];
        }
        row.cards.iter().map(|card| Self { combination, row, card: Some(card) }).collect()
    }

    fn held(&self) -> usize {
        self.card.map_or(0, |card| card.count("yes"))
    }

    fn held_by_value(&self) -> usize {
        self.card.map_or(0, Card::held_by_value)
    }

    fn naming(&self) -> &str {
        self.card.map_or("", |card| &card.naming)
    }

    fn counting(&self) -> Option<&str> {
        self.card.and_then(|card| card.counting.as_deref())
    }

    /// Way of naming modes, and of counting the paper's numbers where these say which modes are meant.
    fn names(&self) -> String {
        let counted = self.counting().map(|counting| format!(", numbers by {counting}"));
        self.naming().to_owned() + &counted.unwrap_or_default()
    }

    /// Number of answers that depart from the paper's words; names by anything but continuation are one.
    fn departures(&self) -> usize {
        self.combination.departures() + usize::from(self.card.is_some_and(|card| card.naming != TRACKED))
    }

    /// Ranks of the modes of C4, C8 and C10.
    fn ranks(&self) -> [Option<usize>; 3] {
        NUMBERED.map(|id| self.card.and_then(|card| card.mode(id)))
    }

    fn modes(&self) -> [String; 3] {
        self.ranks().map(|rank| rank.map_or("-".into(), |rank| rank.to_string()))
    }

    /// Number of the paper's mode numbers that the scorecard has, by each way of counting.
    fn numbers(&self, paper: &PaperModes) -> [usize; COUNTINGS.len()] {
        COUNTINGS.map(|counting| {
            let theirs = paper.ranks(counting);
            self.ranks().iter().zip(theirs).filter(|(found, rank)| **found == Some(*rank)).count()
        })
    }

    /// True if the modes are those that the claims describe, whatever their numbers.
    fn is_found(&self) -> bool {
        self.card.is_some_and(|card| card.counting.is_none())
    }
}

/// The scorecards of all stages.
pub struct Stages<'a> {
    /// Scorecards with the draws that every combination gets.
    pub coarse: &'a [Entry<'a>],
    /// Scorecards with the draws of the better ones.
    pub second: &'a [Entry<'a>],
    /// Scorecards with all draws.
    pub full: &'a [Entry<'a>],
    /// Number of combinations.
    pub product: usize,
    /// The modes of C4, C8 and C10 that the paper numbers.
    pub paper: PaperModes,
}

/// Writes everything, one scorecard a line.
///
/// # Errors
/// A file that cannot be written.
pub fn write_all(path: &Path, stages: &Stages<'_>) -> Result<(), Error> {
    let Stages { coarse, second, full, paper, .. } = stages;
    let mut header: Vec<String> = AXES.iter().map(|axis| axis.name.to_string()).collect();
    header.extend(["R7 naming", "R7 counting", "departures", "samples", "failures", "refused"].map(String::from));
    header.extend(["held", "not held", "held by value"].map(String::from));
    header.extend(["mode C4", "mode C8", "mode C10"].map(String::from));
    header.extend(COUNTINGS.map(|counting| format!("numbers by {}", counting.word())));
    let claims =
        full.iter().chain(*second).chain(*coarse).find_map(|entry| entry.card).map_or(&[][..], |card| &card.claims);
    for cell in claims {
        header.extend(["holds", "by value", "value", "lower", "upper"].map(|column| format!("{} {column}", cell.id)));
    }
    let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    let row = |entry: &Entry<'_>| {
        let mut row: Vec<String> = entry.combination.labels().map(String::from).to_vec();
        let refused = entry.row.refused.clone().unwrap_or_default();
        row.extend([entry.naming(), entry.counting().unwrap_or_default()].map(String::from));
        row.push(entry.departures().to_string());
        row.extend([entry.row.samples.to_string(), entry.row.failures.to_string(), refused]);
        let not_held = entry.card.map_or(0, |card| card.count("no"));
        row.extend([entry.held(), not_held, entry.held_by_value()].map(|n| n.to_string()));
        row.extend(entry.modes());
        row.extend(entry.numbers(paper).map(|n| n.to_string()));
        for place in 0..claims.len() {
            let cell = entry.card.map(|card| &card.claims[place]);
            let limits = cell.and_then(|cell| cell.limits);
            row.extend([
                cell.map_or(String::new(), |cell| cell.holds.clone()),
                cell.map_or(String::new(), |cell| cell.by_value.clone()),
                number(cell.and_then(|cell| cell.value)),
                number(limits.map(|[lower, _]| lower)),
                number(limits.map(|[_, upper]| upper)),
            ]);
        }
        row
    };
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let table = Table::new(name, header, full.iter().chain(*second).chain(*coarse).map(row));
    Ok(table.write(path.parent().unwrap_or(Path::new("")))?)
}

/// The rule, the combinations with all draws, and a digest of the others.
pub fn markdown(stages: &Stages<'_>) -> String {
    let &Stages { coarse, second, full, product, ref paper } = stages;
    let mut text = String::from(HEAD);
    text += &verdict(full);
    text += "\n## With all draws\n\n";
    text += &rows(full, paper, |cell| &cell.holds);
    let samples = |entries: &[Entry<'_>]| entries.first().map_or(0, |entry| entry.row.samples);
    let _ = writeln!(
        text,
        "\n## The second stage\n\n{} combinations, {} draws each, judged by their values. The best, of {} scorecards:\n",
        combinations(second),
        samples(second),
        second.len()
    );
    text += &rows(&best(second), paper, |cell| &cell.by_value);
    let _ = writeln!(
        text,
        "\n## The product\n\n{} of {product} combinations run, {} draws each, judged by their values. {} are refused by \
         the model. The best, of {} scorecards:\n",
        combinations(coarse),
        samples(coarse),
        coarse.iter().filter(|entry| entry.card.is_none()).count(),
        coarse.len()
    );
    text += &rows(&best(coarse), paper, |cell| &cell.by_value);
    text += &counts(coarse);
    text += &tried(coarse);
    text += &discrimination(coarse);
    text += &mode_numbers(coarse, paper);
    text
}

fn combinations(entries: &[Entry<'_>]) -> usize {
    entries.iter().map(|entry| entry.combination.0).collect::<std::collections::BTreeSet<_>>().len()
}

/// The scorecards with the most claims, the fewest departures first among equals.
fn best<'a>(entries: &[Entry<'a>]) -> Vec<Entry<'a>> {
    let mut best = entries.to_vec();
    best.sort_by_key(|entry| (std::cmp::Reverse(entry.held_by_value()), entry.departures()));
    best.truncate(SHOWN);
    best
}

/// Table of how many scorecards hold how many claims, by the way modes are named.
fn counts(coarse: &[Entry<'_>]) -> String {
    let mut by_naming: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for entry in coarse.iter().filter(|entry| entry.card.is_some()) {
        by_naming.entry(entry.names()).or_default().push(entry.held_by_value());
    }
    let most = by_naming.values().flatten().max().copied().unwrap_or(0);
    let numbers: Vec<String> = (0..=most).map(|held| held.to_string()).collect();
    let mut text = format!(
        "\n## How many claims hold\n\nScorecards by the number of claims that hold by value, without C12.\n\n\
         | modes | {} |\n| --- |{}\n",
        numbers.join(" | "),
        " --- |".repeat(most + 1)
    );
    for (naming, held) in by_naming {
        let of = |number: usize| held.iter().filter(|held| **held == number).count().to_string();
        let _ = writeln!(text, "| {naming} | {} |", (0..=most).map(of).collect::<Vec<_>>().join(" | "));
    }
    text
}

const HEAD: &str = "\
# The readings, in all combinations

Rules, written before the run (docs/readings.md):

- The literal text, and the case's own where it says nothing, stands unless another reading holds strictly more of the
  twelve claims, each at its simultaneous 95 % limits with all draws. Of several, the one with the most; among equals the
  one with the fewest departures from the text.
- Every combination with one draw for all contacts is run with few draws, in a part of the arrangements, and judged by the
  values. Modes are named by MAC, by rank and by place among all eigenvalues; a claim counts that holds under any of these.
  Those with a draw for each contact are run in the same way where, with one draw for all and up to the preload and sigma1,
  as many claims hold as of the better of the literal text and the case's own, less two: the best first, up to a number.
  The literal text, the case's own, and those that hold at least as many claims as the better of these two less two get more
  draws, in all arrangements and with continuation too: the best first, the fewest departures from the text first among
  equals, up to a number. Of these, in the same way, those that hold as many as the better of the two less one get all draws.
- Modes: the frequency ranks of the mode of C4 (the paper's 29, of 30 degrees of freedom), of C8 (26, of 26) and of C10
  (18, of 24). Numbers agree if the mode has the paper's number when modes are counted by rank, in pairs among all
  eigenvalues, or as either from the highest frequency down (rank-down, pair-down).
- A scorecard with \"numbers by\" judges C4 to C6, C8 and C10 of the mode that has the paper's number if modes are counted so,
  the others as ever. A number departs from nothing that the paper says; among equals the scorecard that has it goes first.

";

/// Verdict by the rule.
fn verdict(full: &[Entry<'_>]) -> String {
    let of = |combination: Combination| {
        full.iter()
            .filter(|entry| *entry.combination == combination && entry.naming() == TRACKED)
            .map(Entry::held)
            .max()
    };
    let (literal, own) = (of(Combination::literal()).unwrap_or(0), of(Combination::own()).unwrap_or(0));
    let rank = |entry: &&Entry<'_>| (entry.held(), std::cmp::Reverse(entry.departures()), !entry.is_found());
    let Some(best) = full.iter().max_by_key(rank) else { return String::new() };
    let stands = if best.held() > literal {
        format!("the rule chooses: {}, modes {}, with {}", best.combination.describe(), best.names(), best.held())
    } else {
        "the literal text stands".into()
    };
    format!("The literal text holds {literal} claims, the case's own {own}; {stands}.\n")
}

fn rows(entries: &[Entry<'_>], paper: &PaperModes, verdict: impl Fn(&super::row::Cell) -> &String) -> String {
    let mut text = String::from("| reading, where it departs from the case | R7 | departures |");
    let claims = entries.iter().find_map(|entry| entry.card).map_or(&[][..], |card| &card.claims);
    claims.iter().for_each(|cell| text += &format!(" {} |", cell.id));
    text += " held | modes | numbers |\n| --- | --- | --- |";
    text += &" --- |".repeat(claims.len() + 3);
    for entry in entries {
        let _ = write!(text, "\n| {} | {} | {} |", entry.combination.describe(), entry.names(), entry.departures());
        for cell in entry.card.iter().flat_map(|card| &card.claims) {
            let value = cell.value.map_or(String::new(), |value| format!(" ({value:.3})"));
            text += &format!(" {}{value} |", verdict(cell));
        }
        let held = entry.card.map_or(0, |card| card.claims.iter().filter(|cell| verdict(cell) == "yes").count());
        let numbers = entry.numbers(paper).map(|count| count.to_string()).join(", ");
        let _ = write!(text, " {held} | {} | {numbers} |", entry.modes().join(" "));
    }
    text + "\n"
}

/// Table of what each answer does: the most claims that hold by value with it, and their mean.
fn tried(coarse: &[Entry<'_>]) -> String {
    let mut text = String::from(
        "\n## What each answer does\n\nClaims held by value under names by MAC, over all combinations run with the answer.\n\n\
         | question | answer | combinations | most | mean |\n| --- | --- | --- | --- | --- |\n",
    );
    for (i, axis) in AXES.iter().enumerate() {
        for (answer, choice) in axis.choices.iter().enumerate() {
            let by_mac = coarse.iter().filter(|entry| entry.naming() == BY_MAC && entry.is_found());
            let with = by_mac.filter(|entry| entry.combination.0[i] == answer);
            let held: Vec<usize> = with.map(Entry::held_by_value).collect();
            if let Some(most) = held.iter().max() {
                let mean = held.iter().sum::<usize>() as f64 / held.len() as f64;
                let _ = writeln!(text, "| {} | {} | {} | {most} | {mean:.2} |", axis.name, choice.label, held.len());
            }
        }
    }
    text
}

/// Table of the claims that tell readings apart.
fn discrimination(coarse: &[Entry<'_>]) -> String {
    let mut text = String::from(
        "\n## Which claims tell readings apart\n\nParts of the combinations, under names by MAC, by value.\n\n\
         | claim | yes | no |\n| --- | --- | --- |\n",
    );
    let cards: Vec<&Card> =
        coarse.iter().filter(|e| e.naming() == BY_MAC && e.is_found()).filter_map(|e| e.card).collect();
    let mut counts: BTreeMap<usize, (String, [usize; 2])> = BTreeMap::new();
    for card in &cards {
        for (place, cell) in card.claims.iter().enumerate() {
            let (_, [yes, no]) = counts.entry(place).or_insert_with(|| (cell.id.clone(), [0, 0]));
            *yes += usize::from(cell.by_value == "yes");
            *no += usize::from(cell.by_value == "no");
        }
    }
    for (id, [yes, no]) in counts.values() {
        let part = |count: &usize| *count as f64 / cards.len() as f64;
        let _ = writeln!(text, "| {id} | {:.3} | {:.3} |", part(yes), part(no));
    }
    text
}

/// Table of how many scorecards have the paper's mode numbers, and how many hold what the paper says of the modes with these numbers.
fn mode_numbers(coarse: &[Entry<'_>], paper: &PaperModes) -> String {
    let numbers = paper.numbers.map(|number| number.to_string()).join(", ");
    let mut text = format!(
        "\n## The paper's mode numbers\n\nScorecards whose modes are found by the claims, by how many of {numbers} they have.\n\n\
         | counted | none | one | two | three |\n| --- | --- | --- | --- | --- |\n",
    );
    for (place, counting) in COUNTINGS.iter().enumerate() {
        let mut counts = [0; 4];
        coarse.iter().filter(|entry| entry.is_found()).for_each(|entry| counts[entry.numbers(paper)[place]] += 1);
        let _ = writeln!(text, "| {} | {} |", counting.word(), counts.map(|n| n.to_string()).join(" | "));
    }
    let _ = writeln!(
        text,
        "\nScorecards in which a claim holds by value of the mode that has the paper's number.\n\n\
         | modes | scorecards | {} | C5 and C6 | all |\n| --- | --- |{}",
        OF_NUMBERED.join(" | "),
        " --- |".repeat(OF_NUMBERED.len() + 2)
    );
    let mut by_names: BTreeMap<String, Vec<&Card>> = BTreeMap::new();
    for entry in coarse.iter().filter(|entry| entry.counting().is_some()) {
        by_names.entry(entry.names()).or_default().extend(entry.card);
    }
    for (names, cards) in by_names {
        let holding = |ids: &[&str]| cards.iter().filter(|card| card.holds_by_value(ids)).count().to_string();
        let each: Vec<String> = OF_NUMBERED.iter().map(|id| holding(&[id])).collect();
        let (both, all) = (holding(&["C5", "C6"]), holding(&OF_NUMBERED));
        let _ = writeln!(text, "| {names} | {} | {} | {both} | {all} |", cards.len(), each.join(" | "));
    }
    text
}
