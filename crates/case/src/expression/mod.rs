//! Coefficients that are expressions in named parameters, such as `"1/w - 1"` or `"mu_k + (mu_s - mu_k)*exp(-alpha*v)"`.
//!
//! An expression has numbers (`2`, `0.5`, `1e-3`), parameters, the constant `pi`, the operators `+ - * / ^`, parentheses
//! and the functions `sin cos tan exp ln sqrt abs tanh` of one argument. `^` binds before `* /`, these before `+ -` and
//! before a leading minus, so that `-w^2` is `-(w^2)`. Texts that can be read in two ways are refused: `a^b^c`, `2*-w`,
//! `-2^w` after an operator, `2w`.
//!
//! [`grammar`] checks a text and [`exmex`] parses and evaluates it.

pub(crate) mod formulas;
mod grammar;
mod operands;
mod operators;

use exmex::{Express, FlatEx};

pub use operands::is_parameter_name;
use operators::Operators;

/// Errors of expressions, each printed in one line.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ExpressionError {
    /// A character, number or name that is not allowed at its position.
    #[error("{text:?}, column {column}: {found}; allowed: {allowed}")]
    Syntax {
        /// The expression, shortened where it is long.
        text: String,
        /// Column, from 1, in characters.
        column: usize,
        /// Text that was found there.
        found: String,
        /// Words for what is allowed there.
        allowed: String,
    },
    /// The expression has too many characters.
    #[error("{text:?} is too long; allowed: {} characters at most", grammar::LONGEST_EXPRESSION)]
    TooLong {
        /// The beginning of the expression.
        text: String,
    },
    /// The parser refuses an expression that passed the check.
    #[error("{text:?}: {message}; allowed: an expression that the parser understands")]
    Parser {
        /// The expression, shortened where it is long.
        text: String,
        /// The message of the parser.
        message: String,
    },
    /// The value is not a finite number.
    #[error("{text:?} = {result}{}; allowed: a finite number", at(.values))]
    NotFinite {
        /// The expression, shortened where it is long.
        text: String,
        /// The value: infinite or not a number.
        result: String,
        /// The parameters of the expression with their values, as `w = 0`.
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
    /// Boxed: it takes some kilobytes where it stands.
    parsed: Box<FlatEx<f64, Operators>>,
    /// Variables of `parsed`: the name of each and the index of its parameter.
    variables: Vec<(String, usize)>,
}

/// The text and the parameters; the parsed form is left out because its addresses of functions differ between runs.
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
    /// The first fault with its column.
    pub fn parse(text: &str, parameters: &[String]) -> Result<Self, ExpressionError> {
        let checked = grammar::checked(text, parameters)?;
        let refused =
            |message: &str| ExpressionError::Parser { text: grammar::shown(text), message: grammar::shown(message) };
        let parsed = Box::new(FlatEx::<f64, Operators>::parse(&checked).map_err(|error| refused(error.msg()))?);
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

    /// The text of the expression.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Indices of the parameters that occur in the expression.
    pub fn parameters(&self) -> impl Iterator<Item = usize> {
        self.variables.iter().map(|(_, parameter)| *parameter)
    }

    /// The value, given the values of all parameters in the order in which they were named.
    ///
    /// # Errors
    /// The value is not finite, as `1/w` at `w = 0`, or `values` are too few.
    pub fn value(&self, values: &[f64]) -> Result<f64, ExpressionError> {
        let of_variable = |&(_, parameter): &(String, usize)| values.get(parameter).copied().unwrap_or(f64::NAN);
        let variables: Vec<f64> = self.variables.iter().map(of_variable).collect();
        let result = self.parsed.eval(&variables).map_err(|error| ExpressionError::Parser {
            text: grammar::shown(&self.text),
            message: grammar::shown(error.msg()),
        })?;
        if result.is_finite() {
            return Ok(result);
        }
        let named = self.variables.iter().zip(&variables);
        Err(ExpressionError::NotFinite {
            text: grammar::shown(&self.text),
            result: result.to_string(),
            values: named.map(|((name, _), value)| format!("{name} = {value}")).collect(),
        })
    }
}

#[cfg(test)]
mod tests;
