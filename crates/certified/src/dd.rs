//! Double-double arithmetic: a number as the unevaluated sum of two doubles, about 32 digits.
//!
//! The building blocks are error-free: Knuth's two-sum, and Dekker's two-product with Veltkamp's splitting (Dekker,
//! Numer. Math. 18, 1971), because a fused multiply-add is a slow library call on a machine built without it. Numbers
//! beyond 1e290 or below 1e-290 lose the low part; the scaled problem has no such numbers.

use std::ops::{Add, Div, Mul, Neg, Sub};

use num_complex::Complex;

/// 2^27 + 1, splits 53 bits into 26 and 26.
const SPLITTER: f64 = 134_217_729.0;

/// A real number `hi + lo`, |lo| at most half an ulp of hi.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Dd {
    pub(crate) hi: f64,
    pub(crate) lo: f64,
}

fn two_sum(a: f64, b: f64) -> Dd {
    let hi = a + b;
    let b_part = hi - a;
    Dd { hi, lo: (a - (hi - b_part)) + (b - b_part) }
}

/// The sum of two doubles, exactly, as by [`two_sum`] where |a| >= |b| or a = 0.
fn fast_two_sum(a: f64, b: f64) -> Dd {
    let hi = a + b;
    Dd { hi, lo: b - (hi - a) }
}

fn split(a: f64) -> (f64, f64) {
    let c = SPLITTER * a;
    let hi = c - (c - a);
    (hi, a - hi)
}

fn two_product(a: f64, b: f64) -> Dd {
    let hi = a * b;
    let ((a1, a0), (b1, b0)) = (split(a), split(b));
    Dd { hi, lo: ((a1 * b1 - hi) + a1 * b0 + a0 * b1) + a0 * b0 }
}

impl Dd {
    /// The square root, one Newton step from the square root of the high part; zero for what is not positive.
    pub(crate) fn sqrt(self) -> Self {
        if self.hi <= 0.0 {
            return Self::default();
        }
        let root = self.hi.sqrt();
        let rest = self - two_product(root, root);
        fast_two_sum(root, rest.hi / (2.0 * root))
    }

    /// `self * a`.
    pub(crate) fn times(self, a: f64) -> Self {
        let p = two_product(self.hi, a);
        fast_two_sum(p.hi, p.lo + self.lo * a)
    }

    /// The double nearest to it.
    pub(crate) fn value(self) -> f64 {
        self.hi + self.lo
    }
}

impl From<f64> for Dd {
    fn from(hi: f64) -> Self {
        Self { hi, lo: 0.0 }
    }
}

impl Add for Dd {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        let (high, low) = (two_sum(self.hi, b.hi), two_sum(self.lo, b.lo));
        let sum = fast_two_sum(high.hi, high.lo + low.hi);
        fast_two_sum(sum.hi, sum.lo + low.lo)
    }
}

impl Neg for Dd {
    type Output = Self;
    fn neg(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }
}

impl Sub for Dd {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl Mul for Dd {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        let p = two_product(self.hi, b.hi);
        fast_two_sum(p.hi, p.lo + (self.hi * b.lo + self.lo * b.hi))
    }
}

impl Div for Dd {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let first = self.hi / b.hi;
        let rest = self - b.times(first);
        let second = rest.hi / b.hi;
        let rest = rest - b.times(second);
        fast_two_sum(first, second) + Self::from(rest.hi / b.hi)
    }
}

/// A complex number with double-double parts.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct DdComplex {
    pub(crate) re: Dd,
    pub(crate) im: Dd,
}

impl DdComplex {
    /// The complex double nearest to it.
    pub(crate) fn value(self) -> Complex<f64> {
        Complex::new(self.re.value(), self.im.value())
    }
}

impl From<Complex<f64>> for DdComplex {
    fn from(z: Complex<f64>) -> Self {
        Self { re: z.re.into(), im: z.im.into() }
    }
}

impl Add for DdComplex {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self { re: self.re + b.re, im: self.im + b.im }
    }
}

impl Mul for DdComplex {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        Self { re: self.re * b.re - self.im * b.im, im: self.re * b.im + self.im * b.re }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// (a + b)(a - b) = a^2 - b^2 and q b = a to 30 digits, whatever the numbers.
    fn close(x: Dd, y: Dd, size: f64) -> bool {
        (x - y).value().abs() <= 1e-30 * size
    }

    proptest! {
        #[test]
        fn identities_hold_to_thirty_digits(a in -1e6..1e6f64, da in -1e-11..1e-11f64, b in 1e-3..1e6f64) {
            let (a, b) = (Dd::from(a) + Dd::from(da), Dd::from(b) / Dd::from(3.0));
            let size = a.hi * a.hi + b.hi * b.hi;
            prop_assert!(close((a + b) * (a - b), a * a - b * b, 4.0 * size));
            prop_assert!(close(a / b * b, a, a.hi.abs()));
            prop_assert!(close(b.sqrt() * b.sqrt(), b, b.hi));
        }
    }

    #[test]
    fn keeps_what_a_double_drops() {
        let small = Dd::from(1.0) + Dd::from(1e-25);
        assert_eq!((small - Dd::from(1.0)).value(), 1e-25);
        let i = DdComplex { re: Dd::default(), im: 1.0.into() };
        assert_eq!((i * i).value(), Complex::new(-1.0, 0.0));
    }
}
