//! Which scene of a case a command is about.

use brakes::case::{FiniteElementCase, LatticeCase, Law, MatricesCase, SpeedRange};
use cea::Threshold;
use osc_model::ContactArrangement;

use super::options::number;
use crate::Error;

/// The options that choose one scene of a case.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct SceneArgs {
    /// Friction law, where the case has several [default: the case's first]
    #[arg(long, value_name = "LAW")]
    pub law: Option<String>,
    /// Contacts that are closed (oscillators, patches), from 1, as in 1,2,5 [default: the case's first arrangement]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub contact: Option<Vec<usize>>,
    /// Constraint set by name [default: the case's first]
    #[arg(long, value_name = "NAME")]
    pub constraints: Option<String>,
    /// Sliding speed, m/s, of a lattice or finite elements [default: the median of the case's first range]
    #[arg(long, value_name = "V", allow_negative_numbers = true, value_parser = number)]
    pub speed: Option<f64>,
}

/// From where on a mode counts as unstable, to end a heading with, where that is not the bare sign of Re lambda.
pub(super) fn counts_from(threshold: &Threshold) -> String {
    if threshold.is_axis() { String::new() } else { format!("; unstable: with {threshold}") }
}

/// One scene of a case with a lattice.
#[derive(Debug, Clone)]
pub(super) struct LatticeScene {
    pub law: Law,
    /// Place of the set of constraints.
    pub constraints: usize,
    pub arrangement: ContactArrangement,
    /// m/s.
    pub speed: f64,
}

impl SceneArgs {
    /// The scene of a lattice.
    ///
    /// # Errors
    /// What the case does not have.
    pub(super) fn lattice(&self, case: &LatticeCase) -> Result<LatticeScene, Error> {
        let refused = |option, value: &str, allowed: String| Error::Option { option, value: value.into(), allowed };
        let law = match &self.law {
            None => case.laws[0],
            Some(name) => *Law::ALL
                .iter()
                .find(|law| law.name() == name)
                .ok_or_else(|| refused("--law", name, Law::ALL.map(Law::name).join(", ")))?,
        };
        let names: Vec<&str> = case.constraints.iter().map(|set| set.name.as_str()).collect();
        let constraints = chosen("--constraints", self.constraints.as_deref(), &names)?;
        let arrangement = match &self.contact {
            None => case.panels[0].1[0].clone(),
            Some(numbers) => in_contact(case.lattice.grid.oscillators(), numbers, "oscillators")?,
        };
        let speed = allowed_speed(self.speed.unwrap_or(case.speeds[0].quantile(0.5)))?;
        Ok(LatticeScene { law, constraints, arrangement, speed })
    }

    /// The case with this one scene; with a `range` of speeds, unless the options give a speed, or at one speed.
    ///
    /// # Errors
    /// As [`SceneArgs::lattice`].
    pub(super) fn only_lattice(&self, mut case: LatticeCase, range: Option<SpeedRange>) -> Result<LatticeCase, Error> {
        let LatticeScene { law, constraints, arrangement, speed } = self.lattice(&case)?;
        case.laws = vec![law];
        case.constraints = vec![case.constraints.swap_remove(constraints)];
        case.panels = vec![(arrangement.in_contact().len(), vec![arrangement])];
        case.speeds = vec![range.filter(|_| self.speed.is_none()).unwrap_or_else(|| only(speed))];
        Ok(case)
    }

    /// The case with this one set of constraints.
    ///
    /// # Errors
    /// As [`SceneArgs::matrices`].
    pub(super) fn only_matrices(&self, mut case: MatricesCase) -> Result<MatricesCase, Error> {
        let set = self.matrices(&case)?;
        case.constraints = vec![case.constraints.swap_remove(set)];
        Ok(case)
    }

    /// The case with this one scene, in a range of speeds, unless the options give a speed.
    ///
    /// # Errors
    /// What the case does not have, and options of a contact where it has none.
    pub(super) fn only_finite_elements(
        &self,
        mut case: FiniteElementCase,
        range: Option<SpeedRange>,
    ) -> Result<FiniteElementCase, Error> {
        let names: Vec<&str> = case.constraints.iter().map(|set| set.name.as_str()).collect();
        let set = chosen("--constraints", self.constraints.as_deref(), &names)?;
        case.constraints = vec![case.constraints.swap_remove(set)];
        let Some(contact) = &mut case.contact else {
            self.refuse_contact("cases with [contact]; this one has none")?;
            return Ok(case);
        };
        let laws: Vec<&str> = contact.laws.iter().map(|law| law.name()).collect();
        contact.laws = vec![contact.laws[chosen("--law", self.law.as_deref(), &laws)?]];
        let arrangement = match &self.contact {
            None => contact.panels[0].1[0].clone(),
            Some(numbers) => in_contact(contact.patches.len(), numbers, "patches")?,
        };
        contact.panels = vec![(arrangement.in_contact().len(), vec![arrangement])];
        let fixed = self.speed.map(|speed| allowed_speed(speed).map(only)).transpose()?;
        contact.speeds = fixed.or(range).map_or_else(|| std::mem::take(&mut contact.speeds), |range| vec![range]);
        Ok(case)
    }

    /// The place of the set of constraints of a case that is given by its matrices.
    ///
    /// # Errors
    /// What the case does not have, and options of a lattice.
    pub(super) fn matrices(&self, case: &MatricesCase) -> Result<usize, Error> {
        self.refuse_contact("cases with a lattice or finite elements; this one is given by its matrices")?;
        let names: Vec<&str> = case.constraints.iter().map(|set| set.name.as_str()).collect();
        chosen("--constraints", self.constraints.as_deref(), &names)
    }

    /// The options about friction in a contact, refused for a case in which they mean nothing.
    fn refuse_contact(&self, allowed: &str) -> Result<(), Error> {
        let given =
            [("--law", self.law.is_some()), ("--contact", self.contact.is_some()), ("--speed", self.speed.is_some())];
        match given.into_iter().find(|(_, is_given)| *is_given) {
            Some((option, _)) => Err(Error::Option { option, value: "given".into(), allowed: allowed.into() }),
            None => Ok(()),
        }
    }
}

/// The contacts that an option gives by their numbers from 1.
fn in_contact(contacts: usize, numbers: &[usize], what: &str) -> Result<ContactArrangement, Error> {
    ContactArrangement::from_numbers(contacts, numbers).map_err(|_| {
        let value = numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(",");
        Error::Option { option: "--contact", value, allowed: format!("{what} 1 to {contacts}, each once") }
    })
}

/// A speed that an option gives, m/s.
fn allowed_speed(speed: f64) -> Result<f64, Error> {
    if speed.is_finite() && speed > 0.0 {
        return Ok(speed);
    }
    Err(Error::Option { option: "--speed", value: speed.to_string(), allowed: "a speed in m/s, > 0".into() })
}

/// The range of one speed, m/s.
fn only(speed: f64) -> SpeedRange {
    SpeedRange { name: format!("{speed:.4} m/s"), from: speed, to: speed }
}

/// The place of the name that an option gives; the first where it is not given.
pub(super) fn chosen(option: &'static str, given: Option<&str>, names: &[&str]) -> Result<usize, Error> {
    let Some(given) = given else { return Ok(0) };
    let refused = || Error::Option { option, value: given.into(), allowed: names.join(", ") };
    names.iter().position(|name| *name == given).ok_or_else(refused)
}
