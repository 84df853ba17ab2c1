//! Coefficients that are expressions in named parameters, such as `"1/w - 1"` or `"mu_k + (mu_s - mu_k)*exp(-alpha*v)"`.
//!
//! An expression has numbers (`2`, `0.5`, `1e-3`), parameters, the constant `pi`, the operators `+ - * / ^`, parentheses
//! and the functions `sin cos tan exp ln sqrt abs tanh` of one argument. `^` binds before `* /`, these before `+ -` and
//! before a leading minus, so that `-w^2` is `-(w^2)`. Texts that can be read in two ways are refused: `a^b^c`, `2*-w`,
//! `-2^w` after an operator, `2w`.
//!
//! A function may also be given by points, as a [`TableFunction`]: `modulus(T)`.
//!
//! [`grammar`] checks a text and [`exmex`] parses and evaluates it.

pub(crate) mod formulas;
mod grammar;
mod operands;
mod operators;
mod table_function;

use std::collections::BTreeMap;
use std::sync::Arc;

use exmex::{Express, FlatEx};

pub use operands::is_parameter_name;
use operators::Operators;
pub use table_function::TableFunction;

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
    /// The argument of a table is beyond its ends, where it says nothing.
    #[error("{text:?}: {call}{}; allowed: an argument {ends}, between the ends of the table", at(.values))]
    Beyond {
        /// The expression, shortened where it is long.
        text: String,
        /// The table with its argument, as `modulus(500)`.
        call: String,
        /// Both ends of the table in words.
        ends: String,
        /// The parameters of the expression with their values, as `T = 500`.
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
    /// The expression, with a variable for each call of a table.
    whole: Compiled,
    /// Calls of tables, inner ones first.
    calls: Vec<Call>,
    /// Parameters that occur, by name: the name of each and its index.
    variables: Vec<(String, usize)>,
}

/// An expression without calls of tables, as `exmex` has it.
#[derive(Clone)]
struct Compiled {
    /// Boxed: it takes some kilobytes where it stands.
    parsed: Box<FlatEx<f64, Operators>>,
    /// Variables of `parsed`, in their order.
    variables: Vec<Variable>,
}

/// A variable of an expression without calls.
#[derive(Debug, Clone, Copy)]
enum Variable {
    /// A parameter, by its index.
    Parameter(usize),
    /// The value of a call, by its index.
    Call(usize),
}

/// A table with its argument.
#[derive(Clone)]
struct Call {
    table: Arc<TableFunction>,
    argument: Compiled,
}

/// The text and the parameters; the parsed form is left out because its addresses of functions differ between runs.
impl std::fmt::Debug for Expression {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Expression").field("text", &self.text).field("variables", &self.variables).finish()
    }
}

impl PartialEq for Expression {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text && self.variables == other.variables && self.tables().eq(other.tables())
    }
}

impl Expression {
    /// Reads an expression in the named parameters.
    ///
    /// # Errors
    /// The first fault with its column.
    pub fn parse(text: &str, parameters: &[String]) -> Result<Self, ExpressionError> {
        Self::with_tables(text, parameters, &[])
    }

    /// Reads an expression in the named parameters that may call tables.
    ///
    /// # Errors
    /// The first fault with its column.
    pub(crate) fn with_tables(
        text: &str,
        parameters: &[String],
        tables: &[Arc<TableFunction>],
    ) -> Result<Self, ExpressionError> {
        let refused =
            |message: &str| ExpressionError::Parser { text: grammar::shown(text), message: grammar::shown(message) };
        let checked = grammar::checked(text, parameters, tables)?;
        let mut variables = BTreeMap::new();
        let mut compiled = |checked: &str, calls: usize| {
            let parsed = Box::new(FlatEx::<f64, Operators>::parse(checked).map_err(|error| refused(error.msg()))?);
            let variable = |name: &String| {
                if let Some(call) = (0..calls).find(|&call| *name == grammar::name_of_call(call)) {
                    return Ok(Variable::Call(call));
                }
                let parameter = parameters.iter().position(|parameter| parameter == name);
                let parameter = parameter.ok_or_else(|| refused("a name out of nowhere"))?;
                variables.insert(name.clone(), parameter);
                Ok(Variable::Parameter(parameter))
            };
            let variables = parsed.var_names().iter().map(variable).collect::<Result<_, _>>()?;
            Ok::<_, ExpressionError>(Compiled { parsed, variables })
        };
        let mut calls: Vec<Call> = Vec::with_capacity(checked.calls.len());
        for grammar::CheckedCall { table, argument } in &checked.calls {
            let argument = compiled(argument, calls.len())?;
            calls.push(Call { table: Arc::clone(&tables[*table]), argument });
        }
        let whole = compiled(&checked.text, calls.len())?;
        Ok(Self { text: text.to_owned(), whole, calls, variables: variables.into_iter().collect() })
    }

    /// The text of the expression.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Indices of the parameters that occur in the expression.
    pub fn parameters(&self) -> impl Iterator<Item = usize> {
        self.variables.iter().map(|(_, parameter)| *parameter)
    }

    /// The tables that the expression calls, one for each call.
    pub(crate) fn tables(&self) -> impl Iterator<Item = &TableFunction> {
        self.calls.iter().map(|call| &*call.table)
    }

    /// The value, given the values of all parameters in the order in which they were named.
    ///
    /// # Errors
    /// The value is not finite, as `1/w` at `w = 0`, the argument of a table is beyond its ends, or `values` are too few.
    pub fn value(&self, values: &[f64]) -> Result<f64, ExpressionError> {
        let mut of_calls = Vec::with_capacity(self.calls.len());
        for Call { table, argument } in &self.calls {
            let argument = self.value_of(argument, values, &of_calls)?;
            let value = table.value(argument).ok_or_else(|| {
                let [first, last] = table.ends();
                ExpressionError::Beyond {
                    text: grammar::shown(&self.text),
                    call: format!("{}({argument})", table.name()),
                    ends: format!("from {first} to {last}"),
                    values: self.named(values),
                }
            })?;
            of_calls.push(value);
        }
        let result = self.value_of(&self.whole, values, &of_calls)?;
        if result.is_finite() {
            return Ok(result);
        }
        Err(ExpressionError::NotFinite {
            text: grammar::shown(&self.text),
            result: result.to_string(),
            values: self.named(values),
        })
    }

    /// The value of the expression, or of an argument in it, given also the values of the calls in it.
    fn value_of(&self, of: &Compiled, values: &[f64], of_calls: &[f64]) -> Result<f64, ExpressionError> {
        let of_variable = |variable: &Variable| match *variable {
            Variable::Parameter(parameter) => values.get(parameter).copied(),
            Variable::Call(call) => of_calls.get(call).copied(),
        };
        let variables: Vec<f64> =
            of.variables.iter().map(|variable| of_variable(variable).unwrap_or(f64::NAN)).collect();
        of.parsed.eval(&variables).map_err(|error| ExpressionError::Parser {
            text: grammar::shown(&self.text),
            message: grammar::shown(error.msg()),
        })
    }

    /// The parameters with their values, as `w = 0`.
    fn named(&self, values: &[f64]) -> Vec<String> {
        let value = |parameter: usize| values.get(parameter).copied().unwrap_or(f64::NAN);
        self.variables.iter().map(|(name, parameter)| format!("{name} = {}", value(*parameter))).collect()
    }
}

#[cfg(test)]
mod tests;
