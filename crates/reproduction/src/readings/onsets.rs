//! Friction coefficient at which each mode becomes unstable: every oscillator in contact, Amontons-Coulomb friction.
//!
//! The onset does not depend on the distribution of the coefficient: a mode without an onset is unstable under no distribution.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use brakes::case::{LatticeCase, Law};
use brakes::{LatticeBrake, LatticeSample};
use num_complex::Complex;
use squeal::montecarlo::Experiment as _;
use squeal::nalgebra::{DMatrix, DVector};
use squeal::study::{Scratch, Study};
use squeal::work::ModeWork;
use toml::Table;

use super::product::{AXES, COUNTINGS, Combination, PaperModes, paper_modes, product};
use crate::Error;

/// The largest coefficient tried.
const MOST_MU: f64 = 1.3;
/// Step of the coefficient in the table of patterns.
const FINE_STEP: f64 = 0.001;
/// Step of the coefficient in the table of structures.
const COARSE_STEP: f64 = 0.01;
/// Answers that change the structure: mass, lean, lateral, theta and phi, as indices into [`AXES`].
const STRUCTURE: [usize; 5] = [0, 1, 2, 4, 5];
/// Index in [`AXES`] of friction in y.
const LATERAL: usize = 2;

/// Onset of instability of a mode.
struct Onset {
    /// Smallest friction coefficient mu, of those tried, at which the mode is unstable.
    mu: f64,
    /// Oscillators, from 1, in the order of their net work on the mode there, the most first.
    feeders: Vec<usize>,
}

impl Onset {
    /// True if the oscillators that the paper names feed the mode most.
    fn is_fed_by(&self, oscillators: &[usize]) -> bool {
        let (first, _) = self.feeders.split_at(oscillators.len().min(self.feeders.len()));
        !oscillators.is_empty() && oscillators.iter().all(|named| first.contains(named))
    }
}

/// Onsets of one structure.
struct Onsets {
    /// Onset of each mode, by constraint set, then by its frequency rank at the naming point.
    of_sets: Vec<BTreeMap<usize, Onset>>,
    /// Row and column shape of each mode without constraints, by rank from 1.
    patterns: Vec<String>,
}

impl Onsets {
    fn new(mut case: LatticeCase, step: f64) -> Result<Self, Error> {
        let oscillators = case.lattice.grid.oscillators();
        case.laws = vec![Law::AmontonsCoulomb];
        case.panels.retain(|(number, _)| *number == oscillators);
        let brake = LatticeBrake::new(case)?;
        let study = Study::new(&brake, &cea::BatchSolver)?;
        let mus: Vec<f64> = (1..).map(|i| f64::from(i) * step).take_while(|mu| *mu <= MOST_MU + 0.5 * step).collect();
        let mut of_sets = Vec::new();
        for (at, scene) in brake.plan.scenes.iter().enumerate() {
            if scene.key.speed.is_some_and(|range| range > 0) {
                continue;
            }
            let samples: Vec<LatticeSample> = mus.iter().map(|&mu| brake.with_mu(mu)).collect();
            let mut outcomes = Vec::with_capacity(samples.len());
            study.evaluate_block(at, &samples.iter().collect::<Vec<_>>(), &mut Scratch::default(), &mut outcomes);
            let mut onsets = BTreeMap::new();
            for (&mu, outcome) in mus.iter().zip(outcomes) {
                for mode in outcome?.unstable {
                    if let [name] = mode.names[..] {
                        let onset = || Onset { mu, feeders: feeders(mode.work.as_ref(), oscillators) };
                        onsets.entry(usize::from(name.number())).or_insert_with(onset);
                    }
                }
            }
            of_sets.push(onsets);
        }
        let modes = study.references()[0].modes.iter();
        let dofs = &brake.plan.brake(&brake.plan.scenes[0]).dofs;
        let patterns = modes.map(|mode| pattern(&brake.case, &dofs.expand(&mode.shape))).collect();
        Ok(Self { of_sets, patterns })
    }
}

/// The oscillators, from 1, in the order of their net work on a mode, the most first.
fn feeders(work: Option<&ModeWork>, oscillators: usize) -> Vec<usize> {
    // The plate comes last.
    let net = work.map_or(Vec::new(), ModeWork::net);
    let mut order: Vec<usize> = (0..net.len().min(oscillators)).collect();
    order.sort_by(|&a, &b| net[b].total_cmp(&net[a]));
    order.into_iter().map(|at| at + 1).collect()
}

