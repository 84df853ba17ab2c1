//! The table `[correlation]` of a case file of any kind: parameters that are drawn together.

use std::collections::BTreeSet;

use montecarlo::{Distribution, GaussianCopula};
use nalgebra::DMatrix;
use serde::Deserialize;

use super::CaseError;
use super::check::Check;
use super::random_field::Kernel;

/// Largest difference of two correlations that are the same but for rounding; chosen.
const SAME_CORRELATION: f64 = 1e-12;

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

/// Correlation of the values of a draw: which of them depend on each other, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlation {
    /// Indices of what the case names: among the parameters of a contact, where it names what holds in each of them, or among all values.
    named: Vec<usize>,
    /// Indices among all values of a draw: the friction parameters of the first contact, of the second, and so on, then all others.
    places: Vec<usize>,
    /// Copula over these.
    copula: GaussianCopula,
}

/// Values of a draw of a case that can be correlated.
pub(super) struct Correlated<'a> {
    /// Friction parameters of a contact: name and distribution.
    pub friction: Vec<(&'a str, &'a Distribution)>,
    /// Positions of the contacts that have a draw of friction of their own; one where all share a draw.
    pub contacts: &'a [[f64; 3]],
    /// True if the friction parameters of a contact can be named with its number, as `mu@1`.
    pub has_numbers: bool,
    /// Parameters of which the brake has one value, after the parameters of all contacts: name and distribution.
    pub others: Vec<(&'a str, &'a Distribution)>,
}

/// True of what has more than one value.
fn is_drawn(distribution: &Distribution) -> bool {
    !matches!(distribution, Distribution::Constant { .. })
}

impl<'a> Correlated<'a> {
    /// Values that each contact has alike: its friction parameters, and of a single one all others too.
    fn of_contact(&self) -> Vec<(&'a str, &'a Distribution)> {
        let others = if self.contacts.len() == 1 { &self.others[..] } else { &[] };
        self.friction.iter().chain(others).copied().collect()
    }

    /// The values of a draw, each by its own name.
    fn values(&self) -> Vec<(String, &'a Distribution)> {
        let numbers = 1..=self.contacts.len();
        let friction =
            numbers.flat_map(|number| self.friction.iter().map(move |(name, of)| (format!("{name}@{number}"), *of)));
        friction.chain(self.others.iter().map(|(name, of)| ((*name).to_owned(), *of))).collect()
    }

    /// The contact and the friction parameter of a value; `None` of all others.
    fn friction_at(&self, value: usize) -> Option<(usize, usize)> {
        let of_contact = self.friction.len();
        (value < of_contact * self.contacts.len()).then(|| (value / of_contact, value % of_contact))
    }

