//! Exceptional points of a lattice: two parameters at which two modes coalesce, value and shape.
//!
//! Two complex eigenvalues of a real family meet at isolated points of the plane of two real parameters p. There
//! `(lambda_1 - lambda_2)^2` is analytic and has a simple zero, though the eigenvalues have a branch point: Newton's method
//! on it finds p (Seyranian and Mailybaev, Multiparameter Stability Theory with Mechanical Applications, 2003).

use cea::{EigenSolver, QrSolver, Workspace};
use linsys::SecondOrder;
use num_complex::Complex;

use super::AccuracyError;

/// Relative distance of a pair worth a start.
const NEAR: f64 = 0.02;
/// Newton steps.
const MOST_STEPS: usize = 40;
/// Step of the differences, as a part of the parameter range.
const DIFFERENCE: f64 = 1e-5;
/// Squared relative distance of the eigenvalues at which rounding takes over.
const SETTLED: f64 = 1e-13;

/// Two parameters at which two eigenvalues coalesce.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExceptionalPoint {
    /// The parameters.
    pub at: [f64; 2],
    /// The coalescing eigenvalue, rad/s: the mean of the two.
    pub lambda: Complex<f64>,
    /// What is left of the relative distance of the two.
    pub distance: f64,
}

/// Searches the square `range` x `range` on a grid of `grid` x `grid` starts for the coalescence with the largest growth
/// rate.
///
/// # Errors
/// Those of `system` and of the solver; [`AccuracyError::NoConvergence`] where no start leads to one.
pub fn exceptional_point(
    system: &mut dyn FnMut([f64; 2]) -> Result<SecondOrder, AccuracyError>,
    range: [f64; 2],
    grid: usize,
) -> Result<ExceptionalPoint, AccuracyError> {
    let width = range[1] - range[0];
    let place = |i: usize| range[0] + width * (i as f64 + 0.5) / grid as f64;
    let mut starts: Vec<(Complex<f64>, [f64; 2])> = Vec::new();
    for i in 0..grid {
        for j in 0..grid {
            let p = [place(i), place(j)];
            let lambdas = oscillatory(&system(p)?)?;
            for (a, first) in lambdas.iter().enumerate() {
                for second in &lambdas[a + 1..] {
                    // Equal ones are multiple for a reason other than coalescence.
                    if (1e-6..NEAR).contains(&((first - second).norm() / first.norm())) {
                        starts.push((0.5 * (first + second), p));
                    }
                }
            }
        }
    }
    starts.sort_by(|a, b| b.0.re.total_cmp(&a.0.re));
    starts.truncate(8 * grid);
    let mut best: Option<ExceptionalPoint> = None;
    for (near, p) in starts {
        let Some(point) = newton(system, p, near, width)? else { continue };
        let inside = point.at.iter().all(|x| (range[0]..=range[1]).contains(x));
        if inside && best.is_none_or(|b| point.lambda.re > b.lambda.re + 1e-6 * b.lambda.norm()) {
            best = Some(point);
        }
    }
    best.ok_or(AccuracyError::NoConvergence { what: "an exceptional point", left: f64::INFINITY, steps: MOST_STEPS })
}

fn newton(
    system: &mut dyn FnMut([f64; 2]) -> Result<SecondOrder, AccuracyError>,
    start: [f64; 2],
    start_near: Complex<f64>,
    width: f64,
) -> Result<Option<ExceptionalPoint>, AccuracyError> {
    let (mut p, mut near) = (start, start_near);
    let h = DIFFERENCE * width;
    let mut before = f64::INFINITY;
    for _ in 0..MOST_STEPS {
        let (square, mean) = discriminant(&system(p)?, near)?;
        near = mean;
        let scale = mean.norm_sqr();
        let slope = |system: &mut dyn FnMut([f64; 2]) -> Result<SecondOrder, AccuracyError>, step: [f64; 2]| {
            let (ahead, _) = discriminant(&system([p[0] + step[0], p[1] + step[1]])?, mean)?;
            let (behind, _) = discriminant(&system([p[0] - step[0], p[1] - step[1]])?, mean)?;
            Ok::<_, AccuracyError>((ahead - behind) / (2.0 * h))
        };
        let (a, b) = (slope(system, [h, 0.0])?, slope(system, [0.0, h])?);
        let determinant = a.re * b.im - a.im * b.re;
        // Modes that only cross have a double zero: no slope, no exceptional point.
        if determinant.abs() <= 1e-6 * a.norm() * b.norm() || a.norm().min(b.norm()) * width <= 1e-6 * scale {
            return Ok(None);
        }
        let now = square.norm() / scale;
        if now <= SETTLED || (now <= 1e3 * SETTLED && now >= 0.5 * before) {
            return Ok(Some(ExceptionalPoint { at: p, lambda: mean, distance: now.sqrt() }));
        }
        before = now;
        let step =
            [(b.re * square.im - b.im * square.re) / determinant, (a.im * square.re - a.re * square.im) / determinant];
        let length = step[0].hypot(step[1]);
        if !length.is_finite() {
            return Ok(None);
        }
        let limit = (0.1 * width / length).min(1.0);
        p = [p[0] + limit * step[0], p[1] + limit * step[1]];
        if p.iter().any(|x| *x <= 0.0) {
            return Ok(None);
        }
    }
    Ok(None)
}

/// `(lambda_1 - lambda_2)^2` and the mean of the two eigenvalues whose mean is nearest to `near`.
fn discriminant(system: &SecondOrder, near: Complex<f64>) -> Result<(Complex<f64>, Complex<f64>), AccuracyError> {
    let mut lambdas = oscillatory(system)?;
    lambdas.sort_by(|a, b| (a - near).norm().total_cmp(&(b - near).norm()));
    let difference = lambdas[0] - lambdas[1];
    Ok((difference * difference, 0.5 * (lambdas[0] + lambdas[1])))
}

fn oscillatory(system: &SecondOrder) -> Result<Vec<Complex<f64>>, AccuracyError> {
    let lambdas: Vec<_> = QrSolver.eigenvalues(system, &mut Workspace::default())?.oscillatory().collect();
    if lambdas.len() < 2 {
        return Err(AccuracyError::NoConvergence { what: "an exceptional point", left: f64::INFINITY, steps: 0 });
    }
    Ok(lambdas)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, dmatrix};

    #[test]
    fn the_exceptional_point_of_two_damped_oscillators_is_found() {
        let mut system = |[p, q]: [f64; 2]| {
            let (c, k) = (dmatrix![0.1, 0.0; 0.0, 0.3], dmatrix![1.0, p; 0.04, 1.0 + q]);
            Ok(SecondOrder::new(DMatrix::identity(2, 2), c, k).unwrap())
        };
        let point = exceptional_point(&mut system, [0.01, 1.0], 8).unwrap();
        let lambda = point.lambda;
        // A double root of the characteristic polynomial: it and its derivative vanish.
        let (f, g) = (lambda * lambda + 0.1 * lambda + 1.0, lambda * lambda + 0.3 * lambda + 1.0 + point.at[1]);
        let value = f * g - 0.04 * point.at[0];
        let slope = (2.0 * lambda + 0.1) * g + (2.0 * lambda + 0.3) * f;
        assert!(value.norm() < 1e-10 && slope.norm() < 1e-6, "{value} {slope} {point:?}");
        assert!(point.distance < 1e-5);
    }
}
