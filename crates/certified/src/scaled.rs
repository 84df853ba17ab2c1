//! The problem in units of its own: equilibrated rows and columns, time in units of 1 / gamma.
//!
//! `Q~(sigma) = w L (lambda^2 M + lambda C + K) R` with `lambda = gamma sigma`, L and R diagonal. gamma makes the
//! norms of the scaled mass and stiffness equal (Fan, Lin, Van Dooren, SIAM J. Matrix Anal. Appl. 26, 2004); L and R
//! bring the largest entry of each row and column of `gamma^2 |M| + gamma |C| + |K|` near one (Ruiz's iteration, RAL
//! report 2001-034), equally on both sides where the matrices are symmetric. Every factor is a power of two, so the
//! scaled problem is the given one to the last bit, barring underflow.

use linsys::{SecondOrder, real_times_complex};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use pulp::Arch;

use crate::CertifiedError;
use crate::lu::real_product;

/// Number of rounds of choosing gamma and equilibrating in turn; chosen: several, as each changes what the other saw.
const SCALING_ROUNDS: usize = 5;
/// Number of sweeps of Ruiz's iteration: in the limit each halves the distance of the logarithms from zero. Eight leave 1/256 of it, less than
/// rounding to powers of two.
const EQUILIBRATION_SWEEPS: usize = 8;

/// Half the distance from 1 to the next double: the relative size of a rounding error.
pub(super) const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;
/// Factor on `condition x backward error` in every bound: it is a first-order estimate with estimated factors.
/// Chosen; docs/error-bounds.md has the largest ratio of error to bound that was measured.
pub(super) const FIRST_ORDER_SAFETY: f64 = 4.0;

/// The scaled problem, and the scaling that takes its solutions back.
#[derive(Debug, Clone)]
pub(crate) struct Scaled {
    pub(crate) m: DMatrix<f64>,
    pub(crate) c: DMatrix<f64>,
    pub(crate) k: DMatrix<f64>,
    /// lambda = gamma sigma.
    pub(crate) gamma: f64,
    /// psi = left * (scaled left vector), entry by entry.
    pub(crate) left: DVector<f64>,
    /// phi = right * (scaled right vector), entry by entry.
    pub(crate) right: DVector<f64>,
    /// Frobenius norms of the scaled matrices.
    pub(crate) norms: Norms,
}

/// Noise of Q(sigma), |sigma| = `size`: what rounding the data changes it by, and what is allowed for computing it.
pub(super) fn data_noise(problem: &Scaled, size: f64) -> f64 {
    FIRST_ORDER_SAFETY * UNIT_ROUNDOFF * problem.norms.size(size)
}

/// Frobenius norms of M, C and K.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Norms {
    pub(crate) m: f64,
    pub(crate) c: f64,
    pub(crate) k: f64,
}

impl Norms {
    pub(crate) fn of(m: &DMatrix<f64>, c: &DMatrix<f64>, k: &DMatrix<f64>) -> Self {
        Self { m: norm(m), c: norm(c), k: norm(k) }
    }

    /// `|lambda|^2 |M| + |lambda| |C| + |K|`.
    pub(crate) fn size(&self, lambda: f64) -> f64 {
        (lambda * self.m + self.c) * lambda + self.k
    }

    /// `2 |lambda| |M| + |C|`.
    pub(crate) fn slope(&self, lambda: f64) -> f64 {
        2.0 * lambda * self.m + self.c
    }
}

/// The Frobenius norm without overflow of the squares.
fn norm(a: &DMatrix<f64>) -> f64 {
    let largest = a.amax();
    if largest == 0.0 { 0.0 } else { largest * (a / largest).norm() }
}

/// The power of two next to x, within the range that keeps products finite.
pub(super) fn power_of_two(x: f64) -> f64 {
    if x > 0.0 && x.is_finite() { x.log2().round().clamp(-500.0, 500.0).exp2() } else { 1.0 }
}

