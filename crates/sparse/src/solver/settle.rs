//! Merging of the eigenpairs that overlapping discs found: a list that has each once, in both half planes.
//!
//! The matrices are real, so the spectrum is symmetric about the real axis, and the eigenvalues within rounding of the axis together span an
//! invariant space that has a real basis. The distance to which rounding may move two eigenvalues apart that are one is their *blur*, rad/s
//! (`Pencil::blur`); eigenvalues that are no farther apart are a *group*. A group of several eigenvalues that is ill conditioned or meets the axis is solved
//! again in its space: Q is projected on real bases of right and left vectors, which leaves a small real problem, and that is certified.

use faer::Mat;
use linsys::{Internal, SecondOrder};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::blocks::another_block;
use super::disc::Problem;
use super::factor::Factor;
use super::groups::groups;
use super::orthogonal::Orthogonal;
use super::polish::{Polished, ROUNDING_ONLY, pair_of};
use super::products::Side;
use super::types::{Counters, Eigenpair};
use crate::SparseError;

/// Condition number at which a member of a group is ill conditioned, so that the whole group is solved again; chosen: with a smaller number, groups whose
/// members are good are solved again; with a larger one, members stay whose vectors have lost their digits to each other.
const ILL: f64 = 1e5;
/// Largest distance, relative to |lambda|, of an eigenvalue that one disc found from the same one found by another; the bound of either, if that is larger.
/// Chosen: with less, an eigenvalue that two discs found is listed twice; with more, two neighbours have to differ in their vectors to be listed both.
const FOUND_TWICE: f64 = 1e-9;
/// Smallest length of the component of a unit eigenvector outside the span of others, for it to be a vector of its own; chosen: with less, the errors of a
/// vector that was found twice count as a second vector; with more, two eigenvectors that are nearly one count once.
const INDEPENDENT: f64 = 1e-4;
/// Largest backward error in the whole problem of a pair of the projected problem; chosen: a pair with a larger error is not kept.
const CONVERGED: f64 = 1e-9;
/// Number of vectors that are iterated beside the vectors of a group, to find its space; chosen: with none, what members lack of the space is found slowly.
const BESIDE_VECTORS: usize = 2;
/// Number of steps of that iteration; chosen: eigenvalues elsewhere are a thousand times farther from the shift, so that each step gives three digits.
const STEPS: usize = 4;
/// Distance of the shift of that iteration from the mean of the group, in spreads of the group, but no less than in blurs; chosen: nearer the factors are singular to
/// rounding, farther the group stands out less from its neighbours.
const BESIDE: [f64; 2] = [4.0, 20.0];
/// Direction in which the shift lies: neither along the axes, where conjugates and neighbours in frequency are, nor between them.
const BESIDE_DIRECTION: Complex<f64> = Complex::new(0.8, 0.6);
/// Largest distance from the mean of a group, in spreads of it and in blurs, both together, of an eigenvalue of the projected problem that belongs to the group; chosen: members that the
/// discs found scatter by their spread, and those found anew by some blurs about them.
const OWN: [f64; 2] = [2.0, 8.0];
/// Largest distance of a member from the first one, in blurs, of a narrow group: two members are then no farther apart than the least margin of a disc, which is twice that.
const NARROW: f64 = 2.0;
/// Smallest singular value, relative to the largest, of a direction of a space that is more than noise; chosen: with less, directions of rounding enter
/// the projected problem; with more, those in which nearly defective members differ leave it.
const NOISE: f64 = 1e-6;

type Vector = DVector<Complex<f64>>;
/// Complex vectors in columns.
type Block = Mat<Complex<f64>>;

