//! The operators and functions of expressions.

use exmex::{BinOp, MakeOperators, Operator};

/// A function by its name in expressions.
type Function = (&'static str, fn(f64) -> f64);

/// The functions of expressions.
pub(super) const FUNCTIONS: [Function; 8] = [
    ("sin", f64::sin),
    ("cos", f64::cos),
    ("tan", f64::tan),
    ("exp", f64::exp),
    ("ln", f64::ln),
    ("sqrt", f64::sqrt),
    ("abs", f64::abs),
    ("tanh", f64::tanh),
];

/// The operators that `exmex` knows: `+ - * / ^` and [`FUNCTIONS`].
#[derive(Debug, Clone)]
pub(super) struct Operators;

impl MakeOperators<f64> for Operators {
    fn make<'a>() -> Vec<Operator<'a, f64>> {
        // The precedence is as among exmex's own operators; operators of equal precedence are evaluated from left to right. No operator is said to
        // commute: with operators that do, exmex 0.21 then evaluates `2 + 3` of `f(1 + p^2 + 2 + 3)` before the sum in front of it, and applies f to a part
        // of its argument.
        let binary = |sign, apply, prio| Operator::make_bin(sign, BinOp { apply, prio, is_commutative: false });
        let signs = [
            binary("+", |a: f64, b| a + b, 0),
            binary("-", |a, b| a - b, 1),
            binary("*", |a, b| a * b, 2),
            binary("/", |a, b| a / b, 3),
            binary("^", f64::powf, 4),
        ];
        let functions = FUNCTIONS.iter().map(|&(name, apply)| Operator::make_unary(name, apply));
        signs.into_iter().chain(functions).collect()
    }
}
