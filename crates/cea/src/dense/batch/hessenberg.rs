//! Householder's reduction to Hessenberg form, all lanes at once.
//!
//! A reflection `P = I - tau v v^T` from both sides is a change of rank two,
//! `P A P = A - v w^T - y v^T` with `w = tau A^T v` and `y = tau (A v - tau (v^T A v) v)`. The pass over the
//! matrix that makes this change also forms the products `A v` and `A^T v` of the *next* reflection, so that each step reads
//! and writes the matrix once. The reduction takes 5/3 N^3 fused multiply-adds, as LAPACK's dgehrd.

use certified::lanes::Ops;
use pulp::Simd;

use super::layout::{Layout, columns};

/// Largest sum of squares of a column that counts as zero. Chosen: the matrices are scaled to norm one, and a sum of squares
/// below 1e-292 has lost digits to underflow.
pub(super) const NEGLIGIBLE_COLUMN: f64 = 1e-290;

/// Registers of scratch memory needed.
pub(super) fn scratch_len(layout: Layout) -> usize {
    5 * layout.order
}

/// The vectors of length N that the pass of one step reads in every row: v and y of the pending change, v of the next one.
struct ReductionStep<'a, V> {
    v: &'a [V],
    y: &'a [V],
    next: &'a [V],
}

/// Makes the pending change in W columns, adds their part of `A v` to `p`, and returns their entries of `A^T v`.
///
/// In rows before `top` v is zero, and only the change from the right applies.
#[inline(always)]
fn pass<S: Simd, const W: usize>(
    o: Ops<S>,
    cols: [&mut [S::f64s]; W],
    top: usize,
    step: &ReductionStep<'_, S::f64s>,
    p: &mut [S::f64s],
    w: &[S::f64s],
    first: usize,
) -> [S::f64s; W] {
    let n = p.len();
    let ReductionStep { v, y, next } = *step;
    let (v, y, next) = (&v[..n], &y[..n], &next[..n]);
    let mut wj = [o.splat(0.0); W];
    let (mut vj, mut nj, mut q) = (wj, wj, wj);
    wj.copy_from_slice(&w[first..first + W]);
    vj.copy_from_slice(&v[first..first + W]);
    nj.copy_from_slice(&next[first..first + W]);
    for i in 0..top {
        let mut sum = p[i];
        for c in 0..W {
            let x = o.fnma(y[i], vj[c], cols[c][i]);
            cols[c][i] = x;
            sum = o.fma(x, nj[c], sum);
        }
        p[i] = sum;
    }
    for i in top..n {
        let mut sum = p[i];
        for c in 0..W {
            let x = o.fnma(y[i], vj[c], o.fnma(v[i], wj[c], cols[c][i]));
            cols[c][i] = x;
            sum = o.fma(x, nj[c], sum);
            q[c] = o.fma(x, next[i], q[c]);
        }
        p[i] = sum;
    }
    q
}

/// Makes the pending change in one column.
#[inline(always)]
fn finish_column<S: Simd>(o: Ops<S>, column: &mut [S::f64s], v: &[S::f64s], y: &[S::f64s], w: S::f64s, vj: S::f64s) {
    for ((x, &v), &y) in column.iter_mut().zip(v).zip(y) {
        *x = o.fnma(y, vj, o.fnma(v, w, *x));
    }
}

/// Overwrites the matrices with their Hessenberg forms, exact zeros below the subdiagonal.
#[inline(always)]
pub(super) fn reduce<S: Simd>(o: Ops<S>, a: &mut [S::f64s], layout: Layout, scratch: &mut [S::f64s]) {
    let (n, stride, top) = (layout.order, layout.stride, layout.row(0));
    if n < 3 {
        return;
    }
    let (zero, one) = (o.splat(0.0), o.splat(1.0));
    let scratch = &mut scratch[..scratch_len(layout)];
    scratch.fill(zero);
    let (mut v, rest) = scratch.split_at_mut(n);
    let (mut next, rest) = rest.split_at_mut(n);
    let (y, rest) = rest.split_at_mut(n);
    let (p, w) = rest.split_at_mut(n);
    for k in 0..n - 2 {
        let column = &mut a[layout.at(0, k)..][..n];
        finish_column(o, column, v, y, w[k], v[k]);

        let alpha = column[k + 1];
        let mut sigma = zero;
        for &x in &column[k + 2..] {
            sigma = o.fma(x, x, sigma);
        }
        let some = o.lt(o.splat(NEGLIGIBLE_COLUMN), sigma);
        let norm = o.sqrt(o.fma(alpha, alpha, sigma));
        let beta = o.select(o.le(zero, alpha), o.neg(norm), norm);
        let tau = o.select(some, o.div(o.sub(beta, alpha), beta), zero);
        let inverse = o.select(some, o.div(one, o.sub(alpha, beta)), zero);
        next[..=k].fill(zero);
        next[k + 1] = one;
        for (x, v) in column[k + 2..].iter_mut().zip(&mut next[k + 2..]) {
            *v = o.mul(*x, inverse);
            *x = zero;
        }
        column[k + 1] = o.select(some, beta, alpha);

        p.fill(zero);
        let step = ReductionStep { v, y, next };
        let mut j = k + 1;
        while j + 4 <= n {
            let cols = columns::<_, 4>(&mut a[layout.column(j)..], stride, top, n);
            let q = pass(o, cols, k, &step, p, w, j);
            for (w, q) in w[j..j + 4].iter_mut().zip(q) {
                *w = o.mul(tau, q);
            }
            j += 4;
        }
        while j < n {
            let cols = columns::<_, 1>(&mut a[layout.column(j)..], stride, top, n);
            let [q] = pass(o, cols, k, &step, p, w, j);
            w[j] = o.mul(tau, q);
            j += 1;
        }

        let mut c = zero;
        for (&p, &v) in p[k + 1..].iter().zip(&next[k + 1..]) {
            c = o.fma(p, v, c);
        }
        let c = o.mul(tau, c);
        for ((y, &p), &v) in y.iter_mut().zip(&*p).zip(&*next) {
            *y = o.mul(tau, o.fnma(c, v, p));
        }
        std::mem::swap(&mut v, &mut next);
    }
    for k in n - 2..n {
        finish_column(o, &mut a[layout.at(0, k)..][..n], v, y, w[k], v[k]);
    }
}
