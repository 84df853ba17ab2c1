//! The table of readings, for machines and for people.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use squeal::output::write_csv;

use super::product::{AXES, Combination};
use super::row::{BY_MAC, Card, Row, TRACKED};
use crate::error::TaskError;

/// The claims whose modes the paper numbers.
const NUMBERED: [&str; 3] = ["C4", "C8", "C10"];
/// Rows of the coarse product in the digest.
const SHOWN: usize = 20;

/// One scorecard of one combination.
#[derive(Clone, Copy)]
pub struct Entry<'a> {
    combination: &'a Combination,
    row: &'a Row,
    /// `None` for a study that was refused.
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

    /// In how many answers it departs from the paper's words.
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

    /// How many of the paper's mode numbers it has: counted as frequency ranks, and among all eigenvalues.
    fn numbers(&self, paper: [usize; 3]) -> [usize; 2] {
        let agree = |rank: fn(usize) -> usize| {
            self.ranks().iter().zip(paper).filter(|(found, number)| **found == Some(rank(*number))).count()
        };
        [agree(|number| number), agree(|number| number.div_ceil(2))]
    }
}

/// The scorecards of all stages.
pub struct Stages<'a> {
    /// With the draws that every combination gets.
    pub coarse: &'a [Entry<'a>],
    /// With those of the better ones.
    pub second: &'a [Entry<'a>],
    /// With all draws.
    pub full: &'a [Entry<'a>],
    /// How many combinations there are.
    pub product: usize,
    /// The paper's mode numbers of C4, C8 and C10.
    pub paper: [usize; 3],
}

/// Writes everything, one scorecard a line.
///
/// # Errors
/// A file that cannot be written.
pub fn write_all(path: &Path, stages: &Stages<'_>) -> Result<(), TaskError> {
    let &Stages { coarse, second, full, paper, .. } = stages;
    let mut header: Vec<String> = AXES.iter().map(|axis| axis.name.to_string()).collect();
    header.extend(["R7 naming", "departures", "samples", "failures", "refused"].map(String::from));
    header.extend(["held", "not held", "held by value"].map(String::from));
    header.extend(["mode C4", "mode C8", "mode C10", "numbers by rank", "numbers by pair"].map(String::from));
    let claims =
        full.iter().chain(second).chain(coarse).find_map(|entry| entry.card).map_or(&[][..], |card| &card.claims);
    for cell in claims {
        header.extend(["holds", "by value", "value", "lower", "upper"].map(|column| format!("{} {column}", cell.id)));
    }
    let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    let row = |entry: &Entry<'_>| {
        let mut row: Vec<String> = entry.combination.labels().map(String::from).to_vec();
        let refused = entry.row.refused.clone().unwrap_or_default();
        row.extend([entry.naming().to_owned(), entry.departures().to_string()]);
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
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    Ok(write_csv(path, &header, full.iter().chain(second).chain(coarse).map(row))?)
}

