//! The wanted modes of a reduced system at an operating point, from an anchor.
//!
//! First the near modes of the anchor alone make a small eigenvalue problem (rank p), which tells modes of almost one frequency
//! apart and is exact where the other modes of the anchor take no part. Then each pair (lambda, y) is corrected by
//! `dy = -Q^-1 Q(lambda) y` with an inverse made of the near modes here and the other modes of the anchor (Newton's method
//! with an approximate derivative). What converges is a mode of the system at this point, whatever the anchor was like, because
//! the residual is that of the system.
//!
//! None is missing: where the other modes do not resonate in the rectangle, the eigenvalues near it are continuous functions
//! of the strength of the coupling between near and other modes, one starts from each of the small problem, and those
//! within the margin around the rectangle are followed too. Two that end at one mode are a doubt, and so is one in the rectangle that
//! ends farther from its start than half of the margin: another one may have come in from beyond it.

use linsys::{OperatingPoint, SecondOrder};
use nalgebra::DMatrix;
use num_complex::Complex;

use super::anchor::{Anchor, NearModes};
use super::full::outside;
use super::mixing::Mixing;
use super::residual::reduced_residual;
use super::split;
use crate::{Rectangle, SparseError};

/// Corrections after which a mode that has not converged is a doubt; the disc brake of docs/large-problems.md
/// takes four or five.
const MOST_CORRECTIONS: usize = 24;
/// Last change of an eigenvalue, relative to its size, at which it has converged: the next would be smaller.
const CONVERGED_STEP: f64 = 1e-9;
/// How many times its last two changes an eigenvalue must be away from the rectangle to be left there. Chosen; with 10 one of
/// 374 modes of the brake of 4,669 degrees of freedom was left that still came in.
const OUTSIDE: f64 = 30.0;
/// Largest distance of a mode from its start, as a part of the margin. Chosen; of 6,000 analyses of cases/disc-pad and of one with a
/// narrow band the modes that this leaves are those of whole spectra.
const LARGEST_MOVE: f64 = 0.5;
/// Distance of two eigenvalues, relative to their size, up to which they may be one.
const ONE_EIGENVALUE: f64 = 1e-7;
/// Cosine of two shapes above which they are one.
const ONE_SHAPE: f64 = 1.0 - 1e-6;

/// Why the modes at a point were not followed from an anchor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Doubt {
    /// There is no anchor, or its small problem could not be solved.
    NoStart,
    /// A mode in or next to the rectangle did not converge.
    NotConverged,
    /// Two followed modes ended as one.
    Merged,
    /// A mode in the rectangle ended so far from its start that one from outside may be in it too.
    Moved,
}

/// What is wanted of a followed mode.
pub(super) struct Goal<'a> {
    pub rectangle: &'a Rectangle,
    /// Modes that start within this of the rectangle are followed.
    pub margin: f64,
    /// The reduced system's backward error to stop at.
    pub backward_error: f64,
}

/// Modes in the rectangle: eigenvalues with shapes as split columns, and what finding them took.
pub(super) struct Followed {
    pub lambdas: Vec<Complex<f64>>,
    pub shapes: DMatrix<f64>,
    pub corrections: u64,
    pub multiply_adds: u64,
}