/// The row shape and the column shape with most of a mode in it.
fn pattern(case: &LatticeCase, shape: &DVector<Complex<f64>>) -> String {
    let (rows, columns) = (case.lattice.grid.rows(), case.lattice.grid.columns());
    let (along, across) =
        (chain_shapes(&case.lattice.x_stiffness[..=columns]), chain_shapes(&case.lattice.y_stiffness[..=rows]));
    let share = |i: usize, j: usize| -> f64 {
        let of_axis = |axis: usize| -> Complex<f64> {
            let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
            places
                .map(|(row, column)| shape[3 * (row * columns + column) + axis] * along[(column, i)] * across[(row, j)])
                .sum()
        };
        (0..3).map(|axis| of_axis(axis).norm_sqr()).sum()
    };
    let all = (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j)));
    let best = all.max_by(|a, b| share(a.0, a.1).total_cmp(&share(b.0, b.1)));
    best.map_or(String::new(), |(i, j)| format!("X{} Y{}", i + 1, j + 1))
}

/// The shapes of a chain wall - masses - wall in its columns, softest first.
fn chain_shapes(springs: &[f64]) -> DMatrix<f64> {
    let masses = springs.len() - 1;
    let stiffness = DMatrix::from_fn(masses, masses, |i, j| match i.abs_diff(j) {
        0 => springs[i] + springs[i + 1],
        1 => -springs[i.max(j)],
        _ => 0.0,
    });
    let modes = stiffness.symmetric_eigen();
    let mut order: Vec<usize> = (0..masses).collect();
    order.sort_by(|&a, &b| modes.eigenvalues[a].total_cmp(&modes.eigenvalues[b]));
    DMatrix::from_fn(masses, masses, |i, j| modes.eigenvectors[(i, order[j])])
}

/// Markdown of two tables: the case's own structure, and every structure.
///
/// # Errors
/// Those of the model and of the solver.
pub fn markdown(path: &Path, case: &Table) -> Result<String, Error> {
    Ok(patterns(path, case)? + "\n" + &structures(path, case)?)
}

/// The case's own structure, under each reading of friction in y.
fn patterns(path: &Path, case: &Table) -> Result<String, Error> {
    let own = Combination::own().case(path, case)?;
    let answers = AXES[LATERAL].choices.len();
    let with = |lateral: usize| -> Result<Onsets, Error> {
        let mut combination = Combination::own();
        combination.0[LATERAL] = lateral;
        Onsets::new(combination.case(path, case)?, FINE_STEP)
    };
    let of_lateral = (0..answers).map(with).collect::<Result<Vec<_>, _>>()?;
    let mut text = format!(
        "The smallest mu, in steps of {FINE_STEP} up to {MOST_MU}, at which a mode is unstable; every oscillator in contact, \
         Amontons-Coulomb friction, {:.2} m/s. Modes by pattern, with their frequency rank without friction in y; \"above\" is \
         the part of the draws of mu above its onset.\n\n| pattern | mode |",
        own.speeds[0].quantile(0.5)
    );
    for choice in AXES[LATERAL].choices {
        text += &format!(" {} | above |", choice.label);
    }
    text += "\n| --- | --- |";
    text += &" --- | --- |".repeat(answers);
    // A pattern has three modes, of which friction couples two: the one that grows is the pattern's.
    let by_pattern = |onsets: &Onsets| -> BTreeMap<String, (usize, f64)> {
        let mut found: BTreeMap<String, (usize, f64)> = BTreeMap::new();
        for (&rank, &Onset { mu, .. }) in &onsets.of_sets[0] {
            let first = found.entry(onsets.patterns[rank - 1].clone()).or_insert((rank, mu));
            *first = if mu < first.1 { (rank, mu) } else { *first };
        }
        found
    };
    let columns: Vec<BTreeMap<String, (usize, f64)>> = of_lateral.iter().map(by_pattern).collect();
    let mut names: Vec<&String> = columns.iter().flat_map(BTreeMap::keys).collect();
    names.sort();
    names.dedup();
    let onset =
        |column: &BTreeMap<String, (usize, f64)>, name: &str| column.get(name).map_or(f64::INFINITY, |&(_, mu)| mu);
    names.sort_by(|a, b| onset(&columns[0], a).total_cmp(&onset(&columns[0], b)));
    for name in names {
        let mode = columns[0].get(name).map_or("-".into(), |(rank, _)| rank.to_string());
        let _ = write!(text, "\n| {name} | {mode} |");
        for column in &columns {
            text += &match column.get(name) {
                Some(&(_, mu)) => format!(" {mu:.3} | {:.3} |", 1.0 - own.friction.mu.cumulative(mu)),
                None => " none | 0 |".into(),
            };
        }
    }
    Ok(text + "\n")
}

