//! The verdict on one eigenvalue of a spectrum: by its sign where that is beyond doubt, else by a certified bound.

use certified::{Certified, CertifiedEigenvalue, CertifiedError, SingleCertifier};
use linsys::SecondOrder;
use num_complex::Complex;

use super::Threshold;
use super::coupling::Coupling;
use crate::{CeaError, Eigentriple, JudgedEigenvalue, Spectrum, Verdict, Workspace};

/// Assumed error of a solver, in units of the problem's scale. A backward stable one errs by some 1e-14.
const SOLVER_ERROR: f64 = 1e-12;
/// Largest distance of an eigenvalue that is near the axis, as a fraction of the problem's scale: two eigenvalues that meet in one vector move by the root
/// of SOLVER_ERROR, and a simple one of condition 1e6 by as much.
const NEAR_AXIS: f64 = 1e-6;
/// Largest distance of an eigenvalue that is on the axis, as a fraction of [`Spectrum::scale`]; chosen: above what a projection and a
/// solver leave of an undamped mode, and below any growth that a measurement could show.
const ON_AXIS: f64 = 1e-12;
/// Roundings that matrices are taken to have been assembled with, in units of the error by eight roundings of each entry ([`Eigentriple::rounding_of_entries`]);
/// chosen: they make of the double zero of a body that is free to move a pair of either kind.
pub const ROUNDED_DATA: f64 = 32.0;
/// Largest error bound, as a fraction of |lambda|, with which a vibration counts as on the axis; with a larger one it is undecided. Chosen: no measurement
/// could show a growth of 1e-5 of the frequency.
const BLUNT: f64 = 1e-5;
/// Largest multiplicity m of an eigenvalue with one vector that is guarded against. Five take m - 1 = 4 parameters that are hit at once
/// (docs/error-bounds.md, section 8).
const MOST_COALESCING: usize = 4;

/// True if a bound is so large, compared with |lambda|, that a vibration on the axis to within it may grow by as much.
pub(super) fn is_blunt(lambda: Complex<f64>, bound: f64) -> bool {
    bound > BLUNT * lambda.norm()
}

/// Verdict on the motion of eigenvalue `lambda` of `spectrum`, whether it grows: [`verdicts`] of one.
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

/// Verdicts on the motions of the eigenvalues `lambdas` of `spectrum`, whether they grow: the one rule of studies, sweeps, maps and
/// [`stability_census`](crate::stability_census). The verdict of a [`certified`] eigenvalue is what its bound says by itself.
///
/// *On the axis*, [`Verdict::Marginal`], is what is no farther from it than 1e-12 of [`Spectrum::scale`](crate::Spectrum::scale), or than
/// 32 times [`Eigentriple::rounding_of_entries`]: undamped modes, conservative gyroscopic ones and rigid motions, though a solver gives their
/// real parts some sign.
///
/// Else the sign of Re lambda decides where it is beyond what the solver's errors may do to it. The rule: |Re lambda| is more than 1e-6
/// of the scale S = [`Spectrum::scale`](crate::Spectrum::scale), rad/s, and the product of the distances from i Im lambda to the m nearest eigenvalues
/// is more than 1e-12 S s^(m-1) for m = 3 and 4: with m eigenvalues that meet in one vector a perturbation of 1e-12 could otherwise put one on the axis
/// (m = 2 follows from the first). The coupling s, rad/s, of vibrations is at most S, and far less where S is the scale of fast internal states
/// (docs/error-bounds.md, section 8). Elsewhere bound and verdict come from
/// [`certified::certify`](crate::certified::certify).
///
/// Where the bound of one eigenvalue leaves it undecided, the bounds of all eigenvalues together decide, by [`certified::solve`] and
/// [`certified::certify`](crate::certified::certify): so the zeros of a body that is free to move are marginal.
///
/// # Errors
/// [`CertifiedError::NoEigenvector`] where an eigenvalue near the axis is no eigenvalue of this system to working precision.
pub fn verdicts(
    system: &SecondOrder,
    lambdas: &[Complex<f64>],
    spectrum: &Spectrum,
    work: &mut Workspace,
) -> Result<Vec<Verdict>, CeaError> {
    verdicts_beyond(&Threshold::AXIS, system, lambdas, spectrum, work)
}

/// Verdicts on the eigenvalues `lambdas` of `spectrum`, whether they are beyond a threshold: [`verdicts`] with the nearest point of the threshold in place of
/// the nearest point of the imaginary axis. An eigenvalue near the threshold is [`Verdict::Undecided`] where its certified bound straddles the threshold.
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
    lambdas.iter().map(|&lambda| judge.verdict(lambda, threshold, work)).collect()
}

