//! The eigenvalues of a spectrum as a stability analysis counts them, those on the axis told apart from both sides.

use std::iter::repeat_n;

use certified::CertifiedError;
use linsys::SecondOrder;
use num_complex::Complex;

use super::Threshold;
use super::judge::{Judge, is_blunt};
use crate::{CeaError, Spectrum, Verdict, Workspace, real_count};

/// Largest frequency of a motion that may be a rigid one, as a fraction of [`Spectrum::scale`]; chosen: some times the root of epsilon.
const RIGID: f64 = 2e-7;

/// Eigenvalues of a system with Im lambda >= 0, by whether they are beyond a threshold, rad/s: the rule of [`verdicts`](crate::verdicts).
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
    /// Oscillating eigenvalues beyond the threshold, ascending in frequency, rad/s.
    pub flutter: Vec<Complex<f64>>,
    /// Real eigenvalues beyond the threshold, ascending, 1/s.
    pub divergence: Vec<f64>,
    /// Eigenvalues on the threshold to within rounding, rad/s: neither growing nor decaying where it is the axis.
    pub marginal: Vec<Complex<f64>>,
    /// Eigenvalues that are not beyond the threshold, rad/s.
    pub below: Vec<Complex<f64>>,
    /// Number of eigenvalues whose bound leaves their side open though they are not next to the threshold; they are counted by
    /// the side that they are computed on.
    pub open: usize,
    /// Vibrations among the marginal ones of which rounding leaves too few digits to tell whether they grow, rad/s: ties beside them are far stiffer.
    pub blunt: Vec<Complex<f64>>,
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
        Self::of_some(threshold, system, spectrum, |_| true, work)
    }

    /// Counts those eigenvalues of the spectrum of a system that are asked for; the sides of the others, which may take bounds to know, are not looked at.
    ///
    /// # Errors
    /// As [`CountedSpectrum::new`].
    pub fn of_some(
        threshold: &Threshold,
        system: &SecondOrder,
        spectrum: &Spectrum,
        is_asked: impl Fn(Complex<f64>) -> bool,
        work: &mut Workspace,
    ) -> Result<Self, CeaError> {
        let (mut counted, mut judge) = (Self::default(), Judge::new(system, spectrum));
        for &lambda in spectrum.eigenvalues.iter().filter(|lambda| lambda.im >= 0.0 && is_asked(**lambda)) {
            let verdict = match judge.verdict(lambda, threshold, work) {
                Err(CeaError::Certified(CertifiedError::NoEigenvector { .. })) => {
                    Verdict::Undecided { bound: f64::INFINITY }
                }
                verdict => verdict?,
            };
            let is_beyond = match verdict {
                Verdict::Unstable => Some(true),
                Verdict::Stable => Some(false),
                Verdict::Marginal { .. } => None,
                Verdict::Undecided { bound } if judge.is_near(lambda, threshold) => {
                    let vibrates = lambda.im > RIGID * spectrum.scale;
                    counted.blunt.extend((vibrates && is_blunt(lambda, bound)).then_some(lambda));
                    None
                }
                Verdict::Undecided { .. } => {
                    counted.open += 1;
                    Some(threshold.margin(lambda) > 0.0)
                }
            };
            counted.enter(lambda, is_beyond);
        }
        counted.divergence.sort_by(f64::total_cmp);
        Ok(counted)
    }

    fn enter(&mut self, lambda: Complex<f64>, is_beyond: Option<bool>) {
        let real = || repeat_n(lambda.re, real_count(lambda));
        match (is_beyond, real_count(lambda)) {
            (None, _) => self.marginal.push(lambda),
            (Some(true), 0) => self.flutter.push(lambda),
            (Some(true), _) => self.divergence.extend(real()),
            (Some(false), 0) => self.below.push(lambda),
            (Some(false), _) => self.below.extend(real().map(Complex::from)),
        }
    }

    /// Unstable modes: a flutter pair counts once, each diverging real eigenvalue once.
    #[must_use]
    pub fn unstable(&self) -> usize {
        self.flutter.len() + self.divergence.len()
    }
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

    /// Flutter beside a row of any size: a row and column scaled together change nothing, and one that is stiff by itself hides nothing that it does not touch.
    #[test]
    fn growth_beside_rows_of_any_size_is_seen_or_open() {
        for step in 0..=48 {
            let size = 10f64.powf(0.5 * f64::from(step));
            for (friction, damping) in [(1.4, 0.0), (1.1, 0.1), (2.5, 0.05), (0.5, 0.1)] {
                let grows = friction > 1.0 + 2.0 * damping * damping;
                let brake = |own: [f64; 2], coupling: f64| {
                    let [mass, stiffness] = own;
                    let k = dmatrix![2.0, 1.0 - friction, coupling; 1.0, 2.0, 0.0; coupling, 0.0, stiffness];
                    let root = mass.sqrt();
                    counted(
                        dmatrix![1.0, 0.0, 0.0; 0.0, 1.0, 0.0; 0.0, 0.0, mass],
                        dmatrix![damping, 0.0, 0.0; 0.0, damping, 0.0; 0.0, 0.0, root * damping * root],
                        k,
                    )
                };
                // A row and a column times `size`: another unit of the third displacement.
                let scaled = brake([size * size, 50.0 * size * size], 0.01 * size);
                assert_eq!(scaled.flutter.len(), usize::from(grows), "{size:e} {friction} {damping} {scaled:?}");
                // A row that is stiff and not heavy, coupled and by itself; beside one that is 1e7 times as fast vibrations are taken for rigid motions.
                for coupling in [0.0, 1.0].into_iter().filter(|_| (30.0..=1e12).contains(&size)) {
                    let stiff = brake([1.0, size], coupling);
                    let is_clear = size > 30.0;
                    let is_seen =
                        stiff.flutter.len() == usize::from(grows) || !stiff.blunt.is_empty() || stiff.open > 0;
                    assert!(is_seen || !is_clear, "{size:e} {friction} {damping} {coupling} {stiff:?}");
                }
            }
        }
    }
}
