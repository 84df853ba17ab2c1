//! Arithmetic on one vector register. No operation mixes lanes, whether these are samples or neighbours in a row.

use std::marker::PhantomData;

use pulp::Simd;

use super::Precision;

/// Short names for the operations of `S` on numbers of a [`Precision`].
///
/// Every method is inlined into the function that pulp compiles for the instruction set. A closure called in several places may
/// not be inlined and is then compiled without that instruction set: the QR iteration took 53 us instead of 34 us with one.
#[derive(Clone, Copy)]
pub struct Ops<S, T = f64> {
    simd: S,
    precision: PhantomData<T>,
}

impl<S: Simd, T: Precision> Ops<S, T> {
    /// The operations of an instruction set.
    #[inline(always)]
    pub fn of(simd: S) -> Self {
        Self { simd, precision: PhantomData }
    }
    /// `a` in every lane.
    #[inline(always)]
    pub fn splat(self, a: T) -> T::Register<S> {
        <T as Precision>::splat(self.simd, a)
    }
    /// `a + b`.
    #[inline(always)]
    pub fn add(self, a: T::Register<S>, b: T::Register<S>) -> T::Register<S> {
        <T as Precision>::add(self.simd, a, b)
    }
    /// `a - b`.
    #[inline(always)]
    pub fn sub(self, a: T::Register<S>, b: T::Register<S>) -> T::Register<S> {
        <T as Precision>::sub(self.simd, a, b)
    }
    /// `a b`.
    #[inline(always)]
    pub fn mul(self, a: T::Register<S>, b: T::Register<S>) -> T::Register<S> {
        <T as Precision>::mul(self.simd, a, b)
    }
    /// `a / b`.
    #[inline(always)]
    pub fn div(self, a: T::Register<S>, b: T::Register<S>) -> T::Register<S> {
        <T as Precision>::div(self.simd, a, b)
    }
    /// The square root.
    #[inline(always)]
    pub fn sqrt(self, a: T::Register<S>) -> T::Register<S> {
        <T as Precision>::sqrt(self.simd, a)
    }
    /// `-a`.
    #[inline(always)]
    pub fn neg(self, a: T::Register<S>) -> T::Register<S> {
        <T as Precision>::neg(self.simd, a)
    }
    /// `a b + c`, rounded once where the machine can.
    #[inline(always)]
    pub fn fma(self, a: T::Register<S>, b: T::Register<S>, c: T::Register<S>) -> T::Register<S> {
        <T as Precision>::fma(self.simd, a, b, c)
    }
    /// `c - a b`, rounded once where the machine can.
    #[inline(always)]
    pub fn fnma(self, a: T::Register<S>, b: T::Register<S>, c: T::Register<S>) -> T::Register<S> {
        <T as Precision>::fnma(self.simd, a, b, c)
    }
}

impl<S: Simd> Ops<S> {
    /// The operations of an instruction set in double precision.
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        Self::of(simd)
    }
    /// `|a|`.
    #[inline(always)]
    pub fn abs(self, a: S::f64s) -> S::f64s {
        self.simd.abs_f64s(a)
    }
    /// The larger of both; of a NaN and a number either, as the instruction set has it.
    #[inline(always)]
    pub fn max(self, a: S::f64s, b: S::f64s) -> S::f64s {
        self.simd.max_f64s(a, b)
    }
    /// Mask of the lanes where both are equal.
    #[inline(always)]
    pub fn eq(self, a: S::f64s, b: S::f64s) -> S::m64s {
        self.simd.equal_f64s(a, b)
    }
    /// Mask of the lanes where `a <= b`.
    #[inline(always)]
    pub fn le(self, a: S::f64s, b: S::f64s) -> S::m64s {
        self.simd.less_than_or_equal_f64s(a, b)
    }
    /// Mask of the lanes where `a < b`.
    #[inline(always)]
    pub fn lt(self, a: S::f64s, b: S::f64s) -> S::m64s {
        self.simd.less_than_f64s(a, b)
    }
    /// Mask of the lanes where both masks are set.
    #[inline(always)]
    pub fn and(self, a: S::m64s, b: S::m64s) -> S::m64s {
        self.simd.and_m64s(a, b)
    }
    /// Mask of the lanes where one of the masks is set.
    #[inline(always)]
    pub fn or(self, a: S::m64s, b: S::m64s) -> S::m64s {
        self.simd.or_m64s(a, b)
    }
    /// Mask of the lanes where the mask is not set.
    #[inline(always)]
    pub fn not(self, a: S::m64s) -> S::m64s {
        self.simd.not_m64s(a)
    }
    /// `a b + c`, rounded once on every machine, which is slow where it has no such instruction.
    #[inline(always)]
    pub fn exact_fma(self, a: S::f64s, b: S::f64s, c: S::f64s) -> S::f64s {
        self.simd.mul_add_f64s(a, b, c)
    }
    /// A register of these numbers, zero beyond them.
    #[inline(always)]
    pub fn load(self, from: &[f64]) -> S::f64s {
        match S::as_simd_f64s(from).0 {
            [full, ..] => *full,
            [] => self.simd.partial_load_f64s(from),
        }
    }
    /// Stores the numbers of the register, as many as there is room for.
    #[inline(always)]
    pub fn store(self, to: &mut [f64], a: S::f64s) {
        match S::as_mut_simd_f64s(to) {
            ([full, ..], _) => *full = a,
            ([], rest) => self.simd.partial_store_f64s(rest, a),
        }
    }
    /// `a` in the lanes of the mask, `b` in the others.
    #[inline(always)]
    pub fn select(self, mask: S::m64s, a: S::f64s, b: S::f64s) -> S::f64s {
        self.simd.select_f64s(mask, a, b)
    }
}

/// `number` registers in `scratch`, which grows as needed. They hold old numbers: whoever borrows them writes before they read. They begin at a cache line (8 numbers),
/// so that no register straddles two lines, which is faster.
pub fn registers<S: Simd>(scratch: &mut Vec<f64>, number: usize) -> &mut [S::f64s] {
    let needed = number * S::F64_LANES;
    if scratch.len() < needed + 8 {
        scratch.resize(needed + 8, 0.0);
    }
    let start = scratch.as_ptr().align_offset(64).min(8);
    S::as_mut_simd_f64s(&mut scratch[start..start + needed]).0
}