/// Judge of the eigenvalues of one system: by their signs where these are clear, by certified bounds elsewhere. The coupling and both certified
/// routes are made when they are first asked for, and kept.
pub(crate) struct Judge<'a> {
    system: &'a SecondOrder,
    spectrum: &'a Spectrum,
    coupling: Option<Coupling>,
    certifier: Option<SingleCertifier<'a>>,
    /// Eigenvalues, all of them, with bounds, by the general route, which takes ten times as long; the inner `None` where that has no answer.
    certified: Option<Option<Certified>>,
}

impl<'a> Judge<'a> {
    pub(crate) fn new(system: &'a SecondOrder, spectrum: &'a Spectrum) -> Self {
        Self { system, spectrum, coupling: None, certifier: None, certified: None }
    }

    /// A judge of the spectrum of a certificate, which is at hand.
    pub(super) fn with_certified(system: &'a SecondOrder, spectrum: &'a Spectrum, certified: Certified) -> Self {
        Self { certified: Some(Some(certified)), ..Self::new(system, spectrum) }
    }

    /// Verdict on an eigenvalue, whether it is beyond a threshold: the rule of [`verdicts`].
    pub(super) fn verdict(
        &mut self,
        lambda: Complex<f64>,
        threshold: &Threshold,
        work: &mut Workspace,
    ) -> Result<Verdict, CeaError> {
        if self.is_near(lambda, threshold) {
            let tolerance = self.tolerance(lambda, work);
            match threshold.margin(lambda).abs() <= tolerance {
                // Of what surely oscillates, so large a tolerance says nothing: it may grow by as much.
                true if lambda.im.abs() > tolerance && is_blunt(lambda, tolerance) => {
                    return Ok(Verdict::Undecided { bound: tolerance });
                }
                true if threshold.is_axis() => return Ok(Verdict::Marginal { tolerance }),
                true => return Ok(Verdict::Undecided { bound: tolerance }),
                false => {}
            }
        } else if self.is_clear(lambda, threshold) {
            return Ok(threshold.verdict(lambda, 0.0));
        }
        let of = |judged: &JudgedEigenvalue| match threshold.is_axis() {
            true => judged.verdict,
            false => threshold.verdict(judged.lambda, judged.bound),
        };
        let bounded = self.bounded(lambda, work);
        match &bounded {
            Ok(judged) if judged.bound.is_finite() && !matches!(of(judged), Verdict::Undecided { .. }) => {
                Ok(of(judged))
            }
            // A multiple eigenvalue, as the zeros of a body that is free to move, or one that a single bound does not decide.
            _ => match self.with_all_others(lambda, work) {
                Some(judged) => Ok(of(&judged)),
                None => bounded.map(|judged| of(&judged)),
            },
        }
    }

    /// True if an eigenvalue is so near the threshold that a sign alone says nothing.
    pub(super) fn is_near(&self, lambda: Complex<f64>, threshold: &Threshold) -> bool {
        threshold.margin(lambda).abs() <= NEAR_AXIS * self.spectrum.scale
    }

    /// Largest distance, rad/s, of an eigenvalue that is on the axis: the larger of 1e-12 of the scale and 32 roundings.
    fn tolerance(&self, lambda: Complex<f64>, work: &mut Workspace) -> f64 {
        let triple = Eigentriple::new(self.system, lambda, work);
        let rounding = triple.map_or(0.0, |triple| triple.rounding_of_entries(self.system));
        (ON_AXIS * self.spectrum.scale).max(ROUNDED_DATA * rounding)
    }

    /// True if it is beyond doubt on which side of the threshold an eigenvalue is.
    pub(crate) fn is_clear(&mut self, lambda: Complex<f64>, threshold: &Threshold) -> bool {
        let scale = self.spectrum.scale;
        if self.is_near(lambda, threshold) {
            return false;
        }
        let on_axis = threshold.nearest(lambda);
        // Squares of distances over the scale, which need no roots.
        let mut nearest = [f64::INFINITY; MOST_COALESCING];
        for other in &self.spectrum.eigenvalues {
            let mut distance = (other - on_axis).norm_sqr() / (scale * scale);
            for place in &mut nearest {
                if distance < *place {
                    std::mem::swap(place, &mut distance);
                }
            }
        }
        // Two numbers as parts of the scale: how far an error of the whole moves the vibrations, and what couples these.
        let is_apart = |error: f64, coupling: f64| {
            (3..=MOST_COALESCING).all(|m| {
                let least = SOLVER_ERROR * error * coupling.powi(m as i32 - 1);
                nearest[..m].iter().product::<f64>() > least * least
            })
        };
        is_apart(1.0, 1.0) || {
            let coupling = self.coupling.get_or_insert_with(|| Coupling::new(self.system));
            coupling.at(on_axis.norm()).is_some_and(|(error, size)| size < scale && is_apart(error, size / scale))
        }
    }

