//! The product of all readings of what the paper leaves open, as a table with every claim.
//!
//! Every combination is run with few draws; the best by the values, the case and the paper's words with many. The rule of
//! this selection, and that by which a reading becomes the default, stand in docs/readings.md and in the table's head.

mod onsets;
mod product;
mod row;
mod table;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use squeal::case::LatticeCase;
use squeal::output::{make_folder, write};
use toml::Table;

use crate::error::TaskError;
use product::{Combination, product, read_tables};
use row::{Row, Store};
use table::Entry;

/// Every reading of what the paper leaves open, in all combinations, with a scorecard each
///
/// Stopped, even killed, it goes on where it was; the rows it has are in OUT/rows.
#[derive(Debug, clap::Args)]
pub struct ReadingsArgs {
    /// Draws of each combination
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u64).range(1..))]
    samples: u64,
    /// Draws of the best, and of the case and the paper's words
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..))]
    full: u64,
    /// Most combinations that are run with as many
    #[arg(long, value_name = "M", default_value_t = 12)]
    best: usize,
    /// Begin no combination after so many minutes, and make the table of what there is
    #[arg(long, value_name = "MINUTES")]
    minutes: Option<f64>,
    /// Only print at which friction coefficient each mode becomes unstable, under every reading of the structure
    #[arg(long)]
    onsets: bool,
    /// Folder for the results [default: target/readings]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Runs the task.
pub fn run(args: &ReadingsArgs) -> Result<(), TaskError> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let path = root.join("cases/paper.toml");
    let case = read_tables(&path)?;
    if args.onsets {
        print!("{}", onsets::markdown(&path, &case)?);
        return Ok(());
    }
    let out = args.out.clone().unwrap_or_else(|| root.join("target/readings"));
    let store = Store::new(&out)?;
    let deadline = args.minutes.map(|minutes| Instant::now() + Duration::from_secs_f64(60.0 * minutes.max(0.0)));
    let of = |combination: &Combination, samples: u64| -> Result<LatticeCase, TaskError> {
        let mut case = combination.case(&path, &case)?;
        case.samples = samples;
        Ok(case)
    };

    let all = product();
    let paper = product::mode_numbers(&path, &case)?;
    let coarse = run_all(&store, &all, |combination| of(combination, args.samples), deadline)?;
    let best = selected(&coarse, args.best);
    eprintln!("{} combinations with {} draws", best.len(), args.full);
    let full = run_all(&store, &best, |combination| of(combination, args.full), None)?;
    save_cases(&out, &full, &case)?;

    let coarse = entries(&coarse);
    let full = entries(&full);
    table::write_all(&out.join("readings.csv"), &coarse, &full, paper)?;
    let text = table::markdown(&coarse, &full, all.len(), paper);
    write(&out.join("readings.md"), text.as_bytes())?;
    println!("{text}\nThe whole table: {}", out.join("readings.csv").display());
    Ok(())
}

/// The rows of some combinations, those that are not known run, as many as the deadline allows.
fn run_all(
    store: &Store,
    combinations: &[Combination],
    case: impl Fn(&Combination) -> Result<LatticeCase, TaskError>,
    deadline: Option<Instant>,
) -> Result<Vec<(Combination, Row)>, TaskError> {
    let mut rows = Vec::with_capacity(combinations.len());
    let mut open = Vec::new();
    for combination in combinations {
        let case = case(combination)?;
        match store.known(&case) {
            Some(row) => rows.push((*combination, row)),
            None => open.push((*combination, case)),
        }
    }
    let mean = |rows: &[(Combination, Row)]| {
        let seconds: f64 = rows.iter().map(|(_, row)| row.seconds).sum();
        (!rows.is_empty()).then(|| seconds / rows.len() as f64)
    };
    let count = open.len();
    match mean(&rows) {
        Some(seconds) => eprintln!(
            "{} combinations, {count} to be run: roughly {:.0} minutes at {seconds:.1} s each",
            combinations.len(),
            seconds * count as f64 / 60.0
        ),
        None => eprintln!("{} combinations to be run; the first tells how long each takes", combinations.len()),
    }
    for (number, (combination, case)) in open.into_iter().enumerate() {
        if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            eprintln!("stopped: {} combinations are left; the same command goes on", count - number);
            break;
        }
        let row = store.row(case)?;
        rows.push((combination, row));
        let left = mean(&rows).unwrap_or(0.0) * (count - number - 1) as f64 / 60.0;
        let (_, row) = &rows[rows.len() - 1];
        eprintln!(
            "{} of {count}, {:.1} s, {left:.0} minutes left: {}",
            number + 1,
            row.seconds,
            combination.describe()
        );
    }
    Ok(rows)
}

/// The combinations worth all draws: the paper's words, the case, and of the others those that hold by value, under any way of
/// naming modes, at least as many claims as the better of these two less one; the best of them, the fewest departures first
/// among equals.
fn selected(coarse: &[(Combination, Row)], most: usize) -> Vec<Combination> {
    let score = |row: &Row| row.cards.iter().map(|card| card.held_by_value()).max().unwrap_or(0);
    let mut selected = vec![Combination::literal(), Combination::own()];
    let of_selected = coarse.iter().filter(|(combination, _)| selected.contains(combination));
    let least = of_selected.map(|(_, row)| score(row)).max().unwrap_or(0).saturating_sub(1);
    let mut others: Vec<_> =
        coarse.iter().filter(|(c, row)| !selected.contains(c) && score(row) >= least.max(1)).collect();
    others.sort_by_key(|(combination, row)| (std::cmp::Reverse(score(row)), combination.departures()));
    selected.extend(others.iter().take(most).map(|(combination, _)| *combination));
    selected
}

fn entries(rows: &[(Combination, Row)]) -> Vec<Entry<'_>> {
    let of_row = |(combination, row)| Entry::all(combination, row);
    rows.iter().map(|(combination, row)| (combination, row)).flat_map(of_row).collect()
}

/// The case file of each combination that was run with all draws, for `squeal run`.
fn save_cases(out: &Path, full: &[(Combination, Row)], case: &Table) -> Result<(), TaskError> {
    let folder = out.join("cases");
    make_folder(&folder)?;
    for (combination, _) in full {
        let digits: String = combination.0.iter().map(ToString::to_string).collect();
        write(&folder.join(format!("{digits}.toml")), combination.text(case)?.as_bytes())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use row::{Card, Cell};

    /// A row of which the first claims hold by value.
    fn row(held: usize) -> Row {
        let cell = |i: usize| Cell {
            id: format!("C{}", i + 1),
            holds: "?".into(),
            by_value: if i < held { "yes" } else { "no" }.into(),
            value: None,
            limits: None,
            mode: None,
        };
        let cards = vec![Card { naming: "tracked".into(), claims: (0..12).map(cell).collect() }];
        Row { samples: 64, failures: 0, seconds: 1.0, refused: None, cards }
    }

    #[test]
    fn the_best_of_those_that_come_near_the_case_are_selected() {
        let (own, literal) = (Combination::own(), Combination::literal());
        let others: Vec<_> = product().into_iter().filter(|c| ![own, literal].contains(c)).take(4).collect();
        let held = [7, 5, 5, 6, 8, 7];
        let all: Vec<_> = [own, literal].iter().chain(&others).zip(held).map(|(c, held)| (*c, row(held))).collect();
        assert_eq!(selected(&all, 12), [literal, own, others[2], others[3], others[1]]);
        assert_eq!(selected(&all, 1), [literal, own, others[2]]);
    }
}
