//! Verdict from the bound, through refinement where the bound leaves it open.

use num_complex::Complex;

use super::expansion::Disc;
use super::measure::{Measure, State};
use super::scaled::FIRST_ORDER_SAFETY;
use crate::Verdict;

/// [`Verdict::Marginal`] is said only where its tolerance is at most this times the larger of |lambda| and gamma:
/// an eigenvalue that rounding moves by more is not known to be neutral or anything else.
const LARGEST_MARGINAL_TOLERANCE: f64 = 1e-6;

/// Distance to the nearest other eigenvalue.
pub(super) fn gap(sigmas: &[Complex<f64>], i: usize) -> f64 {
    let others = sigmas.iter().enumerate().filter(|&(j, _)| j != i);
    others.map(|(_, s)| (s - sigmas[i]).norm()).fold(f64::INFINITY, f64::min)
}

/// Bound and verdict of an eigenvalue: by its first-order bound where that holds, refined if need be; else by the disc around
/// its group; undecided where there is neither. `gap` is the distance to the nearest other eigenvalue.
pub(super) fn decide(problem: &Measure, mut state: State, gap: f64, disc: Option<Disc>) -> State {
    if state.sigma == Complex::default() {
        return state;
    }
    let (bound, verdict) = match disc {
        _ if state.is_simple => decide_simple(problem, &mut state, gap),
        Some(disc) => ((state.sigma - disc.centre).norm() + disc.radius, by_disc(disc)),
        None => (f64::INFINITY, Verdict::Undecided { bound: f64::INFINITY }),
    };
    let gamma = problem.scaled.gamma;
    let in_given_units = match verdict {
        Verdict::Marginal { tolerance } => Verdict::Marginal { tolerance: tolerance * gamma },
        Verdict::Undecided { bound } => Verdict::Undecided { bound: bound * gamma },
        decided => decided,
    };
    State { bound, verdict: in_given_units, ..state }
}

/// An eigenvalue that the first-order bound holds for; the verdict in scaled units.
fn decide_simple(problem: &Measure, state: &mut State, gap: f64) -> (f64, Verdict) {
    let (bound, mut tolerance) = (state.first_order(), FIRST_ORDER_SAFETY * state.data_shift);
    // Re sigma is known to this; sharp where that is no more than rounded data allow.
    let (mut known_to, mut is_sharp) = (bound, false);
    if state.sigma.re.abs() <= bound {
        // Within the bound there is one eigenvalue.
        if let Some((refined, left)) = problem.refine(state, bound.min(0.45 * gap)) {
            (known_to, is_sharp) = (left, true);
            *state = refined;
        }
        let size = state.sigma.norm();
        if size <= tolerance {
            // Rounded data do not tell it from zero: so much for its real part.
            tolerance += size;
            (known_to, is_sharp) = (tolerance, true);
        }
    }
    (bound, of_real_part(state.sigma, known_to, tolerance, is_sharp))
}

/// The members of a disc, whichever they are.
fn by_disc(disc: Disc) -> Verdict {
    let tolerance = disc.radius + disc.centre.re.abs();
    match Verdict::of(disc.centre, disc.radius) {
        Verdict::Undecided { .. } => of_real_part(disc.centre, tolerance, tolerance, true),
        decided => decided,
    }
}

/// The verdict on an eigenvalue whose real part is known to `known_to`, while rounding the data may move it by `tolerance`.
fn of_real_part(sigma: Complex<f64>, known_to: f64, tolerance: f64, is_sharp: bool) -> Verdict {
    let larger = known_to.max(tolerance);
    match Verdict::of(sigma, larger) {
        Verdict::Undecided { .. } if is_sharp && tolerance <= LARGEST_MARGINAL_TOLERANCE * sigma.norm().max(1.0) => {
            Verdict::Marginal { tolerance }
        }
        verdict => verdict,
    }
}
