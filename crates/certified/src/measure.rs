//! Backward errors and condition numbers of one eigenvalue, of the problem as given and as scaled.

use std::slice::from_ref;

use linsys::{SecondOrder, form_of_sizes};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::expansion::Alone;
use super::planar::{Planar, reveal_rank};
use super::refine::{Refined, newton};
use super::scaled::{FIRST_ORDER_SAFETY, Norms, Scaled, UNIT_ROUNDOFF};
use super::structure::nullity;
use super::vectors::{Factor, by_norms, orthonormalise};
use crate::lu::Vector;
use crate::{CertifiedError, Verdict};

/// Largest backward error that is nothing but rounding, and not worth a Newton step.
pub(super) const ROUNDING_ONLY: f64 = 4.0 * UNIT_ROUNDOFF;
/// Largest error of a refined eigenvalue, as a fraction of what rounded data move it by; chosen: with less, refinement takes more steps; with more, a
/// larger error is left.
const REFINED_PART: f64 = 1e-6;

/// State of one eigenvalue in the course of its certification, in scaled quantities.
#[derive(Debug, Clone)]
pub(super) struct State {
    pub(super) sigma: Complex<f64>,
    pub(super) x: Vector,
    pub(super) y: Vector,
    /// Backward error for the matrices as given.
    pub(super) backward_error: f64,
    pub(super) condition: f64,
    /// Backward error for the scaled matrices.
    pub(super) scaled_error: f64,
    pub(super) scaled_condition: f64,
    /// Distance that sigma may move, to first order, for a rounding of each entry of the matrices: far less than for one of their norms, where rows differ in
    /// size.
    pub(super) data_shift: f64,
    /// |sigma - exact| estimated, in the scaled problem.
    pub(super) bound: f64,
    pub(super) verdict: Verdict,
    /// True if the first-order bound holds: section 3 of docs/error-bounds.md.
    pub(super) is_simple: bool,
    /// Number of directions that rounding hides, if more than its own, where it cannot be enclosed alone.
    pub(super) hidden: usize,
    /// Distance nearer than which no circle of any disc passes, sought where the first-order bound does not hold.
    pub(super) blur: f64,
    /// Outcome of the attempt to hold it alone in a disc, sought where the first-order bound does not hold.
    pub(super) alone: Alone,
}

impl State {
    pub(super) fn conjugate(&self) -> Self {
        Self { sigma: self.sigma.conj(), x: self.x.conjugate(), y: self.y.conjugate(), ..self.clone() }
    }

    /// The larger backward error.
    pub(super) fn error(&self) -> f64 {
        self.backward_error.max(self.scaled_error)
    }

    /// The first-order bound.
    pub(super) fn first_order(&self) -> f64 {
        FIRST_ORDER_SAFETY * self.shift()
    }

    /// Distance that sigma may move, to first order, for its own backward error or for the backward error of data rounded by norms.
    pub(super) fn shift(&self) -> f64 {
        self.scaled_condition * self.scaled_error.max(UNIT_ROUNDOFF) * self.sigma.norm()
    }
}

/// The problem as scaled, with the norms of the one given.
#[derive(Debug)]
pub(super) struct Measure {
    pub(super) scaled: Scaled,
    /// Norms of the matrices as given but for the units of time and of the whole, so that no power of lambda overflows.
    given: Norms,
    /// Weights of left and right vectors, the largest one 1.
    left: Vector,
    right: Vector,
}

impl Measure {
    pub(super) fn new(system: &SecondOrder) -> Self {
        let scaled = Scaled::new(system);
        let weights = |w: &DVector<f64>| w.unscale(w.max()).map(Complex::from);
        let (left, right) = (weights(&scaled.left), weights(&scaled.right));
        let (of_left, of_right) = (scaled.left.max(), scaled.right.max());
        let unit = |a: &DMatrix<f64>, time: f64| a.map(|x| x * of_left * of_right * time);
        let gamma = scaled.gamma;
        let given = Norms::of(&unit(&system.m, gamma * gamma), &unit(&system.c, gamma), &unit(&system.k, 1.0));
        Self { scaled, given, left, right }
    }

    /// Weights by which scaled right and left vectors are multiplied, entry by entry, to be vectors of the problem as given.
    pub(super) fn weights(&self) -> (&Vector, &Vector) {
        (&self.right, &self.left)
    }

