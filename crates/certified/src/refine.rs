//! Newton's method on (sigma, x) with the residual in double-double: an eigenvalue to more digits than a double has.
//!
//! ```text
//! [ Q(s0)   Q'(s0) x0 ] [dx]     [ Q(s) x ]
//! [ x0^H        0     ] [ds] = - [   0    ]
//! ```
//!
//! The matrix is factored in double precision, again only where the steps get slow; the right-hand side and the sums
//! are double-double (as in iterative refinement; Tisseur, SIAM J. Matrix Anal. Appl. 22, 2001). For a simple eigenvalue
//! the matrix is regular and each step gains the digits that a factorisation is good for. The steps' own contraction
//! bounds what is left: if a step is at most half the one before, what follows sums to no more than the last step. Apart from the
//! correctors of paths and neighbours: those stop where a double ends.

use num_complex::Complex;

use super::dd::DdComplex;
use super::residual::residual;
use super::scaled::Scaled;
use crate::lu::{LEAST_PIVOT, Lu, Vector};

/// Most steps with one factorisation; chosen: each step gains as many digits as the factorisation has, sixteen less the digits of the condition number.
const MOST_NEWTON_STEPS: usize = 6;
/// Most factorisations, each at the sigma that the last one led to; chosen: an eigenpair that needs more is not refined.
const MOST_FACTORISATIONS: usize = 4;
/// Least relative error claimed: the rounding of double-double.
const DOUBLE_DOUBLE_ROUNDING: f64 = 1e-31;

/// A refined eigenvalue of the scaled problem.
#[derive(Debug, Clone)]
pub(crate) struct Refined {
    /// sigma, its real part correct on its own scale and not on the scale of |sigma|.
    pub(crate) sigma: Complex<f64>,
    pub(crate) x: Vector,
    /// Error |sigma - exact| that the last steps leave possible, before sigma is rounded to a double.
    pub(crate) left: f64,
}

/// Refines a simple eigenpair until a step is at most `enough`, or nothing where the steps do not contract or leave
/// `reach` around the start.
pub(crate) fn newton(s: &Scaled, start: Complex<f64>, x0: &Vector, enough: f64, reach: f64) -> Option<Refined> {
    let mut sigma = DdComplex::from(start);
    let mut x: Vec<DdComplex> = x0.iter().map(|&z| z.into()).collect();
    let mut last = f64::INFINITY;
    for _ in 0..MOST_FACTORISATIONS {
        let bordered = Bordered::new(s, sigma.value(), &rounded(&x));
        last = f64::INFINITY;
        for _ in 0..MOST_NEWTON_STEPS {
            let (dx, shift) = bordered.step(residual(s, sigma, &x));
            let size = shift.norm();
            if size.is_nan() || size > 0.5 * last {
                break;
            }
            x.iter_mut().zip(dx.iter()).for_each(|(z, &d)| *z = *z + d.into());
            sigma = sigma + shift.into();
            // What this step leaves is as much less as it was less than the one before.
            let expected = if last.is_finite() { size * (size / last) } else { size };
            last = size;
            if size == 0.0 || (size <= enough && expected <= DOUBLE_DOUBLE_ROUNDING * start.norm()) {
                break;
            }
        }
        if last <= enough {
            break;
        }
    }
    let sigma = sigma.value();
    (last <= enough && (sigma - start).norm() <= reach).then(|| {
        let x = rounded(&x).normalize();
        Refined { sigma, x, left: last.max(DOUBLE_DOUBLE_ROUNDING * start.norm()) }
    })
}

fn rounded(x: &[DdComplex]) -> Vector {
    Vector::from_iterator(x.len(), x.iter().map(|z| z.value()))
}

/// The factored matrix of the steps, its border in proportion to Q.
struct Bordered {
    lu: Lu,
    weight: f64,
}

impl Bordered {
    fn new(s: &Scaled, sigma: Complex<f64>, x: &Vector) -> Self {
        let n = s.order();
        let size = s.norms.size(sigma.norm());
        let slope = s.derivative_times(sigma, x);
        let weight = size / slope.norm().max(f64::MIN_POSITIVE);
        let parts = |z: Complex<f64>| [z.re, z.im];
        let [mut re, mut im] = s.polynomial_parts(sigma).map(|part| part.resize(n + 1, n + 1, 0.0));
        for i in 0..n {
            [re[(i, n)], im[(i, n)]] = parts(slope[i] * weight);
            [re[(n, i)], im[(n, i)]] = parts(x[i].conj() * size);
        }
        Self { lu: Lu::of_parts([re, im], LEAST_PIVOT), weight }
    }

    /// dx and ds for the residual `Q(s) x`.
    fn step(&self, residual: Vector) -> (Vector, Complex<f64>) {
        let n = residual.len();
        let mut step = -residual.insert_row(n, Complex::default());
        self.lu.solve(&mut step);
        let shift = step[n] * self.weight;
        (step.remove_row(n), shift)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vectors::Factor;
    use linsys::SecondOrder;
    use nalgebra::dmatrix;

    fn refined(system: &SecondOrder, lambda: Complex<f64>, reach: f64) -> Option<Complex<f64>> {
        let s = Scaled::new(system);
        let x = Factor::new(&s, lambda / s.gamma).null_pairs(1).unwrap().0;
        newton(&s, lambda / s.gamma, &x[0], 1e-29, reach / s.gamma).map(|r| r.sigma * s.gamma)
    }

    #[test]
    fn a_real_part_below_the_rounding_of_the_imaginary_part_is_found() {
        // lambda^2 + 2 d lambda + 1 = 0: Re lambda = -d, 1e-25 of |lambda|.
        let d = 1e-25;
        let system = SecondOrder::new(dmatrix![1.0], dmatrix![2.0 * d], dmatrix![1.0]).unwrap();
        let lambda = refined(&system, Complex::new(1e-9, 1.0 + 1e-9), 1e-6).unwrap();
        assert!((lambda.re + d).abs() < 1e-4 * d);
        assert_eq!(lambda.im, 1.0);
    }

    #[test]
    fn a_start_that_belongs_to_another_eigenvalue_is_refused() {
        let system = SecondOrder::new(dmatrix![1.0], dmatrix![0.0], dmatrix![1.0]).unwrap();
        assert!(refined(&system, Complex::new(0.0, 1.1), 0.05).is_none());
    }
}