impl Scaled {
    pub(crate) fn new(system: &SecondOrder) -> Self {
        let n = system.order();
        let (m, c, k) = (&system.m, &system.c, &system.k);
        let (mut left, mut right) = (DVector::from_element(n, 1.0), DVector::from_element(n, 1.0));
        let mut gamma = time_scale(norm(m), norm(c), norm(k));
        for _ in 0..SCALING_ROUNDS {
            equilibrate(system, gamma, &mut left, &mut right);
            let size = |a: &DMatrix<f64>| norm(&DMatrix::from_fn(n, n, |i, j| left[i] * a[(i, j)] * right[j]));
            gamma = time_scale(size(m), size(c), size(k));
        }
        let gamma = power_of_two(gamma);
        left.apply(|x| *x = power_of_two(*x));
        right.apply(|x| *x = power_of_two(*x));
        let scale = |a: &DMatrix<f64>, f: f64| DMatrix::from_fn(n, n, |i, j| a[(i, j)] * left[i] * right[j] * f);
        let (m, c, k) = (scale(m, gamma * gamma), scale(c, gamma), scale(k, 1.0));
        let norms = Norms::of(&m, &c, &k);
        Self { m, c, k, gamma, left, right, norms }
    }

    /// The error where an eigenvalue does not fit into a double.
    pub(crate) fn range(&self) -> CertifiedError {
        let entries = || [&self.m, &self.c, &self.k].into_iter().flat_map(|a| a.iter()).map(|x| x.abs());
        let smallest = entries().filter(|&x| x > 0.0).fold(f64::INFINITY, f64::min);
        CertifiedError::Range { smallest, largest: entries().fold(0.0, f64::max) }
    }

    /// tau: how many times the damping outweighs stiffness and mass; at least 1.
    pub(crate) fn overdamping(&self) -> f64 {
        let Norms { m, c, k } = self.norms;
        // The product of both may be less than any double.
        let others = m.sqrt() * k.sqrt();
        if others > 0.0 && c > others { c / others } else { 1.0 }
    }

    /// d = 1 / tau, rounded to a power of two.
    pub(crate) fn grading(&self) -> f64 {
        power_of_two(1.0 / self.overdamping())
    }

    /// n.
    pub(crate) fn order(&self) -> usize {
        self.m.nrows()
    }

    /// `Q~(sigma)`.
    pub(crate) fn polynomial(&self, sigma: Complex<f64>) -> DMatrix<Complex<f64>> {
        let [re, im] = self.polynomial_parts(sigma);
        re.zip_map(&im, Complex::new)
    }

    /// Real and imaginary part of Q(sigma).
    pub(crate) fn polynomial_parts(&self, sigma: Complex<f64>) -> [DMatrix<f64>; 2] {
        let square = sigma * sigma;
        [
            self.m.zip_zip_map(&self.c, &self.k, |m, c, k| square.re * m + sigma.re * c + k),
            self.m.zip_map(&self.c, |m, c| square.im * m + sigma.im * c),
        ]
    }

    /// `Q~(sigma) x`.
    pub(crate) fn times(&self, sigma: Complex<f64>, x: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        (real_times_complex(&self.m, x) * sigma + real_times_complex(&self.c, x)) * sigma
            + real_times_complex(&self.k, x)
    }

    /// `Q~'(sigma) x`.
    pub(crate) fn derivative_times(&self, sigma: Complex<f64>, x: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        real_times_complex(&self.m, x) * (sigma * 2.0) + real_times_complex(&self.c, x)
    }

    /// `Q~'(sigma)^H y`.
    pub(crate) fn derivative_adjoint_times(
        &self,
        sigma: Complex<f64>,
        y: &DVector<Complex<f64>>,
    ) -> DVector<Complex<f64>> {
        adjoint_times(&self.m, y) * (sigma.conj() * 2.0) + adjoint_times(&self.c, y)
    }

    /// `Q~(sigma)^H y`.
    pub(crate) fn adjoint_times(&self, sigma: Complex<f64>, y: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        let sigma = sigma.conj();
        (adjoint_times(&self.m, y) * sigma + adjoint_times(&self.c, y)) * sigma + adjoint_times(&self.k, y)
    }

    /// `M~^H y`.
    pub(crate) fn mass_adjoint_times(&self, y: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        adjoint_times(&self.m, y)
    }

    /// `C~ x`.
    pub(crate) fn damping_times(&self, x: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        real_times_complex(&self.c, x)
    }

    /// `K~ x`.
    pub(crate) fn stiffness_times(&self, x: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        real_times_complex(&self.k, x)
    }

    /// `M~ x`.
    pub(crate) fn mass_times(&self, x: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        real_times_complex(&self.m, x)
    }
}

