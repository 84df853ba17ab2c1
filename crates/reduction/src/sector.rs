//! Proofs that nothing grows faster than it oscillates, and that something does, without a spectrum.
//!
//! **Nothing does.** Let `Q(lambda) x = 0` with `lambda = rho exp(i phi)`, |phi| <= pi/4, and M symmetric. With symmetric parts `C_s`, `K_s` and the skew part `K_k`,
//! the real part of `x^H Q x / lambda`, times `rho_0^2 / (rho cos phi)`, is zero too:
//!
//! ```text
//! x^H (rho_0^2 M + s u rho_0 C_s + u^2 (K_s - i t K_k)) x = 0,    s = 1 / cos phi, t = tan phi, u = rho_0 / rho
//! ```
//!
//! The matrix is linear in s, t, u and u^2. For rho >= rho_0 all of these lie in the hull of some corners: s of 1 and root 2, t of -1 and 1, (u, u^2) of pieces of
//! the parabola between their ends and the point where the tangents there meet. Where it is positive definite at each corner, it is at all of them, and there is
//! no such eigenvalue. Corners with t and -t are conjugates. An internal state that adds `kappa lambda / (lambda + a) b b^T` to Q, with kappa >= 0 and a > 0, as what
//! relaxes does, adds `kappa |b^T x|^2 Re 1 / (lambda + a)` to that real part, which is not negative: without it the proof holds all the same.
//!
//! **Something does.** The real eigenvalues larger than a real s > 0 are odd in number where det Q(s) < 0, as M is positive definite, and det Q > 0 far out.

use std::f64::consts::SQRT_2;

use faer::linalg::solvers::{Llt, PartialPivLu, SolveCore as _};
use faer::{Conj, Mat, Side};
use linsys::{Internal, SecondOrder};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

/// Ends of the pieces of the parabola; chosen: with these no draw of 20 of cases/disc-pad that has no such eigenvalue is left without a proof.
const ENDS: [f64; 4] = [0.0, 0.25, 0.5, 1.0];
/// Largest skew part of a mass matrix, and part of the force of a state beside its drive, that is rounding, relative.
const ROUNDING: f64 = 1e-12;
/// Doublings of the size at which signs of det Q are taken; chosen: growth of cases/disc-pad reaches 170 times its band.
const DOUBLINGS: i32 = 10;
/// Halvings of the logarithm of a factor of two that holds an eigenvalue: it is known to 7e-4 then, so that inverse iteration finds its shape.
const HALVINGS: u32 = 10;
/// Solutions of that inverse iteration; chosen: what is nearest outweighs what is ten times as far by 1e4 then.
const SOLUTIONS: usize = 4;

