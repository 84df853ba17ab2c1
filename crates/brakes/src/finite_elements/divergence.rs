//! Divergence of a finite element brake: what grows faster than it oscillates, whatever the band of the case.
//!
//! Up to the end of the band in size the whole brake is searched. Far beyond, single pairs of nodes, which have little mass, grow where the curve of friction
//! falls more steeply than their damping holds. A basis of modes of the band does not have that; but at an eigenvalue s that contacts make, a mode is a
//! combination of the responses `Q_0(s)^-1 b_i` and `Q_0(s)^-1 r_i` of the brake at its medians without friction to forces along all directions of friction
//! b_i and readings r_i. These are smooth in s to the right of the band, so that the responses at a few real numbers hold the responses in between. Loss
//! factors have no part in it: what does not oscillate has no complex stiffness.

use std::f64::consts::TAU;
use std::iter::repeat_n;

use cea::{EigenSolver, QrSolver, ROUNDED_DATA, Spectrum, Threshold, Verdict, Workspace, real_count, right_vector};
use linsys::{AffineSystem, Channel, OperatingPoint, SecondOrder};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use reduction::{growing_real, grows_too_fast, shape_directions, surely_none_grows_too_fast};
use sparse::{Eigenpair, Problem, Rectangle, SparseAffineSystem, SparseSecondOrder, eigenpairs_in};
use study::{ModeSource, Scene};

use super::points::{all_patches, naming_point, of_brake, without_friction};
use super::training::rectangle;
use super::{Diverging, FiniteElementBrake};
use crate::Error;
use crate::case::FiniteElementCase;

/// Smallest real eigenvalue that is looked for as divergence, as a part of the lowest frequency of the band in rad/s; chosen: above the zeros of rigid
/// motions.
const SLOWEST: f64 = 1e-3;
/// Real numbers at which responses are taken, over 2 pi times the highest frequency of the band; chosen: growth of cases/disc-pad reaches 170 times that.
const SHIFTS: [f64; 4] = [1.5, 8.0, 50.0, 400.0];
/// Most contacts at which forces act, thinned evenly; chosen: where single points of a face
/// diverge their neighbours do as well, under the same friction.
const MOST_CONTACTS: usize = 100;
/// Most directions of their responses, principal ones first; chosen: with 200, three diverging draws of cases/disc-pad were not found.
const MOST_COLUMNS: usize = 600;
/// Part of the responses that are directions of their own, roughly. Measured with cases/disc-pad: 324 of 432.
const OF_THEIR_OWN: f64 = 0.75;
/// Largest backward error of an eigenvalue of the whole brake that is found next to one on the responses; chosen.
const FOUND: f64 = 1e-10;

/// What grows far beyond the band of a brake with one set of constraints.
#[derive(Debug)]
pub(super) struct Responses {
    /// Orthonormal columns, n x k, and the brake on them.
    basis: DMatrix<f64>,
    reduced: AffineSystem,
}

impl Responses {
    /// The responses of a brake over its free rows; `None` without contacts.
    pub fn new(case: &FiniteElementCase, system: &SparseAffineSystem) -> Result<Option<Self>, Error> {
        let contacts: Vec<&Channel> = system.channels().iter().filter(|channel| channel.is_contact).collect();
        if contacts.is_empty() {
            return Ok(None);
        }
        let all = all_patches(case);
        let mut at = of_brake(case, &all, &naming_point(case, &all)?);
        without_friction(system.channels(), &mut at);
        let problem = Problem::new(&system.assemble(&at)?.without_structural_damping())?;
        let thinned: Vec<_> = contacts.iter().step_by(step(contacts.len())).collect();
        let mut forces = DMatrix::zeros(system.order(), 2 * thinned.len());
        for (place, channel) in thinned.into_iter().enumerate() {
            channel.force.iter().for_each(|&(dof, value)| forces[(dof, 2 * place)] += value);
            channel.reading.iter().for_each(|&(dof, value)| forces[(dof, 2 * place + 1)] += value);
        }
        let mut shapes = Vec::with_capacity(SHIFTS.len() * forces.ncols());
        for shift in SHIFTS {
            let solved = problem.solve(Complex::from(shift * highest(case)), &forces)?;
            shapes.extend(solved.column_iter().filter(|column| column.norm() > 0.0).map(|column| column.into_owned()));
        }
        let all = shape_directions(&shapes)?;
        let basis = all.columns(0, all.ncols().min(MOST_COLUMNS)).into_owned();
        let reduced = system.project(&basis)?;
        Ok(Some(Self { basis, reduced }))
    }
}

/// Step through the list of `contacts` from one at which forces act to the next.
fn step(contacts: usize) -> usize {
    contacts.div_ceil(MOST_CONTACTS).max(1)
}

/// Number of columns of the responses of a case, roughly, before they are solved for.
pub(super) fn expected_columns(case: &FiniteElementCase) -> usize {
    let contacts = case.channels_of_branches().start;
    let responses = 2 * SHIFTS.len() * contacts.div_ceil(step(contacts));
    ((OF_THEIR_OWN * responses as f64) as usize).min(MOST_COLUMNS)
}

