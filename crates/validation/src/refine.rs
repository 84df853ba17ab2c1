//! Reference eigenvalues to more digits than a double has, by Newton's method on (lambda, x) with the residual in
//! double-double arithmetic.
//!
//! Internal states stay in the vector, `w = (x, z)`, so that the equations are polynomial. For k eigenvalues that are equal
//! or nearly equal, k vectors are found together with a k x k matrix S that has these eigenvalues:
//!
//! ```text
//! M X S^2 + C X S + K X - F Z = 0,   Z S + a Z - E X S = 0,   W_0^H W = I,   W = (X, Z)
//! ```
//!
//! The matrix of the Newton steps, with S near lambda I, is factored in double precision; the limit of the steps depends on the
//! residual only (Tisseur, SIAM J. Matrix Anal. Appl. 22, 2001; Kressner, Numer. Math. 114, 2009 for S). The result is right
//! to the last bit or the one before it.

use cea::Workspace;
use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector, Schur};
use num_complex::Complex;
use twofloat::TwoFloat;

use crate::ValidationError;
use crate::conditioning::condition;
use crate::refine_equations::{Long, bordered, long, product, residuals, short};

/// Most Newton steps; chosen: each step gains the digits to which the factorisation is accurate.
const MOST_NEWTON_STEPS: usize = 30;
/// Largest relative size of a step after which the iteration ends; chosen.
const LAST_STEP: f64 = 1e-22;
/// Largest relative size of the last step of an accepted result; chosen: with a condition number above 1e8, double-double is no
/// more accurate.
const LARGEST_LAST_STEP: f64 = 1e-18;
/// Largest relative distance of eigenvalues that may be one multiple eigenvalue; chosen: rounding splits a double one by 1e-8.
const MULTIPLE_DISTANCE: f64 = 1e-7;

/// A refined eigenvalue, more accurate than a double-precision solver can compute.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RefinedEigenvalue {
    /// lambda, rad/s, each part rounded to a double.
    pub lambda: Complex<f64>,
    /// Normwise relative condition number `(|lambda|^2 |M| + |lambda| |C| + |K|) |psi| |phi| / (|lambda| |psi^H Q' phi|)`
    /// (Tisseur, Linear Algebra Appl. 309, 2000, theorem 5), with the terms of internal states where there are some; for a
    /// multiple eigenvalue, the scalar `psi^H Q' phi` is replaced by the least singular value of `Psi^H Q' Phi`.
    pub condition: f64,
}

/// Refines the simple eigenvalue nearest to `start`.
///
/// # Errors
/// [`ValidationError::NoConvergence`] for a multiple eigenvalue, or a start that is no eigenvalue.
pub fn refine(system: &SecondOrder, start: Complex<f64>) -> Result<RefinedEigenvalue, ValidationError> {
    Ok(refine_block(system, &[start])?.swap_remove(0))
}

/// Refines the eigenvalues `starts` of a system, multiple ones together.
///
/// # Errors
/// [`ValidationError::NoConvergence`] for most defective eigenvalues, and for a start that is no eigenvalue.
pub fn refine_all(system: &SecondOrder, starts: &[Complex<f64>]) -> Result<Vec<RefinedEigenvalue>, ValidationError> {
    let mut refined: Vec<Option<RefinedEigenvalue>> = vec![None; starts.len()];
    for (i, &start) in starts.iter().enumerate() {
        if refined[i].is_some() {
            continue;
        }
        let near = |j: &usize| (starts[*j] - start).norm() <= MULTIPLE_DISTANCE * start.norm();
        let together: Vec<usize> = (0..starts.len()).filter(near).collect();
        match refine(system, start) {
            Err(ValidationError::NoConvergence { .. }) if together.len() > 1 => {
                let of: Vec<_> = together.iter().map(|&j| starts[j]).collect();
                together.into_iter().zip(refine_block(system, &of)?).for_each(|(j, r)| refined[j] = Some(r));
            }
            simple => refined[i] = Some(simple?),
        }
    }
    Ok(refined.into_iter().flatten().collect())
}

