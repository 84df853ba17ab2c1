//! The product of all readings of what the paper leaves open, as a table with every claim.
//!
//! Every combination with one draw for all contacts is run with few draws, and of those with a draw for each contact the ones that are
//! good with one for all; the best by the values, the case and the paper's words with more, and the best of these with all. The
//! rule of this selection, and that by which a reading becomes the default, stand in docs/readings.md and in the table's head.

mod family;
mod onsets;
mod product;
mod row;
mod run;
mod store;
mod table;
mod thin;

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use brakes::case::LatticeCase;
use output::{make_folder, write};
use squeal::study::ModeIdentity;
use squeal_cli::terminal::{note, say};
use toml::Table;

use crate::Error;
use product::{Combination, by_what_is_shared, product, read_tables};
use row::Row;
use run::Stage;
use store::Store;
use table::Entry;
use thin::thin;

/// Number of claims by which a combination may fall short of the better of the case and the paper's words and still be run with more
/// draws, after the few draws that all get. Written before the product was run.
const COARSE_SLACK: usize = 2;
/// The same after the draws of the second stage.
const SECOND_SLACK: usize = 1;

/// Every reading of what the paper leaves open, in all combinations, with a scorecard each
///
/// Stopped, even killed, it goes on where it was; the rows it has are in OUT/rows.
#[derive(Debug, clap::Args)]
pub struct ReadingsArgs {
    /// Draws of each combination
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u64).range(1..))]
    samples: u64,
    /// Most groups, of combinations that have much in common, that are run with a draw for each contact too
    #[arg(long, value_name = "M", default_value_t = 40)]
    each: usize,
    /// Draws of the better ones, and of the case and the paper's words
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u64).range(1..))]
    second: u64,
    /// Most combinations that are run with as many
    #[arg(long, value_name = "M", default_value_t = 30)]
    better: usize,
    /// Draws of the best of these, and of the case and the paper's words
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..))]
    full: u64,
    /// Most combinations that are run with as many
    #[arg(long, value_name = "M", default_value_t = 5)]
    best: usize,
    /// Groups of combinations run at once [default: one per core]; the results do not depend on it, nor on RAYON_NUM_THREADS,
    /// which bounds the threads within one
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    threads: Option<u64>,
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

/// Runs the task in the checkout `root`.
///
/// # Errors
/// A case that cannot be read, a folder that cannot be written.
pub fn run(args: &ReadingsArgs, root: &Path) -> Result<(), Error> {
    let path = root.join("cases/paper.toml");
    let case = read_tables(&path)?;
    if args.onsets {
        print!("{}", onsets::markdown(&path, &case)?);
        return Ok(());
    }
    let out = args.out.clone().unwrap_or_else(|| root.join("target/readings"));
    let store = Store::new(&out)?;
    let deadline = args.minutes.map(|minutes| Instant::now() + Duration::from_secs_f64(60.0 * minutes.max(0.0)));
    let of = |combination: &Combination, samples: u64| -> Result<LatticeCase, Error> {
        let mut case = combination.case(&path, &case)?;
        case.header.samples = samples;
        Ok(case)
    };

    let all = product();
    let paper = product::paper_modes(&path, &case)?;
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let workers = args.threads.map_or_else(cores, |threads| usize::try_from(threads).unwrap_or(usize::MAX));
    let coarse_case = |combination: &Combination| {
        let mut case = of(combination, args.samples)?;
        // To follow modes takes several times as long as all else.
        case.readings.identity = ModeIdentity::Mac;
        thin(&mut case)?;
        Ok(case)
    };
    let shared: Vec<Combination> = all.iter().copied().filter(Combination::shares_draws).collect();
    let shared = run_all(&store, &shared, Stage::Coarse, workers, coarse_case, deadline)?;
    let with_each = with_each_draw(&selected(&shared, COARSE_SLACK, shared.len()), args.each);
    let each = run_all(&store, &with_each, Stage::Coarse, workers, coarse_case, deadline)?;
    let coarse: Vec<_> = shared.into_iter().chain(each).collect();
    let better = selected(&coarse, COARSE_SLACK, args.better);
    let second = run_all(&store, &better, Stage::Second, workers, |c| of(c, args.second), deadline)?;
    let best = selected(&second, SECOND_SLACK, args.best);
    let full = run_all(&store, &best, Stage::Full, 1, |c| of(c, args.full), deadline)?;
    save_cases(&out, &full, &case)?;

    let [coarse, second, full] = [&coarse, &second, &full].map(|rows| entries(rows));
    let stages = table::Stages { coarse: &coarse, second: &second, full: &full, product: all.len(), paper };
    table::write_all(&out.join("readings.csv"), &stages)?;
    let text = table::markdown(&stages);
    write(&out.join("readings.md"), text.as_bytes())?;
    say(&format!("{text}\nThe whole table: {}\n", out.join("readings.csv").display()))?;
    Ok(())
}

