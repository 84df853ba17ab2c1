//! Exceptional points of a lattice, at which two modes coalesce in eigenvalue and shape.
//!
//! Without damping they lie at real friction coefficients: two frequencies approach each other, meet, and part as a growing
//! and a decaying mode. The eigenvalues have a branch point there, but `(lambda_1 - lambda_2)^2` is analytic with a simple
//! zero: it is `-(omega_1 - omega_2)^2` on one side and the square of a growth rate on the other (Kirillov, Nonconservative
//! Stability Problems of Modern Physics, 2013). The secant method finds the zero to nearly full precision.

use cea::{EigenSolver, QrSolver, Workspace};
use linsys::SecondOrder;
use num_complex::Complex;

use crate::ValidationError;

/// Number of steps of the search for a growing mode; chosen.
const SEARCH_STEPS: usize = 64;
/// Least growth rate, as a part of |lambda|, of a mode that counts as growing; chosen: rounding at an exceptional point makes
/// growth rates of about 1e-8.
const SURE_GROWTH: f64 = 1e-5;
/// Number of bisections between a parameter without and one with a growing mode; chosen.
const BISECTIONS: usize = 40;
/// Most steps of the secant method; chosen.
const MOST_SECANT_STEPS: usize = 40;
/// Largest squared relative distance of the eigenvalues at which the secant method ends; chosen: some tens of epsilon.
const ROUNDED_SQUARE: f64 = 1e-14;
/// Largest relative distance of the two eigenvalues at the end of a successful search; chosen.
const LARGEST_DISTANCE: f64 = 1e-5;

/// A parameter at which two eigenvalues coalesce.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExceptionalPoint {
    /// The parameter.
    pub mu: f64,
    /// The coalescing eigenvalue, rad/s: the mean of the two.
    pub lambda: Complex<f64>,
    /// The relative distance of the two eigenvalues that is left.
    pub distance: f64,
}

/// The first exceptional point between two values of the parameter of an undamped family.
///
/// # Errors
/// Those of `system` and of the solver; [`ValidationError::NoConvergence`] where no mode begins to grow.
pub fn exceptional_point(
    system: &mut dyn FnMut(f64) -> Result<SecondOrder, ValidationError>,
    from: f64,
    to: f64,
) -> Result<ExceptionalPoint, ValidationError> {
    let place = |i: usize| from + (to - from) * i as f64 / SEARCH_STEPS as f64;
    let mut bracket = None;
    for i in 1..=SEARCH_STEPS {
        if growing(&system(place(i))?)?.is_some() {
            bracket = Some((place(i - 1), place(i)));
            break;
        }
    }
    let none =
        |left: f64| ValidationError::NoConvergence { what: "an exceptional point", left, steps: MOST_SECANT_STEPS };
    let (mut low, mut high) = bracket.ok_or_else(|| none(f64::INFINITY))?;
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if growing(&system(middle)?)?.is_some() {
            high = middle;
        } else {
            low = middle;
        }
    }
    let near = growing(&system(high)?)?.ok_or_else(|| none(f64::INFINITY))?;
    let near = Complex::new(0.0, near.im);

    // The first secant through a point a little farther up.
    let (mut before, mut mu) = (high + 1e-7 * (to - from), high);
    let (mut square_before, _) = discriminant(&system(before)?, near)?;
    let mut best = ExceptionalPoint { mu, lambda: near, distance: f64::INFINITY };
    for _ in 0..MOST_SECANT_STEPS {
        let (square, lambda) = discriminant(&system(mu)?, near)?;
        let distance = (square.norm() / lambda.norm_sqr()).sqrt();
        if distance < best.distance {
            best = ExceptionalPoint { mu, lambda, distance };
        }
        let step = -square.re * (mu - before) / (square.re - square_before.re);
        if !step.is_finite() || square.norm() <= ROUNDED_SQUARE * lambda.norm_sqr() {
            break;
        }
        (before, square_before) = (mu, square);
        mu += step;
    }
    if best.distance > LARGEST_DISTANCE { Err(none(best.distance)) } else { Ok(best) }
}

/// The fastest growing eigenvalue; `None` where none grows faster than [`SURE_GROWTH`].
fn growing(system: &SecondOrder) -> Result<Option<Complex<f64>>, ValidationError> {
    let spectrum = QrSolver.eigenvalues(system, &mut Workspace::default())?;
    let fastest = spectrum.oscillatory().max_by(|a, b| a.re.total_cmp(&b.re));
    Ok(fastest.filter(|l| l.re > SURE_GROWTH * l.norm()))
}

/// `(lambda_1 - lambda_2)^2` and the mean of the two eigenvalues nearest to `near`.
fn discriminant(system: &SecondOrder, near: Complex<f64>) -> Result<(Complex<f64>, Complex<f64>), ValidationError> {
    let mut lambdas: Vec<_> = QrSolver.eigenvalues(system, &mut Workspace::default())?.oscillatory().collect();
    lambdas.sort_by(|a, b| (a - near).norm().total_cmp(&(b - near).norm()));
    match lambdas[..] {
        [first, second, ..] => Ok(((first - second) * (first - second), 0.5 * (first + second))),
        _ => Err(ValidationError::NoConvergence { what: "an exceptional point", left: f64::INFINITY, steps: 0 }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, dmatrix};

    #[test]
    fn the_exceptional_point_of_two_oscillators_is_where_their_discriminant_vanishes() {
        // K = [1, p; -p, 1.5]: omega^2 = 1.25 -+ sqrt(0.0625 - p^2), double at p = 0.25.
        let mut system = |p: f64| {
            let k = dmatrix![1.0, p; -p, 1.5];
            Ok(SecondOrder::new(DMatrix::identity(2, 2), DMatrix::zeros(2, 2), k).unwrap())
        };
        let point = exceptional_point(&mut system, 0.0, 1.0).unwrap();
        assert!((point.mu - 0.25).abs() < 1e-13, "{point:?}");
        assert!((point.lambda - Complex::new(0.0, 1.25_f64.sqrt())).norm() < 1e-7 && point.distance < 1e-6);
        let stable = |_| Ok(SecondOrder::new(dmatrix![1.0], dmatrix![0.0], dmatrix![1.0]).unwrap());
        assert!(exceptional_point(&mut { stable }, 0.0, 1.0).is_err());
    }
}
