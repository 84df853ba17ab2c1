//! Reading of a case with a lattice: from the fields of its file to a checked case.

use std::path::Path;

use friction::BristleDamping;
use montecarlo::Distribution;
use osc_model::{Dof, Grid, Lateral, LatticeModel, LatticeParameters, Lean, PlateParameters, Preload, Sign};

use super::arrangements::arrangements_by_number;
use super::check::{Check, syntax};
use super::correlation::Correlated;
use super::schema::{self, Chain, LatticeFile, Values};
use super::{
    Alternative, CaseError, ConstraintSet, Draws, FrictionDistributions, LatticeCase, LatticeReadings, Law, Paper,
    SpeedRange,
};
use crate::input::{LARGEST_CASE, read_text};

impl LatticeCase {
    /// Reads and checks a case file.
    ///
    /// # Errors
    /// The first fault, in one line that names the file, the field, the value and what is allowed.
    pub fn read(path: &Path) -> Result<Self, CaseError> {
        let text = read_text(path, LARGEST_CASE).map_err(|source| CaseError::Read { path: path.to_owned(), source })?;
        Self::parse(path, text)
    }

    /// Checks the text of a case file; `path` is for messages.
    ///
    /// # Errors
    /// As [`LatticeCase::read`].
    pub fn parse(path: &Path, text: String) -> Result<Self, CaseError> {
        let file: LatticeFile = toml::from_str(&text).map_err(|error| syntax(path, &text, &error))?;
        let check = Check::new(path);
        let LatticeFile {
            _brake: _,
            study,
            lattice,
            contact,
            constraints,
            speeds,
            readings,
            friction,
            alternatives,
            paper,
            accuracy,
            squeal,
            measured,
            correlation,
        } = file;
        let schema::StudyTable { name, laws, samples, seed } = study;
        let header = check.header(text, (name, samples, seed), accuracy, squeal, measured)?;
        if laws.is_empty() {
            return Err(check.value("study.laws", "[]", "one law or more"));
        }
        check.no_repeats("study.laws", laws.iter().map(ToString::to_string))?;
        let parameters = lattice_parameters(&check, &lattice, readings.lean)?;
        let lateral = readings.lateral.into();
        let readings = LatticeReadings {
            lateral,
            draws: readings.draws,
            labels: readings.labels,
            identity: readings.identity,
            preload: preload(&check, readings.preload)?,
            bristle_damping: readings.bristle_damping.into(),
        };
        let constraints = constraint_sets(&check, constraints, &parameters, lateral)?;
        if let Some(paper) = &paper {
            check_paper(&check, paper, parameters.grid.oscillators())?;
        }
        let friction = distributions(&check, friction)?;
        if correlation.is_some() && readings.draws == Draws::Shared && alternatives.draws.contains(&Draws::Each) {
            let allowed = "no \"each\" beside [correlation], which is made for the one draw that all contacts share; readings.draws = \"each\" with alternatives.draws = [\"shared\"] has one for each contact";
            return Err(check.value("alternatives.draws", "[\"each\"]", allowed));
        }
        let contacts = match readings.draws {
            Draws::Shared => vec![[0.0; 3]],
            Draws::Each => oscillator_places(parameters.grid),
        };
        let correlated = Correlated {
            friction: friction_parameters(&friction),
            contacts: &contacts,
            // Under another reading of the draws there is no contact 1.
            has_numbers: readings.draws == Draws::Each && alternatives.draws.is_empty(),
            others: Vec::new(),
        };
        let speeds = speed_ranges(&check, speeds)?;
        note_speeds(&check, &laws, &friction, &speeds);
        let mut case = Self {
            header,
            laws,
            readings,
            panels: arrangements_by_number(&check, &contact, parameters.grid.oscillators())?,
            lattice: parameters,
            constraints,
            speeds,
            correlation: check.correlation(correlation, &correlated)?,
            friction,
            alternatives: all_alternatives(&check, &alternatives)?,
            paper,
        };
        case.header.notes = check.notes();
        Ok(case)
    }
}