/// The rows of `combinations`; those that are not known are run, as many as the deadline allows. `workers` groups of combinations
/// that have much in common are run at once.
fn run_all(
    store: &Store,
    combinations: &[Combination],
    stage: Stage,
    workers: usize,
    case: impl Fn(&Combination) -> Result<LatticeCase, Error>,
    deadline: Option<Instant>,
) -> Result<Vec<(Combination, Row)>, Error> {
    let groups = match stage {
        Stage::Coarse | Stage::Second => by_what_is_shared(combinations),
        Stage::Full => combinations.iter().map(|combination| vec![*combination]).collect(),
    };
    let (mut rows, mut open) = (Vec::with_capacity(combinations.len()), VecDeque::new());
    for group in groups {
        let cases = group.iter().map(&case).collect::<Result<Vec<_>, _>>()?;
        match store.known(&cases) {
            Some(known) => rows.extend(group.into_iter().zip(known)),
            None => open.push_back((group, cases)),
        }
    }
    let left = |open: &VecDeque<(Vec<Combination>, _)>| open.iter().map(|(group, _)| group.len()).sum::<usize>();
    let (count, start) = (left(&open), Instant::now());
    note(&format!("{} combinations, {count} to be run", combinations.len()));
    let (open, rows, failed) = (Mutex::new(open), Mutex::new(rows), Mutex::new(None));
    let next = || {
        let is_over = deadline.is_some_and(|deadline| Instant::now() >= deadline) || locked(&failed).is_some();
        if is_over { None } else { locked(&open).pop_front() }
    };
    let work = || {
        while let Some((group, cases)) = next() {
            match store.rows(cases, stage) {
                Ok(found) => locked(&rows).extend(group.iter().copied().zip(found)),
                Err(error) => *locked(&failed) = Some(error),
            }
            let (still, minutes) = (left(&locked(&open)), start.elapsed().as_secs_f64() / 60.0);
            let done = count - still;
            let words = group.first().map_or(String::new(), Combination::describe);
            note(&format!(
                "{done} of {count} begun, {minutes:.1} minutes, {:.0} left: {words}",
                minutes * still as f64 / done.max(1) as f64
            ));
        }
    };
    std::thread::scope(|scope| (0..workers).for_each(|_| drop(scope.spawn(work))));
    if let Some(error) = into_inner(failed) {
        return Err(error);
    }
    let still = left(&into_inner(open));
    if still > 0 {
        note(&format!("stopped: {still} combinations are left; the same command goes on"));
    }
    let mut rows = into_inner(rows);
    let order: std::collections::HashMap<_, _> = combinations.iter().zip(0..).map(|(c, at)| (c.0, at)).collect();
    rows.sort_by_key(|(combination, _)| order.get(&combination.0).copied());
    Ok(rows)
}

/// Contents of a lock: a worker that panicked ends the program, so that nothing is half done.
fn locked<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

