//! The expressions of a case file, and the parameters that occur in them.

use crate::check::Check;
use crate::matrices::Parameter;
use crate::matrices::schema::Formula;
use crate::{CaseError, Expression};

/// Reads expressions and records the parameters that occur in them.
pub(crate) struct Formulas<'a> {
    check: &'a Check<'a>,
    parameters: Vec<String>,
    /// Number of parameters of which the whole brake has one value; the others are local.
    of_whole: usize,
    used: Vec<bool>,
}

impl<'a> Formulas<'a> {
    pub fn new(check: &'a Check<'a>, parameters: &[Parameter]) -> Self {
        let parameters: Vec<String> = parameters.iter().map(|parameter| parameter.name.clone()).collect();
        Self { check, used: vec![false; parameters.len()], of_whole: parameters.len(), parameters }
    }

    /// Formulas with further, local parameters, after the others: those that have a value for each patch or point of a contact.
    pub fn with_local<'n>(mut self, names: impl Iterator<Item = &'n String>) -> Self {
        self.parameters.extend(names.cloned());
        self.used.resize(self.parameters.len(), false);
        self
    }

    /// True if a local parameter occurs in an expression.
    pub fn is_local(&self, expression: &Expression) -> bool {
        expression.parameters().any(|parameter| parameter >= self.of_whole)
    }

    /// The expression of a field, `default` where it is left out. A local parameter is refused.
    pub fn expression(&mut self, field: &str, given: Option<Formula>, default: f64) -> Result<Expression, CaseError> {
        let expression = self.local_expression(field, given, default)?;
        let local = expression.parameters().find(|&parameter| parameter >= self.of_whole);
        match local {
            None => Ok(expression),
            Some(local) => {
                let allowed = format!(
                    "parameters of which the brake has one value; {:?} has one for each patch or point, for stiffness_factor and friction_factor alone",
                    self.parameters[local]
                );
                Err(self.check.value(field, format!("{:?}", expression.text()), &allowed))
            }
        }
    }

    /// The expression of a field, in which local parameters may occur, `default` where it is left out.
    pub fn local_expression(
        &mut self,
        field: &str,
        given: Option<Formula>,
        default: f64,
    ) -> Result<Expression, CaseError> {
        let text = match given.unwrap_or(Formula::Number(default)) {
            Formula::Number(value) => self.check.finite(field, value)?.to_string(),
            Formula::Text(text) => text,
        };
        let expression = Expression::parse(&text, &self.parameters).map_err(self.check.expression(field))?;
        for parameter in expression.parameters() {
            self.used[parameter] = true;
        }
        Ok(expression)
    }

    /// Refuses a parameter that occurs in no expression: its name may be misspelt where it was meant.
    pub fn all_used(&self) -> Result<(), CaseError> {
        match self.parameters.iter().zip(&self.used).find(|(_, used)| !**used) {
            None => Ok(()),
            Some((name, _)) => {
                let allowed = "parameters that occur in an expression of this file: a coefficient, or a field of contacts or rotation that takes one";
                Err(self.check.value(&format!("parameters.{name}"), "used nowhere", allowed))
            }
        }
    }
}
