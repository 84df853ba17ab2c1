//! Eigenvalues that are there once each, from what all discs found.
//!
//! The matrices are real, so the spectrum is symmetric about the real axis, and what rounding does not tell apart from the axis has an
//! invariant space with a real basis. Groups of eigenvalues that rounding does not tell apart are solved in their space: Q is projected
//! on real bases of right and left vectors, which leaves a small real problem, and that is certified.

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

/// Condition number from which on a member of a group is solved with the others; chosen: with less groups are solved again whose members are good, with
/// more vectors of members stay that have lost their digits to each other.
const ILL: f64 = 1e5;
/// Distance of the same eigenvalue found twice, relative, where the bounds of both are not larger; chosen: with less one that two discs found is listed
/// twice, with more two that are one next to the other have to differ in their vectors.
const FOUND_TWICE: f64 = 1e-9;
/// Part of a unit vector outside the span of others below which it is none of its own; chosen: with less the errors of a vector that was found twice count
/// as a second one, with more two eigenvectors that are nearly one count once.
const INDEPENDENT: f64 = 1e-4;
/// Backward error up to which a pair of a projected problem is one of the whole; chosen.
const CONVERGED: f64 = 1e-9;
/// Vectors that are iterated with those of a group, steps, and distance of the shift from its mean, in units of what rounding does.
const BESIDE_VECTORS: usize = 2;
const STEPS: usize = 4;
const BESIDE: f64 = 20.0;
/// Part of the largest singular value below which a direction of a space is noise; chosen: with less directions of rounding enter
/// the projected problem, with more those by which nearly defective members differ leave it.
const NOISE: f64 = 1e-6;

type Vector = DVector<Complex<f64>>;
type Block = Mat<Complex<f64>>;

