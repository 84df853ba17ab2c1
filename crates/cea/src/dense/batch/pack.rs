//! Scaled state matrices of a batch, written straight into the lanes.
//!
//! The scaling is the scaling of [`StandardForm`]. Systems with a diagonal mass matrix (lumped masses, modal coordinates) are scaled
//! here, in all lanes at once; any other system goes through `StandardForm`.

use certified::lanes::Ops;
use linsys::SecondOrder;
use nalgebra::DMatrix;
use pulp::{Simd, bytemuck};

use super::layout::Layout;
use crate::dense::scaling::{FASTEST_STATE_IN_LANE, STRONGEST_DAMPING, StandardForm};

/// n and s, if all matrices have the shapes that these numbers imply.
pub(super) fn shape(system: &SecondOrder) -> Option<(usize, usize)> {
    let (n, s) = (system.order(), system.states());
    let square = [&system.m, &system.c, &system.k].iter().all(|a| a.shape() == (n, n));
    let internal = system.internal.drive.shape() == (s, n) && system.internal.force.shape() == (n, s);
    (n > 0 && square && internal).then_some((n, s))
}

/// `lambda = gamma sigma`, and the size of the state matrix in the units of lambda.
#[derive(Debug, Clone, Copy)]
pub(super) struct FrequencyScale<V> {
    pub gamma: V,
    /// gamma times the Frobenius norm of the state matrix; not finite where the system is not finite, or where dashpots or
    /// internal states are too fast for a QR iteration.
    pub size: V,
}

/// Fills `a` with the state matrices of `systems`, at most one per lane and all of shape `(n, s)`; spare lanes
/// become zero matrices. A lane that cannot be scaled or is too steep has size NaN.
#[inline(always)]
pub(super) fn pack<S: Simd>(
    o: Ops<S>,
    a: &mut [S::f64s],
    layout: Layout,
    systems: &[SecondOrder],
    (n, s): (usize, usize),
    weights: &mut [S::f64s],
) -> FrequencyScale<S::f64s> {
    let (zero, one) = (o.splat(0.0), o.splat(1.0));
    a.fill(zero);
    let weights = &mut weights[..n];
    weights.fill(one);
    let lanes = S::F64_LANES;
    let (x, masses) = (bytemuck::cast_slice_mut::<_, f64>(a), bytemuck::cast_slice_mut::<_, f64>(weights));
    // Column by column, so that a register stays in the first cache level until all its lanes are written.
    for j in 0..n {
        for (lane, system) in systems.iter().enumerate() {
            scatter(x, lanes, lane, layout.at(n, j), &system.k.as_slice()[j * n..][..n]);
            scatter(x, lanes, lane, layout.at(n, n + j), &system.c.as_slice()[j * n..][..n]);
            scatter(x, lanes, lane, layout.at(2 * n, n + j), &system.internal.drive.as_slice()[j * s..][..s]);
            masses[j * lanes + lane] = system.m[(j, j)];
        }
    }
    for k in 0..s {
        for (lane, system) in systems.iter().enumerate() {
            scatter(x, lanes, lane, layout.at(n, 2 * n + k), &system.internal.force.as_slice()[k * n..][..n]);
            x[layout.at(2 * n + k, 2 * n + k) * lanes + lane] = system.internal.decay[k];
        }
    }
    for weight in &mut *weights {
        *weight = o.div(one, o.sqrt(*weight));
    }
    let mut scale = scale_lanes(o, a, layout, (n, s), weights);
    for (lane, system) in systems.iter().enumerate() {
        if !is_positive_diagonal(&system.m) {
            let form = StandardForm::new(system).ok().filter(|form| !form.is_steep());
            let (gamma, size) = form.as_ref().map_or((1.0, f64::NAN), |f| (f.gamma, f.gamma * f.state.norm()));
            floats(&mut scale.gamma)[lane] = gamma;
            floats(&mut scale.size)[lane] = size;
            let x: &mut [f64] = bytemuck::cast_slice_mut(a);
            for j in 0..2 * n + s {
                match &form {
                    Some(form) => scatter(x, S::F64_LANES, lane, layout.at(0, j), form.state.column(j).as_slice()),
                    None => (0..2 * n + s).for_each(|i| x[layout.at(i, j) * S::F64_LANES + lane] = 0.0),
                }
            }
        }
    }
    scale
}

