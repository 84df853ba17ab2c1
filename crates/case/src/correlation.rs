//! The table `[correlation]` of a case file of any kind: parameters that are drawn together.

use montecarlo::{Distribution, GaussianCopula};
use nalgebra::DMatrix;
use serde::Deserialize;

use super::CaseError;
use super::check::Check;
use super::random_field::Kernel;

/// Table `[correlation]`.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CorrelationTable {
    #[serde(default)]
    parameters: Vec<String>,
    matrix: Option<Vec<Vec<f64>>>,
    field: Option<FieldTable>,
}

/// A random field over the contacts.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
struct FieldTable {
    kernel: Kernel,
    length: f64,
}

/// Correlation of the parameters of a draw: which of them depend on each other, and how, in one contact or in several with a draw each.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlation {
    /// Indices in the list of parameters.
    parameters: Vec<usize>,
    /// Copula over these in the first contact, then in the second, and so on.
    copula: GaussianCopula,
}

/// Parameters and contacts of a case that can be correlated.
pub(super) struct Correlated<'a> {
    /// Parameters: name and distribution.
    pub parameters: Vec<(&'a str, &'a Distribution)>,
    /// Positions of the contacts that have a draw of their own; one where all share a draw.
    pub contacts: &'a [[f64; 3]],
}

