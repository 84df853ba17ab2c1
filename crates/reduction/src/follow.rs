//! The wanted modes of a reduced system at an operating point, from an anchor.
//!
//! First the near modes of the anchor alone make a small eigenvalue problem (rank p), which tells modes of almost one frequency
//! apart and is exact where the other modes of the anchor take no part; what those do it holds to second order (`response.rs`), where that
//! is small and there are no internal states. Then each pair (lambda, y) is corrected by
//! `dy = -Q^-1 Q(lambda) y` with an inverse made of the near modes here and the other modes of the anchor (Newton's method
//! with an approximate derivative). What converges is a mode of the system at this point, whatever the anchor was like, because
//! the residual is that of the system.
//!
//! None is missing: where the other modes do not resonate in the rectangle, the eigenvalues near it are continuous functions
//! of the strength of the coupling between near and other modes, one starts from each of the small problem, and those
//! within the margin around the rectangle are followed too. Two that end at one mode are a doubt, and so is one in the rectangle that
//! ends farther from its start than half of the margin: another one may have come in from beyond it. `watch.rs` predicts whether one does.

use linsys::{OperatingPoint, SecondOrder};
use nalgebra::DMatrix;
use num_complex::Complex;
use sparse::Rectangle;

use super::anchor::{Anchor, NearModes};
use super::far::Weights;
use super::full::outside;
use super::mixing::{Mixing, Parts};
use super::residual::reduced_residual;
use super::{dense, split};
use crate::ReductionError;

/// Corrections after which a mode that has not converged is a doubt, as where one that is not followed is near it; the disc brake of
/// docs/large-problems.md takes four on average.
const MOST_CORRECTIONS: usize = 12;
/// What the next correction would change an eigenvalue by, relative to its size, at which it has converged.
const CONVERGED_STEP: f64 = 1e-9;
/// Change of an eigenvalue, as a part of the margin, up to which the weights of the other modes are kept: none of them is nearer than about
/// the margin.
const WEIGHTS_KEPT: f64 = 0.1;
/// How many times its last change and the one that would be next an eigenvalue must be away from the rectangle to be left there. Chosen; with 10 one of
/// 374 modes of the brake of 4,669 degrees of freedom was left that still came in.
const OUTSIDE: f64 = 30.0;
/// Largest distance of a mode from its start, as a part of the margin. Chosen; of 6,000 analyses of cases/disc-pad and of one with a
/// narrow band the modes that this leaves are those of whole spectra.
const LARGEST_MOVE: f64 = 0.5;
/// What of an eigenvalue may be of second order at its start, as a part of the margin; chosen.
const SECOND_ORDER: f64 = 0.1;
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
    /// Norms of the residuals of the reduced system.
    pub residuals: Vec<f64>,
    pub corrections: u64,
    pub multiply_adds: u64,
}

/// Whether a mode that is not near at an anchor may come into the rectangle at `point`, where it would be lost.
pub(super) fn comes_near(anchor: &Anchor, point: &OperatingPoint, goal: &Goal<'_>) -> bool {
    anchor.watch.comes_near([&anchor.point, point], goal.rectangle, LARGEST_MOVE * goal.margin)
}

