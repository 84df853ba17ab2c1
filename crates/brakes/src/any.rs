//! The brake of a case of any kind, as programs take it that work on all of them.

use linsys::OperatingPoint;
use montecarlo::Progress;
use osc_model::Grid;
use output::significant;
use serde_json::{Map, Value, json};
use study::{AnySample, Cost, Erased, IndependentBrake, NamedParameter, Scene, UncertainBrake};
use sweep::Over;

use crate::case::CaseFile;
use crate::{Error, FiniteElementBrake, LatticeBrake, MatricesBrake, Prepared};

/// A brake that programs run on: what they show of it beside what a study needs. All of it has an answer for a brake that is known by
/// its equations alone, so that `impl CaseBrake for MyBrake {}` is enough.
pub trait CaseBrake: UncertainBrake {
    /// The grid of a lattice, for pictures of its modes.
    fn grid(&self) -> Option<Grid> {
        None
    }

    /// The brake as one of finite elements, for its mesh and its reduction.
    fn finite_elements(&self) -> Option<&FiniteElementBrake> {
        None
    }

    /// The parts of the brake and its study, each with a name, for people.
    fn contents(&self) -> Vec<(&'static str, String)> {
        let plan = self.plan();
        let Some(scene) = plan.scenes.first() else { return Vec::new() };
        let brake = plan.brake(scene);
        let terms = brake.system.terms().iter().map(|term| with_family(&term.name, &term.family)).collect();
        let contacts = brake.system.contacts().map(|channel| with_family(&channel.name, &channel.family)).collect();
        let given = self.parametrised().map_or_else(Vec::new, |of| of.parameters(scene));
        vec![
            ("dofs", brake.dofs.total().to_string()),
            ("terms", listed(terms)),
            ("contacts", listed(contacts)),
            ("parameters", listed(given.iter().map(|p| format!("{} [{}]", p.name, p.unit)).collect())),
            ("bodies", listed(brake.bodies.iter().map(|body| body.name.clone()).collect())),
            ("laws", listed(plan.labels.laws.iter().map(|law| law.name.clone()).collect())),
            ("constraints", listed(plan.labels.constraints.clone())),
        ]
    }

    /// The first scene at the medians, for machines.
    fn scene_json(&self) -> Value {
        let plan = self.plan();
        let Some(scene) = plan.scenes.first() else { return Value::Null };
        let [constraints, law, speed] = plan.labels.key_columns(scene.key);
        let given = self.parametrised().map_or_else(Vec::new, |of| of.parameters(scene));
        let parameters: Map<String, Value> = given.into_iter().map(|p| (p.name, json!(p.median))).collect();
        json!({ "constraints": constraints, "law": law, "speed": speed, "parameters": parameters })
    }

    /// The first scene at the medians, in words.
    fn medians_in_words(&self) -> String {
        let plan = self.plan();
        plan.scenes.first().map_or_else(String::new, |scene| {
            let given = self.parametrised().map_or_else(Vec::new, |of| of.parameters(scene));
            format!("{}; {}", plan.describe(scene), values_in_words(&given))
        })
    }
}

/// Medians of the parameters `given` in words, without factors of other numbers, which are 1 there, and without parameters of single contacts whose median is
/// the median of all contacts.
pub(crate) fn values_in_words(given: &[NamedParameter]) -> String {
    let is_of_all = |p: &NamedParameter| {
        let all = p.name.split_once('.').map(|(name, _)| name);
        given.iter().any(|other| Some(other.name.as_str()) == all && other.median == p.median)
    };
    let is_value = |p: &&NamedParameter| !p.unit.starts_with("times ") && !is_of_all(p);
    let values: Vec<String> = given.iter().filter(is_value).map(|p| with_unit(&p.name, p.median, &p.unit)).collect();
    format!("median parameters{}{}", if values.is_empty() { "" } else { ": " }, values.join(", "))
}

/// A number with its name and unit; one without a unit has "1" or nothing there.
pub(crate) fn with_unit(name: &str, value: f64, unit: &str) -> String {
    let unit = if matches!(unit, "" | "1") { String::new() } else { format!(" {unit}") };
    format!("{name} = {}{unit}", significant(value, 6))
}

