//! The expressions of a case file, and the parameters that occur in them.

use super::Parameter;
use super::schema::Formula;
use crate::check::Check;
use crate::{CaseError, Expression};

/// Reads expressions and records the parameters that occur in them.
pub(crate) struct Formulas<'a> {
    check: &'a Check<'a>,
    parameters: Vec<String>,
    used: Vec<bool>,
}

impl<'a> Formulas<'a> {
    pub fn new(check: &'a Check<'a>, parameters: &[Parameter]) -> Self {
        let parameters: Vec<String> = parameters.iter().map(|parameter| parameter.name.clone()).collect();
        Self { check, used: vec![false; parameters.len()], parameters }
    }

    /// The expression of a field, `default` where it is left out.
    pub fn expression(&mut self, field: &str, given: Option<Formula>, default: f64) -> Result<Expression, CaseError> {
        let text = match given.unwrap_or(Formula::Number(default)) {
            Formula::Number(value) => self.check.finite(field, value)?.to_string(),
            Formula::Text(text) => text,
        };
        let named = |source| CaseError::Expression {
            path: self.check.path.to_owned(),
            field: field.to_owned(),
            source: Box::new(source),
        };
        let expression = Expression::parse(&text, &self.parameters).map_err(named)?;
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
