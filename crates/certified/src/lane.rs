//! Double and double-double numbers in vector registers: one number in each lane.

use pulp::Simd;

use super::dd::Dd;
use super::real::Real;
use crate::lanes::Ops;

/// The most numbers in one register, of AVX-512.
pub(crate) const MOST_LANES: usize = 8;
/// 2^27 + 1, splits 53 bits into 26 and 26 (Veltkamp).
const SPLITTER: f64 = 134_217_729.0;

/// c and s of the rotation `[c s; -s c]` of two neighbouring rows or columns.
pub(crate) type Rotation<T> = (T, T);
/// The reflection `I - beta w w^T` of three neighbouring rows or columns, w = (1, u): u and beta w.
pub(crate) type Reflection<T> = ([T; 2], [T; 3]);

/// Rows of one register's columns, gathered: for each plane and row the entries of the columns, one in each lane.
///
/// Columns go in and out [`BLOCK_ROWS`] entries at a time: a register read right after single numbers were written to its
/// place waits for them to arrive in memory.
pub(crate) type Block = [[[f64; MOST_LANES]; BLOCK_ROWS]; 2];
/// Rows of a [`Block`]: a cache line of each column.
pub(crate) const BLOCK_ROWS: usize = 8;

/// A number whose vectors are computed with in registers.
///
/// Functions and no closures, which the compiler may leave out of what it compiles for the instruction set.
pub(crate) trait Lane: Real {
    /// A number in each lane.
    type In<V: Copy>: Copy;
    fn splat<S: Simd>(o: Ops<S>, x: Self) -> Self::In<S::f64s>;
    /// Entries `rows.0..rows.1` of a column, no more than a register has lanes; `plane` is the column's length.
    fn load<S: Simd>(o: Ops<S>, column: &[f64], plane: usize, rows: (usize, usize)) -> Self::In<S::f64s>;
    fn store<S: Simd>(o: Ops<S>, column: &mut [f64], plane: usize, rows: (usize, usize), x: Self::In<S::f64s>);
    fn from_block<S: Simd>(o: Ops<S>, block: &Block, row: usize) -> Self::In<S::f64s>;
    fn to_block<S: Simd>(o: Ops<S>, block: &mut Block, row: usize, x: Self::In<S::f64s>);
    fn plus<S: Simd>(o: Ops<S>, a: Self::In<S::f64s>, b: Self::In<S::f64s>) -> Self::In<S::f64s>;
    fn times<S: Simd>(o: Ops<S>, a: Self::In<S::f64s>, b: Self::In<S::f64s>) -> Self::In<S::f64s>;
    /// `c + a b`.
    fn plus_times<S: Simd>(
        o: Ops<S>,
        c: Self::In<S::f64s>,
        a: Self::In<S::f64s>,
        b: Self::In<S::f64s>,
    ) -> Self::In<S::f64s>;
    /// `c - a b`.
    fn minus_times<S: Simd>(
        o: Ops<S>,
        c: Self::In<S::f64s>,
        a: Self::In<S::f64s>,
        b: Self::In<S::f64s>,
    ) -> Self::In<S::f64s>;
    /// The sum over the lanes.
    fn sum<S: Simd>(o: Ops<S>, a: Self::In<S::f64s>) -> Self;
}

#[inline(always)]
fn numbers<S: Simd>(o: Ops<S>, x: S::f64s) -> [f64; MOST_LANES] {
    let mut entries = [0.0; MOST_LANES];
    o.store(&mut entries[..S::F64_LANES], x);
    entries
}

impl Lane for f64 {
    type In<V: Copy> = V;
    #[inline(always)]
    fn splat<S: Simd>(o: Ops<S>, x: f64) -> S::f64s {
        o.splat(x)
    }
    #[inline(always)]
    fn load<S: Simd>(o: Ops<S>, column: &[f64], _plane: usize, rows: (usize, usize)) -> S::f64s {
        o.load(&column[rows.0..rows.1])
    }
    #[inline(always)]
    fn store<S: Simd>(o: Ops<S>, column: &mut [f64], _plane: usize, rows: (usize, usize), x: S::f64s) {
        o.store(&mut column[rows.0..rows.1], x);
    }
    #[inline(always)]
    fn from_block<S: Simd>(o: Ops<S>, block: &Block, row: usize) -> S::f64s {
        o.load(&block[0][row][..S::F64_LANES])
    }
    #[inline(always)]
    fn to_block<S: Simd>(o: Ops<S>, block: &mut Block, row: usize, x: S::f64s) {
        o.store(&mut block[0][row][..S::F64_LANES], x);
    }
    #[inline(always)]
    fn plus<S: Simd>(o: Ops<S>, a: S::f64s, b: S::f64s) -> S::f64s {
        o.add(a, b)
    }
    #[inline(always)]
    fn times<S: Simd>(o: Ops<S>, a: S::f64s, b: S::f64s) -> S::f64s {
        o.mul(a, b)
    }
    #[inline(always)]
    fn plus_times<S: Simd>(o: Ops<S>, c: S::f64s, a: S::f64s, b: S::f64s) -> S::f64s {
        o.fma(a, b, c)
    }
    #[inline(always)]
    fn minus_times<S: Simd>(o: Ops<S>, c: S::f64s, a: S::f64s, b: S::f64s) -> S::f64s {
        o.fnma(a, b, c)
    }
    #[inline(always)]
    fn sum<S: Simd>(o: Ops<S>, a: S::f64s) -> f64 {
        numbers(o, a).iter().sum()
    }
}

