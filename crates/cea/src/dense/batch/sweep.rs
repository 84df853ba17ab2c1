//! Sweep of implicit double-shift QR (Francis, Computer J. 4, 1961-62) over all lanes, each in its own blocks.
//!
//! A bulge of three rows starts at the top of each block and is chased down the block. Steps are taken in windows: the
//! reflectors of a window are found on a small diagonal block, which stays in the first cache level. They are then applied to
//! the columns right of it and the rows above it, where each entry is read and written once for all reflectors. A lane whose
//! block does not contain the current row reflects by the identity.
//!
//! Eigenvalues do not need the entries outside the rows and columns `first..=last` of a sweep; these are not updated.

use certified::lanes::Ops;
use pulp::Simd;

use super::hessenberg::NEGLIGIBLE_COLUMN;
use super::layout::{Layout, REFLECTORS_PER_WINDOW, columns};
use super::reflector::{LaneReflector, Reflectors, from_left, from_right};
use super::shifts::ShiftPair;

/// A diagonal block of each lane, rows `top..=bottom` (row numbers as floating-point lanes), and its shifts.
/// A lane without a block has `bottom < top`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block<V> {
    pub top: V,
    pub bottom: V,
    pub shifts: ShiftPair<V>,
}

/// The blocks that a sweep works on, in all lanes.
pub(super) struct SweepInput<'a, V> {
    /// First row of any block of any lane.
    pub first: usize,
    /// Last row of any block of any lane.
    pub last: usize,
    /// Up to two blocks of each lane, which do not overlap.
    pub blocks: [Block<V>; 2],
    /// `tops[k]`: some lane has a block that begins in row k.
    pub tops: &'a [bool],
}

/// Lanes whose block contains the rows `k..=last`.
#[inline(always)]
fn holds<S: Simd>(o: Ops<S>, block: &Block<S::f64s>, k: S::f64s, last: S::f64s) -> S::m64s {
    o.and(o.le(block.top, k), o.le(last, block.bottom))
}

/// First column of `(H - s1)(H - s2)` in lanes whose block begins in row k, `column` in the others.
///
/// `h` is h00, h10, h01, h11, h21 of the block. The column is not divided by h10 as in textbooks: where h10 vanishes, its second
/// and third entries vanish and the reflection is the identity.
#[inline(always)]
fn begin<S: Simd>(
    o: Ops<S>,
    block: &Block<S::f64s>,
    k: S::f64s,
    h: [S::f64s; 5],
    column: [S::f64s; 3],
) -> [S::f64s; 3] {
    let [h00, h10, h01, h11, h21] = h;
    let ShiftPair { mean, square } = block.shifts;
    let here = o.eq(block.top, k);
    let from_mean = o.sub(h00, mean);
    let x = o.fma(h01, h10, o.sub(o.mul(from_mean, from_mean), square));
    let y = o.mul(h10, o.add(from_mean, o.sub(h11, mean)));
    let z = o.mul(h10, h21);
    [o.select(here, x, column[0]), o.select(here, y, column[1]), o.select(here, z, column[2])]
}

/// Makes a sweep over all blocks of the input.
#[inline(always)]
pub(super) fn sweep<S: Simd>(
    o: Ops<S>,
    a: &mut [S::f64s],
    layout: Layout,
    input: &SweepInput<'_, S::f64s>,
    r: &mut Reflectors<S::f64s>,
) {
    let stride = layout.stride;
    let mut k = input.first;
    while k < input.last {
        let row = layout.row(k);
        // Rows from k of the columns k - 1 ..= k + REFLECTORS_PER_WINDOW + 1.
        let mut diagonal = columns(&mut a[layout.column(k) - stride..], stride, row, REFLECTORS_PER_WINDOW + 3);
        window(o, &mut diagonal, k, input, r);

        let mut j = k + REFLECTORS_PER_WINDOW + 2;
        while j <= input.last {
            from_left(o, columns(&mut a[layout.column(j)..], stride, row, REFLECTORS_PER_WINDOW + 2), r);
            j += 4;
        }

        // In groups of four rows from the window upwards: a group may reach into the spare rows above the matrix.
        let rows = (k - input.first).next_multiple_of(4);
        let mut above = columns(&mut a[layout.column(k)..], stride, row - rows, rows);
        for i in (0..rows).step_by(4) {
            from_right(o, &mut above, i, r);
        }
        k += REFLECTORS_PER_WINDOW;
    }
}

/// Chases the bulges through rows `first..first + REFLECTORS_PER_WINDOW`. `c[0]` is the column before the window's first.
#[inline(always)]
fn window<S: Simd>(
    o: Ops<S>,
    c: &mut [&mut [S::f64s]; REFLECTORS_PER_WINDOW + 3],
    first: usize,
    input: &SweepInput<'_, S::f64s>,
    r: &mut Reflectors<S::f64s>,
) {
    let zero = o.splat(0.0);
    let [p, q] = &input.blocks;
    for t in 0..REFLECTORS_PER_WINDOW {
        let row = o.splat((first + t) as f64);
        let next = o.splat((first + t + 1) as f64);
        let after = o.splat((first + t + 2) as f64);
        let begins = o.or(o.eq(p.top, row), o.eq(q.top, row));
        let active = o.or(holds(o, p, row, next), holds(o, q, row, next));
        let three = o.or(holds(o, p, row, after), holds(o, q, row, after));

        let mut column = [c[t][t], c[t][t + 1], c[t][t + 2]];
        if input.tops[first + t] {
            let h = [c[t + 1][t], c[t + 1][t + 1], c[t + 2][t], c[t + 2][t + 1], c[t + 2][t + 2]];
            column = begin(o, p, row, h, column);
            column = begin(o, q, row, h, column);
        }
        let [x, y, z] = column;
        // The last reflector of a block has two rows.
        let z = o.select(three, z, zero);
        let sigma = o.fma(z, z, o.mul(y, y));
        let some = o.and(active, o.lt(o.splat(NEGLIGIBLE_COLUMN), sigma));
        let norm = o.sqrt(o.fma(x, x, sigma));
        let beta = o.select(o.le(zero, x), o.neg(norm), norm);
        let inverse = o.select(some, o.div(o.splat(1.0), o.sub(x, beta)), zero);
        let tau = o.select(some, o.div(o.sub(beta, x), beta), zero);
        let (v2, v3) = (o.mul(y, inverse), o.mul(z, inverse));
        let g = LaneReflector { v2, v3, t1: tau, t2: o.mul(tau, v2), t3: o.mul(tau, v3) };
        r.0[t] = g;

        c[t][t] = o.select(o.or(begins, o.not(some)), c[t][t], beta);
        c[t][t + 1] = o.select(some, zero, c[t][t + 1]);
        c[t][t + 2] = o.select(some, zero, c[t][t + 2]);
        for column in &mut c[t + 1..] {
            let (mut x, mut y, mut z) = (column[t], column[t + 1], column[t + 2]);
            g.apply(o, &mut x, &mut y, &mut z);
            (column[t], column[t + 1], column[t + 2]) = (x, y, z);
        }
        // From the lowest row up, because the next reflector needs the lower rows first.
        for i in (0..t + 4).rev() {
            let (mut x, mut y, mut z) = (c[t + 1][i], c[t + 2][i], c[t + 3][i]);
            g.apply(o, &mut x, &mut y, &mut z);
            (c[t + 1][i], c[t + 2][i], c[t + 3][i]) = (x, y, z);
        }
    }
}