fn refine_block(system: &SecondOrder, starts: &[Complex<f64>]) -> Result<Vec<RefinedEigenvalue>, ValidationError> {
    let (n, s, k) = (system.order(), system.states(), starts.len());
    let vectors = cea::right_vectors(system, starts, &mut Workspace::default())?;
    let mut w: Vec<Vec<Long>> = Vec::with_capacity(k);
    for (x, &start) in vectors.iter().zip(starts) {
        let drive = system.internal.drive.map(Complex::from) * x;
        let z = (0..s).map(|i| start * drive[i] / (start + system.internal.decay[i]));
        w.push(x.iter().copied().chain(z).map(long).collect());
    }
    let mut small: Vec<Vec<Long>> =
        (0..k).map(|j| (0..k).map(|i| long(if i == j { starts[j] } else { Complex::default() })).collect()).collect();
    let mut left = f64::INFINITY;
    for _ in 0..MOST_NEWTON_STEPS {
        let centre = (0..k).map(|j| short(small[j][j])).sum::<Complex<f64>>() / k as f64;
        let rounded: Vec<_> = w.iter().map(|c| DVector::from_iterator(n + s, c.iter().map(|&v| short(v)))).collect();
        let mut matrix = bordered(system, centre, &rounded);
        let rows: Vec<f64> = (0..n + s + k).map(|i| matrix.row(i).norm()).collect();
        matrix.row_iter_mut().zip(&rows).for_each(|(mut row, norm)| row /= Complex::from(*norm));
        let factor = matrix.lu();
        let next = product(&w, &small);
        let residuals: Vec<_> = residuals(system, &w, &next, &product(&next, &small))
            .into_iter()
            .map(|r| -r.insert_rows(n + s, k, Complex::default()))
            .collect();
        let mut square = 0.0;
        for (j, mut right) in residuals.into_iter().enumerate() {
            right.iter_mut().zip(&rows).for_each(|(r, norm)| *r /= norm);
            if !factor.solve_mut(&mut right) {
                return Err(ValidationError::NoConvergence {
                    what: "a refined eigenvalue",
                    left,
                    steps: MOST_NEWTON_STEPS,
                });
            }
            w[j].iter_mut().zip(right.iter()).for_each(|(v, &d)| *v += long(d));
            small[j].iter_mut().zip(right.iter().skip(n + s)).for_each(|(v, &d)| *v += long(d));
            square += right.rows(n + s, k).norm_squared();
        }
        left = square.sqrt() / centre.norm().max(f64::MIN_POSITIVE);
        if left <= LAST_STEP || !left.is_finite() {
            break;
        }
    }
    if left.is_nan() || left > LARGEST_LAST_STEP {
        return Err(ValidationError::NoConvergence { what: "a refined eigenvalue", left, steps: MOST_NEWTON_STEPS });
    }
    let failed = || ValidationError::NoConvergence { what: "a multiple eigenvalue", left, steps: MOST_NEWTON_STEPS };
    let lambdas = small_eigenvalues(&small).ok_or_else(failed)?;
    lambdas
        .iter()
        .map(|&lambda| Ok(RefinedEigenvalue { lambda, condition: condition(system, lambda, &lambdas)? }))
        .collect()
}