/// A name with its family of forces, where that has another name.
pub(crate) fn with_family(name: &str, family: &str) -> String {
    if name == family { name.into() } else { format!("{name} ({family})") }
}

/// Names with commas between.
pub(crate) fn listed(names: Vec<String>) -> String {
    if names.is_empty() { "none".into() } else { names.join(", ") }
}

/// A brake of any kind.
pub type AnyBrake = Box<dyn CaseBrake<Sample = AnySample> + Send>;

impl CaseBrake for AnyBrake {
    fn grid(&self) -> Option<Grid> {
        (**self).grid()
    }

    fn finite_elements(&self) -> Option<&FiniteElementBrake> {
        (**self).finite_elements()
    }

    fn contents(&self) -> Vec<(&'static str, String)> {
        (**self).contents()
    }

    fn scene_json(&self) -> Value {
        (**self).scene_json()
    }

    fn medians_in_words(&self) -> String {
        (**self).medians_in_words()
    }
}

impl<F: Fn(&Scene, &[f64]) -> Result<OperatingPoint, study::Error> + Sync> CaseBrake for IndependentBrake<F> {}

impl<B: CaseBrake<Sample: 'static>> CaseBrake for Erased<B> {
    fn grid(&self) -> Option<Grid> {
        self.0.grid()
    }

    fn finite_elements(&self) -> Option<&FiniteElementBrake> {
        self.0.finite_elements()
    }

    fn contents(&self) -> Vec<(&'static str, String)> {
        self.0.contents()
    }

    fn scene_json(&self) -> Value {
        self.0.scene_json()
    }

    fn medians_in_words(&self) -> String {
        self.0.medians_in_words()
    }
}

/// The question that a brake is made for, where that decides how much of it is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Purpose<'a> {
    /// A study or influence: a reduced brake is checked against the full model.
    Study,
    /// The whole brake at one point, the first scene at its medians: of a reduced one no more is made than tells what diverges.
    Point,
    /// Analysis of one point by a reduced brake, or the cost of a study: a reduced brake is not checked.
    Analysis,
    /// A sweep: the reduced brake of the first scene holds the modes over these ranges.
    Sweep(&'a [Over]),
    /// A screen of modifications, which asks for the fastest mode of a draw in all arrangements: of finite elements those of a set of constraints have one basis, of a
    /// lattice they are told apart where draws tell them apart.
    Screen,
}

/// Memory and processor time of making the brake of a case for a purpose in a memory of `budget` bytes, roughly, before anything of it is made; `None` where that is nothing beside
/// preparing its study ([`Cost::of`]).
#[must_use]
pub fn cost_of_making(case: &CaseFile, purpose: Purpose<'_>, budget: u64) -> Option<Cost> {
    match case {
        CaseFile::Lattice(case) => Some(LatticeBrake::least_cost(case)),
        CaseFile::Matrices(_) => None,
        CaseFile::FiniteElements(case) => Some(FiniteElementBrake::expected_cost(case, purpose, budget)),
    }
}

/// The brake of a case. Only the reduction of finite elements takes time, and tells how far it has come.
///
/// # Errors
/// Refusals of the model or of the reduction; [`study::Error::Median`] where the medians of the parameters have no operating point.
pub fn make(case: CaseFile, purpose: Purpose<'_>, progress: &dyn Progress) -> Result<AnyBrake, Error> {
    make_prepared(case, purpose, &Prepared::default(), progress)
}

/// The brake of a case as by [`make`], of pieces that are read where they are kept.
///
/// # Errors
/// As [`make`]; a file of another prepared brake.
pub fn make_prepared(
    case: CaseFile,
    purpose: Purpose<'_>,
    prepared: &Prepared,
    progress: &dyn Progress,
) -> Result<AnyBrake, Error> {
    Ok(match case {
        CaseFile::Lattice(case) if purpose == Purpose::Screen => Box::new(Erased(LatticeBrake::of_equal_draws(*case)?)),
        CaseFile::Lattice(case) => Box::new(Erased(LatticeBrake::new(*case)?)),
        CaseFile::Matrices(case) => Box::new(Erased(MatricesBrake::new(*case)?)),
        CaseFile::FiniteElements(case) => {
            Box::new(Erased(FiniteElementBrake::prepared(*case, purpose, prepared, progress)?))
        }
    })
}
