//! Reach of a spectrum: how far from zero an eigenvalue can be, so that a rectangle need not be searched beyond.

use nalgebra_sparse::CscMatrix;

use super::types::{Reach, Rectangle};
use crate::symmetric::{Factor, largest_entry, nearest_to_zero, norm, scaled_part, scales, shifted};
use crate::{SparseError, SparseSecondOrder};

/// Fractions of the smallest eigenvalue of the scaled mass, as inverse iteration estimates it, that are tried as its lower bound tau, the
/// largest first; chosen: a smaller one makes the reach larger.
const PARTS: [f64; 4] = [0.9, 0.5, 0.1, 0.01];
/// Fractions of |K|, the norm of the scaled symmetric part of K, that are tried as a shift, the least first. The first with which `K + shift I`
/// has no negative eigenvalue bounds how far the eigenvalues of K are below zero: 1e-13 is rounding, 1e-4 a small fault of a model; chosen. If no shift
/// does, |K| itself is the bound.
const SHIFTS: [f64; 4] = [1e-13, 1e-10, 1e-7, 1e-4];
/// Factor on a bound for the rounding of the norms in it; chosen.
const MARGIN: f64 = 1.0 + 1e-9;

/// The largest `sqrt(|K_ii| / |M_ii|)`, rad/s: a lower bound of [`Reach::modulus`], which is at least `sqrt(k / tau)` in [`reach`], with
/// `k >= |K_ii| / D_ii` and `tau <= M_ii / D_ii` for every i. A rectangle in the circle about zero of this radius cannot be cut in Im lambda,
/// so that the factorisations of [`reach`] are saved; that it could be cut in Re lambda is forgone.
pub(super) fn least_reach(system: &SparseSecondOrder) -> f64 {
    let diagonal = |a: &CscMatrix<f64>| {
        let mut values = vec![0.0; a.nrows()];
        a.triplet_iter().filter(|(row, column, _)| row == column).for_each(|(row, _, value)| values[row] += value);
        values
    };
    let ratios = diagonal(&system.k).into_iter().zip(diagonal(&system.m)).map(|(k, m)| k.abs() / m.abs());
    ratios.filter(|ratio| ratio.is_finite()).fold(0.0, f64::max).sqrt()
}

/// Reach of the eigenvalues from zero and from the imaginary axis; `None` where the symmetric part of M is not positive definite.
///
/// With the diagonal D of |M| ([`scales`] holds its roots `D_ii^(1/2)`, raised where they are small) an eigenvector x of `x^H D x = 1` has
/// `lambda^2 x^H M x + lambda x^H C x + x^H K x = 0`, and `Re x^H M x >= tau` where the symmetric part of `M - tau D` has no negative
/// eigenvalue, by its factorisation. So `|lambda|^2 tau <= |lambda| c + k` with c and k the bounds ([`form_bound`]) of `|x^H C x|` and
/// `|x^H K x|` for all such x; the larger root of the quadratic equation bounds |lambda|.
///
/// An internal state adds `- lambda / (lambda + a) x^H f e^T x`. Where `|lambda| >= 2 |a|` the factor is at most 2, so that it adds `2 |e| |f|`
/// to k, with the norms of `D^(-1/2) e` and `D^(-1/2) f`. Eigenvalues below that are within the modulus too, as it is never taken below
/// `2 max |a|`.
///
/// # Errors
/// A factorisation that does not fit into memory.
pub(super) fn reach(system: &SparseSecondOrder) -> Result<Option<Reach>, SparseError> {
    let scale = scales(&system.m);
    let (rows, mass) = scaled_part(&system.m);
    if rows.len() < system.order() {
        return Ok(None);
    }
    let Ok((nearest, _)) = nearest_to_zero(&Factor::new(&mass)?, 0.0, 1.min(rows.len())) else { return Ok(None) };
    let Some(least) = nearest.first().copied().filter(|least| *least > 0.0) else { return Ok(None) };
    let mut tau = None;
    for part in PARTS {
        if Factor::new(&shifted(&mass, -part * least))?.negative() == Some(0) {
            tau = Some(part * least);
            break;
        }
    }
    let Some(tau) = tau else { return Ok(None) };
    let side =
        |side: &[(usize, f64)]| side.iter().map(|&(dof, value)| (value / scale[dof]).powi(2)).sum::<f64>().sqrt();
    let states: f64 = system.states.iter().map(|state| 2.0 * side(&state.drive) * side(&state.force)).sum();
    let twice_decay = system.states.iter().map(|state| 2.0 * state.decay.abs()).fold(0.0, f64::max);
    let (c, k) = (form_bound(&system.c, &scale), form_bound(&system.k, &scale) + states);
    let modulus = ((c + (c * c + 4.0 * tau * k).sqrt()) / (2.0 * tau) * MARGIN).max(twice_decay);
    if !modulus.is_finite() {
        return Ok(None);
    }
    let real = real_reach(system, &scale, tau)?.filter(|real| *real < modulus).unwrap_or(modulus);
    Ok(Some(Reach { modulus, real }))
}

