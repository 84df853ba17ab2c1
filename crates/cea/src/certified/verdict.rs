//! From bound to verdict, through refinement where the bound leaves it open.

use std::f64::consts::TAU;

use num_complex::Complex;

use super::clusters::ClusterKind;
use super::measure::{FIRST_ORDER_SAFETY, Measure, State, UNIT_ROUNDOFF};
use super::vectors::Factor;
use crate::Verdict;

/// [`Verdict::Marginal`] is said only where its tolerance is at most this times the larger of |lambda| and gamma:
/// an eigenvalue that rounding moves by more is not known to be neutral or anything else.
const LARGEST_MARGINAL_TOLERANCE: f64 = 1e-6;

/// Points on a circle around a defective group. Between them the smallest singular value is not looked at: a heuristic, and
/// docs/error-bounds.md, section 7, says what it relies on.
const POINTS_ON_CIRCLE: usize = 8;

/// Members of a group and what it is.
pub(super) type Group = (Vec<usize>, ClusterKind);

/// Distance to the nearest other eigenvalue.
pub(super) fn gap(sigmas: &[Complex<f64>], i: usize) -> f64 {
    let others = sigmas.iter().enumerate().filter(|&(j, _)| j != i);
    others.map(|(_, s)| (s - sigmas[i]).norm()).fold(f64::INFINITY, f64::min)
}

/// Bound and verdict of eigenvalue `i`, which is refined if need be.
pub(super) fn decide(problem: &Measure, found: &mut [State], i: usize, groups: &[Group]) {
    let gamma = problem.scaled.gamma;
    let state = &found[i];
    let sigma = state.sigma;
    if sigma == Complex::default() {
        return;
    }
    let (mut bound, mut tolerance) = (FIRST_ORDER_SAFETY * state.shift(), FIRST_ORDER_SAFETY * state.data_shift());
    let group = groups.iter().find(|(members, kind)| members.contains(&i) && *kind != ClusterKind::NearlyDefective);
    // Re sigma is known to this; sharp where that is no more than rounded data allow. A projection determines a semisimple group to second order.
    let (mut known_to, mut is_sharp) = (bound, false);
    match group {
        Some((members, ClusterKind::Defective)) => {
            bound = root_bound(problem, found, members);
            (tolerance, known_to, is_sharp) = (bound, bound, true);
        }
        Some(_) => (known_to, is_sharp) = (tolerance, true),
        None if sigma.re.abs() <= bound => {
            let sigmas: Vec<_> = found.iter().map(|s| s.sigma).collect();
            let reach = (4.0 * bound).min(0.45 * gap(&sigmas, i));
            if let Some(refined) = problem.refine(state, reach) {
                (known_to, is_sharp) = (refined.1, true);
                found[i] = refined.0;
            }
            let size = found[i].sigma.norm();
            if size <= tolerance {
                // Rounded data do not tell it from zero: so much for its real part.
                tolerance += size;
                (known_to, is_sharp) = (tolerance, true);
            }
        }
        None => {}
    }
    let re = found[i].sigma.re;
    let verdict = if re.abs() > known_to.max(tolerance) {
        Verdict::of(Complex::from(re), 0.0)
    } else if is_sharp && tolerance <= LARGEST_MARGINAL_TOLERANCE * sigma.norm().max(1.0) {
        Verdict::Marginal { tolerance: tolerance * gamma }
    } else {
        Verdict::Undecided { bound: known_to.max(tolerance) * gamma }
    };
    (found[i].bound, found[i].verdict) = (bound, verdict);
}

/// How far a member of a defective group may move for its backward error or that of rounded data.
///
/// The smallest radius, in steps of two, of a circle around the group on which Q is farther from singular than that
/// (the pseudospectrum; Tisseur and Higham, SIAM J. Matrix Anal. Appl. 23, 2001): no perturbation of this size puts an
/// eigenvalue on the circle, so none moves one across it. The circle is sampled.
fn root_bound(problem: &Measure, found: &[State], members: &[usize]) -> f64 {
    let s = &problem.scaled;
    let count = members.len() as f64;
    let mean = members.iter().map(|&j| found[j].sigma).sum::<Complex<f64>>() / count;
    let spread = members.iter().map(|&j| (found[j].sigma - mean).norm()).fold(0.0, f64::max);
    let error = members.iter().map(|&j| found[j].scaled_error).fold(UNIT_ROUNDOFF, f64::max);
    let mut radius = (1.1 * spread).max((FIRST_ORDER_SAFETY * error).powf(1.0 / count) * mean.norm() / 8.0);
    while radius < mean.norm() {
        let free = (0..POINTS_ON_CIRCLE).all(|k| {
            let at = mean + Complex::from_polar(radius, (k as f64 + 0.5) * TAU / POINTS_ON_CIRCLE as f64);
            Factor::new(s, at).smallest() > FIRST_ORDER_SAFETY * error * s.norms.size(at.norm())
        });
        if free {
            // From a member to any point of the disc.
            return radius + spread;
        }
        radius *= 2.0;
    }
    f64::INFINITY
}