/// Every structure: which modes can be unstable at all, and whether the paper's are among them.
fn structures(path: &Path, case: &Table) -> Result<String, Error> {
    let paper = paper_modes(path, case)?;
    let printed = Combination::own().case(path, case)?.paper.ok_or(Error::Toml("has no table [paper]".into()))?;
    let mut combinations = product();
    combinations.retain(|combination| (0..AXES.len()).all(|i| STRUCTURE.contains(&i) || combination.0[i] == 0));
    let mut text = format!(
        "Modes that are unstable at any mu up to {MOST_MU}, in steps of {COARSE_STEP}: frequency rank and onset, by onset. Last \
         columns: which of the paper's numbers ({}, of {} modes) are among them if modes are counted in this way; with a star \
         where the oscillators that the paper names do most net work on that mode at its onset.\n\n\
         | structure | free | corners held | six held |",
        in_words(&paper.numbers.map(|number| number.to_string())),
        in_words(&paper.modes.map(|modes| modes.to_string())),
    );
    COUNTINGS.iter().for_each(|counting| text += &format!(" {} |", counting.word()));
    text += "\n| --- | --- | --- | --- |";
    text += &" --- |".repeat(COUNTINGS.len());
    let mut found = Agreement::default();
    for combination in &combinations {
        let onsets = Onsets::new(combination.case(path, case)?, COARSE_STEP)?;
        let _ = write!(text, "\n| {} |", combination.describe());
        for of_set in &onsets.of_sets {
            let mut list: Vec<_> = of_set.iter().collect();
            list.sort_by(|a, b| a.1.mu.total_cmp(&b.1.mu));
            let list: Vec<String> = list.iter().map(|(rank, onset)| format!("{rank} {:.2}", onset.mu)).collect();
            let _ = write!(text, " {} |", or_none(list.join(", ")));
        }
        let words = found.add(&onsets, &paper, [&printed.corners, &printed.after_corners_dominant, &[]]);
        words.into_iter().for_each(|words| text += &format!(" {} |", or_none(words)));
    }
    Ok(text + "\n\n" + &found.in_words(combinations.len(), &paper))
}

/// Agreement of the paper's numbers with the modes that can be unstable.
#[derive(Default)]
struct Agreement {
    /// Highest frequency rank of an unstable mode, and structures without any such mode, by constraint set.
    highest: [usize; 3],
    quiet: [usize; 3],
    /// Structures in which a mode is fed by the oscillators that the paper names for the number of the set, by constraint set.
    described: [usize; 3],
    /// Number of modes that are fed so, over all structures, by constraint set.
    fed_modes: [usize; 3],
    /// Structures in which the number is one of a mode that is unstable, and of one that is fed so, by way of counting and set.
    unstable: [[usize; 3]; COUNTINGS.len()],
    fed: [[usize; 3]; COUNTINGS.len()],
    /// Structures in which all numbers are of unstable modes, and in which those whose oscillators are named are of modes fed so, by way of
    /// counting.
    all: [usize; COUNTINGS.len()],
    all_fed: [usize; COUNTINGS.len()],
    /// Values that `all`, and `all_fed`, would have on average if each number were drawn among the modes of its set.
    by_chance: f64,
    fed_by_chance: f64,
}

