//! Which scene of a case a command is about.

use osc_model::ContactArrangement;

use super::options::number;
use crate::Error;
use crate::case::{LatticeCase, Law, MatricesCase, SpeedRange};

/// The options that choose one scene of a case.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct SceneArgs {
    /// Friction law of a lattice [default: the case's first]
    #[arg(long, value_name = "LAW")]
    pub law: Option<String>,
    /// Oscillators in contact, from 1, as in 1,2,5 [default: the case's first arrangement]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub contact: Option<Vec<usize>>,
    /// Constraint set by name [default: the case's first]
    #[arg(long, value_name = "NAME")]
    pub constraints: Option<String>,
    /// Sliding speed of a lattice, m/s [default: the median of the case's first range]
    #[arg(long, value_name = "V", allow_negative_numbers = true, value_parser = number)]
    pub speed: Option<f64>,
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
            Some(numbers) => {
                let oscillators = case.lattice.grid.oscillators();
                ContactArrangement::from_numbers(oscillators, numbers).map_err(|_| {
                    let list: Vec<String> = numbers.iter().map(usize::to_string).collect();
                    refused("--contact", &list.join(","), format!("oscillators 1 to {oscillators}, each once"))
                })?
            }
        };
        let speed = self.speed.unwrap_or(case.speeds[0].quantile(0.5));
        if !(speed.is_finite() && speed > 0.0) {
            return Err(refused("--speed", &speed.to_string(), "a speed in m/s, > 0".into()));
        }
        Ok(LatticeScene { law, constraints, arrangement, speed })
    }

    /// A case with a lattice that has this scene alone.
    ///
    /// # Errors
    /// What the case does not have.
    pub(super) fn only_of_lattice(&self, mut case: LatticeCase) -> Result<LatticeCase, Error> {
        let LatticeScene { law, constraints, arrangement, speed } = self.lattice(&case)?;
        case.laws = vec![law];
        case.constraints = vec![case.constraints.swap_remove(constraints)];
        case.panels = vec![(arrangement.in_contact().len(), vec![arrangement])];
        case.speeds = vec![SpeedRange { name: format!("{speed:.4} m/s"), from: speed, to: speed }];
        Ok(case)
    }

    /// A case that is given by its matrices with this scene alone.
    ///
    /// # Errors
    /// As [`SceneArgs::matrices`].
    pub(super) fn only_of_matrices(&self, mut case: MatricesCase) -> Result<MatricesCase, Error> {
        let set = self.matrices(&case)?;
        case.constraints = vec![case.constraints.swap_remove(set)];
        Ok(case)
    }

    /// The place of the set of constraints of a case that is given by its matrices.
    ///
    /// # Errors
    /// What the case does not have, and options of a lattice.
    pub(super) fn matrices(&self, case: &MatricesCase) -> Result<usize, Error> {
        let lattice_only =
            [("--law", self.law.is_some()), ("--contact", self.contact.is_some()), ("--speed", self.speed.is_some())];
        if let Some((option, _)) = lattice_only.into_iter().find(|(_, is_given)| *is_given) {
            let allowed = "cases with a lattice; this one is given by its matrices".into();
            return Err(Error::Option { option, value: "given".into(), allowed });
        }
        let names: Vec<&str> = case.constraints.iter().map(|set| set.name.as_str()).collect();
        chosen("--constraints", self.constraints.as_deref(), &names)
    }
}

/// The place of the name that an option gives; the first where it is not given.
pub(super) fn chosen(option: &'static str, given: Option<&str>, names: &[&str]) -> Result<usize, Error> {
    let Some(given) = given else { return Ok(0) };
    let refused = || Error::Option { option, value: given.into(), allowed: names.join(", ") };
    names.iter().position(|name| *name == given).ok_or_else(refused)
}