    /// Words on what is drawn, where values have their own names.
    fn values_in_words(&self) -> String {
        let drawn = |list: &[(&'a str, &'a Distribution)], end: &str| {
            let drawn = list.iter().filter(|(_, of)| is_drawn(of));
            drawn.map(|(name, _)| format!("{name}{end}")).collect::<Vec<_>>().join(", ")
        };
        let others = drawn(&self.others, "");
        let others = if others.is_empty() { others } else { format!("; {others}") };
        let [friction, numbered] = ["", "@N"].map(|end| drawn(&self.friction, end));
        let count = self.contacts.len();
        format!(
            "what is drawn: {numbered} with the number N of the contact, 1 to {count}{others}; or names of what holds in each contact alone: {friction}"
        )
    }
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
        self.no_repeats("correlation.parameters", parameters.iter().cloned())?;
        let of_contact = of.of_contact();
        let has_own_name = |name: &String| of_contact.iter().all(|(own, _)| own != name);
        let correlation = match of.has_numbers && parameters.iter().any(has_own_name) {
            true => self.of_values(&parameters, matrix, field, of)?,
            false => self.in_each_contact((&parameters, &of_contact), matrix, field, of)?,
        };
        Ok(Some(correlation).filter(|correlation| !correlation.copula.is_independent()))
    }

    /// Indices of names in a list of what is drawn.
    fn places(
        &self,
        named: &[String],
        all: &[(&str, &Distribution)],
        allowed: impl Fn() -> String,
    ) -> Result<Vec<usize>, CaseError> {
        let place = |name: &String| {
            let place = all.iter().position(|(own, of)| own == name && is_drawn(of));
            place.ok_or_else(|| self.value("correlation.parameters", format!("{name:?}"), &allowed()))
        };
        named.iter().map(place).collect()
    }

    /// An error unless all values of these parameters have normal scores: of a value with a probability of its own others would get other distributions with any
    /// of its scores.
    fn no_atoms(&self, places: &[usize], all: &[(&str, &Distribution)]) -> Result<(), CaseError> {
        let Some(&at) = places.iter().find(|&&at| all[at].1.has_atoms()) else { return Ok(()) };
        let (name, distribution) = all[at];
        let found = match distribution {
            Distribution::Empirical { values, .. } | Distribution::Quantiles { values, .. } => {
                let repeated = values.windows(2).find(|pair| pair[0] == pair[1]).map_or(f64::NAN, |pair| pair[0]);
                let times = values.iter().filter(|value| **value == repeated).count();
                format!("{name:?}, whose value {repeated} is there {times} times")
            }
            _ => format!("{name:?}, which is discrete or has one value alone"),
        };
        let allowed = "parameters none of whose values has a probability of its own: with what is correlated with it such a value would have to be drawn anew";
        Err(self.value("correlation.parameters", found, allowed))
    }

    /// The correlation of what holds in each contact alike, between its parameters and over the contacts.
    fn in_each_contact(
        &self,
        (parameters, all): (&[String], &[(&str, &Distribution)]),
        matrix: Option<Vec<Vec<f64>>>,
        field: Option<FieldTable>,
        of: &Correlated<'_>,
    ) -> Result<Correlation, CaseError> {
        let drawn: Vec<usize> = (0..all.len()).filter(|&at| is_drawn(all[at].1)).collect();
        let names = || drawn.iter().map(|&at| all[at].0).collect::<Vec<_>>().join(", ");
        let mut named = self.places(parameters, all, || format!("what is drawn: {}", names()))?;
        if named.is_empty() && matrix.is_none() {
            named.clone_from(&drawn);
        }
        self.no_atoms(&named, all)?;
        let between = match matrix {
            Some(rows) => self.correlation_matrix(&rows, parameters.len())?,
            None => DMatrix::identity(named.len(), named.len()),
        };
        let across = match field {
            Some(field) => self.field(field, of.contacts)?,
            None => DMatrix::identity(of.contacts.len(), of.contacts.len()),
        };
        // A parameter in one contact and a parameter in another: the product of both correlations.
        let Some(copula) = copula(&across.kronecker(&between)) else {
            let (of_matrix, of_field) = (smallest(&between), smallest(&across));
            return Err(match of_matrix <= of_field {
                true => self.matrix_not_definite(of_matrix),
                false => self.field_not_definite(of_field),
            });
        };
        let contacts = 0..of.contacts.len();
        let places = contacts.flat_map(|contact| named.iter().map(move |at| contact * of.friction.len() + at));
        Ok(Correlation { places: places.collect(), named, copula })
    }

    /// The correlation of values by their own names: friction parameters of contacts, as `mu@1`, which a field correlates with the same parameters of all
    /// other contacts, and parameters of which the brake has one value.
    fn of_values(
        &self,
        parameters: &[String],
        matrix: Option<Vec<Vec<f64>>>,
        field: Option<FieldTable>,
        of: &Correlated<'_>,
    ) -> Result<Correlation, CaseError> {
        let values = of.values();
        let all: Vec<(&str, &Distribution)> = values.iter().map(|(name, of)| (name.as_str(), *of)).collect();
        let mut places = self.places(parameters, &all, || of.values_in_words())?;
        self.no_atoms(&places, &all)?;
        let named = places.len();
        let given = match matrix {
            Some(rows) => self.correlation_matrix(&rows, named)?,
            None => DMatrix::identity(named, named),
        };
        let Some(field) = field else {
            let copula = copula(&given).ok_or_else(|| self.matrix_not_definite(smallest(&given)))?;
            return Ok(Correlation { named: places.clone(), places, copula });
        };
        let across = self.field(field, of.contacts)?;
        let over: BTreeSet<usize> =
            places.iter().filter_map(|&place| of.friction_at(place)).map(|(_, own)| own).collect();
        if over.is_empty() {
            let allowed = "a friction parameter of a contact among correlation.parameters, as mu@1, which the field correlates over all contacts";
            return Err(self.value("correlation.field", "given", allowed));
        }
        for contact in 0..of.contacts.len() {
            let of_contact = over.iter().map(|own| contact * of.friction.len() + own);
            let new: Vec<usize> = of_contact.filter(|place| !places.contains(place)).collect();
            places.extend(new);
        }
        // The contacts of two values of one friction parameter.
        let two_contacts = |i: usize, j: usize| match (of.friction_at(places[i]), of.friction_at(places[j])) {
            (Some((a, one)), Some((b, other))) if one == other && a != b => Some((a, b)),
            _ => None,
        };
        let mut whole = DMatrix::identity(places.len(), places.len());
        whole.view_mut((0, 0), (named, named)).copy_from(&given);
        for i in 0..places.len() {
            for j in 0..places.len() {
                let Some(contacts) = two_contacts(i, j) else { continue };
                if whole[(i, j)] != 0.0 {
                    let found = format!("{} in row {}, column {}", whole[(i, j)], i + 1, j + 1);
                    let allowed =
                        format!("0 for {} and {}, which the field correlates", all[places[i]].0, all[places[j]].0);
                    return Err(self.value("correlation.matrix", found, &allowed));
                }
                whole[(i, j)] = across[contacts];
            }
        }
        let copula = copula(&whole).ok_or_else(|| match (copula(&given), copula(&across)) {
            (None, _) => self.matrix_not_definite(smallest(&given)),
            (_, None) => self.field_not_definite(smallest(&across)),
            (Some(_), Some(_)) => {
                let found = format!("a matrix and a field with the eigenvalue {:.3e} together", smallest(&whole));
                let allowed = "ones whose eigenvalues are all > 0: smaller entries, a shorter length, or entries for further contacts, which the field ties to those named";
                self.value("correlation", found, allowed)
            }
        })?;
        Ok(Correlation { named: places.clone(), places, copula })
    }

    /// The error for a matrix of correlations that is not positive definite, by its smallest eigenvalue.
    fn matrix_not_definite(&self, smallest: f64) -> CaseError {
        let allowed = "one whose eigenvalues are all > 0; smaller entries beside the diagonal have larger ones";
        self.value("correlation.matrix", format!("a matrix with the eigenvalue {smallest:.3e}"), allowed)
    }

    /// The error for correlations over contacts that are not positive definite, by their smallest eigenvalue.
    fn field_not_definite(&self, smallest: f64) -> CaseError {
        let allowed = "one whose eigenvalues are all > 0; a shorter length or the exponential kernel has larger ones";
        self.value("correlation.field", format!("a matrix with the eigenvalue {smallest:.3e}"), allowed)
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

/// The copula with a correlation matrix; `None` where that is not positive definite.
fn copula(matrix: &DMatrix<f64>) -> Option<GaussianCopula> {
    let rows: Vec<Vec<f64>> = matrix.row_iter().map(|row| row.iter().copied().collect()).collect();
    GaussianCopula::new(&rows)
}

/// The smallest eigenvalue of a symmetric matrix.
fn smallest(matrix: &DMatrix<f64>) -> f64 {
    matrix.clone().symmetric_eigenvalues().min()
}

impl Correlation {
    /// Indices of what the case names.
    pub(super) fn named(&self) -> &[usize] {
        &self.named
    }

    /// The rows of the factor of the correlation matrix.
    pub(super) fn factor(&self) -> &[Vec<f64>] {
        self.copula.factor()
    }

    /// True if a value of a draw, by its index, depends on others. The friction values of all contacts, contact by contact, come before all other values.
    pub fn holds(&self, value: usize) -> bool {
        self.places.contains(&value)
    }

    /// True if correlations are what they were when each value has taken the index that `to` gives it, to each value another one, as where contacts change
    /// their places.
    pub fn is_kept_by(&self, to: impl Fn(usize) -> usize) -> bool {
        let rows = self.factor();
        let between = |a: usize, b: usize| {
            let [a, b] = [a, b].map(|value| self.places.iter().position(|&place| place == value));
            let (Some(a), Some(b)) = (a, b) else { return 0.0 };
            rows[a].iter().zip(&rows[b]).map(|(a, b)| a * b).sum::<f64>()
        };
        let of_pair = |a: usize, b: usize| a == b || (between(a, b) - between(to(a), to(b))).abs() <= SAME_CORRELATION;
        self.places.iter().all(|&a| self.places.iter().all(|&b| of_pair(a, b)))
    }

    /// Makes independent values of a draw, of the friction of all contacts, one after the other, then all others, correlated.
    pub fn apply(&self, distributions: &[&Distribution], values: &mut [f64]) {
        // Of another reading of the case, with a draw for all contacts, there are fewer, and `places` ascend: names with numbers, whose places need not, are
        // refused beside such a reading.
        let places: Vec<usize> = self.places.iter().copied().take_while(|&place| place < values.len()).collect();
        let of: Vec<&Distribution> = places.iter().map(|&place| distributions[place]).collect();
        let mut own: Vec<f64> = places.iter().map(|&place| values[place]).collect();
        self.copula.apply(&of, &mut own);
        for (place, value) in places.into_iter().zip(own) {
            values[place] = value;
        }
    }
}