/// Follows the modes of an anchor to `point`, where the reduced system is `system` and `size` the scale of its residuals.
pub(super) fn follow(
    anchor: &Anchor,
    point: &OperatingPoint,
    system: &SecondOrder,
    size: impl Fn(Complex<f64>) -> f64,
    goal: &Goal<'_>,
) -> Result<Result<Followed, Doubt>, SparseError> {
    let Ok(near) = anchor.near.modes(point) else { return Ok(Err(Doubt::NoStart)) };
    let (k, p, q) = (system.order() as u64, near.lambdas.len() as u64, anchor.lambdas.len() as u64);
    let own: Vec<usize> =
        (0..near.lambdas.len()).filter(|&j| outside(goal.rectangle, near.lambdas[j]) <= goal.margin).collect();
    let mut lambdas: Vec<_> = own.iter().map(|&j| near.lambdas[j]).collect();
    let mut shapes = split::selected(&near.right, &own);
    let mut active: Vec<usize> = (0..own.len()).collect();
    // Internal states move modes by small steps and far: of these all must converge.
    let has_states = system.states() > 0;
    let mut last_steps = vec![[f64::INFINITY; 2]; own.len()];
    let mut mixings: Vec<Mixing> = own.iter().map(|_| Mixing::default()).collect();
    let (mut corrections, mut multiply_adds) = (0, 8 * k * p * p + 40 * p * p * p);
    for _ in 0..=MOST_CORRECTIONS {
        let (at, y): (Vec<_>, _) = (active.iter().map(|&j| lambdas[j]).collect(), split::selected(&shapes, &active));
        let residual = reduced_residual(system, &at, &y);
        multiply_adds += 6 * k * k * active.len() as u64;
        let is_open = |place: usize| {
            let allowed = goal.backward_error * size(at[place]) * split::norm_squared(&y, place).sqrt();
            let [before, step] = last_steps[active[place]];
            let has_converged =
                split::norm_squared(&residual, place).sqrt() <= allowed && step <= CONVERGED_STEP * at[place].norm();
            let stays_outside = !has_states && outside(goal.rectangle, at[place]) > OUTSIDE * step.max(before);
            !(has_converged || stays_outside)
        };
        let open: Vec<usize> = (0..active.len()).filter(|&place| is_open(place)).collect();
        if open.is_empty() {
            active.clear();
            break;
        }
        let owners: Vec<usize> = open.iter().map(|&place| own[active[place]]).collect();
        let at: Vec<_> = open.iter().map(|&place| at[place]).collect();
        let (change, steps) = correction(anchor, &near, &owners, &at, &split::selected(&residual, &open));
        active = open.iter().map(|&place| active[place]).collect();
        multiply_adds += 8 * k * (p + q) * active.len() as u64;
        corrections += active.len() as u64;
        for (place, &j) in active.iter().enumerate() {
            // Both unknowns in one vector.
            let mixed = mixings[j].next(
                &split::vector(&shapes, j).push(lambdas[j] / anchor.gamma),
                &split::vector(&change, place).push(steps[place] / anchor.gamma),
            );
            let lambda = mixed[mixed.len() - 1] * anchor.gamma;
            let step = (lambda - lambdas[j]).norm().max(steps[place].norm());
            last_steps[j] = [last_steps[j][1], step];
            lambdas[j] = lambda;
            split::set(&mut shapes, j, mixed.iter().copied());
        }
    }
    if !active.is_empty() {
        return Ok(Err(Doubt::NotConverged));
    }
    let inside: Vec<usize> = (0..own.len()).filter(|&j| goal.rectangle.contains(lambdas[j], 0.0)).collect();
    if inside.iter().any(|&j| (lambdas[j] - near.lambdas[own[j]]).norm() > LARGEST_MOVE * goal.margin) {
        return Ok(Err(Doubt::Moved));
    }
    let (lambdas, shapes): (Vec<_>, _) =
        (inside.iter().map(|&j| lambdas[j]).collect(), split::selected(&shapes, &inside));
    if have_merged(&lambdas, &shapes) {
        return Ok(Err(Doubt::Merged));
    }
    Ok(Ok(Followed { lambdas, shapes, corrections, multiply_adds }))
}

/// The corrections of shapes and eigenvalues for these residuals; `owners` are the near modes that they started from.
fn correction(
    anchor: &Anchor,
    near: &NearModes,
    owners: &[usize],
    at: &[Complex<f64>],
    residual: &DMatrix<f64>,
) -> (DMatrix<f64>, Vec<Complex<f64>>) {
    let (gamma, q, p, vectors) = (anchor.gamma, anchor.lambdas.len(), near.lambdas.len(), at.len());
    let (others, own_part) = (&anchor.left * residual, &near.left * residual);
    let mut other_weights = split::zeros(2 * q, vectors);
    let mut near_weights = split::zeros(2 * p, vectors);
    let mut steps = Vec::with_capacity(vectors);
    let (turn, zero) = (Complex::new(0.0, 1.0), Complex::new(0.0, 0.0));
    for (place, &lambda) in at.iter().enumerate() {
        let part = |products: &DMatrix<f64>, row: usize| {
            Complex::new(products[(row, place)], products[(row, vectors + place)])
        };
        for (i, (&other, is_near)) in anchor.lambdas.iter().zip(&anchor.is_near).enumerate() {
            let (a, b) = (part(&others, i), turn * part(&others, q + i));
            let upper = if is_near[0] { zero } else { (a + b) / ((other - lambda) * gamma) };
            let is_left_out = is_near[1] || other.im == 0.0;
            let lower = if is_left_out { zero } else { (a - b) / ((other.conj() - lambda) * gamma) };
            put(&mut other_weights, (i, q + i), place, [upper + lower, turn * (upper - lower)]);
        }
        let mut step = zero;
        for (i, &other) in near.lambdas.iter().enumerate() {
            let product = (part(&own_part, i) + turn * part(&own_part, p + i)) / gamma;
            if i == owners[place] {
                step = -product;
            } else {
                let weight = product / (other - lambda);
                put(&mut near_weights, (i, p + i), place, [weight, turn * weight]);
            }
        }
        steps.push(step);
    }
    (&anchor.right * other_weights + &near.right * near_weights, steps)
}

fn put(weights: &mut DMatrix<f64>, rows: (usize, usize), vector: usize, values: [Complex<f64>; 2]) {
    let half = split::count(weights);
    for (row, value) in [rows.0, rows.1].into_iter().zip(values) {
        weights[(row, vector)] = value.re;
        weights[(row, half + vector)] = value.im;
    }
}

fn have_merged(lambdas: &[Complex<f64>], shapes: &DMatrix<f64>) -> bool {
    let is_one = |i: usize, j: usize| {
        (lambdas[i] - lambdas[j]).norm() <= ONE_EIGENVALUE * lambdas[i].norm() && {
            let (a, b) = (split::vector(shapes, i), split::vector(shapes, j));
            a.dotc(&b).norm() > ONE_SHAPE * a.norm() * b.norm()
        }
    };
    (0..lambdas.len()).any(|i| (0..i).any(|j| is_one(i, j)))
}