    /// The eigenvalue with a bound from [`certified::certify`], which knows of all others; `None` where that has no answer, or no
    /// eigenvalue there.
    fn with_all_others(&mut self, lambda: Complex<f64>, work: &mut Workspace) -> Option<JudgedEigenvalue> {
        let system = self.system;
        let certified = self.certified.get_or_insert_with(|| {
            work.counting(|counters| {
                let spectrum = certified::solve(system, counters).ok()?;
                certified::certify(system, &spectrum, counters).ok()
            })
        });
        let distance = |found: &CertifiedEigenvalue| (found.lambda - lambda).norm();
        let all = certified.as_ref()?.eigenvalues.iter();
        let nearest = all.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        let is_same = distance(nearest) <= NEAR_AXIS * self.spectrum.scale;
        let CertifiedEigenvalue { lambda, bound, verdict, .. } = *nearest;
        is_same.then_some(JudgedEigenvalue { lambda, bound, verdict })
    }

    /// The eigenvalue, improved, with a bound and a verdict by [`SingleCertifier`]. `lambda` need not be of the spectrum: it takes the place of the nearest
    /// one.
    pub(crate) fn bounded(&mut self, lambda: Complex<f64>, work: &mut Workspace) -> Result<JudgedEigenvalue, CeaError> {
        let mut all = self.spectrum.eigenvalues.clone();
        let distance = |i: &usize| (all[*i] - lambda).norm();
        let Some(nearest) = (0..all.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))) else {
            return Err(CertifiedError::NoEigenvector { lambda, residual: 1.0 }.into());
        };
        all[nearest] = lambda;
        let certifier = self.certifier.get_or_insert_with(|| SingleCertifier::new(self.system));
        Ok(work.counting(|counters| certifier.certify(&all, nearest, counters))?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EigenSolver, QrSolver};
    use linsys::Internal;
    use nalgebra::{DMatrix, DVector, dmatrix};

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
        let found = verdicts(&system);
        assert!(found.iter().all(|v| matches!(v, Verdict::Marginal { tolerance } if *tolerance < 1e-6)), "{found:?}");
    }

    #[test]
    fn damping_of_either_sign_is_seen_down_to_rounding() {
        let with = |c: f64| {
            let system = SecondOrder::new(dmatrix![1.0], dmatrix![c], dmatrix![1e8]).unwrap();
            verdicts(&system)[0]
        };
        assert_eq!(with(1e-7), Verdict::Stable);
        assert_eq!(with(-1e-7), Verdict::Unstable);
        assert!([-1e-9, -1e-14, 1e-9].into_iter().all(|c| matches!(with(c), Verdict::Marginal { .. })));
    }

    #[test]
    fn fast_states_do_not_bring_vibrations_together() {
        // Eight oscillators a tenth apart, each on a dashpot of either sign, with a state that acts as one more.
        let n = 8;
        let system = |decay: f64| {
            let gain = DMatrix::identity(n, n) * (1e-2 * decay).sqrt();
            let internal = Internal { decay: DVector::from_element(n, decay), drive: gain.clone(), force: gain };
            let c = DMatrix::from_diagonal(&DVector::from_fn(n, |i, _| if i % 2 == 0 { 0.03 } else { -0.01 }));
            let k = DMatrix::from_diagonal(&DVector::from_fn(n, |i, _| (1.0 + 0.1 * i as f64).powi(2)));
            SecondOrder::with_internal(DMatrix::identity(n, n), c, k, internal).unwrap()
        };
        let mut work = Workspace::default();
        for decay in [10.0, 100.0, 1e3] {
            let system = system(decay);
            let spectrum = QrSolver.eigenvalues(&system, &mut work).unwrap();
            let lambdas: Vec<_> = spectrum.oscillatory().collect();
            for (i, verdict) in
                super::verdicts(&system, &lambdas, &spectrum, &mut work).unwrap().into_iter().enumerate()
            {
                // Re lambda is half of the sum of a dashpot and the state's -0.01.
                assert_eq!(verdict, if i % 2 == 0 { Verdict::Stable } else { Verdict::Unstable }, "{decay}, {i}");
            }
        }
        assert_eq!(work.counters.factorisations, 0);
    }

    #[test]
    fn a_defective_pair_on_the_axis_is_neither_stable_nor_unstable() {
        let system =
            SecondOrder::new(DMatrix::identity(2, 2), DMatrix::zeros(2, 2), dmatrix![4.0, 1.0; 0.0, 4.0]).unwrap();
        assert!(verdicts(&system).iter().all(|v| matches!(v, Verdict::Marginal { .. } | Verdict::Undecided { .. })));
    }
}
