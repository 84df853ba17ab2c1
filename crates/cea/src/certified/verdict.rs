//! From bound to verdict, through refinement where the bound leaves it open.

use num_complex::Complex;

use super::expansion::Disc;
use super::measure::{FIRST_ORDER_SAFETY, Measure, State};
use crate::Verdict;

/// [`Verdict::Marginal`] is said only where its tolerance is at most this times the larger of |lambda| and gamma:
/// an eigenvalue that rounding moves by more is not known to be neutral or anything else.
const LARGEST_MARGINAL_TOLERANCE: f64 = 1e-6;

/// Distance to the nearest other eigenvalue.
pub(super) fn gap(sigmas: &[Complex<f64>], i: usize) -> f64 {
    let others = sigmas.iter().enumerate().filter(|&(j, _)| j != i);
    others.map(|(_, s)| (s - sigmas[i]).norm()).fold(f64::INFINITY, f64::min)
}

/// Bound and verdict of eigenvalue `i`: by its first-order bound where that holds, refined if need be; else by the disc around
/// its group; undecided where there is neither.
pub(super) fn decide(problem: &Measure, found: &mut [State], i: usize, disc: Option<Disc>) {
    if found[i].sigma == Complex::default() {
        return;
    }
    let (bound, verdict) = match disc {
        _ if found[i].is_simple => decide_simple(problem, found, i),
        Some(disc) => ((found[i].sigma - disc.centre).norm() + disc.radius, by_disc(disc)),
        None => (f64::INFINITY, Verdict::Undecided { bound: f64::INFINITY }),
    };
    let gamma = problem.scaled.gamma;
    let in_given_units = match verdict {
        Verdict::Marginal { tolerance } => Verdict::Marginal { tolerance: tolerance * gamma },
        Verdict::Undecided { bound } => Verdict::Undecided { bound: bound * gamma },
        decided => decided,
    };
    (found[i].bound, found[i].verdict) = (bound, in_given_units);
}

/// An eigenvalue that the first-order bound holds for; the verdict in scaled units.
fn decide_simple(problem: &Measure, found: &mut [State], i: usize) -> (f64, Verdict) {
    let (bound, mut tolerance) = (found[i].first_order(), FIRST_ORDER_SAFETY * found[i].data_shift());
    let sigma = found[i].sigma;
    // Re sigma is known to this; sharp where that is no more than rounded data allow.
    let (mut known_to, mut is_sharp) = (bound, false);
    if sigma.re.abs() <= bound {
        let sigmas: Vec<_> = found.iter().map(|s| s.sigma).collect();
        // Within the bound there is one eigenvalue.
        if let Some((refined, left)) = problem.refine(&found[i], bound.min(0.45 * gap(&sigmas, i))) {
            (known_to, is_sharp) = (left, true);
            found[i] = refined;
        }
        let size = found[i].sigma.norm();
        if size <= tolerance {
            // Rounded data do not tell it from zero: so much for its real part.
            tolerance += size;
            (known_to, is_sharp) = (tolerance, true);
        }
    }
    (bound, of_real_part(found[i].sigma, known_to, tolerance, is_sharp))
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
