//! From the fields of a file to a case that can run: every value checked, every list complete.

use std::path::{Path, PathBuf};

use friction::BristleDamping;
use osc_model::{
    ContactArrangement, Dof, Grid, Lateral, LatticeModel, LatticeParameters, Lean, OscModelError, PlateParameters,
    Preload, Sign,
};
use serde::Deserialize;

use super::schema::{self, Chain, Draws, File, Labels, Law, Values};
use super::{CaseError, Distribution};

/// A study, checked.
#[derive(Debug, Clone)]
pub struct Case {
    /// Where it was read from.
    pub path: PathBuf,
    /// The text that it was read from.
    pub text: String,
    /// What it calls itself.
    pub name: String,
    /// Friction laws, in the order of the file.
    pub laws: Vec<Law>,
    /// Samples per scene, >= 1.
    pub samples: u64,
    /// Seed of the random streams.
    pub seed: u64,
    /// The lattice.
    pub lattice: LatticeParameters,
    /// How the model's open questions are read.
    pub readings: LatticeReadings,
    /// Arrangements by number in contact, in the order of the file.
    pub panels: Vec<(usize, Vec<ContactArrangement>)>,
    /// Sets of constraints, in the order of the file; at least one.
    pub constraints: Vec<ConstraintSet>,
    /// Ranges of sliding speed; at least one.
    pub speeds: Vec<SpeedRange>,
    /// Distributions of the friction parameters.
    pub friction: FrictionDistributions,
    /// What a publication prints, to compare with.
    pub paper: Option<Paper>,
}

/// The readings of a case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LatticeReadings {
    /// Friction in y.
    pub lateral: Lateral,
    /// One draw for all contacts or one each.
    pub draws: Draws,
    /// How modes are named.
    pub labels: Labels,
    /// What presses the oscillators on the plate.
    pub preload: Preload,
    /// LuGre's sigma1 over speed; `None` sets it to 0.
    pub bristle_damping: Option<BristleDamping>,
}

/// Degrees of freedom held together, by name.
#[derive(Debug, Clone, PartialEq)]
pub struct ConstraintSet {
    /// Its name.
    pub name: String,
    /// What is held.
    pub fixed: Vec<Dof>,
}

/// A range of sliding speed, drawn from log-uniformly.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedRange {
    /// Its name.
    pub name: String,
    /// Lowest, m/s, > 0.
    pub from: f64,
    /// Highest, m/s.
    pub to: f64,
}

impl SpeedRange {
    /// The speed below which the part `u` of the range lies, log-uniformly; the median for `u = 0.5`.
    pub fn quantile(&self, u: f64) -> f64 {
        self.from * (self.to / self.from).powf(u)
    }
}

/// Distributions of the friction parameters of all laws.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionDistributions {
    /// Amontons-Coulomb's coefficient, and that across the sliding of every law.
    pub mu: Distribution,
    /// Static coefficient.
    pub mu_s: Distribution,
    /// Kinetic coefficient.
    pub mu_k: Distribution,
    /// Decay over speed of the velocity-dependent law, s/m.
    pub alpha: Distribution,
    /// Stribeck speed, m/s.
    pub v_s: Distribution,
    /// Bristle stiffness, 1/m.
    pub sigma0: Distribution,
    /// Bristle damping, s/m.
    pub sigma1: Distribution,
    /// Viscous coefficient, s/m.
    pub sigma2: Distribution,
}

/// Printed values that a study is compared with.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Paper {
    /// Which publication.
    pub source: String,
    /// The mode it finds most robustly unstable, in its own numbering.
    pub mode: u16,
    /// Lowest and highest natural frequency of the oscillators, Hz.
    pub natural_frequencies_oscillators: [f64; 2],
    /// Lowest and highest natural frequency of the plate, Hz.
    pub natural_frequencies_plate: [f64; 2],
    /// Relative tolerance of the natural frequencies.
    pub frequency_tolerance: f64,
    /// Oscillators that dominate that mode, from 1.
    pub corners: Vec<usize>,
    /// Oscillators that dominate what is left with the second constraint set, from 1.
    pub after_corners_dominant: Vec<usize>,
    /// Median occurrence of that with every oscillator in contact.
    pub after_corners_occurrence: f64,
    /// Largest median occurrence with the third constraint set.
    pub after_six_occurrence: f64,
    /// The bound on it that the conclusions state.
    pub after_six_bound: f64,
    /// Arrangements with six in contact.
    pub arrangements_of_six: usize,
    /// CEAs per arrangement.
    pub analyses_per_arrangement: u64,
}

