//! The argument principle: how many eigenvalues are in a rectangle, by the phase of det Q along its border.
//!
//! `det Q(z) prod (z + a_i)` is a polynomial whose zeros are the eigenvalues. Divided by `prod (z - lambda_k)` over the eigenvalues
//! that are known, it turns about zero as often as eigenvalues inside are not known, and it turns little on the way: its phase is
//! constant where all are known.

use std::f64::consts::{PI, TAU};

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::{Mat, Spec};
use num_complex::Complex;

use super::blocks::PAR;
use super::pencil::Pencil;
use super::types::{Count, Rectangle};
use crate::SparseError;

/// Points of a side between its corners to begin with.
const BETWEEN: usize = 3;
/// Change of the phase between two points, rad, above which one is looked at between them; chosen.
const LARGEST_CHANGE: f64 = 0.8;
/// Most points of one border.
const MOST_POINTS: usize = 200;
/// Borders that are tried one farther out than the other.
const BORDERS: usize = 4;
/// How far outwards a side is tried, as parts of the width across it.
const OUTWARDS: [f64; 10] = [0.0, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0];
/// Distance of a side from an eigenvalue: so many bounds of that, and this part of the width.
const BOUNDS: f64 = 1e3;
const CLEAR: f64 = 1e-6;
/// The border goes no farther than so many times the largest eigenvalue from zero.
const BEYOND: f64 = 2.0;

/// An eigenvalue that is known, and how far it may be off, rad/s.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known {
    pub(super) lambda: Complex<f64>,
    pub(super) bound: f64,
}

/// Counts the eigenvalues in a rectangle, given all that are known there and around it.
///
/// A pencil that is scaled has more digits than one that is not; `gamma` is the unit of its time, rad/s.
///
/// # Errors
/// [`SparseError::CountsDiffer`] where det Q has more or fewer zeros than are known.
pub(super) fn count(pencil: &Pencil, gamma: f64, known: &[Known], rectangle: &Rectangle) -> Result<Count, SparseError> {
    let largest = known.iter().map(|k| k.lambda.norm()).fold(0.0, f64::max);
    let end = BEYOND * if largest > 0.0 { largest } else { gamma };
    let side = |[from, to]: [f64; 2]| [from.clamp(-end, end), to.clamp(-end, end)];
    let asked = Rectangle { re: side(rectangle.re), im: side(rectangle.im) };
    let (mut points, mut differing) = (0, None);
    for border in 0..BORDERS {
        let Some(around) = clear_of(known, &asked, border) else { continue };
        let excess = Border { pencil, gamma, known, points: 0 }.excess(&around);
        let Some((excess, own)) = excess else { continue };
        points += own;
        let listed = known.iter().filter(|k| around.contains(k.lambda, 0.0)).count();
        if excess == 0 {
            return Ok(Count::Argument { around, eigenvalues: listed, points });
        }
        let counted = (listed as i64 + excess).max(0) as usize;
        // Rounding that turns the phase next to one border does not at two in the same way.
        if differing == Some(excess) {
            let Rectangle { re, im } = around;
            return Err(SparseError::CountsDiffer { listed, counted, re, im });
        }
        differing = Some(excess);
    }
    Ok(Count::Unclear)
}

/// The rectangle with its sides moved outwards until they are clear of eigenvalues, each to the place number `skipped` that is.
/// `None` where it has no extent.
fn clear_of(known: &[Known], asked: &Rectangle, skipped: usize) -> Option<Rectangle> {
    let moved = |[from, to]: [f64; 2], part: fn(Complex<f64>) -> f64| {
        let width = to - from;
        let outwards = |start: f64, sign: f64| {
            let places = OUTWARDS.iter().map(|t| start + sign * t * width);
            let clearance = |place: f64| {
                let own = |k: &Known| (part(k.lambda) - place).abs() - BOUNDS * k.bound;
                known.iter().map(own).fold(f64::INFINITY, f64::min)
            };
            let best = places.clone().max_by(|a, b| clearance(*a).total_cmp(&clearance(*b)));
            places.filter(|&place| clearance(place) > CLEAR * width).nth(skipped).or(best).unwrap_or(start)
        };
        [outwards(from, -1.0), outwards(to, 1.0)]
    };
    let around = Rectangle { re: moved(asked.re, |l| l.re), im: moved(asked.im, |l| l.im) };
    around.check().ok().map(|()| around)
}

