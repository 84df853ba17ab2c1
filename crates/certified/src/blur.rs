//! Blur of an eigenvalue: the distance up to which every point is an eigenvalue of some problem that rounds to the given matrices.
//!
//! The certificate of a disc says that no problem within rounding has an eigenvalue on its circle. With unit null vector x
//! and any w at right angles to it
//!
//! ```text
//! Q(sigma + d) (x + d w) = Q x + d (Q' x + Q w) + d^2 (M x + Q' w) + d^3 M w,     |x + d w|^2 = 1 + |d|^2 |w|^2,
//! ```
//!
//! all at sigma on the right. Where this is no more than what rounding the data changes Q by, a problem so near has the
//! eigenvalue sigma + d, and no certifiable circle passes there. `w = -E Q' x` makes the linear term as small as it can be.

use super::measure::State;
use super::scaled::{Scaled, UNIT_ROUNDOFF, data_noise};
use super::vectors::Factor;
use crate::lu::Vector;

/// Part of what rounding the data changes that the terms may amount to: computing them hides a quarter, one rounding of the data.
const TERMS_PART: f64 = 0.75;
/// Ratio of one radius that is tried to the one before; chosen: with a smaller one more are tried, with a larger one the radius found is farther below the
/// largest.
const RADIUS_STEP: f64 = 1.1;

/// The radius of a disc around an eigenvalue that no certifiable circle meets; `factor` is Q next to it. A lower bound.
pub(super) fn blur(s: &Scaled, factor: &Factor, state: &State) -> f64 {
    let sigma = state.sigma;
    // Q v, Q' v and M v.
    let images = |v: &Vector| {
        let (mass, damping) = (s.mass_times(v), s.damping_times(v));
        let slope = &mass * (sigma * 2.0) + &damping;
        ((&mass * sigma + damping) * sigma + s.stiffness_times(v), slope, mass)
    };
    let (image, slope, mass) = images(&state.x);
    let w = -factor.deflated_solve(&state.x, &state.y, slope.clone());
    let (image_of_w, slope_of_w, mass_of_w) = images(&w);
    let terms = [image, slope + image_of_w, mass + slope_of_w, mass_of_w].map(|term| term.norm());
    let (noise, bend) = (TERMS_PART * data_noise(s, sigma.norm()), w.norm());
    let most = sigma.norm().max(1.0);
    let (mut inside, mut radius) = (0.0, UNIT_ROUNDOFF * sigma.norm());
    // On the ring between them.
    let is_hidden = |inside: f64, radius: f64| {
        let left = terms.iter().rev().fold(0.0, |sum, term| sum * radius + term);
        left <= noise * 1.0_f64.hypot(inside * bend)
    };
    while inside < most && is_hidden(inside, radius) {
        (inside, radius) = (radius, radius * RADIUS_STEP);
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Measure;
    use linsys::SecondOrder;
    use nalgebra::{DMatrix, dmatrix};
    use num_complex::Complex;

    /// Blur of the eigenvalue next to lambda; at points of its edge the smallest singular value is no more than the noise.
    fn checked(system: &SecondOrder, lambda: Complex<f64>) -> f64 {
        let problem = Measure::new(system);
        let s = &problem.scaled;
        let (state, factor) = problem.first_look(lambda / s.gamma, f64::INFINITY, f64::INFINITY).unwrap();
        let radius = blur(s, &factor, &state);
        let noise = data_noise(s, state.sigma.norm());
        for k in 0..8 {
            let edge = state.sigma + Complex::from_polar(radius, 0.1 + f64::from(k));
            let least = s.polynomial(edge).singular_values().min();
            assert!(least <= noise, "{lambda} {least:e} {noise:e}");
        }
        radius * s.gamma
    }

    #[test]
    fn every_point_of_the_disc_is_an_eigenvalue_of_a_problem_within_rounding() {
        // A chain of two at i moves by the root of the noise, a simple eigenvalue beside it by the noise.
        let chain = dmatrix![1.0, 1.0, 0.0; 0.0, 1.0, 0.0; 0.0, 0.0, 4.0];
        let system = SecondOrder::new(DMatrix::identity(3, 3), DMatrix::zeros(3, 3), chain).unwrap();
        let (defective, simple) = (checked(&system, Complex::i()), checked(&system, Complex::new(0.0, 2.0)));
        assert!(defective > 1e-8 && defective < 1e-7, "{defective:e}");
        assert!(simple > 1e-16 && simple < 1e-14, "{simple:e}");
        // A rigid body but for rounding: zero is in the disc.
        let rounded = dmatrix![1.0, -1.0 - f64::EPSILON, 0.0; -1.0, 1.0, 0.0; 0.0, 0.0, 4.0];
        let system = SecondOrder::new(DMatrix::identity(3, 3), DMatrix::zeros(3, 3), rounded).unwrap();
        assert!(checked(&system, Complex::from(1.5e-8)) > 1.5e-8);
    }
}