impl Case {
    /// Reads and checks a case file.
    ///
    /// # Errors
    /// The first thing that is wrong, in one line that names the file, the field, the value and what is allowed.
    pub fn read(path: &Path) -> Result<Self, CaseError> {
        let text = std::fs::read_to_string(path).map_err(|source| CaseError::Read { path: path.to_owned(), source })?;
        Self::parse(path, text)
    }

    /// Checks the text of a case file; `path` is for messages.
    ///
    /// # Errors
    /// As [`Case::read`].
    pub fn parse(path: &Path, text: String) -> Result<Self, CaseError> {
        let file: File = toml::from_str(&text).map_err(|error| syntax(path, &text, &error))?;
        let check = Check { path };
        let File { study, lattice, contact, constraints, speeds, readings, friction, paper } = file;
        if study.laws.is_empty() {
            return Err(check.value("study.laws", "[]", "one law or more"));
        }
        check.no_repeats("study.laws", study.laws.iter().map(|law| format!("{law:?}")))?;
        if study.samples == 0 {
            return Err(check.value("study.samples", 0, "a whole number >= 1"));
        }
        let parameters = lattice_parameters(&check, &lattice, readings.lean)?;
        let lateral = match readings.lateral {
            schema::Lateral::None => Lateral::None,
            schema::Lateral::Coupled => Lateral::Coupled { sign: Sign::Plus },
            schema::Lateral::CoupledMinus => Lateral::Coupled { sign: Sign::Minus },
            schema::Lateral::Vector => Lateral::Vector,
        };
        let readings = LatticeReadings {
            lateral,
            draws: readings.draws,
            labels: readings.labels,
            preload: preload(&check, readings.preload)?,
            bristle_damping: match readings.bristle_damping {
                schema::BristleDamping::Constant => Some(BristleDamping::Constant),
                schema::BristleDamping::Decaying => Some(BristleDamping::Decaying),
                schema::BristleDamping::None => None,
            },
        };
        let constraints = constraint_sets(&check, constraints, &parameters, lateral)?;
        Ok(Self {
            path: path.to_owned(),
            name: study.name,
            laws: study.laws,
            samples: study.samples,
            seed: study.seed,
            readings,
            panels: panels(&check, &contact, parameters.grid.oscillators())?,
            lattice: parameters,
            constraints,
            speeds: speed_ranges(&check, speeds)?,
            friction: distributions(&check, &friction)?,
            paper,
            text,
        })
    }
}

impl Case {
    /// What tells this study from others, whatever its seed and number of samples: its name and a hash of all that is
    /// computed from.
    pub fn identity(&self) -> String {
        let Self { laws, lattice, readings, panels, constraints, speeds, friction, .. } = self;
        let content = format!("{laws:?} {lattice:?} {readings:?} {panels:?} {constraints:?} {speeds:?} {friction:?}");
        format!("\"{}\" {}", self.name, &crate::fingerprint(&content)[..16])
    }
}

/// Makes errors that name the file.
struct Check<'a> {
    path: &'a Path,
}

impl Check<'_> {
    fn value(&self, field: &str, value: impl ToString, allowed: &str) -> CaseError {
        CaseError::Value {
            path: self.path.to_owned(),
            field: field.to_owned(),
            value: value.to_string(),
            allowed: allowed.to_owned(),
        }
    }

    fn lattice(&self, table: &str) -> impl Fn(OscModelError) -> CaseError {
        let (path, table) = (self.path.to_owned(), table.to_owned());
        move |source| CaseError::Lattice { path: path.clone(), table: table.clone(), source }
    }

    fn no_repeats(&self, field: &str, names: impl Iterator<Item = String>) -> Result<(), CaseError> {
        let mut seen = std::collections::BTreeSet::new();
        for name in names {
            if !seen.insert(name.clone()) {
                return Err(self.value(field, name, "each once"));
            }
        }
        Ok(())
    }
}

