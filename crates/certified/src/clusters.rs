//! Eigenvalues that cannot be told apart, or nearly so: multiple ones and defective or nearly defective pairs.

use std::collections::HashSet;

use nalgebra::{DMatrix, Schur};
use num_complex::Complex;

use super::dd::DdComplex;
use super::expansion::{Alone, Disc, Expansion, LARGEST_CHAINED};
use super::measure::State;
use super::residual::residual;
use super::scaled::Scaled;
use super::vectors::Factor;
use crate::lu::Vector;

/// Largest relative distance of a pair that is called nearly defective: a convention, for a reader's attention alone.
const NEARLY_DEFECTIVE_GAP: f64 = 1e-3;
/// Least squared cosine between the right vectors of a pair that is called nearly defective: 1.8 degrees. A convention too.
const NEARLY_DEFECTIVE_COSINE: f64 = 0.999;

/// Kind of a cluster: what kind of neighbours its eigenvalues are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ClusterKind {
    /// Multiple eigenvalue with as many independent vectors as eigenvalues: harmless, each is as well conditioned as a simple one.
    Semisimple,
    /// Multiple eigenvalue with fewer vectors than eigenvalues, to working precision: each moves as a root of a perturbation.
    Defective,
    /// Eigenvalues that are told apart, but with nearly parallel vectors: near an exceptional point.
    NearlyDefective,
}

/// Eigenvalues to be read together.
#[derive(Debug, Clone, PartialEq)]
pub struct Cluster {
    /// Positions in the list of eigenvalues.
    pub members: Vec<usize>,
    /// Mean of the members, rad/s: well conditioned even where they are not.
    pub mean: Complex<f64>,
    /// Largest distance of a member from the mean, rad/s.
    pub spread: f64,
    /// Kind of the cluster.
    pub kind: ClusterKind,
}

impl Cluster {
    pub(super) fn of(members: Vec<usize>, eigenvalues: &[Complex<f64>], kind: ClusterKind) -> Self {
        let mean = members.iter().map(|&i| eigenvalues[i]).sum::<Complex<f64>>() / members.len() as f64;
        let spread = members.iter().map(|&i| (eigenvalues[i] - mean).norm()).fold(0.0, f64::max);
        Self { members, mean, spread, kind }
    }
}

/// Most expansions that are tried around one eigenvalue; chosen: each costs a factorisation.
pub(super) const MOST_EXPANSIONS: usize = 6;
/// Least distance of the next eigenvalue from the mean of a group that is tried, as a multiple of the distance of its farthest member; chosen: on a circle
/// between them the group's own power of the distance is to outweigh the other terms of its series.
const CLEARANCE: f64 = 1.5;
/// Radius of the smallest circle that is tried around a group, as a multiple of the distance of its farthest member; also the distance of the next eigenvalue,
/// as a multiple of the radius of the largest circle; chosen.
const MARGIN: f64 = 1.05;

/// Eigenvalues that are enclosed together.
pub(super) struct Enclosed {
    pub(super) members: Vec<usize>,
    /// Holds as many eigenvalues of every problem within rounding of this one.
    pub(super) disc: Disc,
    /// Members of a semisimple group from its common null space.
    pub(super) space: Option<Semisimple>,
}

/// A disc around one eigenvalue alone, of which no other is nearer than `gap`.
pub(super) fn enclose_alone(factor: &Factor, state: &State, gap: f64) -> Alone {
    if gap < state.first_order() {
        return Alone::Open;
    }
    let most = largest_radius(state.sigma, gap);
    let disc = |expansion: &Expansion| if state.blur > most { None } else { expansion.disc(0.0, most) };
    let outcome = |expansion: Expansion| match disc(&expansion) {
        Some(disc) => Alone::Enclosed(disc),
        None if expansion.is_crowded() => Alone::Crowded,
        None => Alone::Open,
    };
    if state.sigma == factor.sigma {
        return outcome(Expansion::alone(factor, &state.x, &state.y));
    }
    let factor = Factor::new(factor.problem, state.sigma);
    factor.null_pairs(1).map_or(Alone::Open, |(x, y)| outcome(Expansion::alone(&factor, &x[0], &y[0])))
}

