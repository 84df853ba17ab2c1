//! The folder of a finished study, read back.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use cea::Mode;
use montecarlo::Proportion;
use nalgebra::DVector;
use num_complex::Complex;
use output::Table;
use serde_json::Value;

use super::kept::Kept;
use crate::Error;

/// Constraints, law, speed, number in contact and arrangement of a scene.
pub type SceneNames = [String; 5];

/// Occurrences in a scene.
#[derive(Debug, Default)]
pub(super) struct Occurrences {
    modes: BTreeMap<String, Proportion>,
    /// Occurrence of anything, of a scene that is a panel by itself; of others the tables do not tell it.
    pub any: Option<Proportion>,
    /// Number of samples that could not be evaluated.
    failed: u64,
}

impl Occurrences {
    /// The occurrence of what has this name; without a row it was in none of the samples that could be evaluated.
    pub fn of(&self, name: &str, samples: u64) -> Proportion {
        self.modes.get(name).copied().unwrap_or_else(|| Proportion::of_counts(0, self.failed, samples))
    }
}

/// Columns of a scene in the tables.
const SCENE: [&str; 5] = ["constraints", "law", "speed", "in_contact", "arrangement"];

/// A finished study.
#[derive(Debug)]
pub(super) struct StudyFolder {
    pub path: PathBuf,
    /// Line of `study.txt`.
    pub identity: String,
    pub seed: u64,
    pub samples: u64,
    /// Threshold of the study in words, where it has one.
    pub threshold: Option<String>,
    /// Band of the study in words, where it has one.
    pub band: Option<String>,
    /// Version and commit of the program.
    pub program: String,
    pub scenes: BTreeMap<SceneNames, Occurrences>,
    /// True if kept samples tell which verdicts are open; samples of an earlier program do not.
    pub tells_open: bool,
    /// Kept samples by scene; empty where none were kept.
    pub kept: BTreeMap<SceneNames, Kept>,
    /// Modes by set of constraints.
    pub modes: BTreeMap<String, SetModes>,
    /// Draws: of each input the cells by scene and sample.
    draws: BTreeMap<String, BTreeMap<(SceneNames, u64), String>>,
}

/// The modes of a set of constraints, with their names.
#[derive(Debug, Default)]
pub(super) struct SetModes {
    pub names: Vec<String>,
    /// Modes, whose shapes are over `dofs`.
    pub modes: Vec<Mode>,
    pub dofs: Vec<String>,
}

impl StudyFolder {
    /// The error for a folder that cannot be compared.
    pub fn not_comparable(&self, found: String) -> Error {
        Error::NotComparable { path: self.path.clone(), found }
    }

    pub fn read(path: &Path) -> Result<Self, Error> {
        let no_study = |found: &str| Error::NotComparable { path: path.to_owned(), found: found.to_owned() };
        if !path.is_dir() {
            return Err(no_study("no such folder"));
        }
        let text = |name: &str| {
            fs::read_to_string(path.join(name)).map_err(|error| no_study(&format!("no {name} can be read ({error})")))
        };
        let manifest: Value =
            serde_json::from_str(&text("manifest.json")?).map_err(|_| no_study("its manifest.json is none"))?;
        let number =
            |key: &str| manifest[key].as_u64().ok_or_else(|| no_study(&format!("its manifest.json has no {key}")));
        let words = |key: &str| manifest.get(key).filter(|value| !value.is_null()).map(Value::to_string);
        let table = |name: &str| read(&path.join(format!("{name}.csv")));
        let needed = |name: &str| table(name)?.ok_or_else(|| no_study(&format!("it has no {name}.csv")));
        let mut study = Self {
            path: path.to_owned(),
            identity: text("study.txt")?.trim().to_owned(),
            seed: number("seed")?,
            samples: number("samples")?,
            threshold: words("threshold"),
            band: words("band_hz"),
            program: format!("{} ({})", words("version").unwrap_or_default(), words("commit").unwrap_or_default()),
            scenes: BTreeMap::new(),
            tells_open: true,
            kept: BTreeMap::new(),
            modes: BTreeMap::new(),
            draws: BTreeMap::new(),
        };
        let damaged = |name: &str| no_study(&format!("its {name}.csv is damaged"));
        study.enter_occurrences(&needed("occurrence")?).ok_or_else(|| damaged("occurrence"))?;
        if let Some(panels) = table("panels")? {
            study.enter_panels(&panels).ok_or_else(|| damaged("panels"))?;
        }
        study.enter_modes(&needed("modes")?).ok_or_else(|| damaged("modes"))?;
        for (set, modes) in &mut study.modes {
            let name = format!("shapes-{set}");
            if let Some(shapes) = table(&name)? {
                modes.enter_shapes(&shapes).ok_or_else(|| damaged(&name))?;
            }
        }
        if let Some(samples) = table("samples")? {
            study.enter_samples(&samples).ok_or_else(|| damaged("samples"))?;
        }
        Ok(study)
    }

