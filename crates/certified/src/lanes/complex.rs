//! Complex arithmetic on vector registers: the real parts in one register, the imaginary parts in the next.

use num_complex::Complex;
use pulp::Simd;

use super::{Ops, Precision};

/// A complex number in each lane: real and imaginary parts.
pub type ComplexLanes<S, T = f64> = [<T as Precision>::Register<S>; 2];

/// `a` in every lane.
#[inline(always)]
pub fn splat<S: Simd, T: Precision>(o: Ops<S, T>, a: Complex<T>) -> ComplexLanes<S, T> {
    [o.splat(a.re), o.splat(a.im)]
}

/// `a b`.
#[inline(always)]
pub fn times<S: Simd, T: Precision>(o: Ops<S, T>, a: ComplexLanes<S, T>, b: ComplexLanes<S, T>) -> ComplexLanes<S, T> {
    [o.fnma(a[1], b[1], o.mul(a[0], b[0])), o.fma(a[1], b[0], o.mul(a[0], b[1]))]
}

/// `a b + c`.
#[inline(always)]
pub fn fma<S: Simd, T: Precision>(
    o: Ops<S, T>,
    a: ComplexLanes<S, T>,
    b: ComplexLanes<S, T>,
    c: ComplexLanes<S, T>,
) -> ComplexLanes<S, T> {
    [o.fnma(a[1], b[1], o.fma(a[0], b[0], c[0])), o.fma(a[1], b[0], o.fma(a[0], b[1], c[1]))]
}

/// `c - a b`.
#[inline(always)]
pub fn fnma<S: Simd, T: Precision>(
    o: Ops<S, T>,
    a: ComplexLanes<S, T>,
    b: ComplexLanes<S, T>,
    c: ComplexLanes<S, T>,
) -> ComplexLanes<S, T> {
    [o.fma(a[1], b[1], o.fnma(a[0], b[0], c[0])), o.fnma(a[1], b[0], o.fnma(a[0], b[1], c[1]))]
}

/// `conj(a) b + c`.
#[inline(always)]
pub fn conj_fma<S: Simd, T: Precision>(
    o: Ops<S, T>,
    a: ComplexLanes<S, T>,
    b: ComplexLanes<S, T>,
    c: ComplexLanes<S, T>,
) -> ComplexLanes<S, T> {
    [o.fma(a[1], b[1], o.fma(a[0], b[0], c[0])), o.fnma(a[1], b[0], o.fma(a[0], b[1], c[1]))]
}

/// `|a|^2 + plus`.
#[inline(always)]
pub fn square<S: Simd, T: Precision>(o: Ops<S, T>, a: ComplexLanes<S, T>, plus: T::Register<S>) -> T::Register<S> {
    o.fma(a[0], a[0], o.fma(a[1], a[1], plus))
}

/// `a by`.
#[inline(always)]
pub fn scale<S: Simd, T: Precision>(o: Ops<S, T>, a: ComplexLanes<S, T>, by: T::Register<S>) -> ComplexLanes<S, T> {
    [o.mul(a[0], by), o.mul(a[1], by)]
}

/// `-a`.
#[inline(always)]
pub fn neg<S: Simd, T: Precision>(o: Ops<S, T>, a: ComplexLanes<S, T>) -> ComplexLanes<S, T> {
    [o.neg(a[0]), o.neg(a[1])]
}