fn syntax(path: &Path, text: &str, error: &toml::de::Error) -> CaseError {
    let at = error.span().map_or(0, |span| span.start.min(text.len()));
    let line = text[..at].matches('\n').count() + 1;
    let source = text.lines().nth(line - 1).unwrap_or_default();
    let field = source.split(['=', '#']).next().unwrap_or_default().trim();
    let message = error.message().replace('\n', " ");
    let message = if field.is_empty() { message } else { format!("{field}: {message}") };
    CaseError::Syntax { path: path.to_owned(), line, message }
}

fn lattice_parameters(
    check: &Check<'_>,
    lattice: &schema::Lattice,
    lean: schema::Lean,
) -> Result<LatticeParameters, CaseError> {
    let grid = Grid::new(lattice.rows, lattice.columns).map_err(check.lattice("lattice"))?;
    let springs = |values: &Values, chains: &dyn Fn(f64, f64) -> Vec<f64>| match values {
        Values::All(value) => chains(*value, *value),
        Values::Each(list) => list.clone(),
        Values::Chain(Chain { wall, inner }) => chains(*wall, *inner),
    };
    let each = |field: &str, values: &Values| match values {
        Values::All(value) => Ok(vec![*value; grid.oscillators()]),
        Values::Each(list) => Ok(list.clone()),
        Values::Chain(_) => {
            Err(check.value(&format!("lattice.{field}"), "{ wall, inner }", "a number or one for each oscillator"))
        }
    };
    let x = |values| springs(values, &|wall, inner| grid.x_chains(wall, inner));
    let y = |values| springs(values, &|wall, inner| grid.y_chains(wall, inner));
    let parameters = LatticeParameters {
        grid,
        x_stiffness: x(&lattice.x_stiffness),
        y_stiffness: y(&lattice.y_stiffness),
        x_damping: x(&lattice.x_damping),
        y_damping: y(&lattice.y_damping),
        z_damping: each("z_damping", &lattice.z_damping)?,
        inclined_stiffness: each("inclined_stiffness", &lattice.inclined_stiffness)?,
        theta: lattice.theta.to_radians(),
        phi: lattice.phi.to_radians(),
        lean: match lean {
            schema::Lean::Against => Lean::Against,
            schema::Lean::Along => Lean::Along,
        },
        contact_stiffness: each("contact_stiffness", &lattice.contact_stiffness)?,
        oscillator_mass: each("oscillator_mass", &lattice.oscillator_mass)?,
        plate: PlateParameters {
            mass: lattice.plate.mass,
            stiffness: lattice.plate.stiffness,
            damping: lattice.plate.damping,
        },
    };
    parameters.check().map_err(check.lattice("lattice"))?;
    Ok(parameters)
}

fn preload(check: &Check<'_>, preload: schema::Preload) -> Result<Preload, CaseError> {
    let (key, value, reading) = match preload {
        schema::Preload::PerContact(value) => ("per_contact", value, Preload::PerContact(value)),
        schema::Preload::Clamp(value) => ("clamp", value, Preload::Clamp(value)),
        schema::Preload::Equilibrium(value) => ("equilibrium", value, Preload::Equilibrium(value)),
    };
    if value.is_finite() && value > 0.0 {
        Ok(reading)
    } else {
        Err(check.value(&format!("readings.preload.{key}"), value, "a force in N, > 0"))
    }
}

fn constraint_sets(
    check: &Check<'_>,
    sets: Vec<schema::Constraints>,
    parameters: &LatticeParameters,
    lateral: Lateral,
) -> Result<Vec<ConstraintSet>, CaseError> {
    if sets.is_empty() {
        return Ok(vec![ConstraintSet { name: "none".into(), fixed: Vec::new() }]);
    }
    check.no_repeats("constraints.name", sets.iter().map(|set| set.name.clone()))?;
    let is_plain =
        |name: &str| !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
    if let Some(set) = sets.iter().find(|set| !is_plain(&set.name)) {
        return Err(check.value("constraints.name", &set.name, "letters, digits, - and _"));
    }
    let convert = |set: schema::Constraints| {
        let table = format!("constraints \"{}\"", set.name);
        let fixed = set.fixed.iter().map(|name| name.parse()).collect::<Result<Vec<Dof>, _>>();
        let fixed = fixed.map_err(check.lattice(&table))?;
        LatticeModel::new(parameters.clone(), lateral, &fixed).map_err(check.lattice(&table))?;
        Ok(ConstraintSet { name: set.name, fixed })
    };
    sets.into_iter().map(convert).collect()
}

