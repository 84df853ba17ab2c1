//! Branches of eigenvalues over one real parameter: which eigenvalue at one parameter continues which eigenvalue at another.
//!
//! The tangents at both ends of a step are extended to its middle. The two tangents of one analytic branch miss each other
//! there by the third power of the step, and their slopes differ by its first power; the tangents of two branches miss by more, also
//! where the eigenvalues cross. A link is clear where its tangents meet far better than the tangents of every other link from the
//! same mode; a step without a clear link is halved.

use std::collections::BTreeSet;

use cea::{CeaError, EQUAL_BUT_FOR_ROUNDING, Eigentriple, Workspace};
use linsys::SecondOrder;
use nalgebra::DMatrix;
use num_complex::Complex;

use crate::step_control::PredictorErrors;

/// Weight of the change of slope, relative to the distance of the tangents, in the error of a link; chosen: with less, the slope tells branches apart less;
/// with more, a branch that turns has a larger error.
const DIRECTION_WEIGHT: f64 = 0.25;
/// Largest error of a clear link, as a fraction of the error of the second best link; chosen: with less, more steps are halved; with more, a link may lead to
/// another branch.
const CLEAR_LINK_ERROR: f64 = 0.25;
/// Number of eigenvalues nearest to the tangent at the middle of the step that are compared as links; chosen: the derivatives
/// of the others need not be computed.
const COMPARED_EIGENVALUES: usize = 4;
/// Number of steps that an interval is divided into before any step is halved; chosen: with fewer, more of them are halved; with more, more spectra are taken
/// where nothing happens.
pub(crate) const FIRST_STEPS: usize = 16;

/// An eigenvalue and its derivative by the parameter.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct BranchPoint {
    /// The eigenvalue, rad/s.
    pub lambda: Complex<f64>,
    /// Derivative d lambda / d parameter, rad/s per unit of the parameter.
    pub rate: Complex<f64>,
}

/// A refined eigenvalue with a bound of its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RefinedPoint {
    /// lambda, rad/s, after one Newton step with the left and the right eigenvector.
    pub lambda: Complex<f64>,
    /// Derivative d lambda / d parameter, rad/s per unit of the parameter.
    pub rate: Complex<f64>,
    /// Bound of the error of lambda by rounding, rad/s.
    pub bound: f64,
}

impl RefinedPoint {
    /// The eigenvalue of `system` next to `lambda`, refined by its vectors x and y, with
    /// `d lambda / d p = -y^H (d Q / d p) x / y^H Q' x` (Lancaster, Numer. Math. 6, 1964); `derivative` is d Q / d p at `lambda`,
    /// n x n.
    ///
    /// # Errors
    /// Those of [`Eigentriple::new`].
    pub fn new(
        system: &SecondOrder,
        derivative: &DMatrix<Complex<f64>>,
        lambda: Complex<f64>,
        work: &mut Workspace,
    ) -> Result<Self, CeaError> {
        let triple = Eigentriple::new(system, lambda, work)?;
        Ok(Self { lambda: triple.refined(system), rate: triple.rate(derivative), bound: triple.rounding() })
    }
}

/// A parameter, never NaN, as an ordered key of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrderedParameter(pub f64);

impl Eq for OrderedParameter {}

impl PartialOrd for OrderedParameter {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for OrderedParameter {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

/// The eigenvalues of systems with one real parameter, computed where they are asked for and kept.
///
/// A family of systems is a trait because only the maker of the systems knows how to find a spectrum and the derivative by the parameter.
/// All methods are called many times with the same parameter.
pub trait Branches {
    /// The error of a system or of a solution.
    type Error;

    /// Eigenvalues, one of each conjugate pair, rad/s, ascending in frequency. Their number differs from parameter to parameter only where the family
    /// lets modes become overdamped or leave a band.
    ///
    /// # Errors
    /// Errors of the systems and of the solver.
    fn lambdas(&mut self, at: f64) -> Result<&[Complex<f64>], Self::Error>;

    /// The eigenvalue `index` of [`Branches::lambdas`] with its derivative.
    ///
    /// # Errors
    /// As [`Branches::lambdas`], and errors of the eigenvectors.
    fn point(&mut self, at: f64, index: usize) -> Result<BranchPoint, Self::Error>;

    /// The eigenvalue next to `lambda`, one of [`Branches::lambdas`], to full accuracy.
    ///
    /// # Errors
    /// As [`Branches::point`].
    fn refined(&mut self, at: f64, lambda: Complex<f64>) -> Result<RefinedPoint, Self::Error>;

    /// Number of modes that grow at a parameter and are not among [`Branches::lambdas`], where these are not all modes.
    ///
    /// # Errors
    /// As [`Branches::lambdas`].
    fn growing_outside(&mut self, _at: f64) -> Result<usize, Self::Error> {
        Ok(0)
    }

