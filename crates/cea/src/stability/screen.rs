//! The verdict on one eigenvalue of a spectrum: by its sign where that is beyond doubt, else by a certified bound.

use linsys::SecondOrder;
use num_complex::Complex;

use super::Threshold;
use crate::certified::SingleCertifier;
use crate::{CeaError, JudgedEigenvalue, Spectrum, Verdict, Workspace};

/// What a solver's errors are taken to be, in units of the problem's scale. A backward stable one errs by some 1e-14.
const SOLVER_ERROR: f64 = 1e-12;
/// Real parts up to this part of the problem's scale are near the axis: two eigenvalues that meet in one vector move by the root
/// of SOLVER_ERROR, and a simple one of condition 1e6 by as much.
const NEAR_AXIS: f64 = 1e-6;
/// No more eigenvalues than so many are expected to meet in one vector: that takes as many parameters less two.
const MOST_COALESCING: usize = 4;

/// Whether the motion of eigenvalue `lambda` of `spectrum` grows: [`verdicts`] of one.
///
/// # Errors
/// Those of [`verdicts`].
pub fn verdict(
    system: &SecondOrder,
    lambda: Complex<f64>,
    spectrum: &Spectrum,
    work: &mut Workspace,
) -> Result<Verdict, CeaError> {
    verdicts(system, &[lambda], spectrum, work).map(|verdicts| verdicts[0])
}

/// Whether the motions of some eigenvalues of `spectrum` grow.
///
/// The sign of Re lambda decides where it is beyond what the solver's errors may do to it. The rule: |Re lambda| is more than 1e-6
/// of [`Spectrum::scale`](crate::Spectrum::scale), and the product of the distances from i Im lambda to the m nearest eigenvalues, m = 3 and 4, is more than
/// 1e-12 times the m-th power of the scale. With m eigenvalues that meet in one vector a perturbation of 1e-12 could
/// otherwise put one on the axis. Elsewhere bound and verdict are those of [`certified::certify`](crate::certified::certify).
///
/// [`stability_census`](crate::stability_census) asks this of a whole system, and has an answer where this has none.
///
/// # Errors
/// [`CeaError::NoEigenvector`] where an eigenvalue near the axis is none of this system to working precision.
pub fn verdicts(
    system: &SecondOrder,
    lambdas: &[Complex<f64>],
    spectrum: &Spectrum,
    work: &mut Workspace,
) -> Result<Vec<Verdict>, CeaError> {
    verdicts_beyond(&Threshold::AXIS, system, lambdas, spectrum, work)
}

/// Whether some eigenvalues of `spectrum` are beyond a threshold: [`verdicts`] with the nearest point of the threshold in place of
/// that of the axis. Near it [`Verdict::Undecided`] is where the certified bound straddles the threshold.
///
/// # Errors
/// Those of [`verdicts`].
pub fn verdicts_beyond(
    threshold: &Threshold,
    system: &SecondOrder,
    lambdas: &[Complex<f64>],
    spectrum: &Spectrum,
    work: &mut Workspace,
) -> Result<Vec<Verdict>, CeaError> {
    let mut judge = Judge::new(system, spectrum);
    let one = |&lambda: &Complex<f64>| {
        if is_clear(lambda, spectrum, threshold) {
            return Ok(threshold.verdict(lambda, 0.0));
        }
        let judged = judge.bounded(lambda, work)?;
        Ok(if threshold.is_axis() { judged.verdict } else { threshold.verdict(judged.lambda, judged.bound) })
    };
    lambdas.iter().map(one).collect()
}

/// Whether it is beyond doubt on which side of the threshold an eigenvalue is.
pub(crate) fn is_clear(lambda: Complex<f64>, spectrum: &Spectrum, threshold: &Threshold) -> bool {
    if threshold.margin(lambda).abs() <= NEAR_AXIS * spectrum.scale {
        return false;
    }
    let on_axis = threshold.nearest(lambda);
    // Squares of distances over the scale, which need no roots.
    let mut nearest = [f64::INFINITY; MOST_COALESCING];
    for other in &spectrum.eigenvalues {
        let mut distance = (other - on_axis).norm_sqr() / (spectrum.scale * spectrum.scale);
        for place in &mut nearest {
            if distance < *place {
                std::mem::swap(place, &mut distance);
            }
        }
    }
    (3..=MOST_COALESCING).all(|m| nearest[..m].iter().product::<f64>() > SOLVER_ERROR * SOLVER_ERROR)
}

/// Bounds of single eigenvalues, made ready when the first is asked for.
pub(crate) struct Judge<'a> {
    system: &'a SecondOrder,
    spectrum: &'a Spectrum,
    certifier: Option<SingleCertifier<'a>>,
}

impl<'a> Judge<'a> {
    pub(crate) fn new(system: &'a SecondOrder, spectrum: &'a Spectrum) -> Self {
        Self { system, spectrum, certifier: None }
    }

    /// The eigenvalue with a bound, as improved.
    pub(crate) fn bounded(&mut self, lambda: Complex<f64>, work: &mut Workspace) -> Result<JudgedEigenvalue, CeaError> {
        let mut all = self.spectrum.eigenvalues.clone();
        let distance = |i: &usize| (all[*i] - lambda).norm();
        let Some(nearest) = (0..all.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))) else {
            return Err(CeaError::NoEigenvector { lambda, residual: 1.0 });
        };
        all[nearest] = lambda;
        let certifier = self.certifier.get_or_insert_with(|| SingleCertifier::new(self.system));
        certifier.certify(&all, nearest, work)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EigenSolver, QrSolver};
    use nalgebra::{DMatrix, dmatrix};

    fn verdicts(system: &SecondOrder) -> Vec<Verdict> {
        let mut work = Workspace::default();
        let spectrum = QrSolver.eigenvalues(system, &mut work).unwrap();
        spectrum.oscillatory().map(|l| verdict(system, l, &spectrum, &mut work).unwrap()).collect()
    }

    #[test]
    fn an_undamped_structure_is_never_called_unstable() {
        let k = DMatrix::from_fn(12, 12, |i, j| match i.abs_diff(j) {
            0 => 2e8,
            1 => -1e8,
            _ => 0.0,
        });
        let system = SecondOrder::new(DMatrix::identity(12, 12) * 0.37, DMatrix::zeros(12, 12), k).unwrap();
        assert!(verdicts(&system).iter().all(|v| matches!(v, Verdict::Marginal { tolerance } if *tolerance < 1e-9)));
    }

    #[test]
    fn damping_of_either_sign_is_seen_down_to_rounding() {
        let with = |c: f64| {
            let system = SecondOrder::new(dmatrix![1.0], dmatrix![c], dmatrix![1e8]).unwrap();
            verdicts(&system)[0]
        };
        assert_eq!(with(1e-9), Verdict::Stable);
        assert_eq!(with(-1e-9), Verdict::Unstable);
        assert!(matches!(with(-1e-14), Verdict::Marginal { .. }));
    }

    #[test]
    fn a_defective_pair_on_the_axis_is_neither_stable_nor_unstable() {
        let system =
            SecondOrder::new(DMatrix::identity(2, 2), DMatrix::zeros(2, 2), dmatrix![4.0, 1.0; 0.0, 4.0]).unwrap();
        assert!(verdicts(&system).iter().all(|v| matches!(v, Verdict::Marginal { .. } | Verdict::Undecided { .. })));
    }
}