impl Agreement {
    /// Adds a structure; `named` are the oscillators that the paper names by set. Returns the numbers that it has, by way of counting.
    fn add(&mut self, onsets: &Onsets, paper: &PaperModes, named: [&[usize]; 3]) -> [String; COUNTINGS.len()] {
        let is_fed = |set: usize, rank: usize| onsets.of_sets[set].get(&rank).is_some_and(|o| o.is_fed_by(named[set]));
        let fed: [usize; 3] =
            std::array::from_fn(|set| onsets.of_sets[set].keys().filter(|&&rank| is_fed(set, rank)).count());
        for (set, fed) in fed.into_iter().enumerate() {
            let of_set = &onsets.of_sets[set];
            self.highest[set] = self.highest[set].max(of_set.keys().copied().max().unwrap_or(0));
            self.quiet[set] += usize::from(of_set.is_empty());
            self.described[set] += usize::from(fed > 0);
            self.fed_modes[set] += fed;
        }
        let part = |set: usize, of: usize| of as f64 / paper.modes[set] as f64;
        self.by_chance += (0..3).map(|set| part(set, onsets.of_sets[set].len())).product::<f64>();
        self.fed_by_chance +=
            (0..3).filter(|&set| !named[set].is_empty()).map(|set| part(set, fed[set])).product::<f64>();
        std::array::from_fn(|at| {
            let ranks = paper.ranks(COUNTINGS[at]);
            let has = |set: usize| onsets.of_sets[set].contains_key(&ranks[set]);
            for (set, &rank) in ranks.iter().enumerate() {
                self.unstable[at][set] += usize::from(has(set));
                self.fed[at][set] += usize::from(is_fed(set, rank));
            }
            self.all[at] += usize::from((0..3).all(has));
            self.all_fed[at] +=
                usize::from((0..3).filter(|&set| !named[set].is_empty()).all(|set| is_fed(set, ranks[set])));
            let star = |set: usize| if is_fed(set, ranks[set]) { "*" } else { "" };
            let words = (0..3).filter(|&set| has(set)).map(|set| format!("{}{}", paper.numbers[set], star(set)));
            words.collect::<Vec<_>>().join(" ")
        })
    }

    fn in_words(&self, structures: usize, paper: &PaperModes) -> String {
        let [free, corners, _] = paper.numbers;
        let mut text = format!(
            "The highest rank of an unstable mode is {} free, {} with the corners held and {} with six held. No mode is ever \
             unstable in {} of {structures} structures free, in {} with the corners held and in {} with six held. In {} \
             structures a mode is fed most by the corners when free, in {} one by the oscillators that the paper names when the \
             corners are held.\n\n\
             Structures with the paper's numbers. \"By chance\" is how many there would be on average if each number were drawn \
             among the modes of its set.\n\n| counted |",
            self.highest[0],
            self.highest[1],
            self.highest[2],
            self.quiet[0],
            self.quiet[1],
            self.quiet[2],
            self.described[0],
            self.described[1]
        );
        paper.numbers.iter().for_each(|number| text += &format!(" {number} |"));
        let _ = write!(
            text,
            " all three | {free}* | {corners}* | both* |\n| --- | --- | --- | --- | --- | --- | --- | --- |"
        );
        for (at, counting) in COUNTINGS.iter().enumerate() {
            let ([a, b, c], [d, e, _]) = (self.unstable[at], self.fed[at]);
            let (all, both) = (self.all[at], self.all_fed[at]);
            let _ = write!(text, "\n| {} | {a} | {b} | {c} | {all} | {d} | {e} | {both} |", counting.word());
        }
        let part = |set: usize| self.fed_modes[set] as f64 / paper.modes[set] as f64;
        let _ = writeln!(
            text,
            "\n| by chance, each | | | | {:.2} | {:.2} | {:.2} | {:.2} |",
            self.by_chance,
            part(0),
            part(1),
            self.fed_by_chance
        );
        text
    }
}

fn in_words(parts: &[String; 3]) -> String {
    let [a, b, c] = parts;
    format!("{a}, {b} and {c}")
}

fn or_none(text: String) -> String {
    if text.is_empty() { "none".into() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_has_its_shapes_in_the_order_of_stiffness() {
        // docs/model.md: X1 0.38 0.84 0.38, X2 0.71 0 -0.71, X3 0.60 -0.54 0.60.
        let shapes = chain_shapes(&[2.45e7, 1.05e7, 1.05e7, 2.45e7]).map(f64::abs);
        for (place, expected) in [0.38, 0.84, 0.38, 0.71, 0.0, 0.71, 0.60, 0.54, 0.60].into_iter().enumerate() {
            assert!((shapes[place] - expected).abs() < 0.005, "{place}: {}", shapes[place]);
        }
    }

    #[test]
    fn the_first_flutter_of_the_case_is_that_of_the_corners() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/paper.toml");
        let case = Combination::own().case(&path, &super::super::product::read_tables(&path).unwrap()).unwrap();
        let onsets = Onsets::new(case, 0.02).unwrap();
        let (rank, onset) = onsets.of_sets[0].iter().min_by(|a, b| a.1.mu.total_cmp(&b.1.mu)).unwrap();
        assert_eq!((*rank, onsets.patterns[*rank - 1].as_str()), (16, "X3 Y2"));
        // It is 0.324 in steps of 0.001.
        assert!((onset.mu - 0.34).abs() < 1e-9);
        assert!(onset.is_fed_by(&[1, 3, 7, 9]) && !onset.is_fed_by(&[4, 6]), "{:?}", onset.feeders);
    }
}
