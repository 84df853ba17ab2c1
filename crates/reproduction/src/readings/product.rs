//! The readings and their product: each combination is the paper's case with some named fields changed.

use std::path::Path;

use brakes::case::{CaseError, LatticeCase};
use squeal::study::{ModeLabel, ModeNaming};
use toml::{Table, Value};

use crate::Error;

/// A way to read what the paper leaves open.
#[derive(Debug)]
pub struct Choice {
    /// Text in tables.
    pub label: &'static str,
    /// Fields of the case file and what stands there, as TOML.
    fields: &'static [(&'static str, &'static str)],
}

const fn choice(label: &'static str, fields: &'static [(&'static str, &'static str)]) -> Choice {
    Choice { label, fields }
}

/// A question that the paper leaves open, with its answers. The first is the case's own.
#[derive(Debug)]
pub struct Axis {
    /// Name in tables.
    pub name: &'static str,
    /// The answers.
    pub choices: &'static [Choice],
    /// Index of the answer that the paper's words give.
    pub literal: usize,
    /// Weight of a departure in the order of the run: more where the answer acts on one law alone.
    weight: usize,
}

const fn axis(name: &'static str, choices: &'static [Choice]) -> Axis {
    Axis { name, choices, literal: 0, weight: 1 }
}

/// Questions that the paper leaves open.
pub const AXES: [Axis; 9] = [
    axis("R1 mass", &[choice("0.39", &[]), choice("0.39/9", &[("lattice.oscillator_mass", "0.043333333333333335")])]),
    axis("R2 lean", &[choice("against", &[]), choice("along", &[("readings.lean", "\"along\"")])]),
    Axis {
        literal: 1,
        ..axis(
            "R3 lateral",
            &[
                choice("none", &[]),
                choice("coupled", &[("readings.lateral", "\"coupled\"")]),
                choice("coupled-minus", &[("readings.lateral", "\"coupled-minus\"")]),
                choice("vector", &[("readings.lateral", "\"vector\"")]),
            ],
        )
    },
    axis(
        "R8 preload",
        &[
            choice("per contact", &[]),
            choice("clamp", &[("readings.preload", "{ clamp = 5400.0 }")]),
            choice("equilibrium", &[("readings.preload", "{ equilibrium = 600.0 }")]),
        ],
    ),
    axis("theta from", &[choice("plane", &[]), choice("normal", &[("lattice.theta", "30.0")])]),
    axis("phi from", &[choice("x", &[]), choice("y", &[("lattice.phi", "30.0")])]),
    axis(
        "mean of mu",
        &[
            choice("0.50", &[]),
            choice(
                "0.35",
                &[("friction.mu.mean", "0.35"), ("friction.mu_s.mean", "0.40"), ("friction.mu_k.mean", "0.30")],
            ),
            choice(
                "0.65",
                &[("friction.mu.mean", "0.65"), ("friction.mu_s.mean", "0.70"), ("friction.mu_k.mean", "0.60")],
            ),
        ],
    ),
    Axis {
        weight: 2,
        ..axis(
            "R9 sigma1",
            &[
                choice("constant", &[]),
                choice("decaying", &[("readings.bristle_damping", "\"decaying\"")]),
                choice("0", &[("readings.bristle_damping", "\"none\"")]),
            ],
        )
    },
    axis("R4 draws", &[choice("shared", &[]), choice("each", &[("readings.draws", "\"each\"")])]),
];

/// Answers, one to each question of [`AXES`], as indices of its choices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Combination(pub [usize; AXES.len()]);

impl Combination {
    /// The combination that the paper's words say, and the case's own answers where they say nothing.
    pub fn literal() -> Self {
        Self(AXES.each_ref().map(|axis| axis.literal))
    }

    /// The case as it stands.
    pub fn own() -> Self {
        Self([0; AXES.len()])
    }

    /// True if all contacts have one draw.
    pub fn shares_draws(&self) -> bool {
        self.0[DRAWS] == 0
    }

