//! The verdict on one eigenvalue of a spectrum: by its sign where that is beyond doubt, else by a certified bound.

use linsys::SecondOrder;
use num_complex::Complex;

use super::census::JudgedEigenvalue;
use crate::certified::certify_one;
use crate::{CeaError, Spectrum, Verdict, Workspace};

/// Real parts up to this part of the problem's scale are near the axis. A backward stable solver errs by some 1e-14 of the scale
/// in the matrices; a simple eigenvalue of condition up to 1e8 moves by less than this.
const NEAR_AXIS: f64 = 1e-6;
/// Eigenvalues that meet in one, with one vector, move by this root of a perturbation; more than so many are not looked for.
/// On a lattice two parameters must be hit for three eigenvalues to meet, and four for five.
const MOST_COALESCING: usize = 4;

/// Whether the motion of eigenvalue `lambda` of `spectrum` grows.
///
/// The sign of Re lambda decides where it is beyond what the solver's errors may do to it: NEAR_AXIS of
/// [`Spectrum::scale`](crate::Spectrum::scale), and for each m up to MOST_COALESCING the root `NEAR_AXIS^(2/m)` of it if m eigenvalues are as near
/// to each other as that, which a perturbation of NEAR_AXIS^2 may then move so far. Elsewhere the bound and the verdict are those of
/// [`certified::certify`](crate::certified::certify), of this eigenvalue alone.
///
/// [`stability_census`](crate::stability_census) asks this of a whole system, and has an answer where this has none.
///
/// # Errors
/// [`CeaError::NoEigenvector`] where `lambda` is none of this system to working precision.
pub fn verdict(
    system: &SecondOrder,
    lambda: Complex<f64>,
    spectrum: &Spectrum,
    work: &mut Workspace,
) -> Result<Verdict, CeaError> {
    if is_clear(lambda, spectrum) {
        return Ok(Verdict::of(lambda, 0.0));
    }
    Ok(bounded(system, lambda, spectrum, work)?.verdict)
}

/// Whether the sign of Re lambda is beyond doubt.
pub(crate) fn is_clear(lambda: Complex<f64>, spectrum: &Spectrum) -> bool {
    let reach = |m: usize| NEAR_AXIS.powf(2.0 / m as f64) * spectrum.scale;
    (2..=MOST_COALESCING).all(|m| {
        let reach = reach(m);
        // Itself among them.
        let near = || spectrum.eigenvalues.iter().filter(|other| (*other - lambda).norm() <= 2.0 * reach).count();
        lambda.re.abs() > reach || (m > 2 && near() < m)
    })
}

/// The eigenvalue with a bound, as improved.
pub(crate) fn bounded(
    system: &SecondOrder,
    lambda: Complex<f64>,
    spectrum: &Spectrum,
    work: &mut Workspace,
) -> Result<JudgedEigenvalue, CeaError> {
    let mut all = spectrum.eigenvalues.clone();
    let distance = |i: &usize| (all[*i] - lambda).norm();
    let Some(nearest) = (0..all.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))) else {
        return Err(CeaError::NoEigenvector { lambda, residual: 1.0 });
    };
    all[nearest] = lambda;
    certify_one(system, &all, nearest, work)
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
