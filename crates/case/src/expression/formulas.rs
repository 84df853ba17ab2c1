//! The expressions of a case file, and the parameters and tables that occur in them.

use std::sync::Arc;

use serde::Deserialize;

use crate::check::Check;
use crate::parameter::Parameter;
use crate::{CaseError, Expression, TableFunction};

/// A number, or an expression in the parameters.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged, expecting = "expected a number or an expression in quotes")]
pub(crate) enum Formula {
    Number(f64),
    Text(String),
}

/// Reads expressions and records the parameters and tables that occur in them.
pub(crate) struct Formulas<'a> {
    check: &'a Check<'a>,
    parameters: Vec<String>,
    /// Number of parameters of which the whole brake has one value; the others are local.
    of_whole: usize,
    used: Vec<bool>,
    tables: &'a [Arc<TableFunction>],
    used_tables: Vec<bool>,
}

impl<'a> Formulas<'a> {
    pub fn new(check: &'a Check<'a>, parameters: &[Parameter], tables: &'a [Arc<TableFunction>]) -> Self {
        let parameters: Vec<String> = parameters.iter().map(|parameter| parameter.name.clone()).collect();
        Self {
            check,
            used: vec![false; parameters.len()],
            of_whole: parameters.len(),
            parameters,
            tables,
            used_tables: vec![false; tables.len()],
        }
    }

    /// Formulas with further, local parameters, after the others: parameters that have a value for each patch or point of a contact.
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
        let expression =
            Expression::with_tables(&text, &self.parameters, self.tables).map_err(self.check.expression(field))?;
        for parameter in expression.parameters() {
            self.used[parameter] = true;
        }
        for called in expression.tables() {
            let known = self.tables.iter().zip(&mut self.used_tables);
            known.filter(|(table, _)| table.name() == called.name()).for_each(|(_, used)| *used = true);
        }
        Ok(expression)
    }

    /// Refuses a parameter and a table that occur in no expression: a name may be misspelt where it was meant.
    pub fn all_used(&self) -> Result<(), CaseError> {
        let unused = |kind: &str, allowed: &str, name: &str| {
            Err(self.check.value(&format!("{kind}.{name}"), "used nowhere", allowed))
        };
        if let Some((name, _)) = self.parameters.iter().zip(&self.used).find(|(_, used)| !**used) {
            let allowed = "parameters that occur in an expression of this file: a coefficient, or a field of contacts or rotation that takes one";
            return unused("parameters", allowed, name);
        }
        match self.tables.iter().zip(&self.used_tables).find(|(_, used)| !**used) {
            None => Ok(()),
            Some((table, _)) => unused(
                "tables",
                &format!("tables that an expression of this file calls, as {0}(w)", table.name()),
                table.name(),
            ),
        }
    }
}
