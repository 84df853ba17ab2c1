//! Tracing: one mode along a way by its own derivative, without the spectra on the way.
//!
//! The singular vectors x and y of the smallest singular value of `Q(lambda, t)` next to an eigenvalue give that eigenvalue
//! to second order and how it moves along the way,
//!
//! ```text
//! lambda - y^H Q x / y^H Q' x,        d lambda / d t = -y^H (d Q / d t) x / y^H Q' x
//! ```
//!
//! (Lancaster, Numer. Math. 6, 1964). One factorisation of Q is a small part of the price of a spectrum.
//!
//! **Steps.** With d the distance to the next branch point, an eigenvalue there is a smooth function plus a square root; a
//! step s errs by `s / 4 d` times as much by the trapezoidal rule for `d lambda / d t` as by the tangent alone, whatever
//! value and slope of the smooth function. A step is taken where that ratio is small and the shape has hardly changed; one
//! that would jump to another mode has a ratio near 1. What does not get on with steps of reasonable length is next to a
//! coalescence: on a line of gains it is followed together with its neighbour ([`pair`]), and what is left then is left to
//! [`Walk`](crate::walk::Walk), which sees all modes on the way.

mod pace;
mod pair;
mod point;

use cea::{Line, Mode, Workspace};
use num_complex::Complex;

use crate::mac::{Match, mac, match_modes};
use crate::track::Way;
use pace::{Pace, misses};
use pair::{Behind, NOT_IT, follow_pairs};
use point::{Place, Point, points};

/// The first step, as a part of the way.
const FIRST: f64 = 0.2;
/// Errors of the tangent that are no errors, relative to the eigenvalue.
const NO_ERROR: f64 = 1e-5;
/// Least MAC of the shapes before and after a step.
const LEAST_MAC: f64 = 0.8;
/// Shorter steps are next to a coalescence.
const SHORTEST: f64 = 1.0 / 512.0;
/// How often a mode is followed as one of a pair.
const MOST_PAIRS: usize = 6;

/// One mode on its way.
struct Trace<'a> {
    way: Way<'a>,
    /// Whether MAC with the end may end it.
    near: bool,
    pace: Pace,
    here: Point,
    /// Second derivative of the eigenvalue, from the last step.
    bend: Complex<f64>,
}

enum Next {
    Go,
    Arrived(usize),
    Lost,
}

