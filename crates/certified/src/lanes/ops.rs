//! Arithmetic on one vector register: lane l belongs to sample l, and no operation mixes lanes.

use pulp::Simd;

/// Short names for the operations of `S`.
///
/// Every method is inlined into the function that pulp compiles for the instruction set. A closure called in several places may
/// not be inlined and is then compiled without that instruction set: the QR iteration took 53 us instead of 34 us with one.
#[derive(Clone, Copy)]
pub struct Ops<S>(
    /// The instruction set.
    pub S,
);

impl<S: Simd> Ops<S> {
    /// `a` in every lane.
    #[inline(always)]
    pub fn splat(self, a: f64) -> S::f64s {
        self.0.splat_f64s(a)
    }
    /// `a + b`.
    #[inline(always)]
    pub fn add(self, a: S::f64s, b: S::f64s) -> S::f64s {
        self.0.add_f64s(a, b)
    }
    /// `a - b`.
    #[inline(always)]
    pub fn sub(self, a: S::f64s, b: S::f64s) -> S::f64s {
        self.0.sub_f64s(a, b)
    }
    /// `a b`.
    #[inline(always)]
    pub fn mul(self, a: S::f64s, b: S::f64s) -> S::f64s {
        self.0.mul_f64s(a, b)
    }
    /// `a / b`.
    #[inline(always)]
    pub fn div(self, a: S::f64s, b: S::f64s) -> S::f64s {
        self.0.div_f64s(a, b)
    }
    /// The square root.
    #[inline(always)]
    pub fn sqrt(self, a: S::f64s) -> S::f64s {
        self.0.sqrt_f64s(a)
    }
    /// `-a`.
    #[inline(always)]
    pub fn neg(self, a: S::f64s) -> S::f64s {
        self.0.neg_f64s(a)
    }
    /// `|a|`.
    #[inline(always)]
    pub fn abs(self, a: S::f64s) -> S::f64s {
        self.0.abs_f64s(a)
    }
    /// The larger of both.
    #[inline(always)]
    pub fn max(self, a: S::f64s, b: S::f64s) -> S::f64s {
        self.0.max_f64s(a, b)
    }
    /// `a b + c`, rounded once where the machine can.
    #[inline(always)]
    pub fn fma(self, a: S::f64s, b: S::f64s, c: S::f64s) -> S::f64s {
        self.0.mul_add_e_f64s(a, b, c)
    }
    /// `c - a b`, rounded once where the machine can.
    #[inline(always)]
    pub fn fnma(self, a: S::f64s, b: S::f64s, c: S::f64s) -> S::f64s {
        self.0.negate_mul_add_e_f64s(a, b, c)
    }
    /// Where both are equal.
    #[inline(always)]
    pub fn eq(self, a: S::f64s, b: S::f64s) -> S::m64s {
        self.0.equal_f64s(a, b)
    }
    /// Where `a <= b`.
    #[inline(always)]
    pub fn le(self, a: S::f64s, b: S::f64s) -> S::m64s {
        self.0.less_than_or_equal_f64s(a, b)
    }
    /// Where `a < b`.
    #[inline(always)]
    pub fn lt(self, a: S::f64s, b: S::f64s) -> S::m64s {
        self.0.less_than_f64s(a, b)
    }
    /// Where both masks are set.
    #[inline(always)]
    pub fn and(self, a: S::m64s, b: S::m64s) -> S::m64s {
        self.0.and_m64s(a, b)
    }
    /// Where one of the masks is set.
    #[inline(always)]
    pub fn or(self, a: S::m64s, b: S::m64s) -> S::m64s {
        self.0.or_m64s(a, b)
    }
    /// Where the mask is not set.
    #[inline(always)]
    pub fn not(self, a: S::m64s) -> S::m64s {
        self.0.not_m64s(a)
    }
    /// `a b + c`, rounded once on every machine, which is slow where it has no such instruction.
    #[inline(always)]
    pub fn exact_fma(self, a: S::f64s, b: S::f64s, c: S::f64s) -> S::f64s {
        self.0.mul_add_f64s(a, b, c)
    }
    /// A register of these numbers, zero beyond them.
    #[inline(always)]
    pub fn load(self, from: &[f64]) -> S::f64s {
        match S::as_simd_f64s(from).0 {
            [full, ..] => *full,
            [] => self.0.partial_load_f64s(from),
        }
    }
    /// As many numbers of the register as there is room for.
    #[inline(always)]
    pub fn store(self, to: &mut [f64], a: S::f64s) {
        match S::as_mut_simd_f64s(to) {
            ([full, ..], _) => *full = a,
            ([], rest) => self.0.partial_store_f64s(rest, a),
        }
    }
    /// `a` in the lanes of the mask, `b` in the others.
    #[inline(always)]
    pub fn select(self, mask: S::m64s, a: S::f64s, b: S::f64s) -> S::f64s {
        self.0.select_f64s(mask, a, b)
    }
}

/// `number` registers in `scratch`, which grows as needed. They begin at a cache line (8 numbers), so that no register
/// straddles two lines.
pub fn registers<S: Simd>(scratch: &mut Vec<f64>, number: usize) -> &mut [S::f64s] {
    let needed = number * S::F64_LANES;
    if scratch.len() < needed + 8 {
        scratch.resize(needed + 8, 0.0);
    }
    let start = scratch.as_ptr().align_offset(64).min(8);
    S::as_mut_simd_f64s(&mut scratch[start..start + needed]).0
}