    /// The parameters at which spectra are known, between two parameters and including them, ascending.
    fn known_between(&self, from: f64, to: f64) -> Vec<f64>;
}

/// The mode at the end of a step that best continues a mode at its beginning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BranchLink {
    /// Index of the mode at the end of the step.
    pub to: usize,
    /// The [`link_error`], rad/s.
    pub error: f64,
    /// True if the error is far below the errors of all other links of the two modes.
    pub is_clear: bool,
}

/// The error of a link, rad/s: the distance of the tangents from both ends of a step at its middle, which is the error of the
/// trapezoidal rule, plus a quarter of the change of slope. `changes` are the derivatives at the two ends times the step; with
/// several parameters, the sum over the parameters.
///
/// Along one analytic branch the first term is of the third order of the step and the second of the second; between two
/// branches they are of the first order, also where the branches cross in the middle.
pub fn link_error(ends: [Complex<f64>; 2], changes: [Complex<f64>; 2]) -> f64 {
    PredictorErrors::new(ends, changes, 1.0).trapezoid + DIRECTION_WEIGHT * (changes[1] - changes[0]).norm()
}

/// [`link_error`] of a step of one parameter.
fn step_error(from: BranchPoint, to: BranchPoint, step: f64) -> f64 {
    link_error([from.lambda, to.lambda], [from.rate * step, to.rate * step])
}

/// The best link of the mode `index` at `a` to a mode at `b`; a link with an infinite error where there is no mode at `b`.
///
/// # Errors
/// Those of the branches.
pub fn link<B: Branches + ?Sized>(branches: &mut B, a: f64, index: usize, b: f64) -> Result<BranchLink, B::Error> {
    let from = branches.point(a, index)?;
    let (best, second) = two_best(branches, from, a, b)?;
    if best.1.is_infinite() {
        return Ok(BranchLink { to: 0, error: best.1, is_clear: false });
    }
    let there = branches.point(b, best.0)?;
    let (back, rival) = two_best(branches, there, b, a)?;
    // A branch that goes with another one, equal to it at both ends, is as good as that one.
    let is_back = back.0 == index || is_equal(branches.lambdas(a)?[back.0], from.lambda);
    let is_clear = best.1 <= CLEAR_LINK_ERROR * second.min(rival) && is_back;
    Ok(BranchLink { to: best.0, error: best.1, is_clear })
}

/// True if two eigenvalues are equal but for rounding.
pub(crate) fn is_equal(a: Complex<f64>, b: Complex<f64>) -> bool {
    (a - b).norm() <= EQUAL_BUT_FOR_ROUNDING * b.norm()
}

/// The mode at `b` with the least link error from `from`, that error, and the error of the second best mode. Where `from` is equal to
/// another mode at `a`, a mode that is equal to the best one does not count as second best.
fn two_best<B: Branches + ?Sized>(
    branches: &mut B,
    from: BranchPoint,
    a: f64,
    b: f64,
) -> Result<((usize, f64), f64), B::Error> {
    let step = b - a;
    let predicted = from.lambda + from.rate * (0.5 * step);
    let mut near: Vec<(usize, f64)> =
        branches.lambdas(b)?.iter().enumerate().map(|(j, lambda)| (j, (lambda - predicted).norm())).collect();
    near.sort_by(|x, y| x.1.total_cmp(&y.1));
    let is_multiple = branches.lambdas(a)?.iter().filter(|lambda| is_equal(**lambda, from.lambda)).count() > 1;
    let (mut best, mut second) = ((usize::MAX, f64::INFINITY), f64::INFINITY);
    for &(j, _) in near.iter().take(COMPARED_EIGENVALUES) {
        let point = branches.point(b, j)?;
        let error = step_error(from, point, step);
        if is_multiple && best.1.is_finite() && is_equal(branches.lambdas(b)?[best.0], point.lambda) {
            if error < best.1 {
                best = (j, error);
            }
        } else if error < best.1 {
            second = best.1;
            best = (j, error);
        } else {
            second = second.min(error);
        }
    }
    Ok((best, second))
}

/// The steps with which the search for onsets and the root locus begin, ascending.
pub(crate) fn first_steps(from: f64, to: f64, steps: usize) -> impl Iterator<Item = [f64; 2]> {
    let at = move |i: usize| from + (to - from) * i as f64 / steps as f64;
    (0..steps).map(move |i| [at(i), at(i + 1)])
}

/// The modes at `b` that the mode `index` at `a` may have become: one mode, unless a coalescence lies so near to the branch
/// that a step of the length `smallest` leaves a doubt. The steps lead from one known spectrum to the next, and are halved
/// where a link is not clear.
///
/// # Errors
/// Those of the branches.
pub fn follow_branch<B: Branches + ?Sized>(
    branches: &mut B,
    a: f64,
    index: usize,
    b: f64,
    smallest: f64,
) -> Result<BTreeSet<usize>, B::Error> {
    branches.lambdas(a)?;
    branches.lambdas(b)?;
    let mut known = branches.known_between(a.min(b), a.max(b));
    if a > b {
        known.reverse();
    }
    let mut now = BTreeSet::from([index]);
    for step in known.windows(2) {
        let mut next = BTreeSet::new();
        for &index in &now {
            next.extend(follow_step(branches, step[0], index, step[1], smallest)?);
        }
        now = next;
    }
    Ok(now)
}

/// [`follow_branch`] over one step between known spectra.
fn follow_step<B: Branches + ?Sized>(
    branches: &mut B,
    a: f64,
    index: usize,
    b: f64,
    smallest: f64,
) -> Result<BTreeSet<usize>, B::Error> {
    let best = link(branches, a, index, b)?;
    if best.is_clear {
        return Ok(BTreeSet::from([best.to]));
    }
    let step = b - a;
    if step.abs() <= smallest {
        let from = branches.point(a, index)?;
        let rival_error = best.error / CLEAR_LINK_ERROR;
        let lambdas = branches.lambdas(b)?.to_vec();
        let mut open: BTreeSet<usize> = best.error.is_finite().then_some(best.to).into_iter().collect();
        for (j, lambda) in lambdas.into_iter().enumerate() {
            let is_far = (lambda - from.lambda).norm() > rival_error + from.rate.norm() * step.abs();
            if !is_far && step_error(from, branches.point(b, j)?, step) <= rival_error {
                open.insert(j);
            }
        }
        return Ok(open);
    }
    branches.lambdas(0.5 * (a + b))?;
    follow_branch(branches, a, index, b, smallest)
}