/// The eigenpairs of both half planes, from the pairs that the discs found in the upper half plane and next to the real axis, each with the number of its disc.
///
/// # Errors
/// [`SparseError::GroupLost`] where the space of a group has fewer eigenvalues than a disc found.
pub(super) fn settled(
    problem: &Problem,
    found: Vec<(usize, Polished)>,
    counters: &mut Counters,
) -> Result<Vec<Eigenpair>, SparseError> {
    let pencil = &problem.pencil;
    let lambdas: Vec<_> = found.iter().map(|(_, polished)| polished.ritz).collect();
    let (mut upper, mut all) = (Vec::new(), Vec::new());
    let mut found: Vec<_> = found.into_iter().map(Some).collect();
    for group in groups(&lambdas, |lambda| pencil.blur(lambda)) {
        let members: Vec<_> = group.iter().filter_map(|&i| found[i].take()).collect();
        let blur = members.iter().map(|(_, member)| pencil.blur(member.ritz)).fold(0.0, f64::max);
        // With structural damping Q is not real on the real axis, and nothing is sought there.
        let is_real = !pencil.is_structurally_damped();
        // Only there is an eigenvalue in one group with its conjugate. A group wholly below the axis has the conjugates of one above, which is listed with its conjugates: it is left
        // out.
        let is_on_real_axis = is_real && members.iter().any(|(_, member)| 2.0 * member.ritz.im.abs() <= blur);
        if !is_on_real_axis && members.iter().all(|(_, member)| member.ritz.im < 0.0) {
            continue;
        }
        let of_one_disc = |disc: usize| members.iter().filter(|(other, _)| *other == disc).count();
        let copies = members.iter().map(|(disc, _)| of_one_disc(*disc)).max().unwrap_or(0);
        // A disc finds what is within a margin of its part, too. If the group is no wider than that margin, one disc has found all of it: the disc with
        // the most members; the members of the other discs are the same again.
        let first = members[0].1.ritz;
        let is_narrow = members.iter().all(|(_, member)| (member.ritz - first).norm() <= NARROW * blur);
        if is_on_real_axis
            && copies == 1
            && let Some(pair) = real(problem, &members[0].1)
        {
            all.push(pair);
            continue;
        }
        let is_fine = |(_, member): &(usize, Polished)| member.is_good && member.pair.condition < ILL;
        // With structural damping a group has no real basis: it stays as it is, with the bounds that it has.
        if !is_on_real_axis && (copies == 1 || !is_real || members.iter().all(is_fine)) {
            let fullest = members.iter().map(|(disc, _)| *disc).find(|&disc| of_one_disc(disc) == copies);
            let chosen = members.into_iter().filter(|(disc, _)| !is_narrow || Some(*disc) == fullest);
            upper.extend(chosen.map(|(disc, member)| (disc, member.pair)));
            continue;
        }
        // Of a wider one each disc may lack members that others have.
        let apart = || members.iter().map(|(disc, member)| (*disc, member.pair.clone())).collect();
        let copies = if is_narrow { copies } else { copies.max(without_duplicates(apart()).len()) };
        let pairs = in_space(problem, &members, (copies, is_on_real_axis), blur, counters)?.unwrap_or_default();
        if pairs.len() < copies {
            let lambda = members[0].1.ritz;
            return Err(SparseError::GroupLost { lambda, found: copies, settled: pairs.len() });
        }
        if is_on_real_axis {
            all.extend(pairs);
        } else {
            pairs.iter().for_each(|pair| all.push(conjugate(pair)));
            all.extend(pairs);
        }
    }
    for pair in without_duplicates(upper) {
        if pair.lambda.im >= 0.0 {
            all.push(conjugate(&pair));
            all.push(pair);
        }
    }
    Ok(all)
}

fn conjugate(pair: &Eigenpair) -> Eigenpair {
    let (right, left) = (pair.right.conjugate(), pair.left.conjugate());
    Eigenpair { lambda: pair.lambda.conj(), right, left, ..pair.clone() }
}

/// An eigenvalue that is alone in its group, and not told apart from the real axis, is real, as its conjugate would be in the group too, and so are its vectors;
/// `None` where the real pair has not converged.
fn real(problem: &Problem, member: &Polished) -> Option<Eigenpair> {
    let real = |v: &Vector| v.map(|z| Complex::from(z.re));
    let (right, left) = (real(&member.pair.right), real(&member.pair.left));
    let pair = pair_of(&problem.pencil, Complex::from(member.pair.lambda.re), &right, &left);
    (member.is_good && pair.backward_error <= CONVERGED).then_some(pair)
}

