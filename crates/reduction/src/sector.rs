//! Proof that nothing grows faster than it oscillates, without a spectrum.
//!
//! Let `Q(lambda) x = 0` with `lambda = rho exp(i phi)`, |phi| <= pi/4, and M symmetric. With symmetric parts `C_s`, `K_s` and the skew part `K_k`,
//! the real part of `x^H Q x / lambda`, times `rho_0^2 / (rho cos phi)`, is zero too:
//!
//! ```text
//! x^H (rho_0^2 M + s u rho_0 C_s + u^2 (K_s - i t K_k)) x = 0,    s = 1 / cos phi, t = tan phi, u = rho_0 / rho
//! ```
//!
//! The matrix is linear in s, t, u and u^2. For rho >= rho_0 all of these lie in the hull of some corners: s of 1 and root 2, t of -1 and 1, (u, u^2) of pieces of
//! the parabola between their ends and the point where the tangents there meet. Where it is positive definite at each corner, it is at all of them, and there is
//! no such eigenvalue. Corners with t and -t are conjugates.

use std::f64::consts::SQRT_2;

use faer::linalg::solvers::Llt;
use faer::{Mat, Side};
use linsys::SecondOrder;
use nalgebra::DMatrix;
use num_complex::Complex;

/// Ends of the pieces of the parabola; chosen: with these no draw of 20 of cases/disc-pad that has no such eigenvalue is left without a proof.
const ENDS: [f64; 4] = [0.0, 0.25, 0.5, 1.0];
/// Largest skew part of a mass matrix that is rounding, relative.
const ROUNDING: f64 = 1e-12;

/// True if a system surely has no eigenvalue of at least some size, rad/s, that grows as fast as it oscillates or faster; false says nothing. Systems with
/// internal states and with a mass matrix that is not symmetric are not looked at.
#[must_use]
pub fn surely_none_grows_too_fast(system: &SecondOrder, size: f64) -> bool {
    let SecondOrder { m, c, k, internal } = system;
    let is_symmetric = (m - m.transpose()).amax() <= ROUNDING * m.amax();
    if !is_symmetric || !internal.decay.is_empty() || size <= 0.0 {
        return false;
    }
    let symmetric = |a: &DMatrix<f64>| (a + a.transpose()) * 0.5;
    let (c, skew, k) = (symmetric(c) * size, (k - k.transpose()) * 0.5, symmetric(k));
    let m = symmetric(m) * (size * size);
    let is_definite = |s: f64, (u, square): (f64, f64)| {
        let entry = |i: usize, j: usize| {
            let real = m[(i, j)] + s * u * c[(i, j)] + square * k[(i, j)];
            Complex::new(real, square * skew[(i, j)])
        };
        Llt::new(Mat::from_fn(m.nrows(), m.nrows(), entry).as_ref(), Side::Lower).is_ok()
    };
    let ends = ENDS.map(|u| (u, u * u));
    let tangents = ENDS.windows(2).map(|ends| (0.5 * (ends[0] + ends[1]), ends[0] * ends[1]));
    ends.into_iter().chain(tangents).all(|corner| is_definite(1.0, corner) && is_definite(SQRT_2, corner))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use cea::{EigenSolver as _, QrSolver, Workspace};
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::grows_too_fast;

    /// A positive definite mass, damping that may drive, a stiffness that may be negative and circulate.
    fn system(random: &mut ChaCha8Rng) -> SecondOrder {
        let n = random.random_range(1..7);
        let mut full = |size: f64| DMatrix::from_fn(n, n, |_, _| size * random.random_range(-1.0..1.0));
        let (a, b, c, k) = (full(1.0), full(1.0), full(0.3), full(0.4));
        let m = &a * a.transpose() + DMatrix::identity(n, n) * 0.3;
        let drive: f64 = random.random_range(-1.0..0.3);
        let stiffness: f64 = random.random_range(-0.5..2.0);
        let c = c + DMatrix::identity(n, n) * drive.min(0.1);
        let k = k + &b * b.transpose() * stiffness + DMatrix::identity(n, n) * (0.5 * stiffness);
        SecondOrder::new(m, c, k).unwrap()
    }

    #[test]
    fn what_is_proven_is_so_and_most_of_what_is_so_is_proven() {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let (mut proven, mut quiet, mut growing) = (0, 0, 0);
        for number in 0..2000 {
            let (system, size) = (system(&mut random), random.random_range(0.01..2.0));
            let spectrum = QrSolver.eigenvalues(&system, &mut Workspace::default()).unwrap().eigenvalues;
            let grows = |lambda: &Complex<f64>| lambda.im >= 0.0 && lambda.norm() >= size && grows_too_fast(*lambda);
            let is_proven = surely_none_grows_too_fast(&system, size);
            match spectrum.iter().any(grows) {
                true => {
                    assert!(!is_proven, "{number}");
                    growing += 1;
                }
                false => quiet += 1,
            }
            proven += usize::from(is_proven);
        }
        println!("{proven} of {quiet} proven, {growing} grow");
        assert!(growing > 300 && proven > quiet / 2, "{proven} of {quiet} proven, {growing} grow");
    }
}
