//! The scalar route: QR iteration on the scaled standard form.

use linsys::SecondOrder;

use crate::{CeaError, EigenSolver, Spectrum, StandardForm, Workspace, francis, sort};

/// QR steps allowed per eigenvalue: LAPACK's cap. A healthy matrix takes 2 to 4; clusters of equal bristles have been
/// seen to take more than 60.
const MOST_STEPS: usize = 300;

/// One system at a time by Francis' QR iteration on the [`StandardForm`], with a cap on its steps.
///
/// ```
/// use cea::{EigenSolver, QrSolver, Workspace};
/// use nalgebra::dmatrix;
///
/// // Two masses, friction couples their stiffness: K is not symmetric, and one pair of modes flutters.
/// let system = linsys::SecondOrder::new(
///     dmatrix![1.0, 0.0; 0.0, 1.0],
///     dmatrix![0.0, 0.0; 0.0, 0.0],
///     dmatrix![10.0, 3.0; -3.0, 12.0],
/// )?;
/// let spectrum = QrSolver.eigenvalues(&system, &mut Workspace::default())?;
/// assert_eq!(spectrum.oscillatory().filter(|l| l.re > 0.0).count(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, Default)]
pub struct QrSolver;

impl EigenSolver for QrSolver {
    fn eigenvalues(&self, system: &SecondOrder, work: &mut Workspace) -> Result<Spectrum, CeaError> {
        let StandardForm { state, gamma, .. } = StandardForm::new(system)?;
        let dimension = state.nrows();
        let scale = gamma * state.norm();
        work.counters.eigenvalue_solves += 1;
        let failed = CeaError::NoConvergence { iterations: MOST_STEPS, dimension };
        let mut eigenvalues = francis::eigenvalues(state, MOST_STEPS).ok_or(failed)?;
        eigenvalues.iter_mut().for_each(|sigma| *sigma *= gamma);
        sort(&mut eigenvalues);
        Ok(Spectrum { eigenvalues, scale })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use linsys::Internal;
    use nalgebra::{DMatrix, dmatrix, dvector};
    use num_complex::Complex;

    fn eigenvalues(system: &SecondOrder) -> Vec<Complex<f64>> {
        QrSolver.eigenvalues(system, &mut Workspace::default()).unwrap().eigenvalues
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
    fn a_zero_system_has_zero_eigenvalues_and_does_not_hang() {
        let zero = DMatrix::zeros(2, 2);
        let system = SecondOrder::new(DMatrix::identity(2, 2), zero.clone(), zero).unwrap();
        assert!(eigenvalues(&system).iter().all(|l| l.norm() == 0.0));
    }
}
