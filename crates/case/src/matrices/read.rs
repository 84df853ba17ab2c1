//! Reading of a case with matrices: from the fields of its file to a checked case.

use std::f64::consts::TAU;
use std::path::Path;

use cea::{CeaError, RealModes, check_mass};
use formats::{Entry, Kind};
use linsys::{AffineSystem, SecondOrder, Term};
use nalgebra::DMatrix;

use super::contacts::channels_with_gains;
use super::dofs::DofNames;
use super::elsewhere::Places;
use super::loss::add_dashpots;
use super::relaxing::branches_of_terms;
use super::schema::{self, MatricesFile};
use super::terms::{Terms, read_terms};
use super::{BodyDofs, FixedDofs, MatricesCase};
use crate::CaseError;
use crate::check::{Check, field, syntax};
use crate::correlation::Correlated;
use crate::expression::formulas::Formulas;
use crate::feeding::note_feeding;
use crate::held::HeldRows;
use crate::parameter::{CUT, Parameter, parameter};
use crate::relaxing::Relaxing;

/// Frequency, Hz, below which all of a brake are where it has its mass and its stiffness in each other's places: `omega` becomes `1 / omega`, and the lowest
/// frequency `f` of a brake the highest, `1 / (4 pi^2 f)`. Of 1 Hz and more it comes to less than this; chosen.
const SWAPPED: f64 = 0.03;

impl MatricesCase {
    /// Checks the text of a case file; `path` is for messages, and files with matrices are read relative to its folder.
    ///
    /// # Errors
    /// The first fault, in one line that names the file, the field, the value and what is allowed.
    pub fn parse(path: &Path, text: String) -> Result<Self, CaseError> {
        let (case, formulas_use_all) = Self::parse_open(path, text)?;
        formulas_use_all?;
        case.check_mass()?;
        Ok(case)
    }

    /// Checks the text of a case of which some coefficients are computed by the program that reads it: the case, and beside it the error
    /// for a parameter that occurs in none of its own expressions.
    ///
    /// # Errors
    /// As [`MatricesCase::parse`], for any other fault.
    pub fn parse_open(path: &Path, text: String) -> Result<(Self, Result<(), CaseError>), CaseError> {
        let file: MatricesFile = toml::from_str(&text).map_err(|error| syntax(path, &text, &error))?;
        let check = Check::new(path);
        let MatricesFile {
            study,
            brake,
            parameters,
            tables,
            terms,
            contacts,
            bodies,
            constraints,
            accuracy,
            squeal,
            measured,
            correlation,
        } = file;
        let header = check.header(text, (study.name, study.samples, study.seed), accuracy, squeal, measured)?;
        let parameters: Vec<Parameter> =
            parameters.into_iter().map(|(name, given)| parameter(&check, name, given)).collect::<Result<_, _>>()?;
        let tables = check.tables(tables, parameters.iter().map(|parameter| &parameter.name))?;
        let mut formulas = Formulas::new(&check, &parameters, &tables);
        let Terms { terms, coefficients, losses, branches, taken, rows } = read_terms(&check, &mut formulas, terms)?;
        let order = terms.first().map_or(0, Term::order);
        let dofs = DofNames::new(&check, brake.dofs, rows, order)?;
        let (mut channels, gains) = channels_with_gains(&check, &mut formulas, &dofs, contacts)?;
        let Relaxing { branches, channels: relaxing } =
            branches_of_terms(&check, &mut formulas, &terms, &losses, branches)?;
        channels.extend(relaxing);
        let all_used = formulas.all_used();
        let mut constraints = constraint_sets(&check, &dofs, constraints)?;
        refuse_held(&check, &dofs, &terms, &constraints)?;
        if losses.iter().any(Option::is_some) {
            let with_loss =
                terms.iter().zip(&coefficients).zip(&losses).filter(|(_, loss)| loss.is_some_and(|loss| loss > 0.0));
            let lossy = with_loss.map(|((term, coefficient), _)| (term.name.as_str(), coefficient));
            note_feeding(&check, &parameters.iter().collect::<Vec<_>>(), lossy);
            let places = Places::new(&check, &parameters, &terms, &coefficients)?;
            add_dashpots(&check, &mut constraints, &places, &terms, &losses)?;
        }
        let system = AffineSystem::new(terms, channels).map_err(check.system("terms"))?;
        let named = parameters.iter().map(|parameter| (parameter.name.as_str(), &parameter.distribution));
        let correlated =
            Correlated { friction: Vec::new(), contacts: &[[0.0; 3]], has_numbers: false, others: named.collect() };
        let mut case = Self {
            header,
            correlation: check.correlation(correlation, &correlated)?,
            system,
            coefficients,
            taken,
            gains,
            branches,
            bodies: groups(&check, &dofs, bodies)?,
            constraints,
            moves: dofs.moves().to_vec(),
            dofs: dofs.into_names(),
            parameters,
            tables,
        };
        case.check_contacts(&check)?;
        case.note_swapped(&check)?;
        case.header.notes = check.notes();
        // An expression without a value at the medians is an error of the case, found before a study starts.
        case.operating_point(&case.medians())?;
        Ok((case, all_used))
    }
}

