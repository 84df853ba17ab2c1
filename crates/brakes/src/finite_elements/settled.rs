//! Open verdicts of a reduced brake, settled: where the error of the reduction leaves open whether a mode grows, the whole brake says it.

use cea::Verdict;
use linsys::OperatingPoint;
use num_complex::Complex;
use sparse::Problem;
use study::{BandMode, Plan, WholeEigenvalue};

use super::{Part, ReducedSet, whole};
use crate::Error;

/// Largest distance from a mode to the eigenvalue of the whole brake that is found from it and taken for its own, as a fraction of the error that is assumed
/// of the mode. Chosen: that error is a hundred times the largest distance that was measured, so that this is ten times that distance.
const SAME_MODE: f64 = 0.1;

/// Gives the modes whose verdict is open, of a reduced brake at an operating point of the whole one, the eigenvalues of the whole brake next to them, with
/// the error bounds of these. True if the whole brake was asked, which it is not if no mode or more than `most` are open. A mode stays as it is if its
/// eigenvalue is not found, is farther away than the mode of the whole brake can be, or may belong to another open mode.
///
/// # Errors
/// A point of another brake, an elimination order of the whole brake that does not fit into memory.
pub(super) fn settle(
    modes: &mut [BandMode],
    plan: &Plan,
    (part, set): (&Part, &ReducedSet),
    at: &OperatingPoint,
    most: usize,
) -> Result<bool, Error> {
    let is_open = |mode: &BandMode| matches!(mode.verdict(&plan.threshold), Verdict::Undecided { .. });
    let is_asked = |&index: &usize| plan.is_studied(modes[index].lambda) && is_open(&modes[index]);
    let open: Vec<usize> = (0..modes.len()).filter(is_asked).collect();
    if open.is_empty() || open.len() > most {
        return Ok(false);
    }
    let next_to = |problem: &Problem, index: usize| {
        let BandMode { lambda, shape, bound, .. } = &modes[index];
        let found = whole::next_to(problem, *lambda, &part.reduced.lift(shape)).ok();
        found.filter(|found| (found.lambda - lambda).norm() <= SAME_MODE * bound)
    };
    let found: Vec<Option<WholeEigenvalue>> = set.together.one(|| {
        let problem = Problem::new(&set.system.assemble(at)?)?;
        Ok::<_, Error>(open.iter().map(|&index| next_to(&problem, index)).collect())
    })?;
    let own: Vec<(Complex<f64>, f64)> = open.iter().map(|&index| (modes[index].lambda, modes[index].bound)).collect();
    for (at, &index) in open.iter().enumerate() {
        if let Some(found) = own_eigenvalue(at, &own, &found) {
            (modes[index].lambda, modes[index].bound) = (found.lambda, found.bound);
        }
    }
    Ok(true)
}

/// The eigenvalue of the whole brake that was `found` from mode number `at`, if it cannot belong to any other of the `modes`; `None` if it can. `modes` are
/// eigenvalues with the errors assumed of them, rad/s.
fn own_eigenvalue(
    at: usize,
    modes: &[(Complex<f64>, f64)],
    found: &[Option<WholeEigenvalue>],
) -> Option<WholeEigenvalue> {
    let own = found[at]?;
    let (lambda, error) = modes[at];
    let is_apart = |other: usize| {
        let (other_lambda, other_error) = modes[other];
        (other_lambda - lambda).norm() > 2.0 * SAME_MODE * error.max(other_error)
            || found[other].is_some_and(|other| (other.lambda - own.lambda).norm() > other.bound + own.bound)
    };
    (0..modes.len()).all(|other| other == at || is_apart(other)).then_some(own)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(re: f64, im: f64) -> Option<WholeEigenvalue> {
        Some(WholeEigenvalue { lambda: Complex::new(re, im), bound: 1e-6 })
    }

    #[test]
    fn an_eigenvalue_is_that_of_one_mode_only() {
        let modes =
            [(Complex::new(0.1, 100.0), 1.0), (Complex::new(0.1, 100.05), 1.0), (Complex::new(-0.5, 110.0), 1.0)];
        let apart = [found(0.11, 100.0), found(-0.01, 100.06), found(-0.4, 110.0)];
        assert!((0..3).all(|at| own_eigenvalue(at, &modes, &apart) == apart[at]));
        // Both neighbours end at the same eigenvalue, or one of them nowhere: neither knows which of both it is.
        for other in [found(0.11, 100.0), None] {
            let found = [apart[0], other, apart[2]];
            assert_eq!(own_eigenvalue(0, &modes, &found), None);
            assert_eq!(own_eigenvalue(1, &modes, &found), None);
            assert_eq!(own_eigenvalue(2, &modes, &found), apart[2]);
        }
    }
}