impl Check<'_> {
    /// The correlation that a case asks for; `None` where it asks for none, or for one of 0 everywhere.
    pub fn correlation(
        &self,
        table: Option<CorrelationTable>,
        of: &Correlated<'_>,
    ) -> Result<Option<Correlation>, CaseError> {
        let Some(CorrelationTable { parameters, matrix, field }) = table else { return Ok(None) };
        if matrix.is_none() && field.is_none() {
            return Err(self.value("correlation", "empty", "a matrix over parameters, a field over contacts, or both"));
        }
        let is_drawn = |distribution: &Distribution| !matches!(distribution, Distribution::Constant { .. });
        let drawn: Vec<usize> = (0..of.parameters.len()).filter(|&at| is_drawn(of.parameters[at].1)).collect();
        let names = || drawn.iter().map(|&at| of.parameters[at].0).collect::<Vec<_>>().join(", ");
        self.no_repeats("correlation.parameters", parameters.iter().cloned())?;
        let mut places = Vec::with_capacity(parameters.len());
        for name in &parameters {
            let place = drawn.iter().find(|&&at| of.parameters[at].0 == name);
            let refused =
                || self.value("correlation.parameters", format!("{name:?}"), &format!("what is drawn: {}", names()));
            places.push(*place.ok_or_else(refused)?);
        }
        if places.is_empty() && matrix.is_none() {
            places.clone_from(&drawn);
        }
        // A value with a probability of its own has no normal score: with any of its scores others would get other distributions.
        if let Some(&at) = places.iter().find(|&&at| of.parameters[at].1.has_atoms()) {
            let allowed = "parameters none of whose values has a probability of its own, as discrete and measured values that repeat have";
            return Err(self.value("correlation.parameters", format!("{:?}", of.parameters[at].0), allowed));
        }
        let between = match matrix {
            Some(rows) => self.correlation_matrix(&rows, parameters.len())?,
            None => DMatrix::identity(places.len(), places.len()),
        };
        let across = match field {
            Some(field) => self.field(field, of.contacts)?,
            None => DMatrix::identity(of.contacts.len(), of.contacts.len()),
        };
        // A parameter in one contact and a parameter in another: the product of both correlations.
        let whole = across.kronecker(&between);
        let rows: Vec<Vec<f64>> =
            (0..whole.nrows()).map(|i| (0..whole.ncols()).map(|j| whole[(i, j)]).collect()).collect();
        let Some(copula) = GaussianCopula::new(&rows) else {
            let smallest = |matrix: DMatrix<f64>| matrix.symmetric_eigenvalues().min();
            let (of_matrix, of_field) = (smallest(between), smallest(across));
            let (key, smallest) = match of_matrix <= of_field {
                true => ("matrix", of_matrix),
                false => ("field", of_field),
            };
            let allowed =
                "one whose eigenvalues are all > 0; a shorter length or the exponential kernel has larger ones";
            let found = format!("a matrix with the eigenvalue {smallest:.3e}");
            return Err(self.value(&format!("correlation.{key}"), found, allowed));
        };
        Ok(Some(Correlation { parameters: places, copula }).filter(|correlation| !correlation.copula.is_independent()))
    }

    /// A symmetric matrix with a diagonal of 1.
    fn correlation_matrix(&self, rows: &[Vec<f64>], parameters: usize) -> Result<DMatrix<f64>, CaseError> {
        let key = "correlation.matrix";
        if parameters == 0 {
            return Err(self.value("correlation.parameters", "[]", "the names of the rows of correlation.matrix"));
        }
        if rows.len() != parameters || rows.iter().any(|row| row.len() != parameters) {
            let lengths: Vec<String> = rows.iter().map(|row| row.len().to_string()).collect();
            let allowed = format!("{parameters} rows of {parameters}, one for each of correlation.parameters");
            return Err(self.value(key, format!("rows of {}", lengths.join(", ")), &allowed));
        }
        for (i, row) in rows.iter().enumerate() {
            for (j, &value) in row.iter().enumerate() {
                let is_allowed = match i == j {
                    true => value == 1.0,
                    false => (-1.0..=1.0).contains(&value) && value == rows[j][i],
                };
                if !is_allowed {
                    let allowed = "1 on the diagonal, and elsewhere the same number, -1 to 1, on both sides of it";
                    return Err(self.value(key, format!("{value} in row {}, column {}", i + 1, j + 1), allowed));
                }
            }
        }
        Ok(DMatrix::from_fn(parameters, parameters, |i, j| rows[i][j]))
    }

    /// The correlation of contacts by their distances.
    fn field(&self, field: FieldTable, contacts: &[[f64; 3]]) -> Result<DMatrix<f64>, CaseError> {
        let FieldTable { kernel, length } = field;
        if contacts.len() < 2 {
            let allowed = "two contacts or more with a draw each: draws = \"each\"";
            return Err(self.value("correlation.field", "given", allowed));
        }
        if !(length.is_finite() && length >= 0.0) {
            return Err(self.value("correlation.field.length", length, "a distance, >= 0"));
        }
        let distance = |i: usize, j: usize| {
            let squares = (0..3).map(|d| (contacts[i][d] - contacts[j][d]).powi(2));
            squares.sum::<f64>().sqrt()
        };
        // A length of 0 correlates nothing.
        let at = |i: usize, j: usize| match (i == j, length > 0.0) {
            (true, _) => 1.0,
            (false, false) => 0.0,
            (false, true) => kernel.at(distance(i, j) / length),
        };
        Ok(DMatrix::from_fn(contacts.len(), contacts.len(), at))
    }
}

impl Correlation {
    /// Indices in the list of parameters.
    pub(super) fn places(&self) -> &[usize] {
        &self.parameters
    }

    /// The rows of the factor of the correlation matrix, over these parameters in one contact after the other.
    pub(super) fn factor(&self) -> &[Vec<f64>] {
        self.copula.factor()
    }

    /// True if a parameter, by its index, depends on others.
    pub fn holds(&self, parameter: usize) -> bool {
        self.parameters.contains(&parameter)
    }

    /// Makes independent draws correlated: of each contact its value of every parameter.
    pub fn apply(&self, distributions: &[&Distribution], contacts: &mut [&mut [f64]]) {
        let pairs = || (0..contacts.len()).flat_map(|contact| self.parameters.iter().map(move |&at| (contact, at)));
        let mut values: Vec<f64> = pairs().map(|(contact, at)| contacts[contact][at]).collect();
        let of: Vec<&Distribution> = pairs().map(|(_, at)| distributions[at]).collect();
        let places: Vec<(usize, usize)> = pairs().collect();
        self.copula.apply(&of, &mut values);
        for ((contact, at), value) in places.into_iter().zip(values) {
            contacts[contact][at] = value;
        }
    }
}
