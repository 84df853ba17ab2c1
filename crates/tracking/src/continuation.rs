//! Single-mode continuation: one mode is followed along a path by the derivative of its eigenvalue; no spectrum is computed.
//!
//! Predictor: a parabola through the last point, with the derivatives at the last two points. Corrector: Newton's method, by
//! the secular equation or by singular vectors ([`corrector`](crate::corrector)). A step is taken where the ratio of the
//! predictor errors is small ([`step_control`](crate::step_control)) and the shape has hardly changed. A mode whose steps
//! become short, with another eigenvalue near, is next to a coalescence: where the path has a characteristic function that costs little, it is continued
//! together with the mode it coalesces with
//! ([`coalescence`](crate::coalescence)); a mode that is lost all the same is left to adaptive subdivision
//! ([`subdivision`](crate::subdivision)), which computes all modes at points of the path.

use cea::{Mode, Workspace};
use num_complex::Complex;

use crate::coalescence::{ACCEPTANCE_RADIUS, PastCoalescence, continue_pairs};
use crate::corrector::{ModeOnPath, modes_on_paths};
use crate::mac::Match;
use crate::path::{Path, PathPoint};
use crate::step_control::{PredictorErrors, StepControl};
use crate::tuning::tuning;

/// Most coalescences that one mode is continued past; chosen: a mode with more is left to subdivision.
const MOST_COALESCENCES: usize = 6;
/// Least distance of the second nearest known eigenvalue from the end of a continuation, as a multiple of `negligible_error`, the largest distance of the
/// nearest one; chosen: nearer, it is in doubt which of both the mode is.
const LEAST_SEPARATION: f64 = 10.0;
/// Least distance of all known eigenvalues from the end of a continuation that has reached none of them, as a multiple of `negligible_error`; chosen: far
/// more than known modes and the end of a path differ by, whose modes may have been reduced in other coordinates.
const LEAST_DISTANCE: f64 = 100.0;

/// A mode that is being continued.
struct Continuation<'a> {
    path: Path<'a>,
    /// The continuation ends as soon as MAC with the modes at the end of the path is clear.
    near: bool,
    steps: StepControl,
    here: ModeOnPath,
    /// Second derivative of the eigenvalue over t, from the last step.
    curvature: Complex<f64>,
}

enum Advance {
    UnderWay,
    Arrived(Ending),
    Lost,
}

/// Ending of a path for one mode: the mode that it has become.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Ending {
    /// The known mode with this index.
    Known(usize),
    /// A mode with this eigenvalue, rad/s, that is not among the known ones: it has left the band that these are from.
    Other(Complex<f64>),
    /// In doubt.
    Lost,
}

impl Ending {
    /// True if both are one mode.
    pub(crate) fn is_same(self, other: Self) -> bool {
        match (self, other) {
            (Self::Other(a), Self::Other(b)) => {
                (a - b).norm() <= LEAST_SEPARATION * tuning().negligible_error * a.norm()
            }
            _ => self == other,
        }
    }
}