fn lattice_parameters(
    check: &Check<'_>,
    lattice: &schema::LatticeTable,
    lean: schema::LeanEntry,
) -> Result<LatticeParameters, CaseError> {
    let grid = Grid::new(lattice.rows, lattice.columns).map_err(check.lattice("lattice"))?;
    let x = |values| of_chains(values, |wall, inner| grid.x_chains(wall, inner));
    let y = |values| of_chains(values, |wall, inner| grid.y_chains(wall, inner));
    let each = |field, values| of_oscillators(check, grid.oscillators(), field, values);
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
            schema::LeanEntry::Against => Lean::Against,
            schema::LeanEntry::Along => Lean::Along,
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

/// A value for each member of all chains, which `chains` makes from the values of walls and of inner members.
fn of_chains(values: &Values, chains: impl Fn(f64, f64) -> Vec<f64>) -> Vec<f64> {
    match values {
        Values::All(value) => chains(*value, *value),
        Values::Each(list) => list.clone(),
        Values::Chain(Chain { wall, inner }) => chains(*wall, *inner),
    }
}

/// A value for each oscillator.
fn of_oscillators(check: &Check<'_>, oscillators: usize, field: &str, values: &Values) -> Result<Vec<f64>, CaseError> {
    match values {
        Values::All(value) => Ok(vec![*value; oscillators]),
        Values::Each(list) => Ok(list.clone()),
        Values::Chain(_) => {
            Err(check.value(&format!("lattice.{field}"), "{ wall, inner }", "a number or one for each oscillator"))
        }
    }
}

fn preload(check: &Check<'_>, preload: schema::PreloadEntry) -> Result<Preload, CaseError> {
    let (key, value, reading) = match preload {
        schema::PreloadEntry::PerContact(value) => ("per_contact", value, Preload::PerContact(value)),
        schema::PreloadEntry::Clamp(value) => ("clamp", value, Preload::Clamp(value)),
        schema::PreloadEntry::Equilibrium(value) => ("equilibrium", value, Preload::Equilibrium(value)),
    };
    if value.is_finite() && value > 0.0 {
        Ok(reading)
    } else {
        Err(check.value(&format!("readings.preload.{key}"), value, "a force in N, > 0"))
    }
}

impl From<schema::LateralEntry> for Lateral {
    fn from(lateral: schema::LateralEntry) -> Self {
        match lateral {
            schema::LateralEntry::None => Self::None,
            schema::LateralEntry::Coupled => Self::Coupled { sign: Sign::Plus },
            schema::LateralEntry::CoupledMinus => Self::Coupled { sign: Sign::Minus },
            schema::LateralEntry::Vector => Self::Vector,
        }
    }
}

impl From<schema::BristleDampingEntry> for Option<BristleDamping> {
    fn from(damping: schema::BristleDampingEntry) -> Self {
        match damping {
            schema::BristleDampingEntry::Constant => Some(BristleDamping::Constant),
            schema::BristleDampingEntry::Decaying => Some(BristleDamping::Decaying),
            schema::BristleDampingEntry::None => None,
        }
    }
}

fn all_alternatives(check: &Check<'_>, given: &schema::AlternativesTable) -> Result<Vec<Alternative>, CaseError> {
    if let Some(mass) = given.oscillator_mass.iter().find(|mass| !(mass.is_finite() && **mass > 0.0)) {
        return Err(check.value("alternatives.oscillator_mass", mass, "a mass in kg, > 0"));
    }
    let mut all: Vec<_> = given.oscillator_mass.iter().map(|&mass| Alternative::OscillatorMass(mass)).collect();
    all.extend(given.lateral.iter().map(|&lateral| Alternative::Lateral(lateral.into())));
    all.extend(given.draws.iter().map(|&draws| Alternative::Draws(draws)));
    all.extend(given.labels.iter().map(|&labels| Alternative::ModeNaming(labels)));
    for &force in &given.preload {
        all.push(Alternative::Preload(preload(check, force)?));
    }
    all.extend(given.bristle_damping.iter().map(|&damping| Alternative::BristleDamping(damping.into())));
    all.extend(given.in_place_of_lugre.iter().map(|&law| Alternative::InPlaceOfLuGre(law)));
    Ok(all)
}

fn constraint_sets(
    check: &Check<'_>,
    sets: Vec<schema::ConstraintsTable>,
    parameters: &LatticeParameters,
    lateral: Lateral,
) -> Result<Vec<ConstraintSet>, CaseError> {
    if sets.is_empty() {
        return Ok(vec![ConstraintSet { name: "none".into(), fixed: Vec::new() }]);
    }
    check.no_repeats("constraints.name", sets.iter().map(|set| set.name.clone()))?;
    sets.iter().try_for_each(|set| check.plain_name("constraints.name", &set.name))?;
    let convert = |set: schema::ConstraintsTable| {
        let table = format!("constraints \"{}\".fixed", set.name);
        let fixed = set.fixed.iter().map(|name| name.parse()).collect::<Result<Vec<Dof>, _>>();
        let fixed = fixed.map_err(check.lattice(&table))?;
        LatticeModel::new(parameters.clone(), lateral, &fixed).map_err(check.lattice(&table))?;
        Ok(ConstraintSet { name: set.name, fixed })
    };
    sets.into_iter().map(convert).collect()
}

fn check_paper(check: &Check<'_>, paper: &Paper, oscillators: usize) -> Result<(), CaseError> {
    let lists = [("paper.corners", &paper.corners), ("paper.after_corners_dominant", &paper.after_corners_dominant)];
    for (field, list) in lists {
        if let Some(number) = list.iter().find(|&number| !(1..=oscillators).contains(number)) {
            return Err(check.value(field, number, &format!("oscillators 1 to {oscillators}")));
        }
    }
    Ok(())
}

/// Fastest sliding of which nothing is said, m/s; chosen: several times that of a brake disc of a fast car, far below the same numbers in mm/s.
const FASTEST: f64 = 100.0;
/// Largest product of alpha and the slowest sliding of which nothing is said; chosen: beyond it `exp(-alpha v)` is nothing, and friction no longer falls.
const STEEPEST: f64 = 50.0;

/// Asks for the units of speeds that no brake has, and of an exponential fall of friction that ends below all of them.
pub(super) fn note_speeds(check: &Check<'_>, laws: &[Law], friction: &FrictionDistributions, speeds: &[SpeedRange]) {
    let unit = check.units.of("m/s");
    for SpeedRange { name, from, to } in speeds {
        if to * check.units.length() > FASTEST {
            check.note(format!("speeds {name:?}: sliding at up to {to} {unit}; is that the unit?"));
        }
        let steepness = friction.alpha.median() * from;
        if laws.contains(&Law::VelocityDependent) && steepness > STEEPEST {
            check.note(format!(
                "friction.alpha = {}: alpha v is {steepness:.0} at {from} {unit}, so that friction is mu_k alone; is the unit {}?",
                friction.alpha.median(),
                check.units.of("s/m")
            ));
        }
    }
}

pub(super) fn speed_ranges(check: &Check<'_>, speeds: Vec<schema::SpeedsTable>) -> Result<Vec<SpeedRange>, CaseError> {
    if speeds.is_empty() {
        return Err(check.value("speeds", "[]", "one range or more"));
    }
    let speed = check.units.of("m/s");
    check.names("speeds.name", speeds.iter().map(|range| &range.name))?;
    for range in &speeds {
        if !(range.from.is_finite() && range.from > 0.0) {
            return Err(check.value(
                &format!("speeds \"{}\".from", range.name),
                range.from,
                &format!("a speed in {speed}, > 0"),
            ));
        }
        if !(range.to.is_finite() && range.to >= range.from) {
            let allowed = format!("a finite speed in {speed}, at least from = {}", range.from);
            return Err(check.value(&format!("speeds \"{}\".to", range.name), range.to, &allowed));
        }
    }
    Ok(speeds.into_iter().map(|schema::SpeedsTable { name, from, to }| SpeedRange { name, from, to }).collect())
}

/// Positions (x, y, 0) of the oscillators of a grid, row by row, in units of their spacing.
fn oscillator_places(grid: Grid) -> Vec<[f64; 3]> {
    let place = |at: usize| [(at % grid.columns()) as f64, (at / grid.columns()) as f64, 0.0];
    (0..grid.oscillators()).map(place).collect()
}

/// The names and distributions of what is drawn for a contact.
pub(super) fn friction_parameters(friction: &FrictionDistributions) -> Vec<(&'static str, &Distribution)> {
    FrictionDistributions::DRAWN.into_iter().zip(friction.of_draw()).collect()
}

pub(super) fn distributions(
    check: &Check<'_>,
    friction: FrictionDistributions,
) -> Result<FrictionDistributions, CaseError> {
    let FrictionDistributions { mu, mu_s, mu_k, alpha, v_s, sigma0, sigma1, sigma2 } = friction;
    let of = |name: &str, given| check.distribution(&format!("friction.{name}"), given);
    let friction = FrictionDistributions {
        mu: of("mu", mu)?,
        mu_s: of("mu_s", mu_s)?,
        mu_k: of("mu_k", mu_k)?,
        alpha: of("alpha", alpha)?,
        v_s: of("v_s", v_s)?,
        sigma0: of("sigma0", sigma0)?,
        sigma1: of("sigma1", sigma1)?,
        sigma2: of("sigma2", sigma2)?,
    };
    let FrictionDistributions { mu, mu_s, mu_k, alpha, v_s, sigma0, sigma1, sigma2 } = &friction;
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
        // `None` means that all values are > 0.
        let Some((key, least)) = distribution.least() else { continue };
        if least < 0.0 || (positive && least == 0.0) {
            let allowed = if positive { "a number > 0" } else { "a number >= 0" };
            return Err(check.value(&format!("friction.{name}.{key}"), least, allowed));
        }
    }
    for (name, distribution) in [("mu", mu), ("mu_s", mu_s), ("mu_k", mu_k)] {
        check.note_large_friction(&format!("friction.{name}"), distribution.median());
    }
    if mu_s.median() < mu_k.median() {
        let allowed = format!("a median of at least that of mu_k, {}", mu_k.median());
        return Err(check.value("friction.mu_s", mu_s.median(), &allowed));
    }
    Ok(friction)
}
