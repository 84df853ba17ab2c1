//! The eigenvalues of a spectrum as a stability analysis counts them, those on the axis told apart from both sides.

use linsys::SecondOrder;
use num_complex::Complex;

use super::Threshold;
use super::screen::{Judge, NEAR_AXIS};
use crate::{CeaError, Eigentriple, Spectrum, Verdict, Workspace};

/// Distance from the axis, as a part of [`Spectrum::scale`], up to which an eigenvalue is on it: above what a projection and a
/// solver leave of an undamped mode, and below any growth that a measurement could show; chosen.
const ON_AXIS: f64 = 1e-12;
/// Distance up to which an eigenvalue near the axis is on it, in units of [`Eigentriple::rounding`]; chosen: matrices of a body that is free
/// to move are assembled with some roundings, which make its double zero a pair of either kind.
const ROUNDED_DATA: f64 = 32.0;
/// Largest |Im lambda| / |lambda| of two real eigenvalues that rounding has made a pair; chosen: where a pair becomes two real
/// eigenvalues Im lambda grows with the root of the distance, so that the place moves by the square of this.
const STILL_REAL: f64 = 1e-7;

/// Eigenvalues of a system with Im lambda >= 0, by whether they are beyond a threshold, rad/s. The sign of Re lambda is read
/// only where it is beyond what rounding may do: undamped modes, conservative gyroscopic ones and rigid motions are *on* the axis,
/// though a solver gives their real parts some sign.
///
/// A flutter pair counts as one unstable mode and each real eigenvalue above zero as one. So a growing mode that loses its
/// frequency becomes two diverging ones.
///
/// ```
/// use cea::{CountedSpectrum, EigenSolver, QrSolver, Threshold, Workspace};
/// use linsys::SecondOrder;
/// use nalgebra::{DMatrix, dmatrix};
///
/// // Two undamped modes that friction couples flutter from mu = 0.5 on. Below, both are on the axis.
/// let mut work = Workspace::default();
/// let mut counted = |mu: f64| -> Result<_, Box<dyn std::error::Error>> {
///     let k = dmatrix![3.0, -1.0 + 4.0 * mu; -1.0, 5.0];
///     let system = SecondOrder::new(DMatrix::identity(2, 2), DMatrix::zeros(2, 2), k)?;
///     let spectrum = QrSolver.eigenvalues(&system, &mut work)?;
///     Ok(CountedSpectrum::new(&Threshold::AXIS, &system, &spectrum, &mut work)?)
/// };
/// let (below, above) = (counted(0.4)?, counted(0.6)?);
/// assert_eq!((below.unstable(), below.marginal.len()), (0, 2));
/// assert_eq!((above.flutter.len(), above.divergence.len(), above.marginal.len()), (1, 0, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CountedSpectrum {
    /// Oscillating and beyond the threshold, ascending in frequency, rad/s.
    pub flutter: Vec<Complex<f64>>,
    /// Real and beyond it, ascending, 1/s.
    pub divergence: Vec<f64>,
    /// On it to within rounding: neither growing nor decaying where the threshold is the axis.
    pub marginal: Vec<Complex<f64>>,
    /// Not beyond it.
    pub below: Vec<Complex<f64>>,
    /// Number of eigenvalues whose bound leaves their side open though they are not next to the threshold; they are counted by
    /// the side that they are computed on.
    pub open: usize,
}

impl CountedSpectrum {
    /// Counts the eigenvalues of the spectrum of a system.
    ///
    /// # Errors
    /// Errors of the bound of a single eigenvalue, but that it has no vector: its side is open then.
    pub fn new(
        threshold: &Threshold,
        system: &SecondOrder,
        spectrum: &Spectrum,
        work: &mut Workspace,
    ) -> Result<Self, CeaError> {
        let (mut counted, mut judge) = (Self::default(), Judge::new(system, spectrum));
        for &lambda in spectrum.eigenvalues.iter().filter(|lambda| lambda.im >= 0.0) {
            let margin = threshold.margin(lambda);
            let is_near = margin.abs() <= NEAR_AXIS * spectrum.scale;
            let tolerance = if is_near { tolerance(system, lambda, spectrum.scale, work) } else { 0.0 };
            let verdict = if margin.abs() <= tolerance {
                Verdict::Marginal { tolerance }
            } else if judge.is_clear(lambda, threshold) {
                threshold.verdict(lambda, 0.0)
            } else {
                match judge.bounded(lambda, work) {
                    Ok(judged) if threshold.is_axis() => judged.verdict,
                    Ok(judged) => threshold.verdict(judged.lambda, judged.bound),
                    Err(CeaError::NoEigenvector { .. }) => Verdict::Undecided { bound: f64::INFINITY },
                    Err(other) => return Err(other),
                }
            };
            let is_beyond = match verdict {
                Verdict::Unstable => Some(true),
                Verdict::Stable => Some(false),
                Verdict::Marginal { .. } => None,
                Verdict::Undecided { .. } if is_near => None,
                Verdict::Undecided { .. } => {
                    counted.open += 1;
                    Some(margin > 0.0)
                }
            };
            counted.enter(lambda, is_beyond);
        }
        counted.divergence.sort_by(f64::total_cmp);
        Ok(counted)
    }

