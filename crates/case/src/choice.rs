//! Choice of one scene of a case, by what a user calls it.

use osc_model::ContactArrangement;
use output::significant;
use study::Units;

use super::{CaseError, CaseFile, FiniteElementCase, LatticeCase, Law, MatricesCase, SpeedRange};

/// The scene of a case that a question is about; what is not chosen is the first that the case has.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SceneChoice {
    /// Friction law, by its name.
    pub law: Option<String>,
    /// Contacts that are closed (oscillators, patches), from 1.
    pub contact: Option<Vec<usize>>,
    /// Set of constraints, by its name.
    pub constraints: Option<String>,
    /// Sliding speed.
    pub speed: ChosenSpeed,
}

/// The sliding speed of a chosen scene.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum ChosenSpeed {
    /// The median of the first range of the case.
    #[default]
    Median,
    /// A given speed, m/s, > 0.
    Fixed(f64),
    /// A range of the case from which speeds are drawn, by its name; the first without one.
    Range(Option<String>),
}

impl CaseFile {
    /// The case with the one scene that is chosen.
    ///
    /// # Errors
    /// [`CaseError::Choice`]: what the case does not have, and what means nothing for a brake of its kind.
    pub fn only(self, choice: &SceneChoice) -> Result<Self, CaseError> {
        Ok(match self {
            Self::Lattice(case) => Self::Lattice(Box::new(lattice(*case, choice)?)),
            Self::Matrices(case) => Self::Matrices(Box::new(matrices(*case, choice)?)),
            Self::FiniteElements(case) => Self::FiniteElements(Box::new(finite_elements(*case, choice)?)),
        })
    }

    /// Names of the sets of constraints.
    pub fn constraint_sets(&self) -> Vec<&str> {
        match self {
            Self::Lattice(case) => case.constraints.iter().map(|set| set.name.as_str()).collect(),
            Self::Matrices(case) => case.constraints.iter().map(|set| set.name.as_str()).collect(),
            Self::FiniteElements(case) => case.constraints.iter().map(|set| set.name.as_str()).collect(),
        }
    }
}

fn lattice(mut case: LatticeCase, choice: &SceneChoice) -> Result<LatticeCase, CaseError> {
    if let Some(name) = &choice.law {
        let law = Law::ALL.into_iter().find(|law| law.name() == name);
        case.laws = vec![law.ok_or_else(|| refused("law", name, Law::ALL.map(Law::name).join(", ")))?];
    }
    case.laws.truncate(1);
    let names: Vec<&str> = case.constraints.iter().map(|set| set.name.as_str()).collect();
    let set = chosen("constraints", choice.constraints.as_deref(), &names)?;
    case.constraints = vec![case.constraints.swap_remove(set)];
    let arrangement = match &choice.contact {
        None => case.panels[0].1[0].clone(),
        Some(numbers) => in_contact(case.lattice.grid.oscillators(), numbers, "oscillators")?,
    };
    case.panels = vec![(arrangement.in_contact().len(), vec![arrangement])];
    let median = fixed(case.speeds[0].quantile(0.5), Units::Si);
    case.speeds = vec![speeds(&choice.speed, &case.speeds, Units::Si)?.unwrap_or(median)];
    Ok(case)
}

fn matrices(mut case: MatricesCase, choice: &SceneChoice) -> Result<MatricesCase, CaseError> {
    nothing_of_contact(choice, "cases with a lattice or finite elements; this one is given by its matrices")?;
    let names: Vec<&str> = case.constraints.iter().map(|set| set.name.as_str()).collect();
    let set = chosen("constraints", choice.constraints.as_deref(), &names)?;
    case.constraints = vec![case.constraints.swap_remove(set)];
    Ok(case)
}