/// The rule, the combinations with all draws, and a digest of the others.
pub fn markdown(stages: &Stages<'_>) -> String {
    let &Stages { coarse, second, full, product, paper } = stages;
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

/// How many scorecards hold how many claims, by the way modes are named.
fn counts(coarse: &[Entry<'_>]) -> String {
    let mut by_naming: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for entry in coarse.iter().filter(|entry| entry.card.is_some()) {
        by_naming.entry(entry.naming()).or_default().push(entry.held_by_value());
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
  (18, of 24). Numbers agree if the rank is the number, or if the rank's pair of all eigenvalues has it: 15, 13 and 9.

";

/// What the rule says.
fn verdict(full: &[Entry<'_>]) -> String {
    let of = |combination: Combination| {
        full.iter()
            .filter(|entry| *entry.combination == combination && entry.naming() == TRACKED)
            .map(Entry::held)
            .max()
    };
    let (literal, own) = (of(Combination::literal()).unwrap_or(0), of(Combination::own()).unwrap_or(0));
    let rank = |entry: &&Entry<'_>| (entry.held(), std::cmp::Reverse(entry.departures()));
    let Some(best) = full.iter().max_by_key(rank) else { return String::new() };
    let stands = if best.held() > literal {
        format!("the rule chooses: {}, modes {}, with {}", best.combination.describe(), best.naming(), best.held())
    } else {
        "the literal text stands".into()
    };
    format!("The literal text holds {literal} claims, the case's own {own}; {stands}.\n")
}

fn rows(entries: &[Entry<'_>], paper: [usize; 3], verdict: impl Fn(&super::row::Cell) -> &String) -> String {
    let mut text = String::from("| reading, where it departs from the case | R7 | departures |");
    let claims = entries.iter().find_map(|entry| entry.card).map_or(&[][..], |card| &card.claims);
    claims.iter().for_each(|cell| text += &format!(" {} |", cell.id));
    text += " held | modes | numbers |\n| --- | --- | --- |";
    text += &" --- |".repeat(claims.len() + 3);
    for entry in entries {
        let _ = write!(text, "\n| {} | {} | {} |", entry.combination.describe(), entry.naming(), entry.departures());
        for cell in entry.card.iter().flat_map(|card| &card.claims) {
            let value = cell.value.map_or(String::new(), |value| format!(" ({value:.3})"));
            text += &format!(" {}{value} |", verdict(cell));
        }
        let held = entry.card.map_or(0, |card| card.claims.iter().filter(|cell| verdict(cell) == "yes").count());
        let [by_rank, by_pair] = entry.numbers(paper);
        let _ = write!(text, " {held} | {} | {by_rank}, {by_pair} |", entry.modes().join(" "));
    }
    text + "\n"
}

/// What each answer does: the most claims that hold by value with it, and their mean.
fn tried(coarse: &[Entry<'_>]) -> String {
    let mut text = String::from(
        "\n## What each answer does\n\nClaims held by value under names by MAC, over all combinations run with the answer.\n\n\
         | question | answer | combinations | most | mean |\n| --- | --- | --- | --- | --- |\n",
    );
    for (i, axis) in AXES.iter().enumerate() {
        for (answer, choice) in axis.choices.iter().enumerate() {
            let with = coarse.iter().filter(|entry| entry.combination.0[i] == answer && entry.naming() == BY_MAC);
            let held: Vec<usize> = with.map(Entry::held_by_value).collect();
            if let Some(most) = held.iter().max() {
                let mean = held.iter().sum::<usize>() as f64 / held.len() as f64;
                let _ = writeln!(text, "| {} | {} | {} | {most} | {mean:.2} |", axis.name, choice.label, held.len());
            }
        }
    }
    text
}

/// Which claims tell readings apart.
fn discrimination(coarse: &[Entry<'_>]) -> String {
    let mut text = String::from(
        "\n## Which claims tell readings apart\n\nParts of the combinations, under names by MAC, by value.\n\n\
         | claim | yes | no |\n| --- | --- | --- |\n",
    );
    let cards: Vec<&Card> = coarse.iter().filter(|entry| entry.naming() == BY_MAC).filter_map(|e| e.card).collect();
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

/// How many scorecards have the paper's mode numbers.
fn mode_numbers(coarse: &[Entry<'_>], paper: [usize; 3]) -> String {
    let mut text = String::from(
        "\n## The paper's mode numbers\n\nScorecards by how many of 29, 26 and 18 they have.\n\n\
         | counted | none | one | two | three |\n| --- | --- | --- | --- | --- |\n",
    );
    for (place, counted) in ["as frequency ranks", "among all eigenvalues"].into_iter().enumerate() {
        let mut counts = [0; 4];
        coarse.iter().filter(|entry| entry.card.is_some()).for_each(|entry| counts[entry.numbers(paper)[place]] += 1);
        let _ = writeln!(text, "| {counted} | {} |", counts.map(|n| n.to_string()).join(" | "));
    }
    text
}