/// The smallest group around eigenvalue `i`, of this state, that an expansion encloses: it and the nearest others, however few or many,
/// but not fewer than the directions that rounding hides; not it alone where others are as near as its first-order bound. Groups join
/// `seen` as they are tried, so that none is tried again around another of its members, and count as tried where `blurs`, one for each
/// eigenvalue, leave no circle between members and others.
pub(super) fn enclose(
    s: &Scaled,
    eigenvalues: &[Complex<f64>],
    blurs: &[f64],
    i: usize,
    state: &State,
    seen: &mut HashSet<Vec<usize>>,
) -> Option<Enclosed> {
    let distance = |j: usize, from: Complex<f64>| (eigenvalues[j] - from).norm();
    // As `distance(j, from) < limit`, mostly without the root: no part is greater than the whole.
    let is_nearer = |j: usize, from: Complex<f64>, limit: f64| {
        let apart = eigenvalues[j] - from;
        apart.re.abs() < limit && apart.im.abs() < limit && apart.norm() < limit
    };
    let mut nearest: Vec<_> = (0..eigenvalues.len()).map(|j| (distance(j, eigenvalues[i]), j)).collect();
    nearest.sort_by(|a, b| a.0.total_cmp(&b.0));
    let nearest: Vec<usize> = nearest.into_iter().map(|(_, j)| j).collect();
    let least = if state.alone == Alone::Crowded { state.hidden.max(2) } else { 1 };
    let mut tried = 0;
    for count in least..=nearest.len().min(s.order().max(LARGEST_CHAINED)) {
        let (members, others) = nearest.split_at(count);
        let mean = members.iter().map(|&j| eigenvalues[j]).sum::<Complex<f64>>() / count as f64;
        let spread = members.iter().map(|&j| distance(j, mean)).fold(0.0, f64::max);
        if others.iter().any(|&j| is_nearer(j, mean, CLEARANCE * spread)) {
            continue;
        }
        let nearer = |next: f64, &j: &usize| if is_nearer(j, mean, next) { distance(j, mean) } else { next };
        let next = others.iter().fold(f64::INFINITY, nearer);
        if next == 0.0 || (count == 1 && next < state.first_order()) {
            continue;
        }
        if tried == MOST_EXPANSIONS {
            break;
        }
        tried += 1;
        let mut group = members.to_vec();
        group.sort_unstable();
        if !seen.insert(group) {
            continue;
        }
        let inner = members.iter().map(|&j| distance(j, mean) + blurs[j]).fold(0.0, f64::max);
        // Of eigenvalues that are no larger than the circle: rounding moves what is on it by no less.
        let blurred = |&j: &usize| eigenvalues[j].norm() <= mean.norm() + inner;
        let outer = others.iter().copied().filter(blurred).map(|j| distance(j, mean) - blurs[j]);
        let most = largest_radius(mean, next);
        if inner > outer.fold(most, f64::min) {
            continue;
        }
        let Some(expansion) = Expansion::new(s, mean, count) else { continue };
        if let Some(disc) = expansion.disc(MARGIN * spread, most) {
            let own: Vec<_> = members.iter().map(|&j| eigenvalues[j]).collect();
            let semisimple = count > 1 && expansion.is_semisimple();
            let space = semisimple.then(|| project(s, mean, &own, expansion.right, expansion.left)).flatten();
            return Some(Enclosed { members: members.to_vec(), disc, space });
        }
    }
    None
}

/// Radius of the largest disc, where the next eigenvalue is so far from its centre; one larger than its centre and than gamma says nothing.
fn largest_radius(centre: Complex<f64>, next: f64) -> f64 {
    (next / MARGIN).min(centre.norm().max(1.0))
}

/// True if two eigenvalues that are told apart are near, with nearly parallel vectors.
pub(super) fn nearly_defective((a, x): (Complex<f64>, &Vector), (b, y): (Complex<f64>, &Vector)) -> bool {
    (a - b).norm() <= NEARLY_DEFECTIVE_GAP * a.norm() && x.dotc(y).norm_sqr() >= NEARLY_DEFECTIVE_COSINE
}

/// A semisimple multiple eigenvalue: independent vectors from both sides and the eigenvalues they give.
pub(super) struct Semisimple {
    pub(super) right: Vec<Vector>,
    pub(super) left: Vec<Vector>,
    /// Eigenvalues, one for each member, rounded once; none where they would break conjugate pairs.
    pub(super) sigmas: Option<Vec<Complex<f64>>>,
}

/// The members of a semisimple group from the projection of Q on its null spaces, or nothing where this fails.
///
/// With orthonormal X and Y, `det(Y^H Q(mu) X + delta Y^H Q'(mu) X) = 0` gives the offsets delta from the mean mu; an
/// error of X and one of Y enter only as their product.
fn project(
    s: &Scaled,
    mean: Complex<f64>,
    members: &[Complex<f64>],
    right: Vec<Vector>,
    left: Vec<Vector>,
) -> Option<Semisimple> {
    let count = members.len();
    let images: Vec<_> = right
        .iter()
        .map(|x| residual(s, mean.into(), &x.iter().map(|&z| DdComplex::from(z)).collect::<Vec<_>>()))
        .collect();
    let slopes: Vec<_> = right.iter().map(|x| s.derivative_times(mean, x)).collect();
    let projected = |v: &[Vector]| DMatrix::from_fn(count, count, |i, j| left[i].dotc(&v[j]));
    let inverse = projected(&slopes).try_inverse()?;
    let offsets = -(inverse * projected(&images));
    let offsets = match count {
        1 => offsets.diagonal(),
        _ => Schur::try_new(offsets, f64::EPSILON, 100 * count)?.eigenvalues()?,
    };
    let mut sigmas: Vec<_> = offsets.iter().map(|d| mean + d).collect();
    let tiny = 4.0 * f64::EPSILON * mean.norm();
    if members.iter().all(|s| s.im == 0.0) && sigmas.iter().all(|s| s.im.abs() <= tiny) {
        sigmas.iter_mut().for_each(|s| s.im = 0.0);
    }
    let side = |f: fn(f64) -> bool| members.iter().chain(&sigmas).all(|s| f(s.im));
    let keeps_pairs = side(|im| im > 0.0) || side(|im| im < 0.0) || side(|im| im == 0.0);
    Some(Semisimple { right, left, sigmas: keeps_pairs.then_some(sigmas) })
}
