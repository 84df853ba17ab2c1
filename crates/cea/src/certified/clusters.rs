//! Eigenvalues that cannot be told apart, or nearly so: multiple ones and defective or nearly defective pairs.

use nalgebra::{DMatrix, Schur};
use num_complex::Complex;

use super::dd::DdComplex;
use super::refine::residual;
use super::scaled::Scaled;
use super::vectors::{Factor, Vector};

/// Relative distance below which eigenvalues are looked at together whatever their bounds: some 1e5 rounding errors. Chosen.
const SAME_EIGENVALUE: f64 = 1e-11;
/// Relative distance within which a pair is called nearly defective: a convention, for a reader's attention alone.
const NEARLY_DEFECTIVE_GAP: f64 = 1e-3;
/// Squared cosine between right vectors from which a pair is called nearly defective: 1.8 degrees. A convention too.
const NEARLY_DEFECTIVE_COSINE: f64 = 0.999;

/// What kind of neighbours the eigenvalues of a cluster are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ClusterKind {
    /// As many independent vectors as eigenvalues: harmless, each is as well conditioned as a simple one.
    Semisimple,
    /// Fewer vectors than eigenvalues, to working precision: each moves as a root of a perturbation.
    Defective,
    /// Told apart, but with nearly parallel vectors: near an exceptional point.
    NearlyDefective,
}

/// Eigenvalues to be read together.
#[derive(Debug, Clone, PartialEq)]
pub struct Cluster {
    /// Positions in the list of eigenvalues.
    pub members: Vec<usize>,
    /// Their mean, rad/s: well conditioned even where they are not.
    pub mean: Complex<f64>,
    /// Largest distance of a member from the mean, rad/s.
    pub spread: f64,
    /// What they are.
    pub kind: ClusterKind,
}

impl Cluster {
    pub(super) fn of(members: Vec<usize>, eigenvalues: &[Complex<f64>], kind: ClusterKind) -> Self {
        let mean = members.iter().map(|&i| eigenvalues[i]).sum::<Complex<f64>>() / members.len() as f64;
        let spread = members.iter().map(|&i| (eigenvalues[i] - mean).norm()).fold(0.0, f64::max);
        Self { members, mean, spread, kind }
    }
}

/// Largest relative distance of two members, whatever their bounds: eigenvalues known to less than two digits are not grouped
/// with everything in reach.
const WIDEST_GAP: f64 = 1e-2;

/// Groups of nonzero eigenvalues closer than SAME_EIGENVALUE or than four times what each may move by (first order, `shifts`).
pub(super) fn groups(eigenvalues: &[Complex<f64>], shifts: &[f64]) -> Vec<Vec<usize>> {
    let count = eigenvalues.len();
    let mut group: Vec<usize> = (0..count).collect();
    for i in 0..count {
        for j in 0..i {
            let distance = (eigenvalues[i] - eigenvalues[j]).norm();
            let size = eigenvalues[i].norm().min(eigenvalues[j].norm());
            let reach = (4.0 * shifts[i].min(shifts[j])).clamp(SAME_EIGENVALUE * size, WIDEST_GAP * size);
            if size > 0.0 && distance <= reach && group[i] != group[j] {
                let (from, to) = (group[i].max(group[j]), group[i].min(group[j]));
                group.iter_mut().filter(|g| **g == from).for_each(|g| *g = to);
            }
        }
    }
    let mut found = vec![Vec::new(); count];
    for (i, &g) in group.iter().enumerate() {
        found[g].push(i);
    }
    found.retain(|members| members.len() > 1);
    found
}

/// Two eigenvalues that are told apart, with nearly parallel vectors.
pub(super) fn nearly_defective((a, x): (Complex<f64>, &Vector), (b, y): (Complex<f64>, &Vector)) -> bool {
    (a - b).norm() <= NEARLY_DEFECTIVE_GAP * a.norm() && x.dotc(y).norm_sqr() >= NEARLY_DEFECTIVE_COSINE
}

/// A semisimple multiple eigenvalue: independent vectors from both sides and the eigenvalues they give.
pub(super) struct Semisimple {
    pub(super) right: Vec<Vector>,
    pub(super) left: Vec<Vector>,
    /// One for each member, rounded once; none where they would break conjugate pairs.
    pub(super) sigmas: Option<Vec<Complex<f64>>>,
}

/// The members of a cluster from the projection of Q on its null spaces, or nothing where these are too small.
///
/// With orthonormal X and Y, `det(Y^H Q(mu) X + delta Y^H Q'(mu) X) = 0` gives the offsets delta from the mean mu; an
/// error of X and one of Y enter only as their product.
pub(super) fn semisimple(s: &Scaled, members: &[Complex<f64>]) -> Option<Semisimple> {
    let count = members.len();
    let mean = members.iter().sum::<Complex<f64>>() / count as f64;
    let spread = members.iter().map(|l| (l - mean).norm()).fold(0.0, f64::max);
    let factor = Factor::new(s, mean);
    let (right, left) = factor.null_pairs(count)?;
    let size = s.norms.size(mean.norm());
    let rounding = s.order() as f64 * f64::EPSILON;
    let negligible = size * (4.0 * spread / mean.norm() + 10.0 * rounding);
    if right.iter().any(|x| factor.residual(x).norm() > negligible) {
        return None;
    }
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
