//! Errors of solutions with a model at given points.

use num_complex::Complex;

use crate::solver::Problem;
use crate::{SparseError, SparseSecondOrder};

/// Errors of a solution with `Q(lambda)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolutionErrors {
    /// Point lambda at which it was solved with Q, rad/s.
    pub lambda: Complex<f64>,
    /// Backward error `|Q x - b| / (|Q| |x| + |b|)`: some rounding errors where the factorisation is sound. Infinite where there is no solution.
    pub backward: f64,
    /// Forward error `|x - x_0| / |x_0|` for `b = Q x_0` with a known x_0: how many digits a solution has. Infinite where there is no solution.
    pub forward: f64,
}

/// Errors of solutions with Q at `points`, rad/s, where the solution is known.
///
/// # Errors
/// A factorisation that does not fit into memory.
pub fn solution_errors(
    system: &SparseSecondOrder,
    points: &[Complex<f64>],
) -> Result<Vec<SolutionErrors>, SparseError> {
    let problem = Problem::new(system)?;
    let errors = |&lambda: &Complex<f64>| {
        let (backward, forward) = problem.solution_errors(lambda)?;
        Ok(SolutionErrors { lambda, backward, forward })
    };
    points.iter().map(errors).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::of_entries::diagonal;

    #[test]
    fn a_sound_model_is_solved_to_rounding_and_a_singular_one_is_not() {
        let points = [Complex::new(1.0, 2.0), Complex::new(-3.0, 40.0)];
        let of = |m: &[f64], k: &[f64]| {
            let system = SparseSecondOrder::new(diagonal(m), diagonal(&[0.1; 3]), diagonal(k)).unwrap();
            solution_errors(&system, &points).unwrap()
        };
        let sound = of(&[1.0, 2.0, 0.5], &[3.0, 1e4, 2.0]);
        assert!(sound.iter().all(|e| e.backward < 1e-15 && e.forward < 1e-14), "{sound:?}");
        // The last row is empty in all three matrices.
        let empty = diagonal(&[0.1, 0.1, 0.0]);
        let system = SparseSecondOrder::new(diagonal(&[1.0, 1.0, 0.0]), empty, diagonal(&[1.0, 1.0, 0.0])).unwrap();
        let singular = solution_errors(&system, &points).unwrap();
        assert!(singular.iter().all(|e| e.forward.is_nan() || e.forward > 1e-3), "{singular:?}");
    }
}
