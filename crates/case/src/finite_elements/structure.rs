//! The structure of a case without its contact: terms with their coefficients, and holders.

use nalgebra_sparse::CscMatrix;
use sparse::SparseTerm;

use crate::check::{Check, field};
use crate::{CaseError, Expression};

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

    /// Terms that have a stiffness, by their indices.
    pub fn stiff(&self) -> Vec<usize> {
        let is_stiff = |term: &SparseTerm| term.matrices.k.values().iter().any(|value| *value != 0.0);
        (0..self.terms.len()).filter(|&at| is_stiff(&self.terms[at])).collect()
    }

    /// The value of an expression of a field at the medians.
    ///
    /// # Errors
    /// An expression without a value there.
    pub fn value(&self, field: String, expression: &Expression) -> Result<f64, CaseError> {
        expression.value(&self.medians).map_err(self.check.expression(&field))
    }

    /// The coefficient of each term at the medians.
    ///
    /// # Errors
    /// A coefficient without a value there.
    pub fn coefficients_at_medians(&self) -> Result<Vec<f64>, CaseError> {
        let all = self.terms.iter().zip(&self.coefficients);
        all.map(|(term, own)| self.value(field("terms", &term.name, "coefficient"), own)).collect()
    }

    /// The diagonal of K at the medians.
    ///
    /// # Errors
    /// A coefficient without a value there.
    pub fn diagonal_at_medians(&self) -> Result<Vec<f64>, CaseError> {
        let mut sum = vec![0.0; self.terms.first().map_or(0, |term| term.matrices.order())];
        let holders = self.holders.iter().map(|term| (term, 1.0));
        for (term, theta) in self.terms.iter().zip(self.coefficients_at_medians()?).chain(holders) {
            for (row, _, own) in term.matrices.k.diagonal_as_csc().triplet_iter() {
                sum[row] += theta * own;
            }
        }
        Ok(sum)
    }

    /// K at the medians, and a multiple of M.
    ///
    /// # Errors
    /// A coefficient without a value there.
    pub fn at_medians(&self, of_mass: f64) -> Result<CscMatrix<f64>, CaseError> {
        let order = self.terms.first().map_or(0, |term| term.matrices.order());
        let zero = || CscMatrix::zeros(order, order);
        let mut sum = self.holders.as_ref().map_or_else(zero, |term| term.matrices.k.clone());
        for (term, theta) in self.terms.iter().zip(self.coefficients_at_medians()?) {
            sum = sum + &term.matrices.k * theta + &term.matrices.m * (theta * of_mass);
        }
        Ok(sum)
    }
}
