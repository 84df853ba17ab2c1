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

use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use crate::batch::{NullVector, null_vectors};
use crate::mac::{Match, Mode, mac, match_modes};
use crate::track::Way;
use crate::vectors::start;
use crate::{Workspace, mass_norm_squared, secular};
use pair::{Behind, NOT_IT, Stop, follow_pairs};

/// The first step, as a part of the way.
const FIRST: f64 = 0.2;
/// Steps that are taken have at most this ratio of errors, and the next one aims at two thirds of it.
const RATIO: f64 = 0.3;
/// Errors of the tangent that are no errors, relative to the eigenvalue.
const NO_ERROR: f64 = 1e-5;
/// Least MAC of the shapes before and after a step.
const LEAST_MAC: f64 = 0.8;
/// Shorter steps are left to the walk.
const SHORTEST: f64 = 1.0 / 512.0;
/// A correction of the eigenvalue after which another would not be felt, relatively.
const SETTLED: f64 = 5e-5;
/// Corrections of a guess at most.
const MOST_CORRECTIONS: usize = 4;
/// How often a mode is followed as one of a pair.
const MOST_PAIRS: usize = 6;
/// So are more attempts than these.
const MOST_ATTEMPTS: usize = 48;
/// How far aside of the predicted eigenvalue Q is factorised, relatively: on an eigenvalue there is no y but rounding.
const ASIDE: f64 = 1e-7;

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

