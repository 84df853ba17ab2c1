//! Reflections of three rows or columns, by which a bulge is chased.

use certified::lanes::Ops;
use pulp::Simd;

use super::layout::REFLECTORS_PER_WINDOW;

/// `P = I - (t1, t2, t3)^T (1, v2, v3)`; all zero, the identity, in a lane without a reflection.
#[derive(Debug, Clone, Copy)]
pub(super) struct LaneReflector<V> {
    pub v2: V,
    pub v3: V,
    pub t1: V,
    pub t2: V,
    pub t3: V,
}

/// The reflectors of a window, aligned so that no register straddles two cache lines.
#[repr(align(64))]
pub(super) struct Reflectors<V>(pub [LaneReflector<V>; REFLECTORS_PER_WINDOW]);

impl<V: Copy> Reflectors<V> {
    pub fn identities(zero: V) -> Self {
        Self([LaneReflector { v2: zero, v3: zero, t1: zero, t2: zero, t3: zero }; REFLECTORS_PER_WINDOW])
    }
}

impl<V: Copy> LaneReflector<V> {
    /// Reflects (x, y, z).
    #[inline(always)]
    pub fn apply<S: Simd<f64s = V>>(&self, o: Ops<S>, x: &mut V, y: &mut V, z: &mut V) {
        let u = o.fma(self.v2, *y, o.fma(self.v3, *z, *x));
        *x = o.fnma(self.t1, u, *x);
        *y = o.fnma(self.t2, u, *y);
        *z = o.fnma(self.t3, u, *z);
    }
}

/// Applies a window's reflectors from the left to `REFLECTORS_PER_WINDOW + 2` rows of four columns.
///
/// The chains of dependent operations of four columns overlap, and each coefficient is loaded once for the four.
#[inline(always)]
pub(super) fn from_left<S: Simd>(o: Ops<S>, columns: [&mut [S::f64s]; 4], r: &Reflectors<S::f64s>) {
    let [a, b, c, d] = columns;
    let mut x = [a[0], b[0], c[0], d[0]];
    let mut y = [a[1], b[1], c[1], d[1]];
    for t in 0..REFLECTORS_PER_WINDOW {
        let mut z = [a[t + 2], b[t + 2], c[t + 2], d[t + 2]];
        for g in 0..4 {
            r.0[t].apply(o, &mut x[g], &mut y[g], &mut z[g]);
        }
        (a[t], b[t], c[t], d[t]) = (x[0], x[1], x[2], x[3]);
        (x, y) = (y, z);
    }
    (a[REFLECTORS_PER_WINDOW], b[REFLECTORS_PER_WINDOW], c[REFLECTORS_PER_WINDOW], d[REFLECTORS_PER_WINDOW]) =
        (x[0], x[1], x[2], x[3]);
    (
        a[REFLECTORS_PER_WINDOW + 1],
        b[REFLECTORS_PER_WINDOW + 1],
        c[REFLECTORS_PER_WINDOW + 1],
        d[REFLECTORS_PER_WINDOW + 1],
    ) = (y[0], y[1], y[2], y[3]);
}

/// Applies a window's reflectors from the right to `REFLECTORS_PER_WINDOW + 2` columns, in four rows from row `i`.
#[inline(always)]
pub(super) fn from_right<S: Simd>(
    o: Ops<S>,
    columns: &mut [&mut [S::f64s]; REFLECTORS_PER_WINDOW + 2],
    i: usize,
    r: &Reflectors<S::f64s>,
) {
    let mut x = four(columns[0], i);
    let mut y = four(columns[1], i);
    for t in 0..REFLECTORS_PER_WINDOW {
        let mut z = four(columns[t + 2], i);
        for g in 0..4 {
            r.0[t].apply(o, &mut x[g], &mut y[g], &mut z[g]);
        }
        columns[t][i..i + 4].copy_from_slice(&x);
        (x, y) = (y, z);
    }
    columns[REFLECTORS_PER_WINDOW][i..i + 4].copy_from_slice(&x);
    columns[REFLECTORS_PER_WINDOW + 1][i..i + 4].copy_from_slice(&y);
}

#[inline(always)]
fn four<V: Copy>(column: &[V], i: usize) -> [V; 4] {
    let part = &column[i..i + 4];
    [part[0], part[1], part[2], part[3]]
}