impl MatricesCase {
    /// An error where a load, speed or stiffness of a contact is no number > 0 at the medians; a note of each coefficient of friction that no material has,
    /// that is negative there, or where one parameter is at an end of what it is drawn from.
    fn check_contacts(&self, check: &Check<'_>) -> Result<(), CaseError> {
        let medians = self.medians();
        let ends = self.parameters.iter().enumerate().flat_map(|(at, parameter)| {
            let end = |part: f64| (at, parameter.distribution.quantile(part));
            [end(CUT), end(1.0 - CUT)]
        });
        let ends: Vec<(usize, f64)> = ends.filter(|&(at, value)| value != medians[at]).collect();
        for (channel, gain) in self.system.channels().iter().zip(&self.gains) {
            for (key, given) in [("load", &gain.load), ("speed", &gain.speed), ("stiffness", &gain.stiffness)] {
                let Some(expression) = given else { continue };
                let key = field("contacts", &channel.name, key);
                let value = expression.value(&medians).map_err(check.expression(&key))?;
                if value <= 0.0 {
                    return Err(check.value(&key, value, "a number > 0"));
                }
            }
            let key = field("contacts", &channel.name, "mu");
            // A product may have a part of the reading in it.
            let own = gain.mu.text().trim();
            if own.parse::<f64>().is_ok() || self.parameters.iter().any(|parameter| parameter.name == own) {
                check.note_large_friction(&key, gain.mu.value(&medians).unwrap_or(0.0));
            }
            let at = |changed: Option<&(usize, f64)>| {
                let mut values = medians.clone();
                changed.into_iter().for_each(|&(at, value)| values[at] = value);
                // Where it has no value the operating point says so.
                gain.mu.value(&values).unwrap_or(0.0)
            };
            let place = match (at(None) < 0.0, ends.iter().find(|&end| at(Some(end)) < 0.0)) {
                (true, _) => format!("{} at the medians", at(None)),
                (false, Some(end)) => format!("{} at {} = {}", at(Some(end)), self.parameters[end.0].name, end.1),
                (false, None) => continue,
            };
            check.note(format!(
                "{key} is {place}: negative friction drives the sliding; the other direction turns the sign of force"
            ));
        }
        Ok(())
    }

    /// A note where all frequencies at the medians are so low that each term may have its mass in the place of its stiffness.
    fn note_swapped(&self, check: &Check<'_>) -> Result<(), CaseError> {
        let medians = self.medians();
        // Where a coefficient has no value the operating point says so.
        let coefficients: Result<Vec<f64>, _> = self.coefficients.iter().map(|own| own.value(&medians)).collect();
        let Ok(coefficients) = coefficients else { return Ok(()) };
        let SecondOrder { m, k, .. } = self.system.structure(&coefficients).map_err(check.system("terms"))?;
        if !(k.amax() > 0.0 && k.amax() < m.amax()) {
            return Ok(());
        }
        let modes = RealModes::new(&m, &k).ok();
        let largest = modes.and_then(|modes| modes.omega_squared.last().map(|square| square.max(0.0).sqrt() / TAU));
        if largest.is_some_and(|largest| largest < SWAPPED) {
            check.note(format!(
                "terms: all frequencies of the structure are below {SWAPPED} Hz at the medians: are mass and stiffness swapped?"
            ));
        }
        Ok(())
    }

    /// An error unless the mass at the medians is symmetric and positive definite on the degrees of freedom that each set of constraints
    /// leaves free.
    fn check_mass(&self) -> Result<(), CaseError> {
        let mass = self.system.structure(&self.operating_point(&self.medians())?.coefficients);
        let check = Check::new(&self.header.path);
        let mass = mass.map_err(check.system("terms"))?.m;
        for FixedDofs { fixed, .. } in &self.constraints {
            let free: Vec<usize> = (0..mass.nrows()).filter(|row| !fixed.contains(row)).collect();
            let of_free = mass.select_rows(&free).select_columns(&free);
            let Err(CeaError::MassNotPositiveDefinite { row }) = check_mass(&of_free) else { continue };
            let with_mass = self.system.terms().iter().filter(|term| term.matrices().m.amax() > 0.0);
            let fields: Vec<String> = with_mass.map(|term| field("terms", &term.name, "mass")).collect();
            let found = format!("not symmetric positive definite in row {:?}", self.dofs[free[row - 1]]);
            let allowed = "masses that are so together at the medians, on all degrees of freedom that are not fixed";
            return Err(check.value(&fields.join(", "), found, allowed));
        }
        Ok(())
    }
}