/// The eigenvalues of S, given by columns; `None` where its Schur form does not converge.
fn small_eigenvalues(small: &[Vec<Long>]) -> Option<Vec<Complex<f64>>> {
    let k = small.len();
    match small {
        [a, b] => {
            let half = long(Complex::from(0.5));
            let (mean, difference) = ((a[0] + b[1]) * half, (a[0] - b[1]) * half);
            let root = short(difference * difference + a[1] * b[0]).sqrt();
            Some(vec![short(mean + long(root)), short(mean - long(root))])
        }
        [a] => Some(vec![short(a[0])]),
        // The differences from the mean are small, so that the errors of their eigenvalues are small too.
        _ => {
            let of_mean = Long::new(TwoFloat::from(1.0 / k as f64), TwoFloat::from(0.0));
            let mean = (0..k).fold(long(Complex::default()), |sum, j| sum + small[j][j]) * of_mean;
            let offset = |i: usize, j: usize| short(if i == j { small[j][j] - mean } else { small[j][i] });
            let schur = Schur::try_new(DMatrix::from_fn(k, k, offset), f64::EPSILON, 100 * k)?;
            Some(schur.eigenvalues()?.iter().map(|&d| short(mean + long(d))).collect())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use linsys::Internal;
    use nalgebra::{dmatrix, dvector};

    #[test]
    fn a_real_part_far_below_the_rounding_of_lambda_is_found() {
        // lambda^2 + 2 d lambda + 1 = 0: Re lambda = -d.
        let d = 1e-21;
        let system = SecondOrder::new(dmatrix![1.0], dmatrix![2.0 * d], dmatrix![1.0]).unwrap();
        let refined = refine(&system, Complex::new(1e-12, 1.0 + 1e-12)).unwrap();
        assert!((refined.lambda.re + d).abs() < 1e-6 * d, "{}", refined.lambda);
        // |lambda|^2 m + |lambda| c + k over |lambda| |2 lambda m + c|.
        assert!((refined.condition - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_cubic_of_a_maxwell_element_is_solved_to_the_last_bits() {
        let internal = Internal { decay: dvector![3.0], drive: dmatrix![1.0], force: dmatrix![-5.0] };
        let system = SecondOrder::with_internal(dmatrix![1.0], dmatrix![0.0], dmatrix![4.0], internal).unwrap();
        // (l^2 + 4)(l + 3) + 5 l = l^3 + 3 l^2 + 9 l + 12: the real root of the cubic is -2 + ..., the pair follows.
        let spectrum = cea::EigenSolver::eigenvalues(&cea::QrSolver, &system, &mut Workspace::default()).unwrap();
        let roots: Vec<_> = spectrum.eigenvalues.iter().map(|&l| refine(&system, l).unwrap().lambda).collect();
        let sum: Complex<f64> = roots.iter().sum();
        let product: Complex<f64> = roots.iter().product();
        assert!((sum + 3.0).norm() < 2e-15 && (product + 12.0).norm() < 1e-14);
    }

    #[test]
    fn a_double_eigenvalue_is_refined_as_a_pair() {
        // Two equal, uncoupled oscillators in coordinates in which M, C and K are full.
        let system =
            SecondOrder::new(dmatrix![2.0, 1.0; 1.0, 2.0], dmatrix![0.2, 0.1; 0.1, 0.2], dmatrix![6.0, 3.0; 3.0, 6.0])
                .unwrap();
        let exact = Complex::new(-0.05, (3.0_f64 - 0.0025).sqrt());
        for refined in refine_all(&system, &[exact + 1e-9, exact - 1e-9]).unwrap() {
            assert!((refined.lambda - exact).norm() < 1e-15, "{refined:?}");
            assert!(refined.condition < 10.0);
        }
    }

    #[test]
    fn three_eigenvalues_that_differ_in_their_last_digits_are_told_apart() {
        // K = I + 1e-11 diag(0, 1, 2) in turned coordinates.
        let axis = DVector::from_vec(vec![0.6, 0.48, 0.64]);
        let turn = DMatrix::identity(3, 3) - &axis * axis.transpose() * 2.0;
        let offsets = DMatrix::from_diagonal(&DVector::from_vec(vec![0.0, 1e-11, 2e-11]));
        let k = DMatrix::identity(3, 3) + &turn * offsets * &turn;
        let system = SecondOrder::new(DMatrix::identity(3, 3), DMatrix::zeros(3, 3), k).unwrap();
        let starts = [0.0, 0.5e-11, 1e-11].map(|d| Complex::new(1e-12, 1.0 + d));
        let mut found: Vec<f64> = refine_block(&system, &starts).unwrap().iter().map(|r| r.lambda.im - 1.0).collect();
        found.sort_by(f64::total_cmp);
        for (found, exact) in found.into_iter().zip([0.0, 0.5e-11, 1e-11]) {
            assert!((found - exact).abs() < 1e-15, "{found:e} {exact:e}");
        }
    }

    #[test]
    fn a_defective_eigenvalue_is_infinitely_ill_conditioned() {
        let system =
            SecondOrder::new(DMatrix::identity(2, 2), DMatrix::zeros(2, 2), dmatrix![4.0, 1.0; 0.0, 4.0]).unwrap();
        let refined = refine(&system, Complex::new(0.0, 2.0 + 1e-9));
        assert!(refined.is_err() || refined.is_ok_and(|r| r.condition > 1e12));
    }
}