impl Lane for Dd {
    /// High and low parts.
    type In<V: Copy> = [V; 2];
    #[inline(always)]
    fn splat<S: Simd>(o: Ops<S>, x: Dd) -> [S::f64s; 2] {
        [o.splat(x.hi), o.splat(x.lo)]
    }
    #[inline(always)]
    fn load<S: Simd>(o: Ops<S>, column: &[f64], plane: usize, (from, to): (usize, usize)) -> [S::f64s; 2] {
        [o.load(&column[from..to]), o.load(&column[plane + from..plane + to])]
    }
    #[inline(always)]
    fn store<S: Simd>(o: Ops<S>, column: &mut [f64], plane: usize, (from, to): (usize, usize), x: [S::f64s; 2]) {
        o.store(&mut column[from..to], x[0]);
        o.store(&mut column[plane + from..plane + to], x[1]);
    }
    #[inline(always)]
    fn from_block<S: Simd>(o: Ops<S>, block: &Block, row: usize) -> [S::f64s; 2] {
        [o.load(&block[0][row][..S::F64_LANES]), o.load(&block[1][row][..S::F64_LANES])]
    }
    #[inline(always)]
    fn to_block<S: Simd>(o: Ops<S>, block: &mut Block, row: usize, x: [S::f64s; 2]) {
        o.store(&mut block[0][row][..S::F64_LANES], x[0]);
        o.store(&mut block[1][row][..S::F64_LANES], x[1]);
    }
    /// `a + b`, wrong by some 2^-104 of |a| + |b|, which is what an orthogonal reduction needs, and half the price of a sum that
    /// is right to that part of |a + b|.
    #[inline(always)]
    fn plus<S: Simd>(o: Ops<S>, a: [S::f64s; 2], b: [S::f64s; 2]) -> [S::f64s; 2] {
        let high = o.add(a[0], b[0]);
        let b_part = o.sub(high, a[0]);
        let error = o.add(o.sub(a[0], o.sub(high, b_part)), o.sub(b[0], b_part));
        fast_two_sum(o, high, o.add(error, o.add(a[1], b[1])))
    }
    #[inline(always)]
    fn times<S: Simd>(o: Ops<S>, a: [S::f64s; 2], b: [S::f64s; 2]) -> [S::f64s; 2] {
        let product = o.mul(a[0], b[0]);
        let error = product_error(o, a[0], b[0], product);
        fast_two_sum(o, product, o.fma(a[1], b[0], o.fma(a[0], b[1], error)))
    }
    /// `c + a b` with one renormalisation for both operations; wrong by some 2^-104 of |c| + |a b|, as [`plus`](Lane::plus).
    #[inline(always)]
    fn plus_times<S: Simd>(o: Ops<S>, c: [S::f64s; 2], a: [S::f64s; 2], b: [S::f64s; 2]) -> [S::f64s; 2] {
        let product = o.mul(a[0], b[0]);
        let low = o.fma(a[1], b[0], o.fma(a[0], b[1], o.add(product_error(o, a[0], b[0], product), c[1])));
        let high = o.add(c[0], product);
        let part = o.sub(high, c[0]);
        let error = o.add(o.sub(c[0], o.sub(high, part)), o.sub(product, part));
        fast_two_sum(o, high, o.add(error, low))
    }
    #[inline(always)]
    fn minus_times<S: Simd>(o: Ops<S>, c: [S::f64s; 2], a: [S::f64s; 2], b: [S::f64s; 2]) -> [S::f64s; 2] {
        let product = o.mul(a[0], b[0]);
        let low = o.fma(a[1], b[0], o.fma(a[0], b[1], o.sub(product_error(o, a[0], b[0], product), c[1])));
        let high = o.sub(c[0], product);
        let part = o.sub(c[0], high);
        let error = o.sub(o.sub(c[0], o.add(high, part)), o.sub(product, part));
        fast_two_sum(o, high, o.sub(error, low))
    }
    #[inline(always)]
    fn sum<S: Simd>(o: Ops<S>, a: [S::f64s; 2]) -> Dd {
        let (hi, lo) = (numbers(o, a[0]), numbers(o, a[1]));
        hi.into_iter().zip(lo).fold(Dd::default(), |sum, (hi, lo)| sum + Dd { hi, lo })
    }
}

#[inline(always)]
pub(crate) fn fast_two_sum<S: Simd>(o: Ops<S>, a: S::f64s, b: S::f64s) -> [S::f64s; 2] {
    let high = o.add(a, b);
    [high, o.sub(b, o.sub(high, a))]
}

/// `a b - product`, exactly: by a fused multiply-add, or by Dekker's splitting on a machine that has none.
#[inline(always)]
pub(crate) fn product_error<S: Simd>(o: Ops<S>, a: S::f64s, b: S::f64s, product: S::f64s) -> S::f64s {
    if !S::IS_SCALAR {
        return o.exact_fma(a, b, o.neg(product));
    }
    let ([a1, a0], [b1, b0]) = (split(o, a), split(o, b));
    let high = o.sub(o.mul(a1, b1), product);
    o.add(o.add(o.add(high, o.mul(a1, b0)), o.mul(a0, b1)), o.mul(a0, b0))
}

#[inline(always)]
fn split<S: Simd>(o: Ops<S>, a: S::f64s) -> [S::f64s; 2] {
    let c = o.mul(o.splat(SPLITTER), a);
    let high = o.sub(c, o.sub(c, a));
    [high, o.sub(a, high)]
}
