//! Drawn parameters: their names, units and distributions.

use montecarlo::Distribution;
use serde::Deserialize;

use crate::check::Check;
use crate::random_field::Kernel;
use crate::{CaseError, is_parameter_name};

/// A drawn parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name in expressions.
    pub name: String,
    /// Unit, for information only.
    pub unit: String,
    /// Distribution from which the parameter is drawn.
    pub distribution: Distribution,
}

/// Places away from the medians, in words, with the values of all parameters there: one of them at its 5 or 95 % quantile, where that is another value than its
/// median.
pub(crate) fn elsewhere(parameters: &[&Parameter]) -> Vec<(String, Vec<f64>)> {
    let medians: Vec<f64> = parameters.iter().map(|parameter| parameter.distribution.median()).collect();
    let of_parameter = |(at, Parameter { name, distribution, .. }): (usize, &&Parameter)| {
        let quantiles = [0.05, 0.95].map(|fraction| distribution.quantile(fraction));
        let place = |quantile: f64| {
            let mut values = medians.clone();
            values[at] = quantile;
            (format!("{name} = {quantile:.4}"), values)
        };
        quantiles.into_iter().filter(|quantile| *quantile != medians[at]).map(place).collect::<Vec<_>>()
    };
    parameters.iter().enumerate().flat_map(of_parameter).collect()
}

/// A unit, and a distribution whose fields are in the same table.
#[derive(Debug, Deserialize)]
pub(crate) struct ParameterTable {
    #[serde(default)]
    pub unit: String,
    pub over: Option<OverEntry>,
    #[serde(flatten)]
    pub distribution: Distribution,
}

/// Places of the values of a parameter, as a case file says them.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(
    untagged,
    expecting = "expected \"patches\", or { kernel = \"exponential\" or \"gaussian\", length = a distance, share = of the variance }"
)]
pub(crate) enum OverEntry {
    Word(OverWord),
    Field(OverField),
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum OverWord {
    Patches,
}

/// A random field over the faces of contacts.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct OverField {
    pub kernel: Kernel,
    pub length: f64,
    #[serde(default = "share")]
    pub share: f64,
}

fn share() -> f64 {
    0.95
}

/// Largest part of a normal distribution below 0 that is left out without a line that says so; chosen: it moves no occurrence that anyone reads. Also the
/// probability beyond the quantile that is taken for an end of a distribution.
pub(crate) const CUT: f64 = 1e-3;

/// A parameter with a name, from its table.
///
/// # Errors
/// A name that an expression cannot have; `over`, which finite elements alone have; a unit that is not one line, a distribution that is not allowed.
pub(crate) fn parameter(check: &Check<'_>, name: String, given: ParameterTable) -> Result<Parameter, CaseError> {
    if !is_parameter_name(&name) {
        let allowed = "a letter or _, then letters, digits and _, no function and not pi";
        return Err(check.value("parameters", format!("{name:?}"), allowed));
    }
    let ParameterTable { unit, over, distribution } = given;
    if over.is_some() {
        let allowed = "finite elements, whose contacts have patches and faces";
        return Err(check.value(&format!("parameters.{name}.over"), "given", allowed));
    }
    check.line(&format!("parameters.{name}.unit"), &unit)?;
    let distribution = check.distribution(&format!("parameters.{name}"), distribution)?;
    if let Distribution::Normal { mean, deviation, at_least: 0.0, at_most: None } = distribution {
        let cut = Distribution::Normal { mean, deviation, at_least: f64::NEG_INFINITY, at_most: None }.cumulative(0.0);
        if cut > CUT {
            check.note(format!(
                "parameters.{name}: {:.1} % of the normal distribution lie below 0 and are left out; at_least = -inf takes it whole",
                100.0 * cut
            ));
        }
    }
    Ok(Parameter { name, unit, distribution })
}
