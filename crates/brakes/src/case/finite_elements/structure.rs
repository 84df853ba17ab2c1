//! The structure of a case without its contact: terms with their coefficients, and holders.

use nalgebra_sparse::CscMatrix;
use sparse::SparseTerm;

use crate::case::check::{Check, field};
use crate::case::{CaseError, Expression};

/// Terms with a coefficient each, then the holders, whose coefficient is 1.
pub(super) struct Structure<'a> {
    pub check: &'a Check<'a>,
    pub terms: Vec<SparseTerm>,
    pub coefficients: Vec<Expression>,
    pub holders: Option<SparseTerm>,
    /// The medians of the parameters.
    pub medians: Vec<f64>,
}

impl Structure<'_> {
    /// Adds a term.
    pub fn add(&mut self, (term, coefficient): (SparseTerm, Expression)) {
        self.terms.push(term);
        self.coefficients.push(coefficient);
    }

    /// K at the medians, and a multiple of M.
    ///
    /// # Errors
    /// A coefficient without a value there.
    pub fn at_medians(&self, of_mass: f64) -> Result<CscMatrix<f64>, CaseError> {
        let order = self.terms.first().map_or(0, |term| term.matrices.order());
        let zero = || CscMatrix::zeros(order, order);
        let mut sum = self.holders.as_ref().map_or_else(zero, |term| term.matrices.k.clone());
        for (term, coefficient) in self.terms.iter().zip(&self.coefficients) {
            let named = |source| CaseError::Expression {
                path: self.check.path.to_owned(),
                field: field("terms", &term.name, "coefficient"),
                source: Box::new(source),
            };
            let theta = coefficient.value(&self.medians).map_err(named)?;
            sum = sum + &term.matrices.k * theta + &term.matrices.m * (theta * of_mass);
        }
        Ok(sum)
    }
}
