//! Splits fast internal states off a state matrix, exactly; the remaining matrix has the norm of the vibrations.
//!
//! A QR iteration errs by rounding errors of the norm of its matrix, so that a state a thousand times faster than the
//! vibrations costs the vibrations three digits. With the fast states last, the similarity
//!
//! ```text
//! [ I  0 ] [ A11  A12 ] [ I  0 ]   [ A11 + A12 L      A12      ]
//! [ -L I ] [ A21  A22 ] [ L  I ] = [      0       A22 - L A12  ],     A22 L = L (A11 + A12 L) - A21
//! ```
//!
//! separates the two blocks. A22 is diagonal and large, so that the equation for L is solved by fixed-point iteration, with a
//! contraction of about `|A11| / |A22|` (the slow manifold of singular perturbation theory).

use nalgebra::DMatrix;

/// Most steps of the fixed-point iteration: at a contraction of one half, the slowest accepted, 53 steps reach rounding.
const MOST_FIXED_POINT_STEPS: usize = 60;
/// Size of a step, in rounding errors of L, at which the iteration ends: smaller steps are rounding and no longer become shorter. Chosen: with less, an
/// iteration that has converged is taken for one that does not, and the whole spectrum takes far longer.
const ROUNDING: f64 = 4.0;

/// `A11 + A12 L` and `A22 - L A12` for the last rows, as many as `states`: all internal states of a system, fast or not. A22 has to be diagonal, which is not checked: the
/// iteration divides by its diagonal alone. `None` where the slowest of them is too slow for the iteration to converge.
pub(crate) fn split(state: &DMatrix<f64>, states: usize) -> Option<[DMatrix<f64>; 2]> {
    let slow = state.nrows() - states;
    let (a11, a12) = (state.view((0, 0), (slow, slow)), state.view((0, slow), (slow, states)));
    let (a21, a22) = (state.view((slow, 0), (states, slow)), state.view((slow, slow), (states, states)));
    let rates = a22.diagonal();
    let mut l = DMatrix::zeros(states, slow);
    let mut last = f64::INFINITY;
    for _ in 0..MOST_FIXED_POINT_STEPS {
        let mut next = &l * (a11 + a12 * &l) - a21;
        next.row_iter_mut().zip(rates.iter()).for_each(|(mut row, rate)| row /= *rate);
        let step = (&next - &l).norm();
        l = next;
        if step <= ROUNDING * f64::EPSILON * l.norm() {
            return Some([a11 + a12 * &l, a22 - &l * a12]);
        }
        if step.is_nan() || step > 0.5 * last {
            return None;
        }
        last = step;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    #[test]
    fn the_parts_have_the_trace_and_the_determinant_of_the_whole() {
        let state = dmatrix![0.0, 1.0, 0.0; -1.0, -0.1, 20.0; 0.0, -30.0, -1e3];
        let [slow, fast] = split(&state, 1).unwrap();
        assert!((slow.trace() + fast.trace() - state.trace()).abs() < 1e-12);
        assert!((slow.determinant() * fast.determinant() / state.determinant() - 1.0).abs() < 1e-14);
        // To first order the state is a dashpot of 20 * 30 / 1e3.
        assert!((slow[(1, 1)] + 0.7).abs() < 0.01 && slow.norm() < 2.0);
    }

    #[test]
    fn a_state_as_slow_as_the_vibration_is_not_split_off() {
        assert!(split(&dmatrix![0.0, 1.0, 0.0; -1.0, -0.1, 1.0; 0.0, -1.0, -1.0], 1).is_none());
    }
}