/// `A^T y`.
fn adjoint_times(a: &DMatrix<f64>, y: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
    let (re, im): (Vec<f64>, Vec<f64>) = y.iter().map(|z| (z.re, z.im)).unzip();
    // The vectors of real eigenvalues have one part.
    let is_real = im.iter().all(|&x| x == 0.0);
    Arch::new().dispatch(|| {
        let product = |j: usize, part: &[f64]| real_product(&a.as_slice()[j * re.len()..(j + 1) * re.len()], part);
        DVector::from_fn(a.ncols(), |j, _| Complex::new(product(j, &re), if is_real { 0.0 } else { product(j, &im) }))
    })
}

/// gamma: sqrt(|K| / |M|), or what the damping says where one of them vanishes.
fn time_scale(m: f64, c: f64, k: f64) -> f64 {
    match (m > 0.0, c > 0.0, k > 0.0) {
        (true, _, true) => (k / m).sqrt(),
        (true, true, false) => c / m,
        (false, true, true) => k / c,
        _ => 1.0,
    }
}

/// Number of maxima that are found side by side; chosen: the numbers of the widest registers.
const MAXIMA: usize = 8;

/// The greater one of two numbers that are no NaN, in one instruction.
fn greater(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

fn equilibrate(system: &SecondOrder, gamma: f64, left: &mut DVector<f64>, right: &mut DVector<f64>) {
    let n = system.order();
    let weight =
        |i: usize, j: usize| (gamma * system.m[(i, j)].abs() + system.c[(i, j)].abs()) * gamma + system.k[(i, j)].abs();
    let weights = DMatrix::from_fn(n, n, weight);
    for _ in 0..EQUILIBRATION_SWEEPS {
        let (mut rows, mut columns) = (DVector::<f64>::zeros(n), DVector::<f64>::zeros(n));
        for ((weights, largest), right) in weights.as_slice().chunks(n.max(1)).zip(columns.iter_mut()).zip(right.iter())
        {
            // Several maxima side by side: one would wait for the last at every entry.
            let mut maxima = [0.0; MAXIMA];
            let groups = weights.chunks(MAXIMA).zip(left.as_slice().chunks(MAXIMA));
            for ((weights, left), rows) in groups.zip(rows.as_mut_slice().chunks_mut(MAXIMA)) {
                for (((weight, left), row), maximum) in weights.iter().zip(left).zip(rows).zip(&mut maxima) {
                    let w = left * weight * right;
                    *row = greater(*row, w);
                    *maximum = greater(*maximum, w);
                }
            }
            *largest = maxima.into_iter().fold(0.0, greater);
        }
        left.zip_apply(&rows, |l, r| *l /= if r > 0.0 { r.sqrt() } else { 1.0 });
        right.zip_apply(&columns, |r, c| *r /= if c > 0.0 { c.sqrt() } else { 1.0 });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    #[test]
    fn units_of_length_mass_time_and_rotation_do_not_matter() {
        let si = SecondOrder::new(
            dmatrix![2.0, 0.1; 0.1, 3.0],
            dmatrix![0.3, 0.1; 0.0, 0.2],
            dmatrix![4.0e6, -3.0e6; 3.0e6, 7.0e6],
        )
        .unwrap();
        let units = dmatrix![2f64.powi(-40), 0.0; 0.0, 2f64.powi(25)];
        let other = SecondOrder::new(&units * &si.m * &units, &units * &si.c * &units, &units * &si.k * &units);
        let (a, b) = (Scaled::new(&si), Scaled::new(&other.unwrap()));
        assert_eq!((a.m, a.c, a.k, a.gamma), (b.m, b.c, b.k, b.gamma));
    }

    #[test]
    fn scaling_is_exact() {
        let system =
            SecondOrder::new(dmatrix![0.1, 0.0; 0.0, 0.3], DMatrix::zeros(2, 2), dmatrix![1e9, 7.0; 7.0, 1e-3]);
        let system = system.unwrap();
        let s = Scaled::new(&system);
        let undo = DMatrix::from_fn(2, 2, |i, j| s.k[(i, j)] / s.left[i] / s.right[j]);
        assert_eq!(undo, system.k);
        assert!(s.norms.size(1.0) < 10.0 && s.norms.size(1.0) > 0.1);
    }
}
