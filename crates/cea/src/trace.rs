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

mod pair;
mod point;

use num_complex::Complex;

use crate::Workspace;
use crate::mac::{Match, Mode, mac, match_modes};
use crate::track::Way;
use pair::{Behind, NOT_IT, Stop, follow_pairs};
use point::{Point, points};

/// The first step, as a part of the way.
const FIRST: f64 = 0.2;
/// Steps that are taken have at most this ratio of errors, and the next one aims at two thirds of it.
const RATIO: f64 = 0.3;
/// Errors of the tangent that are no errors, relative to the eigenvalue.
const NO_ERROR: f64 = 1e-5;
/// Least MAC of the shapes before and after a step.
const LEAST_MAC: f64 = 0.8;
/// Shorter steps are next to a coalescence.
const SHORTEST: f64 = 1.0 / 512.0;
/// So are more attempts than these.
const MOST_ATTEMPTS: usize = 48;
/// How often a mode is followed as one of a pair.
const MOST_PAIRS: usize = 6;

/// One mode on its way.
struct Trace<'a> {
    way: Way<'a>,
    /// Whether MAC with the end may end it.
    near: bool,
    /// Part of the way gone.
    at: f64,
    step: f64,
    here: Point,
    /// Second derivative of the eigenvalue, from the last step.
    bend: Complex<f64>,
    attempts: usize,
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
    let mut open: Vec<(usize, Stop<'a>)> = of.iter().map(|(way, mode)| (*way, 0.0, mode.lambda)).enumerate().collect();
    for _ in 0..MOST_PAIRS {
        let mut lost = follow_alone(&open, near, &mut ends, work);
        lost.retain(|(_, trace)| trace.way.line().is_some() && trace.at < 1.0);
        open.clear();
        for ((i, _), behind) in lost.iter().zip(pass(&lost, work)) {
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
    from: &[(usize, Stop<'a>)],
    near: bool,
    ends: &mut [Option<usize>],
    work: &mut Workspace,
) -> Vec<(usize, Trace<'a>)> {
    let begin: Vec<Stop<'a>> = from.iter().map(|(_, stop)| *stop).collect();
    let begun = |(here, &(i, (way, at, lambda))): (Option<Point>, &(usize, Stop<'a>))| {
        let here = here.filter(|point| (point.mode.lambda - lambda).norm() <= NO_ERROR * lambda.norm())?;
        Some((i, Trace { way, near, at, step: FIRST, here, bend: Complex::default(), attempts: 0 }))
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
fn pass<'a>(lost: &[(usize, Trace<'a>)], work: &mut Workspace) -> Vec<Option<Stop<'a>>> {
    let stops: Vec<Stop<'a>> = lost.iter().map(|(_, trace)| (trace.way, trace.at, trace.here.mode.lambda)).collect();
    let pairs = follow_pairs(&stops, work);
    let both = |Behind { way, at, lambdas }: &Behind<'a>| lambdas.map(|lambda| (*way, *at, lambda));
    let asked: Vec<Stop<'a>> = pairs.iter().flatten().flat_map(both).collect();
    let mut points = points(&asked, work).into_iter();
    let mut behind = |(pair, (_, trace)): (Option<Behind<'a>>, &(usize, Trace<'a>))| {
        let Behind { way, at, lambdas } = pair?;
        let found = [points.next().flatten(), points.next().flatten()];
        let most = NOT_IT * (lambdas[1] - lambdas[0]).norm();
        let is_it = |(point, lambda): (&Point, Complex<f64>)| (point.mode.lambda - lambda).norm() <= most;
        let [Some(first), Some(second)] = found else { return None };
        if !is_it((&first, lambdas[0])) || !is_it((&second, lambdas[1])) {
            return None;
        }
        let both = [first.mode, second.mode];
        let alike = match_modes(std::slice::from_ref(&trace.here.mode), &both, &way.inertia().m).remove(0);
        let to = alike.to.filter(|_| alike.is_clear()).unwrap_or(0);
        Some((way, at, both[to].lambda))
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
    fn ahead(&self) -> (Way<'a>, f64, Complex<f64>) {
        let step = self.step.min(1.0 - self.at);
        (self.way, self.at + step, self.here.mode.lambda + (self.here.rate + self.bend * (0.5 * step)) * step)
    }

    /// Goes `there`, where the next step leads, if that can be trusted, and makes the step shorter if not.
    fn go(&mut self, there: Option<Point>) -> Next {
        self.attempts += 1;
        let step = self.step.min(1.0 - self.at);
        match there.map(|there| (self.ratio(&there, step), there)) {
            Some((ratio, there)) if ratio <= RATIO => {
                self.bend = (there.rate - self.here.rate) / step;
                self.here = there;
                self.at += step;
                self.step = step * (RATIO / (1.5 * ratio)).clamp(0.6, 2.0);
                if let Some(to) = self.end() {
                    return Next::Arrived(to);
                }
            }
            other => {
                // The larger of a NaN and a number is the number.
                let ratio = other.map_or(f64::INFINITY, |(ratio, _)| ratio).max(RATIO);
                self.step = step * (RATIO / (1.5 * ratio)).clamp(0.25, 0.6);
            }
        }
        let is_lost = self.at == 1.0 || self.step < SHORTEST || self.attempts >= MOST_ATTEMPTS;
        if is_lost { Next::Lost } else { Next::Go }
    }

    /// The known mode at the end that this one is or, beyond doubt, becomes.
    fn end(&self) -> Option<usize> {
        let known = self.way.to.1;
        if self.at == 1.0 {
            return nearest(known, self.here.mode.lambda);
        }
        let by_mac = || match_modes(std::slice::from_ref(&self.here.mode), known, &self.way.inertia().m).remove(0);
        if self.near { Some(by_mac()).filter(Match::is_clear).and_then(|found| found.to) } else { None }
    }

    /// How badly a step can be trusted.
    fn ratio(&self, there: &Point, step: f64) -> f64 {
        let Point { mode: Mode { lambda, .. }, rate } = &self.here;
        let moved = there.mode.lambda - lambda;
        let tangent = (moved - rate * step).norm();
        let trapezoid = (moved - (rate + there.rate) * (0.5 * step)).norm();
        let [before, after] = [&self.here, there].map(|point| std::slice::from_ref(&point.mode));
        let is_alike = mac(before, after, &self.way.inertia().m)[(0, 0)] >= LEAST_MAC;
        if is_alike { trapezoid / tangent.max(NO_ERROR * lambda.norm()) } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests;