fn into_inner<T>(of: Mutex<T>) -> T {
    of.into_inner().unwrap_or_else(PoisonError::into_inner)
}

/// The combinations that differ from those of `of`, the best of which are first, in that each contact has a draw of its own: the first `most`
/// groups of them.
fn with_each_draw(of: &[Combination], most: usize) -> Vec<Combination> {
    let best: Vec<_> = of.iter().map(Combination::with_draw_for_each).collect();
    let groups: Vec<_> = by_what_is_shared(&best).iter().take(most).map(|group| group[0].what_is_shared()).collect();
    product().into_iter().filter(|combination| groups.contains(&combination.what_is_shared())).collect()
}

/// The combinations worth more draws: the paper's words, the case, and of the others those that hold at least as many claims as
/// the better of these two less the `slack`, each by value and under some way of naming modes; the `most` best of them, the
/// fewest departures first among equals.
fn selected(rows: &[(Combination, Row)], slack: usize, most: usize) -> Vec<Combination> {
    let mut selected = vec![Combination::literal(), Combination::own()];
    let of_selected = rows.iter().filter(|(combination, _)| selected.contains(combination));
    let least = of_selected.map(|(_, row)| row.held_by_value()).max().unwrap_or(0).saturating_sub(slack);
    let mut others: Vec<_> =
        rows.iter().filter(|(c, row)| !selected.contains(c) && row.held_by_value() >= least.max(1)).collect();
    others.sort_by_key(|(combination, row)| (std::cmp::Reverse(row.held_by_value()), combination.departures()));
    selected.extend(others.iter().take(most).map(|(combination, _)| *combination));
    selected
}

fn entries(rows: &[(Combination, Row)]) -> Vec<Entry<'_>> {
    let of_row = |(combination, row)| Entry::all(combination, row);
    rows.iter().map(|(combination, row)| (combination, row)).flat_map(of_row).collect()
}

/// The case file of each combination that was run with all draws, for `squeal run`.
fn save_cases(out: &Path, full: &[(Combination, Row)], case: &Table) -> Result<(), Error> {
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
        let cards = vec![Card { naming: row::TRACKED.into(), counting: None, claims: (0..12).map(cell).collect() }];
        Row { samples: 64, failures: 0, seconds: 1.0, refused: None, cards }
    }

    #[test]
    fn groups_with_a_draw_for_each_contact_are_those_of_the_best_with_one() {
        let shared: Vec<_> = product().into_iter().filter(Combination::shares_draws).collect();
        // The first two are of one group.
        let best =
            [Combination([0, 0, 1, 0, 0, 0, 0, 2, 0]), Combination([0, 0, 1, 2, 0, 0, 0, 0, 0]), Combination::own()];
        let with_each = with_each_draw(&best, 1);
        assert_eq!(with_each.len(), 9);
        assert!(with_each.iter().all(|c| c.0[2] == 1 && !c.shares_draws() && !shared.contains(c)));
        assert_eq!(with_each_draw(&best, 5).len(), 18);
        assert_eq!(with_each_draw(&shared, usize::MAX).len(), shared.len());
    }

    #[test]
    fn the_best_of_those_that_come_near_the_case_are_selected() {
        let (own, literal) = (Combination::own(), Combination::literal());
        let others: Vec<_> = product().into_iter().filter(|c| ![own, literal].contains(c)).take(4).collect();
        let held = [7, 5, 5, 6, 8, 7];
        let all: Vec<_> = [own, literal].iter().chain(&others).zip(held).map(|(c, held)| (*c, row(held))).collect();
        assert_eq!(selected(&all, 1, 12), [literal, own, others[2], others[3], others[1]]);
        assert_eq!(selected(&all, 2, 12), [literal, own, others[2], others[3], others[1], others[0]]);
        assert_eq!(selected(&all, 1, 1), [literal, own, others[2]]);
    }
}
