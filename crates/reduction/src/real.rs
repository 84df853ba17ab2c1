//! Single and double precision on vector registers: guesses and counts take the one, last digits the other.

use nalgebra::RealField;
use num_complex::Complex;
use pulp::Simd;

/// A real number with its vector registers.
pub(super) trait Real: RealField + Copy + Default {
    type Register<S: Simd>: Copy;
    /// Numbers in the widest register.
    const WIDEST: usize;

    fn of(value: f64) -> Self;
    fn wide(self) -> f64;
    /// Numbers in a register.
    fn width<S: Simd>() -> usize;
    fn registers<S: Simd>(of: &[Self]) -> &[Self::Register<S>];
    fn registers_mut<S: Simd>(of: &mut [Self]) -> &mut [Self::Register<S>];
    fn filled<S: Simd>(simd: S, value: Self) -> Self::Register<S>;
    /// The sum of the numbers in a register.
    fn sum<S: Simd>(simd: S, of: Self::Register<S>) -> Self;
    /// `a b + c`.
    fn add_product<S: Simd>(
        simd: S,
        a: Self::Register<S>,
        b: Self::Register<S>,
        c: Self::Register<S>,
    ) -> Self::Register<S>;
    /// `c - a b`.
    fn take_product<S: Simd>(
        simd: S,
        a: Self::Register<S>,
        b: Self::Register<S>,
        c: Self::Register<S>,
    ) -> Self::Register<S>;
}

/// A complex number in another precision.
pub(super) fn cast<T: Real, U: Real>(value: Complex<T>) -> Complex<U> {
    Complex::new(U::of(value.re.wide()), U::of(value.im.wide()))
}

macro_rules! real {
    ($real:ty, $registers:ident, $lanes:ident, $widest:literal, [$of:ident, $of_mut:ident, $splat:ident, $sum:ident, $add:ident, $take:ident]) => {
        impl Real for $real {
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

            #[inline(always)]
            fn filled<S: Simd>(simd: S, value: Self) -> S::$registers {
                simd.$splat(value)
            }

            #[inline(always)]
            fn sum<S: Simd>(simd: S, of: S::$registers) -> Self {
                simd.$sum(of)
            }

            #[inline(always)]
            fn add_product<S: Simd>(simd: S, a: S::$registers, b: S::$registers, c: S::$registers) -> S::$registers {
                simd.$add(a, b, c)
            }

            #[inline(always)]
            fn take_product<S: Simd>(simd: S, a: S::$registers, b: S::$registers, c: S::$registers) -> S::$registers {
                simd.$take(a, b, c)
            }
        }
    };
}

real!(
    f64,
    f64s,
    F64_LANES,
    8,
    [as_simd_f64s, as_mut_simd_f64s, splat_f64s, reduce_sum_f64s, mul_add_e_f64s, negate_mul_add_e_f64s]
);
real!(
    f32,
    f32s,
    F32_LANES,
    16,
    [as_simd_f32s, as_mut_simd_f32s, splat_f32s, reduce_sum_f32s, mul_add_e_f32s, negate_mul_add_e_f32s]
);
