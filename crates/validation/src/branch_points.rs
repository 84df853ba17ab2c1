//! Which modes an expansion about the median cannot describe up to their onset.
//!
//! The eigenvalue of a mode is an analytic function of mu up to the nearest point of the complex plane where it coalesces
//! with another, a branch point: there its Taylor series about the median ends, and it converges slowly before. Two
//! eigenvalues coalesce where `(lambda_1 - lambda_2)^2`, which is analytic, vanishes; to first order from a real mu that is at
//! `mu - (lambda_1 - lambda_2) / (2 (lambda_1' - lambda_2'))`.

use std::collections::BTreeSet;

use num_complex::Complex;
use squeal::estimators::{Exact, OneParameterFamily};
use squeal::study::{ModeLabel, Reference};
use squeal::tracking::{Branches, link};

use crate::ValidationError;

/// Distance of a branch point from the real mu that shows it, up to which first order is relied on: half of the standard
/// deviation of mu in the paper's case; chosen.
const LARGEST_BRANCH_POINT_OFFSET: f64 = 0.05;
/// Real mu on either side of the median that are asked for branch points; with a third of them branches are lost at sharp
/// turns.
const STEPS_PER_SIDE: usize = 64;
/// Part of the probability in which a mode without an onset is judged; chosen.
const CENTRAL_PROBABILITY: f64 = 0.99;

/// The modes with a branch point nearer to the median than their farthest onset; for those without an onset, than the ends
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

/// How far from `median` the nearest branch point of a mode is, among those near the real mu within `radius`. All modes
/// share the steps of `widest`, and so their spectra.
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

/// Where the mode `index` at `mu` coalesces with each other mode, to first order.
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