/// A matrix of a term.
fn part(term: &Term, kind: Kind) -> &DMatrix<f64> {
    match kind {
        Kind::Mass => &term.matrices().m,
        Kind::Damping => &term.matrices().c,
        Kind::Stiffness => &term.matrices().k,
    }
}

/// Refuses rows that are held by huge entries, unless every set of constraints fixes them: no digits are left of the others.
fn refuse_held(
    check: &Check<'_>,
    dofs: &DofNames<'_>,
    terms: &[Term],
    constraints: &[FixedDofs],
) -> Result<(), CaseError> {
    let mut held = HeldRows::new(dofs.order());
    for kind in [Kind::Mass, Kind::Damping, Kind::Stiffness] {
        let entry = |(at, &value): (usize, &f64)| Entry {
            row: (at % dofs.order()) as u32,
            column: (at / dofs.order()) as u32,
            value,
        };
        let entries = terms.iter().flat_map(|term| part(term, kind).iter().enumerate().map(entry));
        held.add(kind, entries).map_err(|tied| {
            let found = format!("matrices in which {:?} has a huge entry", dofs.name(tied.row - 1));
            check.value("terms", found, &tied.to_string())
        })?;
    }
    let free: Vec<_> = held
        .rows()
        .into_iter()
        .filter(|row| constraints.iter().any(|set| !set.fixed.contains(row)))
        .map(|row| dofs.name(row).to_owned())
        .collect();
    if !free.is_empty() {
        let found = format!("{} held by huge entries on the diagonal", free.join(", "));
        return Err(check.value("terms", found, "held degrees of freedom among those fixed in every [[constraints]]"));
    }
    Ok(())
}

fn groups(check: &Check<'_>, dofs: &DofNames<'_>, given: Vec<schema::BodyTable>) -> Result<Vec<BodyDofs>, CaseError> {
    if given.is_empty() {
        return Ok(vec![BodyDofs { name: "brake".into(), dofs: (0..dofs.order()).collect() }]);
    }
    check.names("bodies.name", given.iter().map(|body| &body.name))?;
    let mut owners: Vec<Option<usize>> = vec![None; dofs.order()];
    let mut bodies: Vec<BodyDofs> = Vec::new();
    for schema::BodyTable { name, dofs: listed } in given {
        let field = field("bodies", &name, "dofs");
        let own = dofs.indices(&field, &listed)?;
        if own.is_empty() {
            return Err(check.value(&field, "[]", "one degree of freedom or more"));
        }
        for &dof in &own {
            if let Some(other) = owners[dof].replace(bodies.len()) {
                let found = format!("{:?}, which is in {:?} too", dofs.name(dof), bodies[other].name);
                return Err(check.value(&field, found, "each degree of freedom in one body"));
            }
        }
        bodies.push(BodyDofs { name, dofs: own });
    }
    match owners.iter().position(Option::is_none) {
        None => Ok(bodies),
        Some(dof) => {
            let found = format!("{:?} in none", dofs.name(dof));
            Err(check.value("bodies", found, "each degree of freedom in one body"))
        }
    }
}

fn constraint_sets(
    check: &Check<'_>,
    dofs: &DofNames<'_>,
    given: Vec<schema::ConstraintsTable>,
) -> Result<Vec<FixedDofs>, CaseError> {
    if given.is_empty() {
        return Ok(vec![FixedDofs { name: "none".into(), fixed: Vec::new(), dashpots: Vec::new() }]);
    }
    check.no_repeats("constraints.name", given.iter().map(|set| set.name.clone()))?;
    given.into_iter().map(|set| fixed_dofs(check, dofs, set)).collect()
}

fn fixed_dofs(check: &Check<'_>, dofs: &DofNames<'_>, given: schema::ConstraintsTable) -> Result<FixedDofs, CaseError> {
    let schema::ConstraintsTable { name, fixed } = given;
    check.plain_name("constraints.name", &name)?;
    let field = field("constraints", &name, "fixed");
    let fixed = dofs.indices(&field, &fixed)?;
    if fixed.len() == dofs.order() {
        return Err(check.value(&field, "all", "at most all degrees of freedom but one"));
    }
    Ok(FixedDofs { name, fixed, dashpots: Vec::new() })
}