/// Follows the modes of an anchor to `point`, where the reduced system is `system` and `size` the scale of its residuals.
pub(super) fn follow(
    anchor: &Anchor,
    point: &OperatingPoint,
    system: &SecondOrder,
    size: impl Fn(Complex<f64>) -> f64,
    goal: &Goal<'_>,
) -> Result<Result<Followed, Doubt>, ReductionError> {
    // Internal states move modes by small steps and far: of these all must converge.
    let has_states = system.states() > 0;
    let Some((near, own)) = start(anchor, point, goal, has_states) else { return Ok(Err(Doubt::NoStart)) };
    let (k, p, q) = (system.order() as u64, near.lambdas.len() as u64, anchor.far.count() as u64);
    let mut lambdas: Vec<_> = own.iter().map(|&j| near.lambdas[j]).collect();
    let mut shapes = split::selected(&near.right, &own);
    let (order, lengths) = (system.order(), split::norms(&shapes));
    let mut weights: Vec<Option<Weights>> = own.iter().map(|_| None).collect();
    let mut active: Vec<usize> = (0..own.len()).collect();
    // At the start the last change is what is of second order.
    let mut last_steps: Vec<f64> = own.iter().map(|&j| near.moved[j]).collect();
    let mut residuals = vec![f64::INFINITY; own.len()];
    let mut mixings: Vec<Mixing> = own.iter().map(|_| Mixing::default()).collect();
    let (mut corrections, mut multiply_adds) = (0, 8 * k * p * p + 40 * p * p * p);
    for _ in 0..=MOST_CORRECTIONS {
        let (at, y): (Vec<_>, _) = (active.iter().map(|&j| lambdas[j]).collect(), split::selected(&shapes, &active));
        let residual = reduced_residual(system, &at, &y);
        active.iter().enumerate().for_each(|(place, &j)| residuals[j] = split::norm_squared(&residual, place).sqrt());
        let near_products = dense::product(&near.left, &residual);
        multiply_adds += (6 * k * k + 4 * k * p) * active.len() as u64;
        let along = |i: usize, place: usize| {
            let [re, im] = [place, active.len() + place].map(|column| near_products.column(column));
            let i_im = near.lambdas.len() + i;
            Complex::new(re[i] - im[i_im], im[i] + re[i_im]) / anchor.gamma
        };
        // What the next correction would change each eigenvalue by.
        let steps: Vec<_> = active.iter().enumerate().map(|(place, &j)| -along(own[j], place)).collect();
        let is_open = |place: usize| {
            let allowed = goal.backward_error * size(at[place]) * split::norm_squared(&y, place).sqrt();
            let (step, last) = (steps[place].norm(), last_steps[active[place]]);
            let has_converged = residuals[active[place]] <= allowed && step <= CONVERGED_STEP * at[place].norm();
            let stays_outside = !has_states && outside(goal.rectangle, at[place]) > OUTSIDE * step.max(last);
            !(has_converged || stays_outside)
        };
        let open: Vec<usize> = (0..active.len()).filter(|&place| is_open(place)).collect();
        if open.is_empty() {
            active.clear();
            break;
        }
        let mut near_weights = split::zeros(2 * near.lambdas.len(), open.len());
        for (to, &place) in open.iter().enumerate() {
            for (i, &other) in near.lambdas.iter().enumerate().filter(|&(i, _)| i != own[active[place]]) {
                let weight = along(i, place) / (other - at[place]);
                put(&mut near_weights, (i, near.lambdas.len() + i), to, [weight, Complex::new(-weight.im, weight.re)]);
            }
        }
        for &place in &open {
            let weights = &mut weights[active[place]];
            weights.take_if(|known| (known.lambda - at[place]).norm() > WEIGHTS_KEPT * goal.margin);
            weights.get_or_insert_with(|| anchor.far.weights(at[place]));
        }
        let of_open: Vec<&Weights> = open.iter().filter_map(|&place| weights[active[place]].as_ref()).collect();
        let change =
            anchor.far.apply(&split::selected(&residual, &open), &of_open) + dense::product(&near.right, &near_weights);
        multiply_adds += (8 * k * q + 4 * k * p) * open.len() as u64;
        corrections += open.len() as u64;
        for (column, &place) in open.iter().enumerate() {
            let j = active[place];
            // Both unknowns in one vector, in parts of the shape's length.
            let (re, im) = split::parts(&change, column);
            let of = |part: &[f64], step: f64| {
                part.iter().map(|value| (value / lengths[j]) as f32).chain([(step / anchor.gamma) as f32]).collect()
            };
            let f = Parts { re: of(re.as_slice(), steps[place].re), im: of(im.as_slice(), steps[place].im) };
            let mixed = mixings[j].next(f);
            let step = Complex::new(f64::from(mixed.re[order]), f64::from(mixed.im[order])) * anchor.gamma;
            last_steps[j] = step.norm().max(steps[place].norm());
            lambdas[j] += step;
            split::add(&mut shapes, j, [&mixed.re[..order], &mixed.im[..order]], lengths[j]);
        }
        active = open.iter().map(|&place| active[place]).collect();
    }
    if !active.is_empty() {
        return Ok(Err(Doubt::NotConverged));
    }
    let inside: Vec<usize> =
        (0..own.len()).filter(|&j| goal.rectangle.contains_to_the_right(lambdas[j], 0.0)).collect();
    let of_second_order = |j: usize| if near.moved[own[j]].is_finite() { near.moved[own[j]] } else { 0.0 };
    let move_of = |j: usize| (lambdas[j] - near.lambdas[own[j]]).norm() + of_second_order(j);
    if inside.iter().any(|&j| move_of(j) > LARGEST_MOVE * goal.margin) {
        return Ok(Err(Doubt::Moved));
    }
    let (lambdas, shapes): (Vec<_>, _) =
        (inside.iter().map(|&j| lambdas[j]).collect(), split::selected(&shapes, &inside));
    let residuals = inside.iter().map(|&j| residuals[j]).collect();
    if have_merged(&lambdas, &shapes) {
        return Ok(Err(Doubt::Merged));
    }
    Ok(Ok(Followed { lambdas, shapes, residuals, corrections, multiply_adds }))
}

/// The near modes at a point, and which of them are followed: to second order, where that is small, and else to first order.
fn start(
    anchor: &Anchor,
    point: &OperatingPoint,
    goal: &Goal<'_>,
    has_states: bool,
) -> Option<(NearModes, Vec<usize>)> {
    let with = |is_second: bool| {
        let near = anchor.modes(point, is_second).ok()?;
        let is_own = |&j: &usize| outside(goal.rectangle, near.lambdas[j]) <= goal.margin;
        let own: Vec<usize> = (0..near.lambdas.len()).filter(is_own).collect();
        Some((near, own))
    };
    let is_large = |near: &NearModes, j: usize| near.moved[j].is_finite() && near.moved[j] > SECOND_ORDER * goal.margin;
    let is_small = |(near, own): &(NearModes, Vec<usize>)| !own.iter().any(|&j| is_large(near, j));
    // What internal states do away from the middle of the band is no smaller than what is of second order.
    if has_states { with(false) } else { with(true).filter(is_small).or_else(|| with(false)) }
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