/// The eigenpairs of a group from the space that its vectors span, as many as it has copies at most, and those above the real axis alone where the group is. `blur` is
/// the largest of its members, rad/s. `None` if the matrix at the shift is singular, a solution there is not accurate, or the projected problem cannot be certified.
fn in_space(
    problem: &Problem,
    members: &[(usize, Polished)],
    (copies, is_on_real_axis): (usize, bool),
    blur: f64,
    counters: &mut Counters,
) -> Result<Option<Vec<Eigenpair>>, SparseError> {
    let (pencil, n) = (&problem.pencil, problem.pencil.order());
    let mean = members.iter().map(|(_, member)| member.ritz).sum::<Complex<f64>>() / members.len() as f64;
    let spread = members.iter().map(|(_, member)| (member.ritz - mean).norm()).fold(0.0, f64::max);
    let beside = mean + BESIDE_DIRECTION * (BESIDE[0] * spread).max(BESIDE[1] * blur);
    counters.factorisations += 1;
    let factor = match Factor::new(&problem.symbolic, pencil, beside) {
        Err(SparseError::Singular { .. }) => return Ok(None),
        factor => factor?,
    };
    let columns = (members.len() + BESIDE_VECTORS).min(n);
    let other = another_block(n, columns, 1);
    let start = |i: usize, j: usize| members.get(j).map_or(other[(i, j)], |(_, member)| member.pair.right[i]);
    let spaces = [(Side::Right, Mat::from_fn(n, columns, start)), (Side::Left, another_block(n, columns, 2))];
    let mut bases = Vec::with_capacity(2);
    for (side, start) in spaces {
        counters.solves += STEPS * columns;
        match space(&factor, side, start) {
            Err(SparseError::Solve { .. }) => return Ok(None),
            basis => bases.push(real_basis(&basis?)),
        }
    }
    // The larger of both ranks: with the smaller one a member would be lost of which one side alone has two vectors to rounding.
    let rank = |(singular, _): &(Vec<f64>, DMatrix<f64>)| singular.iter().filter(|s| **s > NOISE * singular[0]).count();
    let order = bases.iter().map(rank).max().unwrap_or(0).min(bases.iter().map(|(_, u)| u.ncols()).min().unwrap_or(0));
    let [v, w] = [0, 1].map(|side| bases[side].1.columns(0, order).into_owned());
    let small = projected(problem, &v, &w)?;
    let mut computed = cea::certified::Counters::default();
    let certified = cea::certified::solve(&small, &mut computed)
        .and_then(|spectrum| cea::certified::certify(&small, &spectrum, &mut computed));
    let Ok(certified) = certified else { return Ok(None) };
    let whole = |basis: &DMatrix<f64>, z: &Vector| basis.map(Complex::from) * z.rows(0, order);
    let mut pairs = Vec::new();
    // Real bases have the conjugates too.
    let is_own = |lambda: Complex<f64>| {
        (lambda - mean).norm() <= OWN[0] * spread + OWN[1] * blur && (is_on_real_axis || lambda.im > 0.0)
    };
    for e in certified.eigenvalues.iter().filter(|e| is_own(e.lambda)) {
        let pair = pair_of(pencil, e.lambda, &whole(&v, &e.right), &whole(&w, &e.left.conjugate()));
        if pair.backward_error <= CONVERGED {
            // The bound of the projected problem is for its rounding errors; it is multiplied by the backward error in the whole problem, in roundings. The first-order bound of a
            // pair of a group means nothing beyond a blur, as far as rounding moves the group.
            let more = (pair.backward_error / (0.5 * f64::EPSILON)).max(1.0);
            let bound = (e.bound * more).max(pair.bound.min(blur));
            let verdict = match e.verdict {
                cea::Verdict::Marginal { .. } if bound <= blur && pair.backward_error <= ROUNDING_ONLY => e.verdict,
                _ => cea::Verdict::of(e.lambda, bound),
            };
            pairs.push(Eigenpair { bound, verdict, ..pair });
        }
    }
    // The vectors iterated beside the vectors of the group may have given pairs of other eigenvalues, those of other groups among them, which are farther than a blur from
    // all members.
    let is_others = |pair: &Eigenpair| members.iter().all(|(_, member)| (member.ritz - pair.lambda).norm() > blur);
    pairs.sort_by(|a, b| is_others(a).cmp(&is_others(b)).then(a.backward_error.total_cmp(&b.backward_error)));
    pairs.truncate(copies);
    Ok(Some(pairs))
}

