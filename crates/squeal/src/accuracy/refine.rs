//! Eigenvalues to more digits than a double has, as references: Newton's method on (lambda, x) with the residual in
//! double-double arithmetic.
//!
//! Internal states stay in the vector, `w = (x, z)`, so that the equations are polynomial:
//!
//! ```text
//! (lambda^2 M + lambda C + K) x - F z = 0,   (lambda + a) z - lambda E x = 0,   w_0^H w = 1
//! ```
//!
//! The matrix of the Newton steps is factored in double precision; only the residual decides where they end (Tisseur, SIAM
//! J. Matrix Anal. Appl. 22, 2001). For a simple eigenvalue the result is right to the last bit or the one before it.

use cea::Workspace;
use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use twofloat::TwoFloat;

use super::AccuracyError;

type Long = Complex<TwoFloat>;

/// Newton steps; each gains the digits that the factorisation is good for.
const MOST_STEPS: usize = 30;
/// Relative size of the last step.
const SETTLED: f64 = 1e-22;

/// A simple eigenvalue known better than any double-precision solver can know it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Refined {
    /// lambda, rad/s, each part rounded to a double.
    pub lambda: Complex<f64>,
    /// Normwise relative condition number `(|lambda|^2 |M| + |lambda| |C| + |K|) |psi| |phi| / (|lambda| |psi^H Q' phi|)`
    /// (Tisseur, Linear Algebra Appl. 309, 2000, theorem 5).
    pub condition: f64,
}

/// Refines the eigenvalue nearest to `start`.
///
/// # Errors
/// [`AccuracyError::NoConvergence`] for a multiple eigenvalue or a start that is none.
pub fn refine(system: &SecondOrder, start: Complex<f64>) -> Result<Refined, AccuracyError> {
    let (n, s) = (system.order(), system.states());
    let mut work = Workspace::default();
    let x = cea::right_vector(system, start, &mut work)?;
    let drive = system.internal.drive.map(Complex::from) * &x;
    let z = DVector::from_fn(s, |i, _| start * drive[i] / (start + system.internal.decay[i]));
    let mut w: Vec<Long> = x.iter().chain(z.iter()).map(|&v| long(v)).collect();
    let mut lambda = long(start);
    let mut left = f64::INFINITY;
    for step in 0..MOST_STEPS {
        let vector = DVector::from_iterator(n + s, w.iter().map(|&v| short(v)));
        let bordered = bordered(system, short(lambda), &vector);
        let rows = DVector::from_fn(n + s + 1, |i, _| bordered.row(i).norm());
        let scaled = DMatrix::from_fn(n + s + 1, n + s + 1, |i, j| bordered[(i, j)] / rows[i]);
        let mut right = -residual(system, lambda, &w).insert_row(n + s, Complex::default());
        right.iter_mut().zip(rows.iter()).for_each(|(r, row)| *r /= row);
        let Some(change) = scaled.lu().solve(&right) else { break };
        w.iter_mut().zip(change.iter()).for_each(|(v, &d)| *v += long(d));
        lambda += long(change[n + s]);
        left = change[n + s].norm() / start.norm().max(f64::MIN_POSITIVE);
        if left <= SETTLED {
            break;
        }
        if !left.is_finite() {
            return Err(AccuracyError::NoConvergence { what: "a refined eigenvalue", left, steps: step + 1 });
        }
    }
    if left > SETTLED {
        return Err(AccuracyError::NoConvergence { what: "a refined eigenvalue", left, steps: MOST_STEPS });
    }
    let lambda = short(lambda);
    Ok(Refined { lambda, condition: condition(system, lambda, &mut work)? })
}

/// The condition number of [`Refined::condition`].
fn condition(system: &SecondOrder, lambda: Complex<f64>, work: &mut Workspace) -> Result<f64, AccuracyError> {
    let (right, left) = (cea::right_vector(system, lambda, work)?, cea::left_vector(system, lambda, work)?);
    let slope = left.dotc(&(system.dynamic_stiffness_derivative(lambda) * &right));
    Ok(size(system, lambda) / (lambda.norm() * slope.norm()))
}

