//! Functions of a case file that are given by points, such as a modulus over temperature.

use std::sync::Arc;

/// A function of one argument that is linear between points, and has no value beyond the first and the last.
#[derive(Debug, Clone, PartialEq)]
pub struct TableFunction {
    /// Name in expressions.
    name: String,
    /// Arguments of the points, two or more, increasing strictly.
    at: Vec<f64>,
    /// Values at these.
    value: Vec<f64>,
}

impl TableFunction {
    /// The function through two or more points, with the arguments `at`, which increase strictly, and the values `value`.
    pub(crate) fn new(name: String, at: Vec<f64>, value: Vec<f64>) -> Self {
        Self { name, at, value }
    }

    /// Name in expressions.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The points: argument and value of each, by the arguments.
    pub fn points(&self) -> impl ExactSizeIterator<Item = [f64; 2]> + '_ {
        self.at.iter().zip(&self.value).map(|(&at, &value)| [at, value])
    }

    /// Smallest and largest argument.
    pub fn ends(&self) -> [f64; 2] {
        match self.at[..] {
            [first, .., last] => [first, last],
            _ => [f64::NAN; 2],
        }
    }

    /// Tables with the ends of their arguments, in words; `None` where there are none.
    #[must_use]
    pub fn in_words(tables: &[Arc<Self>]) -> Option<String> {
        let words = |table: &Arc<Self>| {
            let [first, last] = table.ends();
            format!("{} ({} points from {first} to {last})", table.name, table.at.len())
        };
        (!tables.is_empty()).then(|| tables.iter().map(words).collect::<Vec<_>>().join(", "))
    }

    /// The value at an argument; at a point of the table the value of the point to the last bit; `None` beyond the ends and for NaN.
    pub fn value(&self, argument: f64) -> Option<f64> {
        let [first, last] = self.ends();
        if !(first..=last).contains(&argument) {
            return None;
        }
        // The last point at or below the argument; at the last one of all nothing follows.
        let before = self.at.partition_point(|at| *at <= argument).checked_sub(1)?;
        let [from, value] = [self.at[before], self.value[before]];
        let (Some(to), Some(next)) = (self.at.get(before + 1), self.value.get(before + 1)) else { return Some(value) };
        Some(value + (next - value) * ((argument - from) / (to - from)))
    }
}