/// A mode and how its eigenvalue moves along the way.
#[derive(Debug, Clone)]
struct Point {
    mode: Mode,
    rate: Complex<f64>,
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

/// Next to an eigenvalue: the next guess of it, how it moves along the way and, where that is known, its shape.
struct Corrected {
    lambda: Complex<f64>,
    rate: Complex<f64>,
    shape: Option<DVector<Complex<f64>>>,
}

/// The mode next to a guess of its eigenvalue at a part of a way; `None` where there is none.
fn points(at: &[(Way<'_>, f64, Complex<f64>)], work: &mut Workspace) -> Vec<Option<Point>> {
    let mut at = at.to_vec();
    let mut found: Vec<Option<Corrected>> = at.iter().map(|_| None).collect();
    let mut open: Vec<usize> = (0..at.len()).collect();
    for _ in 0..MOST_CORRECTIONS {
        let asked: Vec<_> = open.iter().map(|&i| at[i]).collect();
        let mut corrected = corrected(&asked, work).into_iter();
        open.retain(|&i| {
            let Some(point) = corrected.next().flatten() else { return false };
            let correction = (point.lambda - at[i].2).norm();
            at[i].2 = point.lambda;
            let is_settled = correction <= SETTLED * point.lambda.norm();
            if is_settled {
                found[i] = Some(point);
            }
            !is_settled
        });
        if open.is_empty() {
            break;
        }
    }
    let is_shapeless = |i: &usize| found[*i].as_ref().is_some_and(|point| point.shape.is_none());
    let shapeless: Vec<usize> = (0..at.len()).filter(is_shapeless).collect();
    let on_lines: Vec<_> = shapeless.iter().filter_map(|&i| Some((at[i].0.line()?, at[i].1, at[i].2))).collect();
    for (i, shape) in shapeless.into_iter().zip(secular::shapes(&on_lines, work)) {
        found[i].iter_mut().for_each(|point| point.shape = shape.clone());
    }
    let point = |(found, (way, ..)): (Option<Corrected>, (Way<'_>, f64, Complex<f64>))| {
        let Corrected { lambda, rate, shape } = found?;
        let mut shape = shape?;
        shape.unscale_mut(mass_norm_squared(way.inertia(), &shape).abs().sqrt());
        Some(Point { mode: Mode { lambda, shape }, rate })
    };
    found.into_iter().zip(at).map(point).collect()
}

/// One step of Newton's method at each guess.
fn corrected(at: &[(Way<'_>, f64, Complex<f64>)], work: &mut Workspace) -> Vec<Option<Corrected>> {
    let mut found = Vec::with_capacity(at.len());
    let kind = |way: &Way<'_>| (way.line().is_some(), way.to.0.order());
    for group in at.chunk_by(|a, b| kind(&a.0) == kind(&b.0)) {
        let on_lines: Vec<_> = group.iter().filter_map(|&(way, t, guess)| Some((way.line()?, t, guess))).collect();
        if on_lines.is_empty() {
            found.extend(by_vectors(group, work));
        } else {
            found.extend(secular::corrected(&on_lines, work).into_iter().map(|[lambda, rate]| {
                (lambda.is_finite() && rate.is_finite()).then_some(Corrected { lambda, rate, shape: None })
            }));
        }
    }
    found
}

/// One step at guesses on ways of one order, by singular vectors.
fn by_vectors(group: &[(Way<'_>, f64, Complex<f64>)], work: &mut Workspace) -> Vec<Option<Corrected>> {
    let Some(n) = group.first().map(|(way, ..)| way.to.0.order()) else { return Vec::new() };
    let systems: Vec<SecondOrder> = group.iter().map(|(way, t, _)| way.system(*t)).collect();
    let guesses: Vec<_> = group.iter().map(|(.., guess)| guess * (1.0 + ASIDE)).collect();
    let stiffness: Vec<_> =
        systems.iter().zip(&guesses).map(|(system, &lambda)| system.dynamic_stiffness(lambda)).collect();
    let vectors = null_vectors(&stiffness, &start(n, 0), &mut work.scratch);
    work.counters.factorisations += group.len() as u64;
    let step = |(i, vector): (usize, Option<NullVector>)| {
        newton(group[i].0.systems()?, &systems[i], guesses[i], &stiffness[i], vector?.vector)
    };
    vectors.into_iter().enumerate().map(step).collect()
}

/// One step next to an eigenvalue whose right singular vector at `lambda` is x.
fn newton(
    ends: [&SecondOrder; 2],
    system: &SecondOrder,
    lambda: Complex<f64>,
    stiffness: &DMatrix<Complex<f64>>,
    x: DVector<Complex<f64>>,
) -> Option<Corrected> {
    let mut y = stiffness * &x;
    let size = y.norm();
    y.unscale_mut(size);
    let slope = y.dotc(&(system.dynamic_stiffness_derivative(lambda) * &x));
    let rate = -y.dotc(&change(ends, lambda, &x)) / slope;
    let lambda = lambda - size / slope;
    (lambda.is_finite() && rate.is_finite()).then_some(Corrected { lambda, rate, shape: Some(x) })
}

/// `d Q(lambda) / d t x = (Q_to(lambda) - Q_from(lambda)) x` on a way between two systems.
fn change([from, to]: [&SecondOrder; 2], lambda: Complex<f64>, x: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
    let mut change = DVector::zeros(x.len());
    let matrices =
        [(&from.m, &to.m, lambda * lambda), (&from.c, &to.c, lambda), (&from.k, &to.k, Complex::new(1.0, 0.0))];
    for (a, b, factor) in matrices {
        let columns = a.as_slice().chunks_exact(x.len()).zip(b.as_slice().chunks_exact(x.len()));
        for ((a, b), x) in columns.zip(x) {
            // Few columns change.
            if a != b {
                let factor = factor * x;
                change.iter_mut().zip(a.iter().zip(b)).for_each(|(change, (a, b))| *change += factor * (b - a));
            }
        }
    }
    for (end, sign) in [(&from.internal, 1.0), (&to.internal, -1.0)] {
        for (s, &decay) in end.decay.iter().enumerate() {
            let reading: Complex<f64> = end.drive.row(s).iter().zip(x).map(|(drive, x)| x * drive).sum();
            let gain = sign * lambda / (lambda + decay) * reading;
            change.iter_mut().zip(&end.force.column(s)).for_each(|(change, force)| *change += gain * force);
        }
    }
    change
}

#[cfg(test)]
mod tests;
