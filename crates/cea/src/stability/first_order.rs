//! The verdict on one eigenvalue, with the error bound that it rests on.

use linsys::SecondOrder;
use num_complex::Complex;

use crate::dense::size;
use crate::{CeaError, Verdict, Workspace, left_vector, right_vector};

/// An eigenvalue whose |Re lambda| is above this part of the problem's scale is decided by its sign, without a bound.
///
/// A backward stable solver errs by some 1e-14 of the scale in the matrices. A simple eigenvalue of condition up to 1e8
/// and a defective pair (index 2, which moves by the square root: 1e-7) so stay within it. One of index 3 or more does not:
/// a triple coalescence moves by the cube root of rounding, some 2e-5 of the scale, and the sign that is found for it may be
/// that of the error. [`stability_census`](crate::stability_census) bounds whatever it says to grow.
pub(crate) const NEAR_AXIS: f64 = 1e-6;
/// Rounding errors in one evaluation of `Q(lambda) phi`, in units of epsilon times the size of its terms: a few operations
/// for each of three terms. Chosen, not derived from the order of the system.
const ROUNDINGS_OF_RESIDUAL: f64 = 8.0;

/// Whether the motion of one eigenvalue grows.
///
/// Far from the axis the sign of Re lambda decides. Near it, one Newton step with left and right vectors refines
/// lambda and `|psi| |Q| epsilon |phi| / |psi^H Q'(lambda) phi|` bounds its error (Tisseur, Linear Algebra Appl. 309,
/// 2000, theorem 5, with Q' including internal states). `scale` is [`Spectrum::scale`](crate::Spectrum::scale).
///
/// [`stability_census`](crate::stability_census) asks this of a whole system, and has an answer where this has none.
///
/// # Errors
/// Those of [`right_vector`].
pub fn verdict(
    system: &SecondOrder,
    lambda: Complex<f64>,
    scale: f64,
    work: &mut Workspace,
) -> Result<Verdict, CeaError> {
    if lambda.re.abs() > NEAR_AXIS * scale {
        return Ok(Verdict::of(lambda, 0.0));
    }
    let (refined, bound) = bounded(system, lambda, work)?;
    // A vanishing slope is a defective eigenvalue: the first-order bound is then no bound, and nothing is decided.
    if !bound.is_finite() || bound > NEAR_AXIS * scale {
        return Ok(Verdict::Undecided { bound: if bound.is_finite() { bound } else { scale } });
    }
    Ok(Verdict::of(refined, bound))
}

/// The eigenvalue after one Newton step, and to first order what its error is at most; infinite where it is defective.
pub(crate) fn bounded(
    system: &SecondOrder,
    lambda: Complex<f64>,
    work: &mut Workspace,
) -> Result<(Complex<f64>, f64), CeaError> {
    let right = right_vector(system, lambda, work)?;
    let left = left_vector(system, lambda, work)?;
    let slope = left.dotc(&(system.dynamic_stiffness_derivative(lambda) * &right));
    let residual = left.dotc(&(system.dynamic_stiffness(lambda) * &right));
    let bound = ROUNDINGS_OF_RESIDUAL * f64::EPSILON * size(system, lambda) / slope.norm();
    Ok((lambda - residual / slope, bound))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EigenSolver, QrSolver};
    use nalgebra::{DMatrix, dmatrix};

    fn verdicts(system: &SecondOrder) -> Vec<Verdict> {
        let mut work = Workspace::default();
        let spectrum = QrSolver.eigenvalues(system, &mut work).unwrap();
        spectrum.oscillatory().map(|l| verdict(system, l, spectrum.scale, &mut work).unwrap()).collect()
    }

    #[test]
    fn an_undamped_structure_is_never_called_unstable() {
        let k = DMatrix::from_fn(12, 12, |i, j| match i.abs_diff(j) {
            0 => 2e8,
            1 => -1e8,
            _ => 0.0,
        });
        let system = SecondOrder::new(DMatrix::identity(12, 12) * 0.37, DMatrix::zeros(12, 12), k).unwrap();
        assert!(verdicts(&system).iter().all(|v| matches!(v, Verdict::Undecided { bound } if *bound < 1e-9)));
    }

    #[test]
    fn damping_of_either_sign_is_seen_down_to_rounding() {
        let with = |c: f64| {
            let system = SecondOrder::new(dmatrix![1.0], dmatrix![c], dmatrix![1e8]).unwrap();
            verdicts(&system)[0]
        };
        assert_eq!(with(1e-9), Verdict::Stable);
        assert_eq!(with(-1e-9), Verdict::Unstable);
        assert!(matches!(with(-1e-14), Verdict::Undecided { .. }));
    }

    #[test]
    fn a_defective_pair_on_the_axis_is_undecided() {
        let system =
            SecondOrder::new(DMatrix::identity(2, 2), DMatrix::zeros(2, 2), dmatrix![4.0, 1.0; 0.0, 4.0]).unwrap();
        let at_two_i = verdict(&system, Complex::new(0.0, 2.0), 4.0, &mut Workspace::default()).unwrap();
        assert!(matches!(at_two_i, Verdict::Undecided { .. }));
    }
}
