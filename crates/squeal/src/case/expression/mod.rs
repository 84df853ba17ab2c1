//! Coefficients that are expressions in named parameters, such as `"1/w - 1"` or `"mu_k + (mu_s - mu_k)*exp(-alpha*v)"`.
//!
//! An expression has numbers (`2`, `0.5`, `1e-3`), parameters, the constant `pi`, the operators `+ - * / ^`, parentheses
//! and the functions `sin cos tan exp ln sqrt abs tanh` of one argument. `^` binds before `* /`, these before `+ -` and
//! before a leading minus, so `-w^2` is `-(w^2)`. What people read in two ways is refused: `a^b^c`, `2*-w`, `-2^w` after an
//! operator, `2w`.
//!
//! [`grammar`] checks a text and [`exmex`] parses and evaluates it.

mod dual;
mod grammar;
mod operands;

use exmex::{Express, FlatEx};

use dual::{Dual, Operators};
pub use operands::is_parameter_name;

/// What can be wrong with an expression, each in one line.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ExpressionError {
    /// Something in it is not allowed where it stands.
    #[error("{text:?}, column {column}: {found}; allowed: {allowed}")]
    Syntax {
        /// The expression, its start where it is long.
        text: String,
        /// Where, from 1, in characters.
        column: usize,
        /// What stands there.
        found: String,
        /// What may stand there.
        allowed: String,
    },
    /// Longer than any coefficient needs to be.
    #[error("{text:?} is too long; allowed: {} characters at most", grammar::LONGEST_EXPRESSION)]
    TooLong {
        /// Its start.
        text: String,
    },
    /// The parser refuses what the check let pass.
    #[error("{text:?}: {message}; allowed: an expression that the parser understands")]
    Parser {
        /// The expression, its start where it is long.
        text: String,
        /// What the parser says.
        message: String,
    },
    /// The result is not a finite number.
    #[error("{text:?} = {result}{}; allowed: a finite number", at(.values))]
    NotFinite {
        /// The expression, its start where it is long.
        text: String,
        /// Infinite or not a number.
        result: String,
        /// The parameters in it with their values, as `w = 0`.
        values: Vec<String>,
    },
}

fn at(values: &[String]) -> String {
    if values.is_empty() { String::new() } else { format!(" at {}", values.join(", ")) }
}

/// An expression in parameters.
#[derive(Clone)]
pub struct Expression {
    text: String,
    parsed: FlatEx<Dual, Operators>,
    /// Name of each variable of `parsed`, in its order, and which parameter it is.
    variables: Vec<(String, usize)>,
}

/// The text and which parameters stand in it; the parsed form has addresses of functions, which differ between runs.
impl std::fmt::Debug for Expression {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Expression").field("text", &self.text).field("variables", &self.variables).finish()
    }
}

impl PartialEq for Expression {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text && self.variables == other.variables
    }
}

impl Expression {
    /// Reads an expression in the named parameters.
    ///
    /// # Errors
    /// What in it is not allowed, with its column.
    pub fn parse(text: &str, parameters: &[String]) -> Result<Self, ExpressionError> {
        let checked = grammar::checked(text, parameters)?;
        let refused =
            |message: &str| ExpressionError::Parser { text: grammar::shown(text), message: grammar::shown(message) };
        let parsed = FlatEx::<Dual, Operators>::parse(&checked).map_err(|error| refused(error.msg()))?;
        let variables = parsed
            .var_names()
            .iter()
            .map(|name| {
                let parameter = parameters.iter().position(|parameter| parameter == name);
                parameter.map(|parameter| (name.clone(), parameter)).ok_or_else(|| refused("a name out of nowhere"))
            })
            .collect::<Result<_, _>>()?;
        Ok(Self { text: text.to_owned(), parsed, variables })
    }

    /// The text that it was read from.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The parameters in it, by their indices.
    pub fn parameters(&self) -> impl Iterator<Item = usize> {
        self.variables.iter().map(|(_, parameter)| *parameter)
    }

    /// Its value, given those of all parameters in the order in which they were named.
    ///
    /// # Errors
    /// The value is not finite, as `1/w` at `w = 0`, or `values` are too few.
    pub fn value(&self, values: &[f64]) -> Result<f64, ExpressionError> {
        self.evaluate(values, None).map(|dual| dual.value)
    }

    /// Its derivative by one parameter.
    ///
    /// # Errors
    /// The value or the derivative is not finite, as that of `abs(w)` at `w = 0`, or `values` are too few.
    pub fn derivative(&self, values: &[f64], by: usize) -> Result<f64, ExpressionError> {
        self.evaluate(values, Some(by)).map(|dual| dual.derivative)
    }

    fn evaluate(&self, values: &[f64], by: Option<usize>) -> Result<Dual, ExpressionError> {
        let variables: Vec<Dual> = self
            .variables
            .iter()
            .map(|&(_, parameter)| Dual {
                value: values.get(parameter).copied().unwrap_or(f64::NAN),
                derivative: if by == Some(parameter) { 1.0 } else { 0.0 },
            })
            .collect();
        let result = self.parsed.eval(&variables).map_err(|error| ExpressionError::Parser {
            text: grammar::shown(&self.text),
            message: grammar::shown(error.msg()),
        })?;
        if result.value.is_finite() && result.derivative.is_finite() {
            return Ok(result);
        }
        let named = self.variables.iter().zip(&variables);
        Err(ExpressionError::NotFinite {
            text: grammar::shown(&self.text),
            result: match result.value.is_finite() {
                true => format!("{}, its derivative {}", result.value, result.derivative),
                false => result.value.to_string(),
            },
            values: named.map(|((name, _), dual)| format!("{name} = {}", dual.value)).collect(),
        })
    }
}

#[cfg(test)]
mod tests;
