//! From bound to verdict, through refinement where the bound leaves it open.

use num_complex::Complex;

use super::clusters::ClusterKind;
use super::measure::{Measure, State, UNIT};
use crate::Verdict;

/// Factor on `condition x backward error` in every bound: it is a first-order estimate with estimated factors.
pub const SAFETY: f64 = 4.0;
/// [`Verdict::Marginal`] is said only where its tolerance is at most this times the larger of |lambda| and gamma.
pub const MARGINAL_LIMIT: f64 = 1e-6;

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
    let (mut bound, mut tolerance) = (SAFETY * state.shift(), SAFETY * state.data_shift());
    let group = groups.iter().find(|(members, kind)| members.contains(&i) && *kind != ClusterKind::NearlyDefective);
    // Re sigma is known to this. A projection settles a semisimple group to second order.
    let (mut known_to, mut proven) = (bound, false);
    match group {
        Some((members, ClusterKind::Defective)) => {
            bound = root_bound(found, i, members);
            (tolerance, known_to, proven) = (bound, bound, true);
        }
        Some(_) => (known_to, proven) = (tolerance, true),
        None if sigma.re.abs() <= bound => {
            let sigmas: Vec<_> = found.iter().map(|s| s.sigma).collect();
            let reach = (4.0 * bound).min(0.45 * gap(&sigmas, i));
            if let Some(refined) = problem.refine(state, reach) {
                (known_to, proven) = (refined.1, true);
                found[i] = refined.0;
            }
        }
        None => {}
    }
    let re = found[i].sigma.re;
    let verdict = if re.abs() > known_to.max(tolerance) {
        Verdict::of(Complex::from(re), 0.0)
    } else if proven && tolerance <= MARGINAL_LIMIT * sigma.norm().max(1.0) {
        Verdict::Marginal { tolerance: tolerance * gamma }
    } else {
        Verdict::Undecided { bound: known_to.max(tolerance) * gamma }
    };
    (found[i].bound, found[i].verdict) = (bound, verdict);
}

/// How far a member of a defective group of m may move: as the m-th root of a perturbation.
///
/// Near its group `det Q` is about a constant times the product of the distances to its members, so that the
/// first-order shift t at distance d_j from the others stands for a perturbation t d_2 ... d_m of that product.
fn root_bound(found: &[State], i: usize, members: &[usize]) -> f64 {
    let sigma = found[i].sigma;
    let size = sigma.norm();
    let mean = members.iter().map(|&j| found[j].sigma).sum::<Complex<f64>>() / members.len() as f64;
    let spread = members.iter().map(|&j| (found[j].sigma - mean).norm()).fold(0.0, f64::max);
    let others = members.iter().filter(|&&j| j != i);
    let distances = others.map(|&j| (found[j].sigma - sigma).norm().max(f64::EPSILON * size));
    let count = members.len() as f64;
    let root = distances.fold(found[i].shift(), |product, d| product * d).powf(1.0 / count);
    let least = (SAFETY * UNIT).powf(1.0 / count) * size;
    (2.0 * root).max(2.0 * spread).max(least)
}
