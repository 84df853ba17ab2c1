//! Choice of the scene of a case that a command is about.

use brakes::case::{CaseError, CaseFile, ChosenSpeed, SceneChoice};
use brakes::{AnyBrake, Purpose};
use cea::Threshold;
use squeal::study::Plan;
use squeal::sweep::Over;

use super::options::{MachineArgs, number, override_run, whole_number};
use super::sized;
use crate::Error;
use crate::case_file::CaseArgs;

/// Name of the sliding speed as a parameter.
const SPEED: &str = "v";

/// The options that choose one scene of a case.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct SceneArgs {
    /// Friction law, where the case has several [default: the case's first]
    #[arg(long, value_name = "LAW")]
    pub law: Option<String>,
    /// Contacts that are closed (oscillators, patches), from 1, as in 1,2,5 [default: the case's first arrangement]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = contact)]
    pub contact: Option<Vec<usize>>,
    /// Constraint set by name [default: the case's first]
    #[arg(long, value_name = "NAME")]
    pub constraints: Option<String>,
    /// Sliding speed, in the unit of the case (m/s; mm/s in mm-t-s), of a lattice or finite elements [default: the median of the case's first range]
    #[arg(long, value_name = "V", allow_negative_numbers = true, value_parser = number)]
    pub speed: Option<f64>,
}

/// The number of a contact.
fn contact(text: &str) -> Result<usize, String> {
    text.parse().map_err(|_| "allowed: numbers of contacts, from 1, with commas between".to_owned())
}

impl SceneArgs {
    /// The case with the one scene that the options choose; `otherwise` says which speed where they give none.
    ///
    /// # Errors
    /// Names that the case does not have.
    pub fn only(&self, case: CaseFile, otherwise: ChosenSpeed) -> Result<CaseFile, Error> {
        let Self { law, contact, constraints, speed } = self.clone();
        let speed = speed.map_or(otherwise, ChosenSpeed::Fixed);
        case.only(&SceneChoice { law, contact, constraints, speed }).map_err(|error| match error {
            CaseError::Choice { what, value, allowed } => Error::Option { option: option(what), value, allowed },
            other => other.into(),
        })
    }
}

/// A scene of a case, and the random streams of its draws.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct DrawnSceneArgs {
    /// The case
    #[command(flatten)]
    pub case: CaseArgs,
    /// The scene
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Range of sliding speed by name [default: the case's first]
    #[arg(long, value_name = "NAME", conflicts_with = "speed")]
    pub range: Option<String>,
    /// Seed of the random streams, instead of the case's
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = whole_number)]
    pub seed: Option<u64>,
    /// Threads and memory
    #[command(flatten)]
    pub machine: MachineArgs,
}

impl DrawnSceneArgs {
    /// The brake of the scene, made for a purpose, with `samples` samples instead of the case's own number.
    ///
    /// # Errors
    /// Faults of the case or of an option.
    pub(super) fn brake(&self, samples: Option<u64>, purpose: Purpose<'_>) -> Result<AnyBrake, Error> {
        let mut case = self.case.read()?;
        override_run(case.header_mut(), samples, self.seed, self.machine.threads)?;
        let case = self.scene.only(case, ChosenSpeed::Range(self.range.clone()))?;
        sized::brake(case, purpose, self.machine, &self.case.prepared)
    }
}

/// The option that gives a field of a choice.
fn option(field: &str) -> &'static str {
    match field {
        "law" => "--law",
        "contact" => "--contact",
        "constraints" => "--constraints",
        "speed" => "--speed",
        _ => "--range",
    }
}

/// Words on the threshold beyond which a mode counts as unstable, to end a heading with; empty where that is the bare sign of Re lambda.
pub(super) fn counts_from(threshold: &Threshold) -> String {
    if threshold.is_axis() { String::new() } else { format!("; unstable: with {threshold}") }
}

/// Heading of an answer over the ranges of the parameters `over`: the first scene of a plan, without a speed where that is one of them.
pub(super) fn swept_in_words(plan: &Plan, over: &[Over]) -> String {
    let scene = &plan.scenes[0];
    let described = plan.describe(scene);
    let speed = scene.key.speed.map_or("all speeds", |range| &plan.labels.speeds[range].name);
    let described = match over.iter().any(|over| over.name == SPEED) {
        true => format!("{}speed {SPEED} as swept", described.strip_suffix(speed).unwrap_or(&described)),
        false => described,
    };
    format!("{}: {described}; other parameters at their medians{}", plan.name, counts_from(&plan.threshold))
}

/// Index of the name that an option gives; 0 where it is not given.
pub(super) fn chosen(option: &'static str, given: Option<&str>, names: &[&str]) -> Result<usize, Error> {
    let Some(given) = given else { return Ok(0) };
    let refused = || Error::Option { option, value: given.into(), allowed: names.join(", ") };
    names.iter().position(|name| *name == given).ok_or_else(refused)
}