fn finite_elements(mut case: FiniteElementCase, choice: &SceneChoice) -> Result<FiniteElementCase, CaseError> {
    let names: Vec<&str> = case.constraints.iter().map(|set| set.name.as_str()).collect();
    let set = chosen("constraints", choice.constraints.as_deref(), &names)?;
    case.constraints = vec![case.constraints.swap_remove(set)];
    let Some(contact) = &mut case.contact else {
        nothing_of_contact(choice, "cases with [contact]; this one has none")?;
        return Ok(case);
    };
    let laws: Vec<&str> = contact.laws.iter().map(|law| law.name()).collect();
    contact.laws = vec![contact.laws[chosen("law", choice.law.as_deref(), &laws)?]];
    let arrangement = match &choice.contact {
        None => contact.panels[0].1[0].clone(),
        Some(numbers) => in_contact(contact.patches.len(), numbers, "patches")?,
    };
    contact.panels = vec![(arrangement.in_contact().len(), vec![arrangement])];
    // The first scene is at the median of the first range.
    if let Some(range) = speeds(&choice.speed, &contact.speeds, case.header.units)? {
        contact.speeds = vec![range];
    }
    Ok(case)
}

/// The range of speeds that is chosen; `None` for the median of the first.
fn speeds(choice: &ChosenSpeed, ranges: &[SpeedRange], units: Units) -> Result<Option<SpeedRange>, CaseError> {
    match choice {
        ChosenSpeed::Median => Ok(None),
        ChosenSpeed::Fixed(speed) if speed.is_finite() && *speed > 0.0 => Ok(Some(fixed(*speed, units))),
        ChosenSpeed::Fixed(speed) => {
            Err(refused("speed", &speed.to_string(), format!("a speed in {}, > 0", units.of("m/s"))))
        }
        ChosenSpeed::Range(Some(name)) if ranges.is_empty() => {
            Err(refused("range", name, "cases with ranges of speed".into()))
        }
        ChosenSpeed::Range(name) => {
            let names: Vec<&str> = ranges.iter().map(|range| range.name.as_str()).collect();
            Ok(ranges.get(chosen("range", name.as_deref(), &names)?).cloned())
        }
    }
}

/// An error where a choice names a law, a contact, a speed or a range of speed of a case in which these mean nothing.
fn nothing_of_contact(choice: &SceneChoice, allowed: &str) -> Result<(), CaseError> {
    let SceneChoice { law, contact, constraints: _, speed } = choice;
    let numbers = |of: &Vec<usize>| of.iter().map(usize::to_string).collect::<Vec<_>>().join(",");
    let speed_given = if let ChosenSpeed::Fixed(speed) = speed { Some(speed.to_string()) } else { None };
    let given = [("law", law.clone()), ("contact", contact.as_ref().map(numbers)), ("speed", speed_given)];
    match given.into_iter().find_map(|(what, value)| Some((what, value?))) {
        Some((what, value)) => Err(refused(what, &value, allowed.into())),
        None => speeds(speed, &[], Units::Si).map(drop),
    }
}

/// The contacts with these numbers, from 1.
fn in_contact(contacts: usize, numbers: &[usize], what: &str) -> Result<ContactArrangement, CaseError> {
    ContactArrangement::from_numbers(contacts, numbers).map_err(|_| {
        let value = numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(",");
        refused("contact", &value, format!("{what} 1 to {contacts}, each once"))
    })
}

/// The range of one speed.
fn fixed(speed: f64, units: Units) -> SpeedRange {
    SpeedRange { name: format!("{} {}", significant(speed, 4), units.of("m/s")), from: speed, to: speed }
}

/// Index of a name in a list; 0 where none is given.
fn chosen(what: &'static str, given: Option<&str>, names: &[&str]) -> Result<usize, CaseError> {
    let Some(given) = given else { return Ok(0) };
    names.iter().position(|name| *name == given).ok_or_else(|| {
        refused(what, given, names.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", "))
    })
}

fn refused(what: &'static str, value: &str, allowed: String) -> CaseError {
    CaseError::Choice { what, value: value.into(), allowed }
}