    /// Null vectors of K, whose rank is known exactly, for eigenvalues that are exactly zero.
    pub(super) fn zeros(&self, stiffness: &DMatrix<f64>) -> Vec<State> {
        let (n, nullity) = (self.scaled.order(), nullity(stiffness));
        // In the units given, in which the backward error counts.
        let k = DMatrix::from_fn(n, n, |i, j| self.scaled.k[(i, j)] / (self.left[i].re * self.right[j].re));
        let right = null_space(&k, nullity).into_iter().map(|phi| phi.component_div(&self.right));
        let left = null_space(&k.transpose(), nullity).into_iter().map(|psi| psi.component_div(&self.left));
        let pairs = right.zip(left);
        let state = |(x, y)| State {
            backward_error: if self.given.k == 0.0 { 0.0 } else { self.errors(Complex::default(), &x).1 },
            sigma: Complex::default(),
            condition: f64::INFINITY,
            scaled_error: 0.0,
            scaled_condition: 0.0,
            data_shift: 0.0,
            bound: 0.0,
            // Exactly zero for the matrices as given.
            verdict: Verdict::Marginal { tolerance: 0.0 },
            is_simple: true,
            hidden: nullity,
            blur: 0.0,
            alone: Alone::Open,
            x,
            y,
        };
        pairs.map(state).collect()
    }

    /// Vectors by inverse iteration, then the eigenvalue improved if its backward error exceeds `threshold`.
    pub(super) fn first_look(
        &self,
        sigma: Complex<f64>,
        gap: f64,
        threshold: f64,
    ) -> Result<(State, Factor<'_>), CertifiedError> {
        let factor = Factor::new(&self.scaled, sigma);
        let failed = || CertifiedError::NoEigenvector { lambda: sigma * self.scaled.gamma, residual: f64::INFINITY };
        let (x, y) = factor.null_pairs(1).ok_or_else(failed)?;
        let mut state = self.state(sigma, x[0].clone(), y[0].clone());
        if state.error() > threshold {
            let reach = (4.0 * state.first_order()).min(0.45 * gap);
            match self.refine(&state, reach) {
                Some((better, _)) if better.error() <= ROUNDING_ONLY.max(state.error()) => state = better,
                _ => {}
            }
        }
        Ok((state, factor))
    }

    /// True if the first-order bound of an eigenvalue holds; `factor` is Q next to it.
    pub(super) fn is_simple(&self, state: &State, factor: &Factor<'_>, gap: f64) -> bool {
        let solve = |g| factor.deflated_solve(&state.x, &state.y, g);
        let couplings = [
            self.scaled.derivative_times(state.sigma, &state.x).norm(),
            self.scaled.derivative_adjoint_times(state.sigma, &state.y).norm(),
        ];
        // Without a solve where no norm would do.
        self.second_order_is_small(state, gap, couplings, 0.0)
            && by_norms(self.scaled.order(), [&solve], |[inverse]| {
                self.second_order_is_small(state, gap, couplings, inverse).then_some(())
            })
            .is_some()
    }

    /// True if exactly one eigenvalue, of every problem as near as the bound says, is within the first-order bound r.
    ///
    /// With unit null vectors x and y and D for Q between their complements, Q(z) is singular at z = sigma + d only where
    /// `y^H Q x + d y^H Q' x + d^2 y^H M x - b^H D^-1 c = 0`; |b| is at most `r |y^H Q'| + r^2 |M| + eps s`, |c| likewise with
    /// Q' x, D changes by at most `beta = r |Q'| + r^2 |M| + eps s`, and `inverse` is the norm of D^-1 at sigma. On the circle
    /// |d| = r the second term is `eps s = 4 max(eta, u) s` by definition of r. It outweighs the others (Rouché's theorem), since
    /// the first is eta s, its perturbation 1.5 u s and the last two eps s / 4 at most.
    fn second_order_is_small(&self, state: &State, gap: f64, couplings: [f64; 2], inverse: f64) -> bool {
        let (norms, size, radius) = (&self.scaled.norms, state.sigma.norm(), state.first_order());
        let (here, on_circle) = (norms.size(size), norms.size(size + radius));
        let noise = FIRST_ORDER_SAFETY * state.scaled_error.max(UNIT_ROUNDOFF) * here;
        let changed = |slope: f64| radius * slope + radius * radius * norms.m + 1.5 * noise;
        let ([c, b], beta) = (couplings.map(changed), changed(norms.slope(size)));
        let second = radius * radius * norms.m + b * c * inverse / (1.0 - beta * inverse);
        2.0 * radius < gap && on_circle <= 1.5 * here && beta * inverse < 0.5 && second <= 0.25 * noise
    }

