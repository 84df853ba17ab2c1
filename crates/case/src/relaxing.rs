//! Viscoelastic terms and springs: stiffness that relaxes, as internal states of the directions in which it acts.

use std::path::Path;

use linsys::{Channel, ChannelGain, Lag};
use serde::Deserialize;

use crate::check::Check;
use crate::expression::formulas::{Formula, Formulas};
use crate::{CaseError, Expression};

/// A branch of a viscoelastic term.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BranchTable {
    pub ratio: Formula,
    pub rate: Formula,
}

/// A branch of a viscoelastic term or spring: `ratio K lambda / (lambda + rate)` beside its `K`, a spring in series with a dashpot at each of its springs.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// Index of the term.
    pub term: usize,
    /// Stiffness of the branch over the stiffness of the term, 1.
    pub ratio: Expression,
    /// Rate at which its force relaxes, 1/s.
    pub rate: Expression,
    /// Field of the case file.
    pub field: String,
    /// Directions in which the stiffness of the term acts: its rank.
    pub directions: usize,
}

impl Branch {
    /// Words on a branch of a term with a name.
    pub fn in_words(&self, term: &str) -> String {
        format!("{term} in {} direction{}", self.directions, if self.directions == 1 { "" } else { "s" })
    }
}

/// Branches of a case, and a channel for each direction of each of them.
#[derive(Default)]
pub(crate) struct Relaxing {
    pub branches: Vec<Branch>,
    pub channels: Vec<Channel>,
}

impl Relaxing {
    /// Adds the branches of a term, by its index, name and family, whose stiffness is `sum b b^T` over its directions b; `key` is their field.
    ///
    /// # Errors
    /// An expression that cannot be read.
    pub fn add(
        &mut self,
        formulas: &mut Formulas<'_>,
        key: &str,
        (term, name, family): (usize, &str, &str),
        directions: &[Vec<(usize, f64)>],
        given: Vec<BranchTable>,
    ) -> Result<(), CaseError> {
        for (number, BranchTable { ratio, rate }) in given.into_iter().enumerate() {
            let field = format!("{key}[{}]", number + 1);
            self.branches.push(Branch {
                term,
                ratio: formulas.expression(&format!("{field}.ratio"), Some(ratio), 0.0)?,
                rate: formulas.expression(&format!("{field}.rate"), Some(rate), 0.0)?,
                field,
                directions: directions.len(),
            });
            self.channels.extend(directions.iter().map(|b| Channel::relaxing(name, family, b.clone())));
        }
        Ok(())
    }
}

/// Gains of the channels of branches, at values of the parameters and the coefficients of the terms there; `path` is the path of the case.
///
/// # Errors
/// An expression without a value; a ratio below 0, a rate that is not above it.
pub(crate) fn gains_of(
    path: &Path,
    branches: &[Branch],
    values: &[f64],
    coefficients: &[f64],
) -> Result<Vec<ChannelGain>, CaseError> {
    let check = Check::new(path);
    let mut gains = Vec::new();
    for Branch { term, ratio, rate, field, directions } in branches {
        let value = |expression: &Expression, key: &str, is_allowed: fn(f64) -> bool, allowed: &str| {
            let field = format!("{field}.{key}");
            let value = expression.value(values).map_err(|source| check.expression(&field)(source))?;
            if is_allowed(value) { Ok(value) } else { Err(check.value(&field, value, allowed)) }
        };
        let ratio = value(ratio, "ratio", |ratio| ratio >= 0.0, "a number >= 0")?;
        let decay = value(rate, "rate", |rate| rate > 0.0, "a rate > 0, in 1/s")?;
        let lag = Lag { decay, drive: 1.0, force: coefficients[*term] * ratio };
        gains.extend(std::iter::repeat_n(ChannelGain { lag: Some(lag), ..ChannelGain::default() }, *directions));
    }
    Ok(gains)
}