    /// A copy with a draw for each contact.
    pub fn with_draw_for_each(&self) -> Self {
        let mut answers = self.0;
        answers[DRAWS] = 1;
        Self(answers)
    }

    /// The answers but for those that change friction alone: equal for combinations that have much in common.
    pub fn what_is_shared(&self) -> [usize; AXES.len()] {
        let mut answers = self.0;
        OF_FRICTION.iter().for_each(|&axis| answers[axis] = 0);
        answers
    }

    /// The label of each answer.
    pub fn labels(&self) -> [&'static str; AXES.len()] {
        std::array::from_fn(|i| AXES[i].choices[self.0[i]].label)
    }

    /// Number of answers that depart from the paper's words.
    pub fn departures(&self) -> usize {
        self.differences(Self::literal()).count()
    }

    /// Description of what differs from the case.
    pub fn describe(&self) -> String {
        let changed = self.differences(Self::own());
        let words: Vec<String> =
            changed.map(|i| format!("{} {}", AXES[i].name, AXES[i].choices[self.0[i]].label)).collect();
        if words.is_empty() { "the case's own".into() } else { words.join(", ") }
    }

    fn differences(&self, from: Self) -> impl Iterator<Item = usize> + '_ {
        (0..AXES.len()).filter(move |&i| self.0[i] != from.0[i])
    }

    /// The text of `case`, a case file, with the fields of the answers changed.
    ///
    /// # Errors
    /// A case whose tables are not those of a lattice.
    pub fn text(&self, case: &Table) -> Result<String, Error> {
        let mut changed = case.clone();
        for (axis, &answer) in AXES.iter().zip(&self.0) {
            for &(field, value) in axis.choices[answer].fields {
                set(&mut changed, field, value)?;
            }
        }
        toml::to_string(&changed).map_err(|error| Error::Toml(error.to_string()))
    }

    /// The case of this combination. `path` is where the paper's case stands.
    ///
    /// # Errors
    /// As [`Combination::text`], and a value that the case refuses.
    pub fn case(&self, path: &Path, case: &Table) -> Result<LatticeCase, Error> {
        Ok(LatticeCase::parse(path, self.text(case)?)?)
    }
}

/// Combinations of all answers: first those with one draw for all contacts, which together are a product of their own, then those with the
/// fewest departures from the case, by their weights.
pub fn product() -> Vec<Combination> {
    let mut all = vec![Combination::own()];
    for (i, axis) in AXES.iter().enumerate() {
        let with = |combination: &Combination| {
            let mut answers = combination.0;
            (0..axis.choices.len()).map(move |answer| {
                answers[i] = answer;
                Combination(answers)
            })
        };
        all = all.iter().flat_map(with).collect();
    }
    let own = Combination::own();
    let weight = |combination: &Combination| combination.differences(own).map(|i| AXES[i].weight).sum::<usize>();
    all.sort_by_key(|combination| (!combination.shares_draws(), weight(combination)));
    all
}

/// Index in [`AXES`] of the question whether all contacts have one draw.
const DRAWS: usize = 8;
/// Questions whose answers change friction alone, as indices into [`AXES`]: the preload and LuGre's bristle damping.
const OF_FRICTION: [usize; 2] = [3, 7];

/// Groups of combinations that differ in answers that change friction alone, in the order of the first of each.
pub fn by_what_is_shared(combinations: &[Combination]) -> Vec<Vec<Combination>> {
    let (mut places, mut groups) = (std::collections::HashMap::new(), Vec::<Vec<Combination>>::new());
    for combination in combinations {
        let place = *places.entry(combination.what_is_shared()).or_insert(groups.len());
        if place == groups.len() {
            groups.push(Vec::new());
        }
        groups[place].push(*combination);
    }
    groups
}

