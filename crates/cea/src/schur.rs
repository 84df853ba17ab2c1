//! The scalar route: real Schur form of the scaled standard form.

use linsys::SecondOrder;
use nalgebra::linalg::Schur;
use nalgebra::{DMatrix, DVector};

use crate::{CeaError, EigenSolver, Spectrum, StandardForm, Workspace, sort};

/// QR steps allowed per eigenvalue; a healthy matrix takes 2 to 4.
const STEPS_PER_EIGENVALUE: usize = 40;
/// Starts from which the iteration is tried.
const ATTEMPTS: usize = 4;

/// One system at a time by nalgebra's QR iteration on the [`StandardForm`], with a cap on its steps.
///
/// ```
/// use cea::{EigenSolver, SchurSolver, Workspace};
/// use nalgebra::dmatrix;
///
/// // Two masses, friction couples their stiffness: K is not symmetric, and one pair of modes flutters.
/// let system = linsys::SecondOrder::new(
///     dmatrix![1.0, 0.0; 0.0, 1.0],
///     dmatrix![0.0, 0.0; 0.0, 0.0],
///     dmatrix![10.0, 3.0; -3.0, 12.0],
/// )?;
/// let spectrum = SchurSolver.eigenvalues(&system, &mut Workspace::default())?;
/// assert_eq!(spectrum.oscillatory().filter(|l| l.re > 0.0).count(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, Default)]
pub struct SchurSolver;

impl EigenSolver for SchurSolver {
    fn eigenvalues(&self, system: &SecondOrder, work: &mut Workspace) -> Result<Spectrum, CeaError> {
        let StandardForm { state, gamma, .. } = StandardForm::new(system)?;
        let dimension = state.nrows();
        let scale = gamma * state.norm();
        let cap = STEPS_PER_EIGENVALUE * dimension;
        work.counters.eigenvalue_solves += 1;
        for attempt in 0..ATTEMPTS {
            let start = if attempt == 0 { state.clone() } else { reflected(&state, attempt) };
            let Some(schur) = Schur::try_new(start, f64::EPSILON, cap) else { continue };
            let mut eigenvalues: Vec<_> = schur.complex_eigenvalues().iter().map(|sigma| sigma * gamma).collect();
            if eigenvalues.iter().all(|l| l.re.is_finite() && l.im.is_finite()) {
                sort(&mut eigenvalues);
                return Ok(Spectrum { eigenvalues, scale });
            }
        }
        Err(CeaError::NoConvergence { iterations: ATTEMPTS * cap, dimension })
    }
}

/// `H A H` with a Householder reflection H: the same eigenvalues from another start.
///
/// nalgebra's iteration has no exceptional shifts, and on symmetric structures it can run in circles.
fn reflected(state: &DMatrix<f64>, attempt: usize) -> DMatrix<f64> {
    let n = state.nrows();
    let axis = DVector::from_fn(n, |i, _| (1.3 * (i + 1) as f64 * (attempt + 1) as f64).sin()).normalize();
    let left = state - &axis * (axis.transpose() * state) * 2.0;
    &left - (&left * &axis) * axis.transpose() * 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use linsys::Internal;
    use nalgebra::{DMatrix, dmatrix, dvector};
    use num_complex::Complex;

    fn eigenvalues(system: &SecondOrder) -> Vec<Complex<f64>> {
        SchurSolver.eigenvalues(system, &mut Workspace::default()).unwrap().eigenvalues
    }

    #[test]
    fn a_damped_oscillator_has_its_textbook_eigenvalues() {
        let (m, c, k): (f64, f64, f64) = (0.39, 181.0, 2.45e7);
        let system = SecondOrder::new(dmatrix![m], dmatrix![c], dmatrix![k]).unwrap();
        let expected = Complex::new(-c / (2.0 * m), (k / m - (c / (2.0 * m)).powi(2)).sqrt());
        let found = eigenvalues(&system);
        assert_eq!(found.len(), 2);
        assert!((found[1] - expected).norm() < 1e-14 * expected.norm());
        assert_eq!(found[0], found[1].conj());
    }

    #[test]
    fn a_maxwell_element_solves_its_cubic() {
        // u'' + 4 u = -5 z, z' = -3 z + u': (l^2 + 4)(l + 3) + 5 l = 0.
        let internal = Internal { decay: dvector![3.0], drive: dmatrix![1.0], force: dmatrix![-5.0] };
        let system = SecondOrder::with_internal(dmatrix![1.0], dmatrix![0.0], dmatrix![4.0], internal).unwrap();
        for l in eigenvalues(&system) {
            assert!(((l * l + 4.0) * (l + 3.0) + l * 5.0).norm() < 1e-13);
        }
    }

    #[test]
    fn another_start_has_the_same_eigenvalues() {
        let state = DMatrix::from_fn(7, 7, |i, j| ((3 * i + 5 * j) % 7) as f64 - 2.5);
        let sorted = |m: &DMatrix<f64>| {
            let mut values: Vec<_> = m.complex_eigenvalues().iter().copied().collect();
            sort(&mut values);
            values
        };
        for (a, b) in sorted(&state).into_iter().zip(sorted(&reflected(&state, 1))) {
            assert!((a - b).norm() < 1e-12, "{a} {b}");
        }
    }

    #[test]
    fn a_zero_system_has_zero_eigenvalues_and_does_not_hang() {
        let zero = DMatrix::zeros(2, 2);
        let system = SecondOrder::new(DMatrix::identity(2, 2), zero.clone(), zero).unwrap();
        assert!(eigenvalues(&system).iter().all(|l| l.norm() == 0.0));
    }
}