/// `|lambda|^2 |M| + |lambda| |C| + |K|` and the states' share: the size of the terms of Q(lambda).
pub(super) fn size(system: &SecondOrder, lambda: Complex<f64>) -> f64 {
    let l = lambda.norm();
    let states = (0..system.states()).map(|s| {
        let gain = (lambda / (lambda + system.internal.decay[s])).norm();
        gain * system.internal.drive.row(s).norm() * system.internal.force.column(s).norm()
    });
    l * l * system.m.norm() + l * system.c.norm() + system.k.norm() + states.sum::<f64>()
}

/// The smallest normwise backward error with which `lambda` is an eigenvalue: the least singular value of Q(lambda) over
/// the size of its terms.
pub(super) fn least_backward_error(system: &SecondOrder, lambda: Complex<f64>) -> f64 {
    let values = system.dynamic_stiffness(lambda).singular_values();
    values.min() / size(system, lambda).max(f64::MIN_POSITIVE)
}

/// The Jacobian of the equations, (n + s + 1) x (n + s + 1).
fn bordered(system: &SecondOrder, lambda: Complex<f64>, w: &DVector<Complex<f64>>) -> DMatrix<Complex<f64>> {
    let (n, s) = (system.order(), system.states());
    let mut matrix = DMatrix::zeros(n + s + 1, n + s + 1);
    let square = lambda * lambda;
    for j in 0..n {
        for i in 0..n {
            matrix[(i, j)] = square * system.m[(i, j)] + lambda * system.c[(i, j)] + system.k[(i, j)];
            matrix[(i, n + s)] += (2.0 * lambda * system.m[(i, j)] + system.c[(i, j)]) * w[j];
        }
        for i in 0..s {
            matrix[(n + i, j)] = -lambda * system.internal.drive[(i, j)];
            matrix[(n + i, n + s)] -= system.internal.drive[(i, j)] * w[j];
            matrix[(j, n + i)] = Complex::from(-system.internal.force[(j, i)]);
        }
    }
    for i in 0..s {
        matrix[(n + i, n + i)] = lambda + system.internal.decay[i];
        matrix[(n + i, n + s)] += w[n + i];
    }
    for j in 0..n + s {
        matrix[(n + s, j)] = w[j].conj();
    }
    matrix
}

/// The left-hand sides of the equations but the last, in double-double, rounded at the end.
fn residual(system: &SecondOrder, lambda: Long, w: &[Long]) -> DVector<Complex<f64>> {
    let (n, s) = (system.order(), system.states());
    let mut sums = vec![long(Complex::default()); n + s];
    for (j, &x) in w[..n].iter().enumerate() {
        let linear = x * lambda;
        let square = linear * lambda;
        for i in 0..n {
            for (entry, factor) in [(system.m[(i, j)], square), (system.c[(i, j)], linear), (system.k[(i, j)], x)] {
                add(&mut sums[i], factor, entry);
            }
        }
        for i in 0..s {
            add(&mut sums[n + i], linear, -system.internal.drive[(i, j)]);
        }
    }
    for (i, &z) in w[n..].iter().enumerate() {
        for j in 0..n {
            add(&mut sums[j], z, -system.internal.force[(j, i)]);
        }
        add(&mut sums[n + i], z, system.internal.decay[i]);
        sums[n + i] += z * lambda;
    }
    DVector::from_iterator(n + s, sums.into_iter().map(short))
}

fn add(sum: &mut Long, factor: Long, entry: f64) {
    if entry != 0.0 {
        sum.re += factor.re * entry;
        sum.im += factor.im * entry;
    }
}

fn long(z: Complex<f64>) -> Long {
    Complex::new(TwoFloat::from(z.re), TwoFloat::from(z.im))
}

fn short(z: Long) -> Complex<f64> {
    Complex::new(f64::from(z.re), f64::from(z.im))
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
    fn a_defective_eigenvalue_is_refused() {
        let system =
            SecondOrder::new(DMatrix::identity(2, 2), DMatrix::zeros(2, 2), dmatrix![4.0, 1.0; 0.0, 4.0]).unwrap();
        assert!(refine(&system, Complex::new(0.0, 2.0 + 1e-9)).is_err());
    }
}