/// True if a system surely has no eigenvalue of modulus `size`, rad/s, or more that grows as fast as it oscillates or faster; false says nothing. Systems with
/// internal states that may feed a motion and with a mass matrix that is not symmetric are not looked at.
#[must_use]
pub fn surely_none_grows_too_fast(system: &SecondOrder, size: f64) -> bool {
    let SecondOrder { m, c, k, internal } = system;
    let is_symmetric = (m - m.transpose()).amax() <= ROUNDING * m.amax();
    if !is_symmetric || !are_passive(internal) || size <= 0.0 {
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

/// True if no internal state feeds a motion: the force of each is `-kappa` times its drive, kappa >= 0, and it decays.
fn are_passive(Internal { decay, drive, force }: &Internal) -> bool {
    (0..decay.len()).all(|state| {
        let (drive, force) = (drive.row(state).transpose(), force.column(state));
        let kappa = -drive.dot(&force) / drive.norm_squared();
        let is_along = (force + &drive * kappa).norm() <= ROUNDING * force.norm();
        decay[state] > 0.0 && (drive.norm() == 0.0 || kappa >= 0.0 && is_along)
    })
}

/// A real eigenvalue larger than `size`, 1/s, roughly, and its right vector, the largest entry 1, roughly too; `None` where no sign of det Q tells of one,
/// which says nothing. The mass matrix is positive definite.
#[must_use]
pub fn growing_real(system: &SecondOrder, size: f64) -> Option<(f64, DVector<f64>)> {
    let points = (0..=DOUBLINGS).rev().map(|power| size * 2_f64.powi(power));
    let mut below = points.into_iter().find(|&s| is_negative(&factorised(system, s)))?;
    let mut beyond = 2.0 * below;
    for _ in 0..HALVINGS {
        let between = (below * beyond).sqrt();
        match is_negative(&factorised(system, between)) {
            true => below = between,
            false => beyond = between,
        }
    }
    let factors = factorised(system, below);
    let mut shape = Mat::from_fn(system.order(), 1, |row, _| 1.0 + 1.0 / (2.0 + row as f64));
    for _ in 0..SOLUTIONS {
        factors.solve_in_place_with_conj(Conj::No, shape.as_mut());
        let largest = shape.col_as_slice(0).iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        shape = Mat::from_fn(system.order(), 1, |row, _| shape[(row, 0)] / largest);
    }
    let shape = DVector::from_column_slice(shape.col_as_slice(0));
    shape.iter().all(|entry| entry.is_finite()).then_some((below, shape))
}

/// Factors of Q(s), s real.
fn factorised(system: &SecondOrder, s: f64) -> PartialPivLu<f64> {
    let q = system.dynamic_stiffness(Complex::from(s));
    PartialPivLu::new(Mat::from_fn(q.nrows(), q.ncols(), |i, j| q[(i, j)].re).as_ref())
}

/// True if the determinant of a factorised matrix is negative.
fn is_negative(factors: &PartialPivLu<f64>) -> bool {
    let (u, (forward, _)) = (factors.U(), factors.P().arrays());
    let negative = (0..u.nrows()).filter(|&i| u[(i, i)] < 0.0).count();
    // A permutation of n rows in c cycles is one of n - c exchanges.
    let mut seen = vec![false; forward.len()];
    let mut cycles = 0;
    for start in 0..forward.len() {
        let mut row = start;
        if !seen[row] {
            cycles += 1;
        }
        while !seen[row] {
            seen[row] = true;
            row = forward[row];
        }
    }
    (negative + forward.len() - cycles) % 2 == 1
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

    /// One with internal states, in each second draw.
    fn with_states(random: &mut ChaCha8Rng) -> SecondOrder {
        let mut system = system(random);
        let (n, states) = (system.order(), random.random_range(0..3));
        let mut full =
            |rows, columns, least: f64| DMatrix::from_fn(rows, columns, |_, _| random.random_range(least..1.0));
        let (drive, force, decay) = (full(states, n, -1.0), full(n, states, -1.0), full(states, 1, 0.1));
        system.internal = linsys::Internal { decay: decay.column(0).into_owned(), drive, force };
        system
    }

    #[test]
    fn an_odd_number_of_growing_real_eigenvalues_is_seen_and_what_is_seen_is_one() {
        let mut random = ChaCha8Rng::seed_from_u64(11);
        let (mut seen, mut odd) = (0, 0);
        for number in 0..2000 {
            let (system, size) = (with_states(&mut random), random.random_range(0.01..0.5));
            let spectrum = QrSolver.eigenvalues(&system, &mut Workspace::default()).unwrap().eigenvalues;
            let is_real = |lambda: &&Complex<f64>| lambda.im.abs() <= 1e-9 * lambda.norm() && lambda.re > size;
            let real: Vec<f64> = spectrum.iter().filter(is_real).map(|lambda| lambda.re).collect();
            let found = growing_real(&system, size);
            if let Some((s, shape)) = &found {
                seen += 1;
                assert!(real.iter().any(|lambda| (lambda / s - 1.0).abs() < 1e-3), "{number}: {s} of {real:?}");
                let is_alone = real.iter().filter(|&lambda| (lambda / s - 1.0).abs() < 0.05).count() == 1;
                let left = (system.dynamic_stiffness(Complex::from(*s)) * shape.map(Complex::from)).norm();
                let terms = system.m.norm() * s * s + system.c.norm() * s + system.k.norm();
                assert!(!is_alone || left < 1e-2 * terms * shape.norm(), "{number}: {left} of {terms}");
            }
            if real.len() % 2 == 1 {
                odd += 1;
                assert!(found.is_some(), "{number}: none of {real:?}");
            }
        }
        assert!(odd > 300 && seen >= odd, "{seen} seen, {odd} odd");
    }

    #[test]
    fn what_is_proven_is_so_and_most_of_what_is_so_is_proven() {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let (mut proven, mut quiet, mut growing) = (0, 0, 0);
        for number in 0..2000 {
            let (mut system, size) = (system(&mut random), random.random_range(0.01..2.0));
            // Of each second draw a part relaxes.
            let states = number % 2 * random.random_range(1..3);
            let drive = DMatrix::from_fn(states, system.order(), |_, _| random.random_range(-1.0..1.0));
            let kappa = DVector::from_fn(states, |_, _| random.random_range(0.0..2.0));
            let decay = DVector::from_fn(states, |_, _| random.random_range(0.1..3.0));
            system.internal = Internal { decay, force: -drive.transpose() * DMatrix::from_diagonal(&kappa), drive };
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
        let mut active = system(&mut random);
        active.internal = Internal { decay: DVector::from_element(1, 1.0), ..Internal::zeros(active.order(), 1) };
        (active.internal.drive[0], active.internal.force[0]) = (-1.0, -0.5);
        assert!(!are_passive(&active.internal));
        active.internal.force[0] = 0.5;
        assert!(are_passive(&active.internal));
        assert!(growing > 300 && proven > quiet / 2, "{proven} of {quiet} proven, {growing} grow");
    }
}