/// The ending of each path for the mode at its beginning.
///
/// With `near`, a continuation ends as soon as MAC with the modes at the end of the path is clear; without, it covers the
/// whole path.
pub(crate) fn continue_modes<'a>(of: &[(Path<'a>, &Mode)], near: bool, work: &mut Workspace) -> Vec<Ending> {
    let mut ends = vec![Ending::Lost; of.len()];
    let start = |(path, mode): &(Path<'a>, &Mode)| PathPoint { path: *path, t: 0.0, lambda: mode.lambda };
    let mut open: Vec<(usize, PathPoint<'a>)> = of.iter().map(start).enumerate().collect();
    for _ in 0..MOST_COALESCENCES {
        let lost = continue_alone(&open, near, &mut ends, work);
        open.clear();
        for ((i, _), past) in lost.iter().zip(pass_coalescences(&lost, work)) {
            match past {
                Some(PathPoint { path, t: 1.0, lambda }) => ends[*i] = ending(path.end.modes, lambda),
                Some(point) => open.push((*i, point)),
                None => {}
            }
        }
        if open.is_empty() {
            break;
        }
    }
    ends
}

/// Continues each mode by itself from a point of its path. Enters the `ends` that are reached; returns the modes that are lost.
fn continue_alone<'a>(
    from: &[(usize, PathPoint<'a>)],
    near: bool,
    ends: &mut [Ending],
    work: &mut Workspace,
) -> Vec<(usize, Continuation<'a>)> {
    let starts: Vec<PathPoint<'a>> = from.iter().map(|(_, point)| *point).collect();
    let begin = |(here, &(i, point)): (Option<ModeOnPath>, &(usize, PathPoint<'a>))| {
        Some((i, Continuation::new(point, near, here?)?))
    };
    let found = modes_on_paths(&starts, work);
    let mut modes: Vec<(usize, Continuation<'a>)> = found.into_iter().zip(from).filter_map(begin).collect();
    let mut lost = Vec::new();
    while !modes.is_empty() {
        let predicted: Vec<_> = modes.iter().map(|(_, mode)| mode.predict()).collect();
        let mut corrected = modes_on_paths(&predicted, work).into_iter();
        let mut under_way = Vec::with_capacity(modes.len());
        for (i, mut mode) in modes {
            match mode.advance(corrected.next().flatten()) {
                Advance::UnderWay => under_way.push((i, mode)),
                Advance::Arrived(end) => ends[i] = end,
                Advance::Lost => lost.push((i, mode)),
            }
        }
        modes = under_way;
    }
    lost
}

/// A point past the coalescence for each mode that was lost next to one; `None` where pair continuation fails. The two modes
/// of a pair may exchange their shapes at a coalescence: a shape that is clearly alike before and after belongs to one mode;
/// where none is, the eigenvalue decides.
fn pass_coalescences<'a>(lost: &[(usize, Continuation<'a>)], work: &mut Workspace) -> Vec<Option<PathPoint<'a>>> {
    let point = |mode: &Continuation<'a>| PathPoint { path: mode.path, t: mode.steps.t, lambda: mode.here.mode.lambda };
    let pairs = continue_pairs(&lost.iter().map(|(_, mode)| point(mode)).collect::<Vec<_>>(), work);
    let both = |(past, (_, mode)): (&Option<PastCoalescence>, &(usize, Continuation<'a>))| {
        past.map(|PastCoalescence { t, lambdas }| lambdas.map(|lambda| PathPoint { path: mode.path, t, lambda }))
    };
    let asked: Vec<PathPoint<'a>> = pairs.iter().zip(lost).filter_map(both).flatten().collect();
    let mut corrected = modes_on_paths(&asked, work).into_iter();
    let mut continued = |(past, (_, mode)): (Option<PastCoalescence>, &(usize, Continuation<'a>))| {
        mode.past(past?, [corrected.next().flatten(), corrected.next().flatten()])
    };
    pairs.into_iter().zip(lost).map(&mut continued).collect()
}

/// The ending for a mode with the eigenvalue `lambda`, rad/s, at the end of its path; in doubt where two known modes are near, or one is so but for an error.
fn ending(known: &[Mode], lambda: Complex<f64>) -> Ending {
    let mut order: Vec<(f64, usize)> =
        known.iter().enumerate().map(|(j, mode)| ((mode.lambda - lambda).norm(), j)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let distance = |place: usize| order.get(place).map_or(f64::INFINITY, |&(distance, _)| distance);
    let negligible = tuning().negligible_error * lambda.norm();
    match order.first() {
        Some(&(_, j)) if distance(0) <= negligible && distance(1) >= LEAST_SEPARATION * negligible => Ending::Known(j),
        _ if distance(0) >= LEAST_DISTANCE * negligible => Ending::Other(lambda),
        _ => Ending::Lost,
    }
}

impl<'a> Continuation<'a> {
    /// A continuation that begins at a point where the corrector found `here`; `None` where that is another mode.
    fn new(PathPoint { path, t, lambda }: PathPoint<'a>, near: bool, here: ModeOnPath) -> Option<Self> {
        let is_same = (here.mode.lambda - lambda).norm() <= tuning().negligible_error * lambda.norm();
        is_same.then_some(Self {
            path,
            near,
            steps: StepControl::new(t, tuning().first_step),
            here,
            curvature: Complex::default(),
        })
    }

    /// The end of the next step, and the eigenvalue predicted there.
    fn predict(&self) -> PathPoint<'a> {
        let step = self.steps.step();
        let change = (self.here.rate + self.curvature * (0.5 * step)) * step;
        PathPoint { path: self.path, t: self.steps.t + step, lambda: self.here.mode.lambda + change }
    }

    /// Takes the next step to the mode `there` if its error ratio is small, and makes the step shorter if not.
    fn advance(&mut self, there: Option<ModeOnPath>) -> Advance {
        let step = self.steps.step();
        let ratio = there.as_ref().map(|there| self.error_ratio(there, step));
        self.steps.advance(ratio);
        if let Some(there) = there.filter(|_| ratio.is_some_and(StepControl::accepts)) {
            self.curvature = (there.rate - self.here.rate) / step;
            self.here = there;
            if let Some(end) = self.end() {
                return Advance::Arrived(end);
            }
        }
        if self.steps.is_over(self.shortest_step()) { Advance::Lost } else { Advance::UnderWay }
    }

    /// The shortest step here, a longer one next to a coalescence. At a distance d from a branch point `lambda = m + sqrt(s)` the two eigenvalues are
    /// `8 d^2 |lambda''|` apart, and the next step is 0.8 d.
    fn shortest_step(&self) -> f64 {
        let tuning = tuning();
        let distance = self.steps.step() / 0.8;
        let gap = 8.0 * distance.powi(2) * self.curvature.norm();
        let is_narrow = gap > 0.0 && gap <= tuning.narrow_gap * self.here.mode.lambda.norm();
        if is_narrow { tuning.shortest_step } else { tuning.least_step }
    }

    /// The ending for this mode, at the end of the path or by a clear MAC before; `None` where it is not known yet.
    fn end(&self) -> Option<Ending> {
        let known = self.path.end.modes;
        if self.steps.t == 1.0 {
            return Some(ending(known, self.here.mode.lambda));
        }
        let alike = self.near.then(|| self.here.matched(known)).filter(Match::is_clear)?;
        alike.to.map(Ending::Known)
    }

    /// The error ratio of the step to `there`; infinite where the shape changes too much.
    fn error_ratio(&self, there: &ModeOnPath, step: f64) -> f64 {
        let ModeOnPath { mode: Mode { lambda, .. }, rate, .. } = &self.here;
        let errors = PredictorErrors::new([*lambda, there.mode.lambda], [*rate, there.rate], step);
        if there.weighted.dotc(&self.here.mode.shape).norm_sqr() >= tuning().least_mac {
            errors.ratio(tuning().negligible_error * lambda.norm())
        } else {
            f64::INFINITY
        }
    }

    /// The point of this mode past a coalescence; `found` are the two modes of the pair as corrected there.
    fn past(&self, past: PastCoalescence, found: [Option<ModeOnPath>; 2]) -> Option<PathPoint<'a>> {
        let PastCoalescence { t, lambdas } = past;
        let radius = ACCEPTANCE_RADIUS * (lambdas[1] - lambdas[0]).norm();
        let is_same = |point: &ModeOnPath, lambda: Complex<f64>| (point.mode.lambda - lambda).norm() <= radius;
        let [Some(first), Some(second)] = found else { return None };
        if !is_same(&first, lambdas[0]) || !is_same(&second, lambdas[1]) {
            return None;
        }
        let both = [first.mode, second.mode];
        let alike = self.here.matched(&both);
        let to = alike.to.filter(|_| alike.is_clear()).unwrap_or(0);
        Some(PathPoint { path: self.path, t, lambda: both[to].lambda })
    }
}

#[cfg(test)]
pub(crate) mod tests;