    fn enter_occurrences(&mut self, table: &Table) -> Option<()> {
        let scene = places(table, SCENE)?;
        let [mode, trials, hits, open, failed] = places(table, ["mode", "samples", "unstable", "open", "failed"])?;
        for row in &table.rows {
            let count = |at: usize| row[at].parse().ok();
            let found = Proportion::of_counts(count(hits)?, count(open)?, count(trials)?);
            let of_scene = self.scenes.entry(scene.map(|at| row[at].clone())).or_default();
            of_scene.failed = count(failed)?;
            of_scene.modes.insert(row[mode].clone(), found);
        }
        Some(())
    }

    fn enter_panels(&mut self, table: &Table) -> Option<()> {
        let panel = places(table, ["constraints", "law", "speed", "in_contact"])?;
        let counts = places(table, ["arrangements", "any_unstable", "perhaps_unstable", "failed"])?;
        for row in &table.rows {
            let [arrangements, any, perhaps, failed] = counts.map(|at| row[at].parse::<u64>().ok());
            if arrangements? != 1 {
                continue;
            }
            let any = Proportion::of_counts(any?, perhaps? + failed?, self.samples);
            let of_panel =
                self.scenes.iter_mut().filter(|(scene, _)| scene.iter().zip(panel).all(|(name, at)| *name == row[at]));
            of_panel.for_each(|(_, occurrences)| occurrences.any = Some(any));
        }
        Some(())
    }

    fn enter_modes(&mut self, table: &Table) -> Option<()> {
        let [set, name, hz, growth] = places(table, ["constraints", "mode", "frequency_hz", "growth_rate"])?;
        for row in &table.rows {
            let number = |at: usize| row[at].parse::<f64>().ok();
            let lambda = Complex::new(number(growth)?, std::f64::consts::TAU * number(hz)?);
            let of_set = self.modes.entry(row[set].clone()).or_default();
            of_set.names.push(row[name].clone());
            of_set.modes.push(Mode { lambda, shape: DVector::zeros(0) });
        }
        Some(())
    }

    fn enter_samples(&mut self, table: &Table) -> Option<()> {
        let scene = places(table, SCENE)?;
        let [sample, growth, unstable] = places(table, ["sample", "growth", "unstable"])?;
        // Tables of earlier programs have not both.
        let has = |at: usize, name: &str| table.columns.get(at).is_some_and(|column| column == name);
        self.tells_open = has(unstable + 1, "open") && has(unstable + 2, "may_be");
        let first_input = unstable + 1 + usize::from(has(unstable + 1, "open")) + usize::from(self.tells_open);
        for row in &table.rows {
            let (scene, index) = (scene.map(|at| row[at].clone()), row[sample].parse().ok()?);
            let is_open = self.tells_open && row[unstable + 1] == "1";
            let may_be = if self.tells_open { &row[unstable + 2] } else { "" };
            self.kept.entry(scene.clone()).or_default().enter(index, [&row[growth], &row[unstable], may_be], is_open);
            for (input, cell) in table.columns.iter().zip(row).skip(first_input) {
                self.draws.entry(input.clone()).or_default().insert((scene.clone(), index), cell.clone());
            }
        }
        Some(())
    }

    /// Inputs of which all draws that two studies have in common agree, and inputs of which some do not, or that one study alone has.
    pub fn draws_in_common(&self, other: &Self) -> [Vec<String>; 2] {
        let mut found = [Vec::new(), Vec::new()];
        for (input, cells) in &self.draws {
            let differs = other
                .draws
                .get(input)
                .is_none_or(|others| cells.iter().any(|(at, cell)| others.get(at).is_some_and(|other| other != cell)));
            found[usize::from(differs)].push(input.clone());
        }
        found[1].extend(other.draws.keys().filter(|input| !self.draws.contains_key(*input)).cloned());
        found
    }
}

impl SetModes {
    fn enter_shapes(&mut self, table: &Table) -> Option<()> {
        let [mode, dof, re, im] = places(table, ["mode", "dof", "re", "im"])?;
        let mut components: BTreeMap<&str, Vec<Complex<f64>>> = BTreeMap::new();
        for row in &table.rows {
            let of_mode = components.entry(&row[mode]).or_default();
            // All modes of a set have their components in one order.
            match self.dofs.get(of_mode.len()) {
                None => self.dofs.push(row[dof].clone()),
                Some(known) if *known == row[dof] => {}
                Some(_) => return None,
            }
            of_mode.push(Complex::new(row[re].parse().ok()?, row[im].parse().ok()?));
        }
        for (name, mode) in self.names.iter().zip(&mut self.modes) {
            let shape = components.remove(name.as_str()).filter(|shape| shape.len() == self.dofs.len())?;
            mode.shape = shape.into();
        }
        Some(())
    }
}

/// The table of a CSV file; `None` where there is no file.
fn read(path: &Path) -> Result<Option<Table>, Error> {
    Table::read(path).map_err(|source| Error::Read { path: path.to_owned(), source: source.into() })
}

/// Places of the columns `names`; `None` where one is missing.
fn places<const N: usize>(table: &Table, names: [&str; N]) -> Option<[usize; N]> {
    let found: Vec<usize> =
        names.iter().filter_map(|name| table.columns.iter().position(|column| column == name)).collect();
    found.try_into().ok()
}