/// The largest |Re lambda|; `None` where M is not symmetric, or there are internal states.
///
/// With the exact quotients `c + i c' = x^H C x / x^H M x` and `k + i k' = x^H K x / x^H M x` of an eigenvector x,
/// `lambda = -(c + i c') / 2 +- sqrt(w)`, `w = (c + i c')^2 / 4 - k - i k'`, and
/// `(Re sqrt(w))^2 = (|w| + Re w) / 2 <= max(Re w, 0) + |Im w| / 2 <= c^2 / 4 + max(-k, 0) + |c c'| / 4 + |k'| / 2`.
///
/// The symmetric parts of C and K make c and k, the antisymmetric ones (gyroscopic, circulatory) c' and k'. In the code `c`, `gyroscopic` and
/// `circulatory` are bounds of |c|, |c'| and |k'|, each [`form_bound`] over tau, and `negative / tau` is one of -k, by [`SHIFTS`]. Without damping
/// and circulatory part all eigenvalues of a sound K are on the axis, and what is left of the bound is rounding, `sqrt(1e-13 |K| / tau)`.
fn real_reach(system: &SparseSecondOrder, scale: &[f64], tau: f64) -> Result<Option<f64>, SparseError> {
    let parts = |a: &CscMatrix<f64>| {
        let transposed = a.transpose();
        [(a + &transposed) * 0.5, (a - &transposed) * 0.5]
    };
    if !system.states.is_empty() || largest_entry(&(&system.m - system.m.transpose())) > 0.0 {
        return Ok(None);
    }
    let ([c, gyroscopic], [k, circulatory]) = (parts(&system.c), parts(&system.k));
    let [c, gyroscopic, circulatory] = [c, gyroscopic, circulatory].map(|part| form_bound(&part, scale) / tau);
    let inverse: Vec<f64> = scale.iter().map(|scale| 1.0 / scale).collect();
    let mut scaled = k;
    scaled.triplet_iter_mut().for_each(|(row, column, value)| *value *= inverse[row] * inverse[column]);
    let size = norm(&scaled);
    let mut negative = size;
    for part in SHIFTS {
        if Factor::new(&shifted(&scaled, part * size))?.negative() == Some(0) {
            negative = part * size;
            break;
        }
    }
    let square = 0.25 * c * c + negative / tau + 0.25 * c * gyroscopic + 0.5 * circulatory;
    Ok(Some((0.5 * c + square.sqrt()) * MARGIN))
}

impl Reach {
    /// The part of a rectangle in which eigenvalues can be; `None` where it is empty. The bounds are widened by `blur`, rad/s: how far rounding
    /// of the matrices moves an eigenvalue.
    pub(super) fn within(&self, rectangle: &Rectangle, blur: f64) -> Option<Rectangle> {
        let side = |[from, to]: [f64; 2], most: f64| [from.max(-most - blur), to.min(most + blur)];
        let part = Rectangle { re: side(rectangle.re, self.real), im: side(rectangle.im, self.modulus) };
        part.check().is_ok().then_some(part)
    }

    /// True if all eigenvalues with Im lambda >= 0 are in a rectangle.
    pub(super) fn is_within(&self, rectangle: &Rectangle) -> bool {
        let [low, high] = rectangle.re;
        low <= -self.real && high >= self.real && rectangle.im[0] <= 0.0 && rectangle.im[1] >= self.modulus
    }
}

/// A bound of `|x^H A x|` for all x with `sum_i |s_i x_i|^2 = 1`, s the `scale`: the geometric mean of the largest sums of rows and of columns of
/// `|A_ij| / (s_i s_j)`, which bounds the 2-norm.
fn form_bound(a: &CscMatrix<f64>, scale: &[f64]) -> f64 {
    let (mut rows, mut columns) = (vec![0.0; a.nrows()], vec![0.0; a.nrows()]);
    for (row, column, value) in a.triplet_iter() {
        let size = value.abs() / scale[row] / scale[column];
        rows[row] += size;
        columns[column] += size;
    }
    let largest = |sums: Vec<f64>| sums.into_iter().fold(0.0, f64::max);
    (largest(rows) * largest(columns)).sqrt()
}
