//! The scalar route: QR iteration on the scaled standard form.

use certified::francis;
use linsys::SecondOrder;

use crate::{CeaError, EigenSolver, Spectrum, StandardForm, Workspace, sort};

/// Most QR steps per eigenvalue: LAPACK's limit. Most matrices take 2 to 4; clusters of equal internal states have been seen
/// to take more than 60.
pub(crate) const MOST_QR_STEPS: usize = 300;

/// Solver of all eigenvalues of a system by Francis' QR iteration on the [`StandardForm`], with a limit on its steps.
///
/// Internal states much faster than the vibrations are split off first. Where dashpots are a hundred times faster, the
/// iteration has no digits left for slow eigenvalues: [`certified::solve`] takes its place, refined, up to a
/// hundred times slower; a [`Workspace`] may bound how often.
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
        let form = StandardForm::new(system)?;
        let gamma = form.gamma;
        let scale = gamma * form.state.norm();
        let ratio = form.steepness();
        // Nor does the iteration end where ties are 1e12 times as stiff as what vibrates: rounding of theirs is all that it sees.
        let fast = form.into_blocks().and_then(|blocks| {
            let of_block = |block| francis::eigenvalues(block, MOST_QR_STEPS);
            Some(blocks.into_iter().map(of_block).collect::<Option<Vec<_>>>()?.concat())
        });
        let mut eigenvalues = match fast {
            Some(sigmas) => {
                work.counters.eigenvalue_solves += 1;
                sigmas.into_iter().map(|sigma| sigma * gamma).collect()
            }
            None => {
                let solves = work.counters.certified_solves;
                if work.most_certified_solves.is_some_and(|most| solves >= most) {
                    return Err(CeaError::TooStiff { ratio, solves });
                }
                work.counters.certified_solves += 1;
                let spectrum = work.counting(|counters| certified::solve(system, counters))?;
                work.counting(|counters| certified::improved(system, &spectrum, counters))?
            }
        };
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
    fn internal_states_are_massless_degrees_of_freedom_without_infinite_eigenvalues() {
        let internal = Internal { decay: dvector![3.0, 0.5], drive: dmatrix![1.0; 2.0], force: dmatrix![-5.0, 0.3] };
        let system = SecondOrder::with_internal(dmatrix![1.0], dmatrix![0.1], dmatrix![4.0], internal).unwrap();
        let general = certified::solve(&system, &mut certified::Counters::default()).unwrap();
        let standard = eigenvalues(&system);
        assert_eq!(general.infinite, 0);
        assert_eq!(general.eigenvalues.len(), 4);
        for (a, b) in general.eigenvalues.iter().zip(standard) {
            assert!((a - b).norm() < 1e-13);
        }
    }

    #[test]
    fn a_dashpot_however_strong_keeps_the_digits_of_the_slow_eigenvalue() {
        for c in [1e3, 1e6, 1e9, 1e12_f64] {
            // Two oscillators, the second with lambda^2 + c lambda + 3 = 0.
            let (damping, stiffness) = (dmatrix![0.0, 0.0; 0.0, c], dmatrix![2.0, 0.0; 0.0, 3.0]);
            let found = eigenvalues(&SecondOrder::new(DMatrix::identity(2, 2), damping, stiffness).unwrap());
            let slow = -6.0 / (c + (c * c - 12.0).sqrt());
            let nearest = |l: f64| found.iter().map(|f| ((f - l) / l).norm()).fold(f64::INFINITY, f64::min);
            assert!(nearest(slow) < 1e-14 && nearest(3.0 / slow) < 1e-14, "{c:e}: {found:?}");
            assert!(found.iter().any(|l| (l - Complex::new(0.0, 2f64.sqrt())).norm() < 1e-15));
        }
    }

    #[test]
    fn a_workspace_bounds_how_often_more_digits_are_called_for() {
        let system = |c: f64| SecondOrder::new(dmatrix![1.0], dmatrix![c], dmatrix![1.0]).unwrap();
        let mut work = Workspace::with_most_certified_solves(2);
        for _ in 0..2 {
            assert!(QrSolver.eigenvalues(&system(1e6), &mut work).is_ok());
        }
        let refused = QrSolver.eigenvalues(&system(1e6), &mut work);
        assert!(matches!(refused, Err(CeaError::TooStiff { solves: 2, ratio }) if ratio > 9e5), "{refused:?}");
        // What needs none is solved as ever.
        assert!(QrSolver.eigenvalues(&system(1.0), &mut work).is_ok());
        assert_eq!(work.counters.certified_solves, 2);
    }

    #[test]
    fn a_fast_state_leaves_the_vibration_its_digits() {
        // (lambda^2 + 4)(lambda + a) - a f lambda = 0 with f = 1e-3: for large a the state acts as a dashpot of -f.
        for a in [1e4, 1e7, 1e10, 1e13] {
            let internal = Internal { decay: dvector![a], drive: dmatrix![a.sqrt()], force: dmatrix![1e-3 * a.sqrt()] };
            let system = SecondOrder::with_internal(dmatrix![1.0], dmatrix![0.0], dmatrix![4.0], internal).unwrap();
            let found = eigenvalues(&system);
            let gain = system.internal.drive[0] * system.internal.force[0];
            let vibration = found.iter().find(|l| l.im > 0.0).unwrap();
            // Newton's correction of the equation with the state eliminated, which has no large coefficients.
            let q = vibration * vibration + 4.0 - vibration * gain / (vibration + a);
            assert!((q / (2.0 * vibration)).norm() < 2e-15, "{a:e}: {q}");
        }
    }

    #[test]
    fn a_zero_system_has_zero_eigenvalues_and_does_not_hang() {
        let zero = DMatrix::zeros(2, 2);
        let system = SecondOrder::new(DMatrix::identity(2, 2), zero.clone(), zero).unwrap();
        assert!(eigenvalues(&system).iter().all(|l| l.norm() == 0.0));
    }
}