/// The eigenpairs of both half planes, of what the discs found in the upper one and next to the real axis.
///
/// # Errors
/// [`SparseError::GroupLost`] where fewer eigenvalues of a group are found in its space than by a disc.
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
        // With structural damping nothing is sought on the real axis, and Q is not real there.
        let is_real = !pencil.is_structurally_damped();
        let is_on_axis = is_real && members.iter().any(|(_, member)| member.ritz.im.abs() <= blur);
        let of_one_disc = |disc: usize| members.iter().filter(|(other, _)| *other == disc).count();
        let copies = members.iter().map(|(disc, _)| of_one_disc(*disc)).max().unwrap_or(0);
        if is_on_axis
            && copies == 1
            && let Some(pair) = real(problem, &members[0].1)
        {
            all.push(pair);
            continue;
        }
        let is_fine = |(_, member): &(usize, Polished)| member.is_good && member.pair.condition < ILL;
        // No real basis holds a group with structural damping: it stays, with the bounds that it has.
        if !is_on_axis && (copies == 1 || !is_real || members.iter().all(is_fine)) {
            // A disc that has any of a group that is no wider than its margin has all, or another one does.
            let middle = members[0].1.ritz;
            let is_narrow = members.iter().all(|(_, member)| (member.ritz - middle).norm() <= 2.0 * blur);
            let fullest = members.iter().map(|(disc, _)| *disc).find(|&disc| of_one_disc(disc) == copies);
            let chosen = members.into_iter().filter(|(disc, _)| !is_narrow || Some(*disc) == fullest);
            upper.extend(chosen.map(|(disc, member)| (disc, member.pair)));
            continue;
        }
        let pairs = in_space(problem, &members, copies, blur, counters)?.unwrap_or_default();
        if pairs.len() < copies {
            let lambda = members[0].1.ritz;
            return Err(SparseError::GroupLost { lambda, found: copies, settled: pairs.len() });
        }
        if is_on_axis {
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

/// The only eigenvalue that is not told apart from the real axis is real, and so are its vectors; `None` where the real pair has not converged.
fn real(problem: &Problem, member: &Polished) -> Option<Eigenpair> {
    let real = |v: &Vector| v.map(|z| Complex::from(z.re));
    let (right, left) = (real(&member.pair.right), real(&member.pair.left));
    let pair = pair_of(&problem.pencil, Complex::from(member.pair.lambda.re), &right, &left);
    (member.is_good && pair.backward_error <= CONVERGED).then_some(pair)
}

/// The eigenpairs of a group, of which a disc found so many copies, from the space that its vectors span; `None` where nothing can be
/// said of it.
fn in_space(
    problem: &Problem,
    members: &[(usize, Polished)],
    copies: usize,
    blur: f64,
    counters: &mut Counters,
) -> Result<Option<Vec<Eigenpair>>, SparseError> {
    let (pencil, n) = (&problem.pencil, problem.pencil.order());
    let mean = members.iter().map(|(_, member)| member.ritz).sum::<Complex<f64>>() / members.len() as f64;
    let spread = members.iter().map(|(_, member)| (member.ritz - mean).norm()).fold(0.0, f64::max);
    let beside = mean + Complex::new(0.8, 0.6) * (4.0 * spread).max(BESIDE * blur);
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
    let clear =
        |(singular, _): &(Vec<f64>, DMatrix<f64>)| singular.iter().filter(|s| **s > NOISE * singular[0]).count();
    let order = bases.iter().map(clear).max().unwrap_or(0).min(bases.iter().map(|(_, u)| u.ncols()).min().unwrap_or(0));
    let [v, w] = [0, 1].map(|side| bases[side].1.columns(0, order).into_owned());
    let small = projected(problem, &v, &w)?;
    let mut computed = cea::certified::Counters::default();
    let certified = cea::certified::solve(&small, &mut computed)
        .and_then(|spectrum| cea::certified::certify(&small, &spectrum, &mut computed));
    let Ok(certified) = certified else { return Ok(None) };
    let whole = |basis: &DMatrix<f64>, z: &Vector| basis.map(Complex::from) * z.rows(0, order);
    let mut pairs = Vec::new();
    for e in certified.eigenvalues.iter().filter(|e| (e.lambda - mean).norm() <= 2.0 * spread + 8.0 * blur) {
        let pair = pair_of(pencil, e.lambda, &whole(&v, &e.right), &whole(&w, &e.left.conjugate()));
        if pair.backward_error <= CONVERGED {
            // The bound is of the projected problem, for rounding errors; what is left of the projection is counted to it.
            let more = (pair.backward_error / (0.5 * f64::EPSILON)).max(1.0);
            let bound = (e.bound * more).max(pair.bound.min(blur));
            let verdict = match e.verdict {
                cea::Verdict::Marginal { .. } if bound <= blur && pair.backward_error <= ROUNDING_ONLY => e.verdict,
                _ => cea::Verdict::of(e.lambda, bound),
            };
            pairs.push(Eigenpair { bound, verdict, ..pair });
        }
    }
    // A vector beside those of the space has a backward error too: as many are the group as a disc has copies.
    pairs.sort_by(|a, b| a.backward_error.total_cmp(&b.backward_error));
    pairs.truncate(copies);
    Ok(Some(pairs))
}

/// The space that `Q^-1 Q'` at the shift takes a block to in some steps: that of the eigenvalues next to it.
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

/// Orthonormal real columns that span real and imaginary parts, with their singular values, the largest first.
fn real_basis(x: &Block) -> (Vec<f64>, DMatrix<f64>) {
    let count = x.ncols();
    let parts =
        DMatrix::from_fn(x.nrows(), 2 * count, |i, j| if j < count { x[(i, j)].re } else { x[(i, j - count)].im });
    let svd = parts.svd(true, false);
    let u = svd.u.unwrap_or_else(|| DMatrix::zeros(x.nrows(), 0));
    (svd.singular_values.iter().copied().collect(), u)
}

/// `W^T Q V` of real bases.
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

/// Pairs that two discs found are kept once.
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
