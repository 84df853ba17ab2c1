//! The condition number of an eigenvalue, and the backward error of a number as an eigenvalue.

use cea::Workspace;
use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use crate::ValidationError;

/// [`crate::RefinedEigenvalue::condition`]; `together` are the eigenvalues refined together with `lambda`.
pub(crate) fn condition(
    system: &SecondOrder,
    lambda: Complex<f64>,
    together: &[Complex<f64>],
) -> Result<f64, ValidationError> {
    let mut work = Workspace::default();
    let right = cea::right_vectors(system, together, &mut work)?;
    let left = cea::right_vectors(&system.transposed(), together, &mut work)?;
    let derivative = system.dynamic_stiffness_derivative(lambda);
    let k = together.len();
    let slope = DMatrix::from_fn(k, k, |i, j| left[i].dot(&(&derivative * &right[j])));
    Ok(size(system, lambda) / (lambda.norm() * slope.singular_values().min()))
}

/// `|lambda|^2 |M| + |lambda| |C| + |K|` and the terms of the internal states: the change of Q(lambda) by relative changes of
/// order one of M, C, K, E, F and a. The gain lambda / (lambda + a) of a state changes by its `|a / (lambda + a)|`-fold.
fn size(system: &SecondOrder, lambda: Complex<f64>) -> f64 {
    let l = lambda.norm();
    let states = (0..system.states()).map(|s| {
        let (decay, sum) = (system.internal.decay[s], (lambda + system.internal.decay[s]).norm());
        l / sum
            * (1.0 + decay.abs() / sum)
            * system.internal.drive.row(s).norm()
            * system.internal.force.column(s).norm()
    });
    l * l * system.m.norm() + l * system.c.norm() + system.k.norm() + states.sum::<f64>()
}

/// The smallest normwise backward error with which `lambda` is an eigenvalue: the least singular value of Q(lambda) over
/// the size of its terms.
pub(crate) fn least_backward_error(system: &SecondOrder, lambda: Complex<f64>) -> f64 {
    least_singular_value(system.dynamic_stiffness(lambda)) / size(system, lambda).max(f64::MIN_POSITIVE)
}

/// The least singular value, by inverse iteration with Q and its adjoint in turn; 0 where Q is exactly singular.
fn least_singular_value(q: DMatrix<Complex<f64>>) -> f64 {
    let mut x = DVector::from_fn(q.nrows(), |i, _| Complex::from_polar(1.0, ((i + 1) * (i + 2)) as f64)).normalize();
    let (adjoint, factor) = (q.adjoint().lu(), q.lu());
    let mut least = f64::INFINITY;
    for _ in 0..3 {
        for side in [&adjoint, &factor] {
            if !side.solve_mut(&mut x) {
                return 0.0;
            }
            least = least.min(1.0 / x.norm());
            x.normalize_mut();
        }
    }
    least
}