/// True if the whole brake has an eigenvalue that grows faster than it oscillates, is larger than the `end` and passes a test, next to such an eigenvalue of a
/// reduced brake: `None` where the reduced brake has none, `false` where nothing is found in the whole brake. Shapes are lifted to the rows of the whole
/// brake. A whole spectrum, which takes the longest, is made where neither proof says.
fn in_whole(
    reduced: &SecondOrder,
    lift: impl Fn(&DVector<Complex<f64>>) -> DVector<Complex<f64>>,
    whole: &SparseSecondOrder,
    (end, is_fast): (f64, impl Fn(Complex<f64>) -> bool),
) -> Result<Option<bool>, Error> {
    if surely_none_grows_too_fast(reduced, end) {
        return Ok(None);
    }
    let passes = |lambda: Complex<f64>| is_fast(lambda) && lambda.norm() > end;
    let is_found = |near: Complex<f64>, shape: &DVector<Complex<f64>>| {
        Problem::new(whole)
            .and_then(|whole| whole.eigenpair_near(near, &lift(shape), FOUND))
            .is_ok_and(|pair| passes(pair.lambda))
    };
    if let Some((near, shape)) = growing_real(reduced, end)
        && is_found(near.into(), &shape.map(Complex::from))
    {
        return Ok(Some(true));
    }
    let mut work = Workspace::default();
    let all = QrSolver.eigenvalues(reduced, &mut work)?.eigenvalues;
    let fastest = all.into_iter().filter(|&lambda| passes(lambda)).max_by(|a, b| a.re.total_cmp(&b.re));
    let Some(fastest) = fastest else { return Ok(None) };
    Ok(Some(right_vector(reduced, fastest, &mut work).is_ok_and(|shape| is_found(fastest, &shape))))
}

/// Smallest growth that is looked for as divergence of a case, 1/s.
fn slowest_divergence(case: &FiniteElementCase) -> f64 {
    SLOWEST * rectangle(case).im[0]
}

/// Eigenvalues that surely are beyond a threshold and grow faster than they oscillate in a whole brake, 1/s, Im >= 0, by ascending growth:
/// divergence, whatever the band of the case. It is looked for from a thousandth of the lowest frequency of the band, as the eigenvalues of a body that is
/// free to move are zero, to the highest in size. `None` where the search does not come to an end, or rounding leaves open whether all that is found grows.
fn diverging(case: &FiniteElementCase, system: &SparseSecondOrder, threshold: &Threshold) -> Option<Vec<Complex<f64>>> {
    let [_, highest] = rectangle(case).im;
    let from = threshold.growth_above().max(slowest_divergence(case));
    let right = Rectangle { re: [from, from + highest], im: [0.0, highest] };
    let found = eigenpairs_in(system, &right, &sparse::Options::default(), &mut |_| {}).ok()?;
    let is_fast = |pair: &Eigenpair| real_count(pair.lambda) > 0 || grows_too_fast(pair.lambda);
    let fast: Vec<Eigenpair> = found.pairs.into_iter().filter(is_fast).collect();
    let verdict = |pair: &Eigenpair| threshold.verdict(pair.lambda, ROUNDED_DATA * pair.bound);
    let grows = |pair: &&Eigenpair| verdict(pair) == Verdict::Unstable;
    let of = |pair: &Eigenpair| match real_count(pair.lambda) {
        0 => repeat_n(pair.lambda, 1),
        count => repeat_n(pair.lambda.re.into(), count),
    };
    let mut growing: Vec<Complex<f64>> = fast.iter().filter(grows).flat_map(of).collect();
    growing.sort_by(|a, b| a.re.total_cmp(&b.re));
    let is_open = |pair: &Eigenpair| matches!(verdict(pair), Verdict::Undecided { .. });
    (!growing.is_empty() || !fast.iter().any(is_open)).then_some(growing)
}

/// 2 pi times the highest frequency of the band, rad/s.
fn highest(case: &FiniteElementCase) -> f64 {
    TAU * case.reduction.frequencies[1]
}

impl FiniteElementBrake {
    /// What diverges in a scene, at an operating point of the brake: of the whole brake up to the end of the band in size, and whether anything does beyond
    /// that, which the `reduced` brake there, responses of its contacts, and the whole one next to the fastest of these say.
    ///
    /// # Errors
    /// A point that the brake refuses, a factorisation that does not fit into memory.
    pub fn diverging(&self, scene: &Scene, at: &OperatingPoint, reduced: &Spectrum) -> Result<Diverging, Error> {
        let set = &self.sets[self.part(scene).set];
        let system = set.system.assemble(at)?.without_structural_damping();
        let whole = diverging(&self.case, &system, &self.plan.threshold);
        let (end, error) = (highest(&self.case), self.relative_error(scene));
        let is_fast = |lambda: Complex<f64>| {
            lambda.im >= 0.0
                && grows_too_fast(lambda)
                && lambda.norm() > slowest_divergence(&self.case)
                && self.plan.threshold.margin(lambda) > error * lambda.norm()
        };
        let is_below = |lambda: &Complex<f64>| is_fast(*lambda) && lambda.norm() <= end;
        let part = &self.part(scene).reduced;
        let of_part = in_whole(&part.system().assemble(at)?, |shape| part.lift(shape), &system, (end, is_fast))?;
        let of_responses = match set.responses(&self.case)? {
            Some(Responses { basis, reduced }) if of_part != Some(true) => {
                let lift = |shape: &DVector<Complex<f64>>| linsys::real_times_complex(basis, shape);
                in_whole(&reduced.assemble(at)?, lift, &system, (end, is_fast))?
            }
            _ => None,
        };
        let found = [of_part, of_responses];
        let (has_beyond, is_open) = (found.contains(&Some(true)), found.contains(&Some(false)));
        let has_below = reduced.eigenvalues.iter().any(is_below);
        let is_told = |whole: &Vec<Complex<f64>>| !whole.is_empty() || has_beyond || !has_below && !is_open;
        Ok(Diverging { whole: whole.filter(is_told), beyond: has_beyond })
    }
}