fn floats<V: bytemuck::Pod>(register: &mut V) -> &mut [f64] {
    bytemuck::cast_slice_mut(std::slice::from_mut(register))
}

/// Writes a column into one lane, from register `at`.
fn scatter(x: &mut [f64], lanes: usize, lane: usize, at: usize, column: &[f64]) {
    for (register, &value) in x[at * lanes..].chunks_exact_mut(lanes).zip(column) {
        register[lane] = value;
    }
}

fn is_positive_diagonal(m: &DMatrix<f64>) -> bool {
    let entries = m.iter().filter(|&&x| x != 0.0).count();
    entries == m.nrows() && (0..m.nrows()).all(|i| m[(i, i)] > 0.0)
}

/// Turns the entries of C, K, E, F and a into the scaled state matrix, in all lanes.
#[inline(always)]
fn scale_lanes<S: Simd>(
    o: Ops<S>,
    a: &mut [S::f64s],
    layout: Layout,
    (n, s): (usize, usize),
    weights: &[S::f64s],
) -> FrequencyScale<S::f64s> {
    let (zero, one) = (o.splat(0.0), o.splat(1.0));
    let (mut stiffness, mut damping) = (zero, zero);
    for j in 0..n {
        for (columns, norm) in [(j, &mut stiffness), (n + j, &mut damping)] {
            for (x, &w) in a[layout.at(n, columns)..][..n].iter_mut().zip(weights) {
                *x = o.mul(*x, o.mul(w, weights[j]));
                *norm = o.fma(*x, *x, *norm);
            }
        }
    }
    let gamma = o.sqrt(o.sqrt(stiffness));
    let gamma = o.select(o.eq(gamma, zero), o.sqrt(damping), gamma);
    let gamma = o.select(o.eq(gamma, zero), one, gamma);
    let rate = o.div(one, gamma);
    let minus_rate = o.neg(rate);
    let minus_square = o.mul(rate, minus_rate);

    let mut is_steep = o.lt(o.splat(STRONGEST_DAMPING * STRONGEST_DAMPING), o.mul(damping, o.mul(rate, rate)));
    // Sum of squares of the state matrix; the unit block first.
    let mut size = o.splat(n as f64);
    for j in 0..n {
        a[layout.at(j, n + j)] = one;
        for (columns, factor) in [(j, minus_square), (n + j, minus_rate)] {
            for x in &mut a[layout.at(n, columns)..][..n] {
                *x = o.mul(*x, factor);
                size = o.fma(*x, *x, size);
            }
        }
    }
    for k in 2 * n..2 * n + s {
        let (mut into, mut out_of) = (zero, zero);
        for (i, &w) in weights.iter().enumerate() {
            let (drive, force) = (layout.at(k, n + i), layout.at(n + i, k));
            a[drive] = o.mul(a[drive], w);
            into = o.fma(a[drive], a[drive], into);
            a[force] = o.mul(a[force], o.mul(w, o.mul(rate, rate)));
            out_of = o.fma(a[force], a[force], out_of);
        }
        let (into, out_of) = (o.sqrt(into), o.sqrt(out_of));
        let driven = o.lt(zero, into);
        let driving = o.lt(zero, out_of);
        let both = o.sqrt(o.div(into, out_of));
        let one_sided = o.select(driven, into, o.select(driving, o.div(one, out_of), one));
        let unit = o.select(o.and(driven, driving), both, one_sided);
        for i in 0..n {
            let (drive, force) = (layout.at(k, n + i), layout.at(n + i, k));
            a[drive] = o.div(a[drive], unit);
            a[force] = o.mul(a[force], unit);
            size = o.fma(a[drive], a[drive], o.fma(a[force], a[force], size));
        }
        let decay = o.mul(minus_rate, a[layout.at(k, k)]);
        a[layout.at(k, k)] = decay;
        is_steep = o.or(is_steep, o.lt(o.splat(FASTEST_STATE_IN_LANE), o.abs(decay)));
        size = o.fma(decay, decay, size);
    }
    let size = o.select(is_steep, o.splat(f64::NAN), o.mul(gamma, o.sqrt(size)));
    FrequencyScale { gamma, size }
}