    fn enter(&mut self, lambda: Complex<f64>, is_beyond: Option<bool>) {
        let is_two = lambda.im > 0.0 && lambda.im <= STILL_REAL * lambda.norm();
        let Some(is_beyond) = is_beyond else {
            self.marginal.push(lambda);
            return;
        };
        match (is_beyond, is_two) {
            (true, false) if lambda.im > 0.0 => self.flutter.push(lambda),
            (true, false) => self.divergence.push(lambda.re),
            (true, true) => self.divergence.extend([lambda.re; 2]),
            (false, false) => self.below.push(lambda),
            (false, true) => self.below.extend([Complex::from(lambda.re); 2]),
        }
    }

    /// Unstable modes: a flutter pair counts once, each diverging real eigenvalue once.
    #[must_use]
    pub fn unstable(&self) -> usize {
        self.flutter.len() + self.divergence.len()
    }
}

/// Distance from the axis, rad/s, up to which an eigenvalue next to it is on it.
fn tolerance(system: &SecondOrder, lambda: Complex<f64>, scale: f64, work: &mut Workspace) -> f64 {
    let rounding = Eigentriple::new(system, lambda, work).map_or(0.0, |triple| triple.rounding());
    (ON_AXIS * scale).max(ROUNDED_DATA * rounding)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EigenSolver, QrSolver};
    use nalgebra::{DMatrix, dmatrix};

    fn counted(m: DMatrix<f64>, c: DMatrix<f64>, k: DMatrix<f64>) -> CountedSpectrum {
        let (system, mut work) = (SecondOrder::new(m, c, k).unwrap(), Workspace::default());
        let spectrum = QrSolver.eigenvalues(&system, &mut work).unwrap();
        CountedSpectrum::new(&Threshold::AXIS, &system, &spectrum, &mut work).unwrap()
    }

    #[test]
    fn rigid_motions_and_undamped_modes_are_on_the_axis() {
        // A free chain of n masses, with and without dashpots between them.
        for n in 2..=12 {
            let chain = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
                0 => 1.0 + f64::from(i > 0 && i + 1 < n),
                1 => -1.0,
                _ => 0.0,
            });
            let masses = DMatrix::from_diagonal(&nalgebra::DVector::from_fn(n, |i, _| 1.0 + 0.3 * i as f64));
            for damping in [0.0, 1e-3, 0.1] {
                let found = counted(masses.clone(), &chain * damping, &chain * 1e6);
                assert_eq!(found.unstable(), 0, "{n} {damping} {found:?}");
                let rigid = found.marginal.iter().filter(|lambda| lambda.norm() < 1e-2).count();
                assert!((1..=2).contains(&rigid), "{n} {damping} {found:?}");
                let all = found.marginal.len() - rigid;
                assert_eq!(all, if damping == 0.0 { n - 1 } else { 0 }, "{n} {damping} {found:?}");
                // Rows that sum to zero but for roundings of either sign.
                for bits in [-4.0, -1.0, 1.0, 4.0] {
                    let mut rounded = &chain * 1e6;
                    rounded[(0, 1)] *= 1.0 + bits * f64::EPSILON;
                    assert_eq!(
                        counted(masses.clone(), &chain * damping, rounded).unstable(),
                        0,
                        "{n} {damping} {bits}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_conservative_gyroscopic_system_is_on_the_axis_and_one_that_is_driven_is_not() {
        let gyroscopic = dmatrix![0.0, 3.0, 0.5; -3.0, 0.0, 0.7; -0.5, -0.7, 0.0];
        let k = dmatrix![4.0, 0.3, 0.0; 0.3, 5.0, 0.2; 0.0, 0.2, 6.0];
        let found = counted(DMatrix::identity(3, 3), gyroscopic.clone(), k.clone());
        assert_eq!((found.unstable(), found.marginal.len()), (0, 3), "{found:?}");
        let driven = gyroscopic - DMatrix::identity(3, 3) * 1e-6;
        assert_eq!(counted(DMatrix::identity(3, 3), driven, k).flutter.len(), 3);
    }

    #[test]
    fn divergence_counts_each_real_eigenvalue_and_equal_parts_stay_real() {
        let found = counted(dmatrix![1.0], dmatrix![-2.2], dmatrix![1.0]);
        assert_eq!((found.flutter.len(), found.divergence.len()), (0, 2), "{found:?}");
        // Equal parts that diverge, mixed by a rotation.
        let (s, c) = 0.7f64.sin_cos();
        let turn = dmatrix![c, -s, 0.0; s, c, 0.0; 0.0, 0.0, 1.0];
        let k = &turn * DMatrix::from_diagonal(&nalgebra::dvector![-9.0, -9.0, 4.0]) * turn.transpose();
        let found = counted(DMatrix::identity(3, 3), DMatrix::identity(3, 3) * 0.1, k);
        assert_eq!((found.flutter.len(), found.divergence.len()), (0, 2), "{found:?}");
    }
}