fn panels(
    check: &Check<'_>,
    contact: &schema::Contact,
    oscillators: usize,
) -> Result<Vec<(usize, Vec<ContactArrangement>)>, CaseError> {
    let mut panels: Vec<(usize, Vec<ContactArrangement>)> = Vec::new();
    match (contact.in_contact.as_slice(), contact.arrangements.as_slice()) {
        ([], []) => {
            return Err(check.value(
                "contact",
                "empty",
                "in_contact = [numbers] or arrangements = [[oscillators], ..]",
            ));
        }
        (numbers, []) => {
            check.no_repeats("contact.in_contact", numbers.iter().map(usize::to_string))?;
            for &number in numbers {
                if number == 0 {
                    return Err(check.value("contact.in_contact", 0, &format!("1 to {oscillators}")));
                }
                let all = ContactArrangement::all(oscillators, number).map_err(check.lattice("contact.in_contact"))?;
                panels.push((number, all));
            }
        }
        ([], arrangements) => {
            for numbers in arrangements {
                let arrangement = ContactArrangement::from_numbers(oscillators, numbers)
                    .map_err(check.lattice("contact.arrangements"))?;
                if numbers.is_empty() {
                    return Err(check.value("contact.arrangements", "[]", "one oscillator or more"));
                }
                match panels.iter_mut().find(|(number, _)| *number == numbers.len()) {
                    Some((_, list)) if list.contains(&arrangement) => {
                        return Err(check.value("contact.arrangements", format!("[{arrangement}]"), "each once"));
                    }
                    Some((_, list)) => list.push(arrangement),
                    None => panels.push((numbers.len(), vec![arrangement])),
                }
            }
        }
        (_, _) => return Err(check.value("contact", "both", "in_contact or arrangements, not both")),
    }
    Ok(panels)
}

fn speed_ranges(check: &Check<'_>, speeds: Vec<schema::Speeds>) -> Result<Vec<SpeedRange>, CaseError> {
    if speeds.is_empty() {
        return Err(check.value("speeds", "[]", "one range or more"));
    }
    check.no_repeats("speeds.name", speeds.iter().map(|range| range.name.clone()))?;
    for range in &speeds {
        if !(range.from.is_finite() && range.from > 0.0) {
            return Err(check.value("speeds.from", range.from, "a speed in m/s, > 0"));
        }
        if !(range.to.is_finite() && range.to >= range.from) {
            return Err(check.value("speeds.to", range.to, &format!("at least from = {}", range.from)));
        }
    }
    Ok(speeds.into_iter().map(|schema::Speeds { name, from, to }| SpeedRange { name, from, to }).collect())
}

fn distributions(check: &Check<'_>, friction: &schema::Friction) -> Result<FrictionDistributions, CaseError> {
    let schema::Friction { mu, mu_s, mu_k, alpha, v_s, sigma0, sigma1, sigma2 } = *friction;
    let all = [
        ("mu", mu, false),
        ("mu_s", mu_s, true),
        ("mu_k", mu_k, true),
        ("alpha", alpha, false),
        ("v_s", v_s, true),
        ("sigma0", sigma0, true),
        ("sigma1", sigma1, false),
        ("sigma2", sigma2, false),
    ];
    for (name, distribution, positive) in all {
        if let Some((key, value, allowed)) = distribution.fault() {
            return Err(check.value(&format!("friction.{name}.{key}"), value, &allowed));
        }
        let least = distribution.least();
        let is_open = matches!(distribution, Distribution::LogNormal { .. });
        if least < 0.0 || (positive && least == 0.0 && !is_open) {
            let allowed = if positive { "values > 0 only" } else { "values >= 0 only" };
            return Err(check.value(&format!("friction.{name}"), format!("{least} at least"), allowed));
        }
    }
    if mu_s.median() < mu_k.median() {
        let allowed = format!("a median of at least that of mu_k, {}", mu_k.median());
        return Err(check.value("friction.mu_s", mu_s.median(), &allowed));
    }
    Ok(FrictionDistributions { mu, mu_s, mu_k, alpha, v_s, sigma0, sigma1, sigma2 })
}
