//! The modes whose Taylor series about the median does not reach the onset.
//!
//! The Taylor series of an eigenvalue about the median converges up to the nearest branch point, a point in the complex plane of
//! mu where the eigenvalue coalesces with another one; near the branch point it converges slowly. Two eigenvalues coalesce
//! where `(lambda_1 - lambda_2)^2`, which is analytic, vanishes. To first order from a real mu this is at
//! `mu - (lambda_1 - lambda_2) / (2 (lambda_1' - lambda_2'))`.

use std::collections::BTreeSet;

use num_complex::Complex;
use squeal::estimators::{Exact, OneParameterFamily};
use squeal::study::{ModeLabel, Reference};
use squeal::tracking::{Branches, link};

use crate::ValidationError;

/// Largest distance between a branch point and the real mu at which it is computed to first order; chosen, half of the standard
/// deviation of mu in the paper's case.
const LARGEST_BRANCH_POINT_OFFSET: f64 = 0.05;
/// Number of real mu on each side of the median at which branch points are computed; chosen: with a third of this number,
/// branches are lost at sharp turns.
const STEPS_PER_SIDE: usize = 64;
/// Probability of the interval about the median in which a mode without an onset is judged; chosen.
const CENTRAL_PROBABILITY: f64 = 0.99;

/// The modes with a branch point nearer to the median than their farthest onset or, for modes without an onset, than the ends
/// of the central part of the distribution.
pub(crate) fn near_coalescence(
    reference: &Reference,
    exact: &Exact,
    family: &mut OneParameterFamily<'_>,
) -> Result<BTreeSet<ModeLabel>, ValidationError> {
    let distribution = family.distribution();
    let median = distribution.median();
    let ends = [0.5 * (1.0 - CENTRAL_PROBABILITY), 0.5 * (1.0 + CENTRAL_PROBABILITY)].map(|u| distribution.quantile(u));
    let widest = (ends[1] - median).max(median - ends[0]);
    let mut near = BTreeSet::new();
    for (index, names) in reference.names.iter().enumerate() {
        let is_own = |unstable: &Vec<Vec<ModeLabel>>| unstable.iter().flatten().any(|name| names.contains(name));
        let onsets =
            exact.integral.pieces.windows(2).filter(|pair| is_own(&pair[0].unstable) != is_own(&pair[1].unstable));
        let reach = onsets.map(|pair| (pair[1].from - median).abs()).fold(0.0, f64::max).min(widest);
        let radius = if reach > 0.0 { reach } else { widest };
        if nearest_branch_point(family, median, index, [radius, widest])? < radius {
            near.extend(names);
        }
    }
    Ok(near)
}

/// Distance from `median` of the nearest branch point of a mode, among those near the real mu within `radius`. The steps are
/// parts of `widest` for all modes, so that all modes use the same spectra.
fn nearest_branch_point(
    family: &mut OneParameterFamily<'_>,
    median: f64,
    index: usize,
    [radius, widest]: [f64; 2],
) -> Result<f64, ValidationError> {
    let mut nearest = f64::INFINITY;
    for direction in [-1.0, 1.0] {
        let (mut mu, mut mode) = (median, index);
        let steps = (1..=STEPS_PER_SIDE).map(|step| widest * step as f64 / STEPS_PER_SIDE as f64);
        for distance in steps.take_while(|distance| distance - widest / STEPS_PER_SIDE as f64 <= radius) {
            let next = (median + direction * distance).max(0.0);
            mode = link(family, mu, mode, next)?.to;
            mu = next;
            for point in branch_points(family, mu, mode)? {
                if (point - mu).norm() <= LARGEST_BRANCH_POINT_OFFSET {
                    nearest = nearest.min((point - median).norm());
                }
            }
        }
    }
    Ok(nearest)
}

/// The points at which the mode `index` at `mu` coalesces with each other mode, to first order.
fn branch_points(
    family: &mut OneParameterFamily<'_>,
    mu: f64,
    index: usize,
) -> Result<Vec<Complex<f64>>, ValidationError> {
    let own = family.point(mu, index)?;
    let mut points = Vec::new();
    for other in (0..family.lambdas(mu)?.len()).filter(|&other| other != index) {
        let other = family.point(mu, other)?;
        points.push(mu - (other.lambda - own.lambda) / (2.0 * (other.rate - own.rate)));
    }
    Ok(points)
}