    /// The eigenvalue refined within `reach`, and how far it may still be from the exact one of these matrices.
    pub(super) fn refine(&self, state: &State, reach: f64) -> Option<(State, f64)> {
        let enough = REFINED_PART * state.data_shift;
        let Refined { sigma, x, left } = newton(&self.scaled, state.sigma, &state.x, enough, reach)?;
        Some((self.state(sigma, x, state.y.clone()), left))
    }

    pub(super) fn state(&self, sigma: Complex<f64>, x: Vector, y: Vector) -> State {
        let (scaled_condition, condition) = self.conditions(sigma, from_ref(&x), from_ref(&y));
        let (scaled_error, backward_error) = self.errors(sigma, &x);
        let data_shift = self.data_shift(sigma, &x, &y);
        let verdict = Verdict::Undecided { bound: f64::INFINITY };
        let bound = f64::INFINITY;
        let (is_simple, hidden, blur, alone) = (false, 0, 0.0, Alone::Open);
        State {
            sigma,
            x,
            y,
            backward_error,
            condition,
            scaled_error,
            scaled_condition,
            data_shift,
            bound,
            verdict,
            is_simple,
            hidden,
            blur,
            alone,
        }
    }

    /// Distance that sigma may move, to first order, for a rounding of each entry, `u |y|^T (|sigma|^2 |M| + |sigma| |C| + |K|) |x| / |y^H Q' x|`, which no
    /// scaling of rows and columns changes.
    fn data_shift(&self, sigma: Complex<f64>, x: &Vector, y: &Vector) -> f64 {
        let (s, size) = (&self.scaled, sigma.norm());
        let slope = y.dotc(&s.derivative_times(sigma, x)).norm();
        let of = |matrix| form_of_sizes(matrix, y, x);
        UNIT_ROUNDOFF * ((of(&s.m) * size + of(&s.c)) * size + of(&s.k)) / slope
    }

    /// Backward errors of the scaled and of the given problem.
    fn errors(&self, sigma: Complex<f64>, x: &Vector) -> (f64, f64) {
        let (s, size) = (&self.scaled, sigma.norm());
        let image = s.times(sigma, x);
        let given = image.component_div(&self.left).norm() / x.component_mul(&self.right).norm();
        (image.norm() / (s.norms.size(size) * x.norm()), given / self.given.size(size))
    }

    /// Condition numbers of the scaled and of the given problem for bases of the null spaces.
    pub(super) fn conditions(&self, sigma: Complex<f64>, right: &[Vector], left: &[Vector]) -> (f64, f64) {
        let s = &self.scaled;
        let inverse_slope = |right: &[Vector], left: &[Vector]| {
            let slopes: Vec<_> = right.iter().map(|x| s.derivative_times(sigma, x)).collect();
            let projected = DMatrix::from_fn(left.len(), right.len(), |i, j| left[i].dotc(&slopes[j]));
            projected.try_inverse().map_or(f64::INFINITY, |inverse| inverse.norm())
        };
        let scaled = s.norms.size(sigma.norm()) * inverse_slope(right, left) / sigma.norm();
        // The same vectors in the coordinates given: orthonormal there, then expressed in the scaled ones.
        let moved = |vectors: &[Vector], weights: &Vector| {
            let mut block: Vec<_> = vectors.iter().map(|v| v.component_mul(weights)).collect();
            orthonormalise(&mut block)?;
            Some(block.iter().map(|v| v.component_div(weights)).collect::<Vec<_>>())
        };
        let given = match (moved(right, &self.right), moved(left, &self.left)) {
            (Some(right), Some(left)) => self.given.size(sigma.norm()) * inverse_slope(&right, &left) / sigma.norm(),
            _ => f64::INFINITY,
        };
        (scaled, given)
    }
}

/// Orthonormal vectors that `a` annihilates, as many as its known nullity.
fn null_space(a: &DMatrix<f64>, nullity: usize) -> Vec<Vector> {
    let n = a.nrows();
    let mut turned = Planar::<f64>::from(&DMatrix::identity(n, n));
    reveal_rank(&mut Planar::from(&a.transpose()), &mut turned, n - nullity);
    (n - nullity..n).map(|row| DVector::from_fn(n, |j, _| Complex::from(turned.get(row, j)))).collect()
}