struct Border<'a> {
    pencil: &'a Pencil,
    gamma: f64,
    known: &'a [Known],
    points: usize,
}

impl Border<'_> {
    /// How many more eigenvalues are inside than are known, and the points that it took; `None` where the phase jumps.
    fn excess(mut self, around: &Rectangle) -> Option<(i64, usize)> {
        let ([left, right], [low, high]) = (around.re, around.im);
        let corners = [(left, low), (right, low), (right, high), (left, high)].map(|(re, im)| Complex::new(re, im));
        let side = |from: Complex<f64>, to: Complex<f64>| {
            (0..=BETWEEN).map(move |i| from + (to - from) * (i as f64 / (BETWEEN + 1) as f64))
        };
        let mut border: Vec<_> = (0..4).flat_map(|i| side(corners[i], corners[(i + 1) % 4])).collect();
        border.push(corners[0]);
        let mut phases = Vec::with_capacity(border.len());
        for &z in &border[..border.len() - 1] {
            phases.push(self.phase(z)?);
        }
        phases.push(phases[0]);
        let mut turn = 0.0;
        for (ends, phases) in border.windows(2).zip(phases.windows(2)) {
            turn += self.change((ends[0], phases[0]), (ends[1], phases[1]))?;
        }
        Some(((turn / TAU).round() as i64, self.points))
    }

    /// By how much the phase changes from one point of the border to another.
    fn change(&mut self, from: (Complex<f64>, f64), to: (Complex<f64>, f64)) -> Option<f64> {
        let change = wrapped(to.1 - from.1);
        if change.abs() <= LARGEST_CHANGE {
            return Some(change);
        }
        let middle = 0.5 * (from.0 + to.0);
        if self.points >= MOST_POINTS || middle == from.0 || middle == to.0 {
            return None;
        }
        let between = (middle, self.phase(middle)?);
        Some(self.change(from, between)? + self.change(between, to)?)
    }

    /// The phase of det Q at z divided by that of the known factors; `None` where Q is singular.
    fn phase(&mut self, z: Complex<f64>) -> Option<f64> {
        self.points += 1;
        let sigma = z / self.gamma;
        let states: f64 = self.pencil.states().iter().map(|state| (sigma + state.decay).arg()).sum();
        let known: f64 = self.known.iter().map(|k| (z - k.lambda).arg()).sum();
        let phase = determinant_phase(self.pencil, sigma)? + states - known;
        phase.is_finite().then_some(phase)
    }
}

/// The angle itself but for whole turns, from -pi to pi.
fn wrapped(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

/// The phase of det Q(sigma), by LU of the full matrix; `None` where a pivot is zero.
fn determinant_phase(pencil: &Pencil, sigma: Complex<f64>) -> Option<f64> {
    let n = pencil.order();
    let values = pencil.values(&pencil.weights(sigma));
    let (starts, rows) = pencil.pattern();
    let mut q = Mat::<Complex<f64>>::zeros(n, n);
    for column in 0..n {
        (starts[column]..starts[column + 1]).for_each(|at| q[(rows[at], column)] = values[at]);
    }
    let (mut pivots, mut inverse) = (vec![0_usize; n], vec![0; n]);
    let mut buffer = MemBuffer::new(lu_in_place_scratch::<usize, Complex<f64>>(n, n, PAR, Spec::default()));
    lu_in_place(q.as_mut(), &mut pivots, &mut inverse, PAR, MemStack::new(&mut buffer), Spec::default());
    let is_regular = (0..n).all(|i| q[(i, i)].is_finite() && q[(i, i)] != Complex::default());
    let sign = if is_even(&pivots) { 0.0 } else { PI };
    is_regular.then(|| sign + (0..n).map(|i| q[(i, i)].arg()).sum::<f64>())
}

/// Whether a permutation is one of an even number of exchanges.
fn is_even(permutation: &[usize]) -> bool {
    let (mut is_seen, mut cycles) = (vec![false; permutation.len()], 0);
    for start in 0..permutation.len() {
        let mut at = start;
        cycles += usize::from(!is_seen[start]);
        while !is_seen[at] {
            is_seen[at] = true;
            at = permutation[at];
        }
    }
    (permutation.len() - cycles).is_multiple_of(2)
}
