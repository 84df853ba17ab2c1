//! Numbers that carry a derivative, and the operators of expressions on them.
//!
//! `exmex` can differentiate an expression symbolically, but at a price that a case file must not be able to set: the
//! derivative of a product of eight factors overflows a stack of 1.5 MB in a debug build, that of 128 factors one of 8 MB
//! in a release build, `abs` has none, and the power rule takes the logarithm of a negative base. It evaluates expressions
//! of any type of number, so derivatives come from evaluating with dual numbers `v + d epsilon`, `epsilon^2 = 0`: exact to
//! rounding, at about twice the cost of a value.

use std::str::FromStr;

use exmex::{BinOp, MakeOperators, Operator};

/// `value + derivative epsilon` with `epsilon^2 = 0`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Dual {
    /// The value.
    pub value: f64,
    /// The derivative by the parameter that is varied.
    pub derivative: f64,
}

impl FromStr for Dual {
    type Err = std::num::ParseFloatError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        text.parse().map(Self::constant)
    }
}

impl Dual {
    /// A number that does not depend on the parameter that is varied.
    pub fn constant(value: f64) -> Self {
        Self { value, derivative: 0.0 }
    }

    /// `f(self)` given the value and the slope of `f` there. What does not depend on the parameter keeps the derivative 0
    /// also where `f` has no slope, as the square root at 0.
    fn map(self, value: f64, slope: f64) -> Self {
        Self { value, derivative: scaled(slope, self.derivative) }
    }

    fn plus(self, other: Self) -> Self {
        Self { value: self.value + other.value, derivative: self.derivative + other.derivative }
    }

    fn minus(self, other: Self) -> Self {
        Self { value: self.value - other.value, derivative: self.derivative - other.derivative }
    }

    fn times(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            derivative: scaled(other.value, self.derivative) + scaled(self.value, other.derivative),
        }
    }

    fn over(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, derivative: (self.derivative - scaled(value, other.derivative)) / other.value }
    }

    fn power(self, exponent: Self) -> Self {
        let value = self.value.powf(exponent.value);
        let by_base = exponent.value * self.value.powf(exponent.value - 1.0);
        let by_exponent = value * self.value.ln();
        Self { value, derivative: scaled(by_base, self.derivative) + scaled(by_exponent, exponent.derivative) }
    }

    fn absolute(self) -> Self {
        let slope = if self.value == 0.0 { f64::NAN } else { self.value.signum() };
        self.map(self.value.abs(), slope)
    }
}

/// `slope derivative`, and 0 where nothing varies, whatever the slope.
fn scaled(slope: f64, derivative: f64) -> f64 {
    if derivative == 0.0 { 0.0 } else { slope * derivative }
}

/// A function by its name in expressions.
type Function = (&'static str, fn(Dual) -> Dual);

/// The functions of expressions.
pub(super) const FUNCTIONS: [Function; 8] = [
    ("sin", |x| x.map(x.value.sin(), x.value.cos())),
    ("cos", |x| x.map(x.value.cos(), -x.value.sin())),
    ("tan", |x| x.map(x.value.tan(), x.value.cos().powi(-2))),
    ("exp", |x| x.map(x.value.exp(), x.value.exp())),
    ("ln", |x| x.map(x.value.ln(), 1.0 / x.value)),
    ("sqrt", |x| x.map(x.value.sqrt(), 0.5 / x.value.sqrt())),
    ("abs", Dual::absolute),
    ("tanh", |x| x.map(x.value.tanh(), 1.0 - x.value.tanh().powi(2))),
];

/// The operators that `exmex` knows: `+ - * / ^` and [`FUNCTIONS`].
#[derive(Debug, Clone)]
pub(super) struct Operators;

impl MakeOperators<Dual> for Operators {
    fn make<'a>() -> Vec<Operator<'a, Dual>> {
        // The order of binding is that of exmex's own operators; what binds alike is evaluated from left to right.
        let binary =
            |sign, apply, prio, is_commutative| Operator::make_bin(sign, BinOp { apply, prio, is_commutative });
        let signs = [
            binary("+", Dual::plus, 0, true),
            binary("-", Dual::minus, 1, false),
            binary("*", Dual::times, 2, true),
            binary("/", Dual::over, 3, false),
            binary("^", Dual::power, 4, false),
        ];
        let functions = FUNCTIONS.iter().map(|&(name, apply)| Operator::make_unary(name, apply));
        signs.into_iter().chain(functions).collect()
    }
}
