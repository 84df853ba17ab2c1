//! Complex arithmetic on vector registers.

use pulp::Simd;

use super::ops::Ops;

/// A complex number in each lane.
#[derive(Debug, Clone, Copy)]
pub struct ComplexLanes<V> {
    /// The real parts.
    pub re: V,
    /// The imaginary parts.
    pub im: V,
}

impl<V: Copy> ComplexLanes<V> {
    /// Real and imaginary parts.
    #[inline(always)]
    pub fn registers(self) -> [V; 2] {
        [self.re, self.im]
    }
}

/// From real and imaginary parts.
#[inline(always)]
pub fn complex<V>([re, im]: [V; 2]) -> ComplexLanes<V> {
    ComplexLanes { re, im }
}

/// `a b + c`.
#[inline(always)]
pub fn fma<S: Simd>(
    o: Ops<S>,
    a: ComplexLanes<S::f64s>,
    b: ComplexLanes<S::f64s>,
    c: ComplexLanes<S::f64s>,
) -> ComplexLanes<S::f64s> {
    ComplexLanes { re: o.fnma(a.im, b.im, o.fma(a.re, b.re, c.re)), im: o.fma(a.im, b.re, o.fma(a.re, b.im, c.im)) }
}

/// `conj(a) b + c`.
#[inline(always)]
pub fn conj_fma<S: Simd>(
    o: Ops<S>,
    a: ComplexLanes<S::f64s>,
    b: ComplexLanes<S::f64s>,
    c: ComplexLanes<S::f64s>,
) -> ComplexLanes<S::f64s> {
    ComplexLanes { re: o.fma(a.im, b.im, o.fma(a.re, b.re, c.re)), im: o.fnma(a.im, b.re, o.fma(a.re, b.im, c.im)) }
}

/// `|a|^2 + plus`.
#[inline(always)]
pub fn square<S: Simd>(o: Ops<S>, a: ComplexLanes<S::f64s>, plus: S::f64s) -> S::f64s {
    o.fma(a.re, a.re, o.fma(a.im, a.im, plus))
}

/// `a by`.
#[inline(always)]
pub fn scale<S: Simd>(o: Ops<S>, a: ComplexLanes<S::f64s>, by: S::f64s) -> ComplexLanes<S::f64s> {
    ComplexLanes { re: o.mul(a.re, by), im: o.mul(a.im, by) }
}