/// The space, as orthonormal columns, to which [`STEPS`] products with `Q^-1 Q'` at the shift take a block, Q' the derivative of Q by lambda: the space of the eigenvalues next to
/// the shift, to first order in their distance from it, so that what is made of it is asked for its backward error.
fn space(factor: &Factor<'_>, side: Side, start: Block) -> Result<Block, SparseError> {
    let pencil = factor.pencil();
    let weights = pencil.slope_weights(factor.shift());
    let mut x = start;
    for _ in 0..STEPS {
        let slopes: Vec<_> = pencil.parts(side, &x).iter().map(|parts| parts.sum(&weights)).collect();
        let slopes = Mat::from_fn(x.nrows(), x.ncols(), |i, j| slopes[j][i]);
        let mut basis = Orthogonal::new(x.nrows());
        basis.append(factor.solve(side, &slopes)?);
        x = Mat::from_fn(x.nrows(), basis.columns(), |i, j| basis.basis()[j][i]);
    }
    Ok(x)
}

/// Orthonormal real columns that span the real and the imaginary parts of a block, with their singular values, the largest first.
fn real_basis(x: &Block) -> (Vec<f64>, DMatrix<f64>) {
    let count = x.ncols();
    let parts =
        DMatrix::from_fn(x.nrows(), 2 * count, |i, j| if j < count { x[(i, j)].re } else { x[(i, j - count)].im });
    let svd = parts.svd(true, false);
    let u = svd.u.unwrap_or_else(|| DMatrix::zeros(x.nrows(), 0));
    (svd.singular_values.iter().copied().collect(), u)
}

/// The projected problem `W^T Q V` of real bases V and W.
fn projected(problem: &Problem, v: &DMatrix<f64>, w: &DMatrix<f64>) -> Result<SecondOrder, SparseError> {
    let (pencil, order) = (&problem.pencil, v.ncols());
    let parts = pencil.parts(Side::Right, &Mat::from_fn(v.nrows(), order, |i, j| Complex::from(v[(i, j)])));
    let [m, c, k] = [0, 1, 2].map(|part| {
        let product = DMatrix::from_fn(v.nrows(), order, |i, j| parts[j].products[part][i].re);
        w.tr_mul(&product)
    });
    let states = pencil.states();
    let mut internal = Internal::zeros(order, states.len());
    for (i, state) in states.iter().enumerate() {
        internal.decay[i] = state.decay;
        for j in 0..order {
            internal.drive[(i, j)] = state.drive.iter().map(|&(dof, e)| e * v[(dof, j)]).sum();
            internal.force[(j, i)] = state.force.iter().map(|&(dof, f)| f * w[(dof, j)]).sum();
        }
    }
    Ok(SecondOrder::with_internal(m, c, k, internal)?)
}

/// The pairs that the discs found, each with the number of its disc, without pairs that an earlier disc found too.
fn without_duplicates(found: Vec<(usize, Eigenpair)>) -> Vec<Eigenpair> {
    let mut kept: Vec<(usize, Eigenpair)> = Vec::with_capacity(found.len());
    for (disc, pair) in found {
        let near = |other: &(usize, Eigenpair)| {
            let bound = |pair: &Eigenpair| if pair.bound.is_finite() { pair.bound } else { 0.0 };
            let reach = (FOUND_TWICE * pair.lambda.norm()).max(bound(&pair)).max(bound(&other.1));
            other.0 != disc && (other.1.lambda - pair.lambda).norm() <= reach
        };
        let mut outside = pair.right.clone();
        let mut basis: Vec<Vector> = Vec::new();
        for (_, other) in kept.iter().filter(|other| near(other)) {
            let mut direction = other.right.clone();
            basis.iter().for_each(|b| direction -= b * b.dotc(&direction));
            if direction.norm() > INDEPENDENT {
                let direction = direction.normalize();
                outside -= &direction * direction.dotc(&outside);
                basis.push(direction);
            }
        }
        if outside.norm() > INDEPENDENT {
            kept.push((disc, pair));
        }
    }
    kept.into_iter().map(|(_, pair)| pair).collect()
}
