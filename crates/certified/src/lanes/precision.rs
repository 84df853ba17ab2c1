//! Double and single precision on vector registers.

use nalgebra::RealField;
use num_complex::Complex;
use pulp::Simd;

/// A real number, `f64` or `f32`, with its vector registers; [`Ops`](super::Ops) computes with them.
pub trait Precision: RealField + Copy + Default {
    /// Numbers in as many lanes as a register of `S` has.
    type Register<S: Simd>: Copy;
    /// Lanes of the widest register (AVX-512).
    const WIDEST: usize;

    /// The number nearest to a double.
    fn of(value: f64) -> Self;
    /// The double of the same value.
    fn wide(self) -> f64;
    /// Lanes of a register.
    fn width<S: Simd>() -> usize;
    /// The whole registers that the numbers fill; those left over are not in them.
    fn registers<S: Simd>(of: &[Self]) -> &[Self::Register<S>];
    /// [`registers`](Self::registers), to be changed.
    fn registers_mut<S: Simd>(of: &mut [Self]) -> &mut [Self::Register<S>];
    /// `a` in every lane.
    fn splat<S: Simd>(simd: S, a: Self) -> Self::Register<S>;
    /// `a + b`.
    fn add<S: Simd>(simd: S, a: Self::Register<S>, b: Self::Register<S>) -> Self::Register<S>;
    /// `a - b`.
    fn sub<S: Simd>(simd: S, a: Self::Register<S>, b: Self::Register<S>) -> Self::Register<S>;
    /// `a b`.
    fn mul<S: Simd>(simd: S, a: Self::Register<S>, b: Self::Register<S>) -> Self::Register<S>;
    /// `a / b`.
    fn div<S: Simd>(simd: S, a: Self::Register<S>, b: Self::Register<S>) -> Self::Register<S>;
    /// The square root.
    fn sqrt<S: Simd>(simd: S, a: Self::Register<S>) -> Self::Register<S>;
    /// `-a`.
    fn neg<S: Simd>(simd: S, a: Self::Register<S>) -> Self::Register<S>;
    /// `a b + c`, rounded once where the machine can.
    fn fma<S: Simd>(simd: S, a: Self::Register<S>, b: Self::Register<S>, c: Self::Register<S>) -> Self::Register<S>;
    /// `c - a b`, rounded once where the machine can.
    fn fnma<S: Simd>(simd: S, a: Self::Register<S>, b: Self::Register<S>, c: Self::Register<S>) -> Self::Register<S>;
}

/// A complex number in another precision.
pub fn cast<T: Precision, U: Precision>(value: Complex<T>) -> Complex<U> {
    Complex::new(U::of(value.re.wide()), U::of(value.im.wide()))
}

macro_rules! precision {
    ($real:ty, $registers:ident, $lanes:ident, $widest:literal, $of:ident, $of_mut:ident, [$($name:ident($($a:ident: $kind:ty),*) -> $out:ty = $op:ident;)*]) => {
        impl Precision for $real {
            type Register<S: Simd> = S::$registers;
            const WIDEST: usize = $widest;

            #[inline(always)]
            fn of(value: f64) -> Self {
                value as $real
            }
            #[inline(always)]
            fn wide(self) -> f64 {
                self.into()
            }
            #[inline(always)]
            fn width<S: Simd>() -> usize {
                S::$lanes
            }
            #[inline(always)]
            fn registers<S: Simd>(of: &[Self]) -> &[S::$registers] {
                S::$of(of).0
            }
            #[inline(always)]
            fn registers_mut<S: Simd>(of: &mut [Self]) -> &mut [S::$registers] {
                S::$of_mut(of).0
            }
            $(
                #[inline(always)]
                fn $name<S: Simd>(simd: S, $($a: $kind),*) -> $out {
                    simd.$op($($a),*)
                }
            )*
        }
    };
}

precision!(f64, f64s, F64_LANES, 8, as_simd_f64s, as_mut_simd_f64s, [
    splat(a: Self) -> S::f64s = splat_f64s;
    add(a: S::f64s, b: S::f64s) -> S::f64s = add_f64s;
    sub(a: S::f64s, b: S::f64s) -> S::f64s = sub_f64s;
    mul(a: S::f64s, b: S::f64s) -> S::f64s = mul_f64s;
    div(a: S::f64s, b: S::f64s) -> S::f64s = div_f64s;
    sqrt(a: S::f64s) -> S::f64s = sqrt_f64s;
    neg(a: S::f64s) -> S::f64s = neg_f64s;
    fma(a: S::f64s, b: S::f64s, c: S::f64s) -> S::f64s = mul_add_e_f64s;
    fnma(a: S::f64s, b: S::f64s, c: S::f64s) -> S::f64s = negate_mul_add_e_f64s;
]);
precision!(f32, f32s, F32_LANES, 16, as_simd_f32s, as_mut_simd_f32s, [
    splat(a: Self) -> S::f32s = splat_f32s;
    add(a: S::f32s, b: S::f32s) -> S::f32s = add_f32s;
    sub(a: S::f32s, b: S::f32s) -> S::f32s = sub_f32s;
    mul(a: S::f32s, b: S::f32s) -> S::f32s = mul_f32s;
    div(a: S::f32s, b: S::f32s) -> S::f32s = div_f32s;
    sqrt(a: S::f32s) -> S::f32s = sqrt_f32s;
    neg(a: S::f32s) -> S::f32s = neg_f32s;
    fma(a: S::f32s, b: S::f32s, c: S::f32s) -> S::f32s = mul_add_e_f32s;
    fnma(a: S::f32s, b: S::f32s, c: S::f32s) -> S::f32s = negate_mul_add_e_f32s;
]);