/// The paper's case as tables.
///
/// # Errors
/// A file that cannot be read or is no TOML.
pub fn read_tables(path: &Path) -> Result<Table, Error> {
    let text = std::fs::read_to_string(path)
        .map_err(|source| Error::from(CaseError::Read { path: path.to_owned(), source }))?;
    toml::from_str(&text).map_err(|error| Error::Toml(error.to_string()))
}

/// The ways in which the paper may count modes: ranks and places among all eigenvalues, from the lowest frequency and from the highest.
pub const COUNTINGS: [ModeNaming; 4] = [ModeNaming::Rank, ModeNaming::Pair, ModeNaming::RankDown, ModeNaming::PairDown];

/// The modes that the paper numbers: without constraints, with the corners held and with six held.
#[derive(Debug, Clone, Copy)]
pub struct PaperModes {
    /// Numbers that the paper gives them.
    pub numbers: [ModeLabel; 3],
    /// Number of modes of the brake, with each of these constraints.
    pub modes: [usize; 3],
}

impl PaperModes {
    /// Frequency ranks of these modes if modes are counted in a way.
    pub fn ranks(&self, counting: ModeNaming) -> [usize; 3] {
        std::array::from_fn(|set| counting.rank(self.numbers[set], self.modes[set]))
    }
}

/// The modes that the paper numbers.
///
/// # Errors
/// A case without a table of what the paper prints.
pub fn paper_modes(path: &Path, case: &Table) -> Result<PaperModes, Error> {
    let case = Combination::own().case(path, case)?;
    let paper = case.paper.ok_or(Error::Toml("has no table [paper]".into()))?;
    let dofs = 3 * (case.lattice.grid.oscillators() + 1);
    let held = |set: usize| case.constraints.get(set).map_or(0, |set| set.fixed.len());
    Ok(PaperModes {
        numbers: [paper.mode, paper.after_corners_mode, paper.after_six_mode],
        modes: std::array::from_fn(|set| dofs - held(set)),
    })
}

/// Puts a value, given as TOML, in a field of nested tables.
fn set(tables: &mut Table, field: &str, value: &str) -> Result<(), Error> {
    let missing = || Error::Toml(format!("the case has no table for {field}"));
    let parsed: Table = toml::from_str(&format!("value = {value}")).map_err(|e| Error::Toml(e.to_string()))?;
    let (path, name) = field.rsplit_once('.').ok_or_else(missing)?;
    let mut table = tables;
    for key in path.split('.') {
        table = table.get_mut(key).and_then(Value::as_table_mut).ok_or_else(missing)?;
    }
    table.insert(name.into(), parsed["value"].clone());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paper() -> (std::path::PathBuf, Table) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/paper.toml");
        let tables = read_tables(&path).unwrap();
        (path, tables)
    }

    #[test]
    fn every_answer_changes_the_study_and_no_other_answer_gives_the_same() {
        let (path, tables) = paper();
        let own = LatticeCase::read(&path).unwrap().identity();
        let mut seen = std::collections::BTreeSet::from([own.clone()]);
        for (i, axis) in AXES.iter().enumerate() {
            for answer in 1..axis.choices.len() {
                let mut combination = Combination::own();
                combination.0[i] = answer;
                assert!(
                    seen.insert(combination.case(&path, &tables).unwrap().identity()),
                    "{}",
                    combination.describe()
                );
            }
        }
        assert_eq!(Combination::own().case(&path, &tables).unwrap().identity(), own);
    }

    #[test]
    fn the_product_is_complete_and_begins_with_the_case() {
        let all = product();
        assert_eq!(all.len(), AXES.iter().map(|axis| axis.choices.len()).product::<usize>());
        assert_eq!(all[0], Combination::own());
        let distinct: std::collections::BTreeSet<_> = all.iter().map(|combination| combination.0).collect();
        assert_eq!(distinct.len(), all.len());
        assert_eq!((Combination::literal().departures(), Combination::own().departures()), (0, 1));
    }
}