/// The index of the mode at the end of each way that the mode at its beginning becomes; `None` where that is in doubt.
///
/// Where a way is `near`, a trace ends as soon as MAC with the end is beyond doubt, and goes all the way where not.
pub(crate) fn trace<'a>(of: &[(Way<'a>, &Mode)], near: bool, work: &mut Workspace) -> Vec<Option<usize>> {
    let mut ends = vec![None; of.len()];
    let mut open: Vec<(usize, Place<'a>)> = of.iter().map(|(way, mode)| (*way, 0.0, mode.lambda)).enumerate().collect();
    for _ in 0..MOST_PAIRS {
        let lost = follow_alone(&open, near, &mut ends, work).into_iter().filter(|(_, trace)| trace.pace.at < 1.0);
        let lost: Vec<_> = lost.filter_map(|(i, trace)| Some((i, trace.way.line()?, trace))).collect();
        open.clear();
        for ((i, ..), behind) in lost.iter().zip(pass(&lost, work)) {
            match behind {
                Some((way, 1.0, lambda)) => ends[*i] = nearest(way.to.1, lambda),
                Some(stop) => open.push((*i, stop)),
                None => {}
            }
        }
        if open.is_empty() {
            break;
        }
    }
    ends
}

/// Follows each mode alone from a place on its way. Enters the `ends` that are reached, and returns the traces that are lost.
fn follow_alone<'a>(
    from: &[(usize, Place<'a>)],
    near: bool,
    ends: &mut [Option<usize>],
    work: &mut Workspace,
) -> Vec<(usize, Trace<'a>)> {
    let begin: Vec<Place<'a>> = from.iter().map(|(_, stop)| *stop).collect();
    let begun = |(here, &(i, (way, at, lambda))): (Option<Point>, &(usize, Place<'a>))| {
        let here = here.filter(|point| (point.mode.lambda - lambda).norm() <= NO_ERROR * lambda.norm())?;
        Some((i, Trace { way, near, pace: Pace::new(at, FIRST), here, bend: Complex::default() }))
    };
    let mut traces: Vec<(usize, Trace<'a>)> = points(&begin, work).into_iter().zip(from).filter_map(begun).collect();
    let mut lost = Vec::new();
    while !traces.is_empty() {
        let ahead: Vec<_> = traces.iter().map(|(_, trace)| trace.ahead()).collect();
        let mut points = points(&ahead, work).into_iter();
        let mut under_way = Vec::with_capacity(traces.len());
        for (i, mut trace) in traces {
            match trace.go(points.next().flatten()) {
                Next::Go => under_way.push((i, trace)),
                Next::Arrived(to) => ends[i] = Some(to),
                Next::Lost => lost.push((i, trace)),
            }
        }
        traces = under_way;
    }
    lost
}

/// Where the modes that are lost next to a coalescence are behind it. The two of a pair exchange their shapes there, or
/// not: shapes that are alike before and after are one mode, as everywhere; where none are, eigenvalues are continued.
fn pass<'a>(lost: &[(usize, Line<'a>, Trace<'a>)], work: &mut Workspace) -> Vec<Option<Place<'a>>> {
    let places: Vec<_> = lost.iter().map(|(_, line, trace)| (*line, trace.pace.at, trace.here.mode.lambda)).collect();
    let pairs = follow_pairs(&places, work);
    let both = |(pair, (.., trace)): (&Option<Behind>, &(usize, Line<'a>, Trace<'a>))| {
        pair.map(|Behind { at, lambdas }| lambdas.map(|lambda| (trace.way, at, lambda)))
    };
    let asked: Vec<Place<'a>> = pairs.iter().zip(lost).filter_map(both).flatten().collect();
    let mut points = points(&asked, work).into_iter();
    let mut behind = |(pair, (.., trace)): (Option<Behind>, &(usize, Line<'a>, Trace<'a>))| {
        let Behind { at, lambdas } = pair?;
        let found = [points.next().flatten(), points.next().flatten()];
        let most = NOT_IT * (lambdas[1] - lambdas[0]).norm();
        let is_it = |point: &Point, lambda: Complex<f64>| (point.mode.lambda - lambda).norm() <= most;
        let [Some(first), Some(second)] = found else { return None };
        if !is_it(&first, lambdas[0]) || !is_it(&second, lambdas[1]) {
            return None;
        }
        let both = [first.mode, second.mode];
        let alike = match_modes(std::slice::from_ref(&trace.here.mode), &both, &trace.way.inertia().m).remove(0);
        let to = alike.to.filter(|_| alike.is_clear()).unwrap_or(0);
        Some((trace.way, at, both[to].lambda))
    };
    pairs.into_iter().zip(lost).map(&mut behind).collect()
}

/// Where a trace has ended among the known modes.
fn nearest(known: &[Mode], lambda: Complex<f64>) -> Option<usize> {
    let mut order: Vec<(f64, usize)> =
        known.iter().enumerate().map(|(j, mode)| ((mode.lambda - lambda).norm(), j)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let &(best, j) = order.first()?;
    let second = order.get(1).map_or(f64::INFINITY, |&(distance, _)| distance);
    (best <= NO_ERROR * lambda.norm() && second >= 10.0 * NO_ERROR * lambda.norm()).then_some(j)
}

impl<'a> Trace<'a> {
    /// Where the next step leads, and the eigenvalue to be expected there.
    fn ahead(&self) -> Place<'a> {
        let step = self.pace.step();
        (self.way, self.pace.at + step, self.here.mode.lambda + (self.here.rate + self.bend * (0.5 * step)) * step)
    }

    /// Goes `there`, where the next step leads, if that can be trusted, and makes the step shorter if not.
    fn go(&mut self, there: Option<Point>) -> Next {
        let step = self.pace.step();
        let ratio = there.as_ref().map(|there| self.ratio(there, step));
        self.pace.go(ratio);
        if let Some(there) = there.filter(|_| ratio.is_some_and(Pace::trusts)) {
            self.bend = (there.rate - self.here.rate) / step;
            self.here = there;
            if let Some(to) = self.end() {
                return Next::Arrived(to);
            }
        }
        if self.pace.is_over(SHORTEST) { Next::Lost } else { Next::Go }
    }

    /// The known mode at the end that this one is or, beyond doubt, becomes.
    fn end(&self) -> Option<usize> {
        let known = self.way.to.1;
        if self.pace.at == 1.0 {
            return nearest(known, self.here.mode.lambda);
        }
        let by_mac = || match_modes(std::slice::from_ref(&self.here.mode), known, &self.way.inertia().m).remove(0);
        if self.near { Some(by_mac()).filter(Match::is_clear).and_then(|found| found.to) } else { None }
    }

    /// How badly a step can be trusted.
    fn ratio(&self, there: &Point, step: f64) -> f64 {
        let Point { mode: Mode { lambda, .. }, rate } = &self.here;
        let [tangent, trapezoid] = misses([*lambda, there.mode.lambda], [*rate, there.rate], step);
        let [before, after] = [&self.here, there].map(|point| std::slice::from_ref(&point.mode));
        let is_alike = mac(before, after, &self.way.inertia().m)[(0, 0)] >= LEAST_MAC;
        if is_alike { trapezoid / tangent.max(NO_ERROR * lambda.norm()) } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests;
