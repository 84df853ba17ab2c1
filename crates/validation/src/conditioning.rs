//! How sensitive an eigenvalue is, and how near a number is to being one.

use cea::Workspace;
use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use crate::ValidationError;

/// The condition number of [`crate::RefinedEigenvalue::condition`]; `together` are the eigenvalues of the pair, or the one.
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

/// `|lambda|^2 |M| + |lambda| |C| + |K|` and the states' share: what relative changes of M, C, K, E, F and a amount to in
/// Q(lambda). A state's gain g = lambda / (lambda + a) changes by `|a / (lambda + a)|` of itself.
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

/// By inverse iteration from both sides in turn; 0 where the factorisation finds an exact zero.
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
