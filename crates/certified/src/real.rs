//! Real numbers of double or double-double precision.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::dd::Dd;

/// `f64` or [`Dd`].
pub(crate) trait Real:
    Copy
    + std::fmt::Debug
    + Default
    + From<f64>
    + Into<Dd>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Distance from 1 to the next number.
    const EPSILON: f64;
    /// Doubles that make up one number.
    const PLANES: usize;
    /// The number whose parts are `parts[0]` and, if it has two, `parts[stride]`.
    fn assembled(parts: &[f64], stride: usize) -> Self;
    /// Writes the parts of the number to where [`assembled`](Self::assembled) finds them.
    fn disassembled(self, parts: &mut [f64], stride: usize);
    /// Rounded to a double.
    fn value(self) -> f64;
    /// The square root of a number that is not negative.
    fn root(self) -> Self;
}

impl Real for f64 {
    const EPSILON: f64 = f64::EPSILON;
    const PLANES: usize = 1;
    fn assembled(parts: &[f64], _stride: usize) -> Self {
        parts[0]
    }
    fn disassembled(self, parts: &mut [f64], _stride: usize) {
        parts[0] = self;
    }
    fn value(self) -> f64 {
        self
    }
    fn root(self) -> Self {
        self.sqrt()
    }
}

impl Real for Dd {
    const EPSILON: f64 = f64::EPSILON * f64::EPSILON;
    const PLANES: usize = 2;
    fn assembled(parts: &[f64], stride: usize) -> Self {
        Self { hi: parts[0], lo: parts[stride] }
    }
    fn disassembled(self, parts: &mut [f64], stride: usize) {
        (parts[0], parts[stride]) = (self.hi, self.lo);
    }
    fn value(self) -> f64 {
        Dd::value(self)
    }
    fn root(self) -> Self {
        self.sqrt()
    }
}
