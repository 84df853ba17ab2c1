//! Complex arithmetic on vector registers.

use pulp::Simd;

use super::ops::Ops;

/// A complex number in each lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pair<V> {
    pub re: V,
    pub im: V,
}

impl<V: Copy> Pair<V> {
    #[inline(always)]
    pub fn registers(self) -> [V; 2] {
        [self.re, self.im]
    }
}

#[inline(always)]
pub(super) fn pair<V>([re, im]: [V; 2]) -> Pair<V> {
    Pair { re, im }
}

/// `a b + c`.
#[inline(always)]
pub(super) fn fma<S: Simd>(o: Ops<S>, a: Pair<S::f64s>, b: Pair<S::f64s>, c: Pair<S::f64s>) -> Pair<S::f64s> {
    Pair { re: o.fnma(a.im, b.im, o.fma(a.re, b.re, c.re)), im: o.fma(a.im, b.re, o.fma(a.re, b.im, c.im)) }
}

/// `conj(a) b + c`.
#[inline(always)]
pub(super) fn conj_fma<S: Simd>(o: Ops<S>, a: Pair<S::f64s>, b: Pair<S::f64s>, c: Pair<S::f64s>) -> Pair<S::f64s> {
    Pair { re: o.fma(a.im, b.im, o.fma(a.re, b.re, c.re)), im: o.fnma(a.im, b.re, o.fma(a.re, b.im, c.im)) }
}

/// `|a|^2 + plus`.
#[inline(always)]
pub(super) fn square<S: Simd>(o: Ops<S>, a: Pair<S::f64s>, plus: S::f64s) -> S::f64s {
    o.fma(a.re, a.re, o.fma(a.im, a.im, plus))
}

/// `a by`.
#[inline(always)]
pub(super) fn scale<S: Simd>(o: Ops<S>, a: Pair<S::f64s>, by: S::f64s) -> Pair<S::f64s> {
    Pair { re: o.mul(a.re, by), im: o.mul(a.im, by) }
}
