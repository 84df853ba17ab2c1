//! Every onset over one real parameter: where an eigenvalue crosses the imaginary axis (a Hopf point), whichever way.
//!
//! The interval is halved until in each step every branch that could reach the axis either stays off the axis or crosses
//! it once. A branch between two spectra is judged by the slopes s_a and s_b of Re lambda at the ends of the step of length h:
//! where both differ from the slope of the chord by less than half of it, Re lambda counts as monotonic. Otherwise Re lambda is
//! taken for a parabola, which departs from its chord by |s_b - s_a| h / 8, and the branch has to stay four times as far from
//! the axis. At the end the number of unstable modes of every spectrum has to agree with the onsets found.
//! This is a rule, not a proof: a branch that crosses the axis twice within one step, faster than [`RATE_MARGIN`] or four times
//! such a parabola allows for, is overlooked (docs/error-bounds.md, section 10, says how often that was looked for).

use num_complex::Complex;

use crate::TrackingError;
use crate::branch::{BranchPoint, Branches, FIRST_STEPS, RefinedPoint, first_steps, link};
use crate::error::check_interval;

/// Factor on the speed of a branch at an end of a step: it is watched in the step if it would reach the axis at that. Chosen: with less, a branch that becomes
/// faster within the step is missed; with more, branches are watched that stay away.
const RATE_MARGIN: f64 = 2.0;
/// Most steps of the root search; chosen: bisection alone takes about 50.
const MOST_ROOT_STEPS: usize = 60;

/// Crossing of the imaginary axis by an eigenvalue.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Onset {
    /// The parameter.
    pub at: f64,
    /// Bound of the error of `at`.
    pub error: f64,
    /// Angular frequency Im lambda, rad/s.
    pub omega: f64,
    /// True if the mode becomes unstable with a growing parameter.
    pub destabilises: bool,
}

/// Onsets on an interval, and the steps in which the search could not decide.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize)]
pub struct Onsets {
    /// The onsets, ascending in the parameter.
    pub onsets: Vec<Onset>,
    /// Steps of the smallest length in which a branch comes so near the axis that the search cannot tell whether it crosses.
    pub unresolved: Vec<(f64, f64)>,
}

/// A watched branch over a step: the indices of its mode at the lower and at the upper end.
type Watched = (usize, usize);

/// Verdict on the branches in a step.
enum StepVerdict {
    /// No watched branch has an onset.
    Quiet,
    /// A single onset on each of these branches.
    Once(Vec<Watched>),
    /// The step is too long to tell.
    Unclear,
}

/// Every onset between two values of the parameter; steps not longer than `smallest` are not halved.
///
/// # Errors
/// Those of the branches; [`TrackingError::OnsetNotConverged`], [`TrackingError::OnsetsContradicted`],
/// [`TrackingError::Interval`].
pub fn find_onsets<B>(branches: &mut B, from: f64, to: f64, smallest: f64) -> Result<Onsets, B::Error>
where
    B: Branches + ?Sized,
    B::Error: From<TrackingError>,
{
    check_interval(from, to)?;
    let mut found = Onsets::default();
    for [a, b] in first_steps(from, to, FIRST_STEPS) {
        search(branches, a, b, smallest, &mut found)?;
    }
    found.onsets.sort_by(|a, b| a.at.total_cmp(&b.at));
    check(branches, [from, to], smallest, &found)?;
    Ok(found)
}

/// Enters the onsets between the parameters `a` and `b`, and the steps in which it cannot be told, into `found`.
fn search<B>(branches: &mut B, a: f64, b: f64, smallest: f64, found: &mut Onsets) -> Result<(), B::Error>
where
    B: Branches + ?Sized,
    B::Error: From<TrackingError>,
{
    match judge(branches, a, b)? {
        StepVerdict::Quiet => Ok(()),
        StepVerdict::Once(watched) => {
            for (f, j) in watched {
                found.onsets.push(onset_between(branches, (a, f), (b, j))?);
            }
            Ok(())
        }
        StepVerdict::Unclear if b - a <= smallest => {
            found.unresolved.push((a, b));
            Ok(())
        }
        StepVerdict::Unclear => {
            let middle = 0.5 * (a + b);
            search(branches, a, middle, smallest, found)?;
            search(branches, middle, b, smallest, found)
        }
    }
}

/// The verdict on the step from `a` to `b`: on all branches that are [`watched`] from either end of it.
fn judge<B: Branches + ?Sized>(branches: &mut B, a: f64, b: f64) -> Result<StepVerdict, B::Error> {
    let h = b - a;
    let mut crossing = Vec::new();
    let (here, there) = (watched(branches, a, h)?, watched(branches, b, h)?);
    let mut linked = Vec::with_capacity(here.len());
    for f in here {
        let link = link(branches, a, f, b)?;
        if !link.is_clear {
            return Ok(StepVerdict::Unclear);
        }
        linked.push((f, link.to));
    }
    for j in there {
        if !linked.iter().any(|&(_, to)| to == j) {
            let link = link(branches, b, j, a)?;
            if !link.is_clear {
                return Ok(StepVerdict::Unclear);
            }
            linked.push((link.to, j));
        }
    }
    for (f, j) in linked {
        let (start, end) = (branches.point(a, f)?, branches.point(b, j)?);
        let chord = (end.lambda.re - start.lambda.re) / h;
        let is_straight = |rate: f64| (rate - chord).abs() < 0.5 * chord.abs();
        let is_monotonic = is_straight(start.rate.re) && is_straight(end.rate.re);
        let does_cross = is_unstable(&start.lambda) != is_unstable(&end.lambda);
        let keeps_distance =
            start.lambda.re.abs().min(end.lambda.re.abs()) > 0.5 * (end.rate.re - start.rate.re).abs() * h;
        match (does_cross, is_monotonic) {
            (true, true) => crossing.push((f, j)),
            (false, true) => {}
            (false, false) if keeps_distance => {}
            _ => return Ok(StepVerdict::Unclear),
        }
    }
    Ok(if crossing.is_empty() { StepVerdict::Quiet } else { StepVerdict::Once(crossing) })
}

/// An eigenvalue on the axis counts as unstable, so that an onset exactly at the end of two steps lies in one of them.
fn is_unstable(lambda: &Complex<f64>) -> bool {
    lambda.re >= 0.0
}

/// Modes at a parameter that could reach the imaginary axis within a step of length `h` or are unstable.
fn watched<B: Branches + ?Sized>(branches: &mut B, at: f64, h: f64) -> Result<Vec<usize>, B::Error> {
    let mut watched = Vec::new();
    for i in 0..branches.lambdas(at)?.len() {
        let BranchPoint { lambda, rate } = branches.point(at, i)?;
        if lambda.re + RATE_MARGIN * rate.norm() * h >= 0.0 {
            watched.push(i);
        }
    }
    Ok(watched)
}

/// The one onset of a branch between the parameters `a` and `b`, where the branch is the mode `f` and `j`, to full accuracy:
/// Newton's method kept within the bracket. Re lambda must have different signs at the two ends.
///
/// # Errors
/// Those of the branches; [`TrackingError::OnsetNotConverged`].
pub fn onset_between<B>(branches: &mut B, (a, f): (f64, usize), (b, j): (f64, usize)) -> Result<Onset, B::Error>
where
    B: Branches + ?Sized,
    B::Error: From<TrackingError>,
{
    let (first, last) = (branches.point(a, f)?, branches.point(b, j)?.lambda);
    let destabilises = !is_unstable(&first.lambda);
    let (mut low, mut high) = (a, b);
    let mut left = f64::INFINITY;
    // The search begins where the chord crosses the axis.
    let start = a + (b - a) * first.lambda.re / (first.lambda.re - last.re);
    let mut guess = first.lambda + first.rate * (start - a);
    let mut at = a.max(start);
    for _ in 0..MOST_ROOT_STEPS {
        let nearest = |x: &&Complex<f64>, y: &&Complex<f64>| (*x - guess).norm().total_cmp(&(*y - guess).norm());
        let Some(&lambda) = branches.lambdas(at)?.iter().min_by(nearest) else { break };
        let RefinedPoint { lambda, rate, bound } = branches.refined(at, lambda)?;
        if is_unstable(&lambda) != destabilises {
            low = at;
        } else {
            high = at;
        }
        let step = -lambda.re / rate.re;
        let error = bound / rate.re.abs();
        left = step.abs();
        if left <= error.max(2.0 * f64::EPSILON * at.abs()) {
            return Ok(Onset { at, error: error + left, omega: lambda.im, destabilises });
        }
        let next = if at + step > low && at + step < high { at + step } else { 0.5 * (low + high) };
        guess = lambda + rate * (next - at);
        at = next;
    }
    Err(TrackingError::OnsetNotConverged { from: a, to: b, left, steps: MOST_ROOT_STEPS }.into())
}

/// Checks that every known spectrum has as many unstable modes as follow from the spectrum at `from` and the onsets between.
fn check<B>(branches: &mut B, [from, to]: [f64; 2], smallest: f64, found: &Onsets) -> Result<(), B::Error>
where
    B: Branches + ?Sized,
    B::Error: From<TrackingError>,
{
    let unstable = |lambdas: &[Complex<f64>]| lambdas.iter().filter(|lambda| is_unstable(lambda)).count();
    let start = unstable(branches.lambdas(from)?) as i64;
    let outside = branches.growing_outside(from)?;
    let is_open = |at: f64| {
        found.unresolved.iter().any(|&(a, b)| (a..=b).contains(&at))
            || found.onsets.iter().any(|onset| (at - onset.at).abs() <= onset.error + smallest)
    };
    for at in branches.known_between(from, to) {
        // A growing mode has left the band or come into it: no onset says so.
        if branches.growing_outside(at)? != outside {
            continue;
        }
        let change = |onset: &Onset| if onset.destabilises { 1 } else { -1 };
        let expected = start + found.onsets.iter().filter(|onset| onset.at < at).map(change).sum::<i64>();
        let found = unstable(branches.lambdas(at)?);
        if found as i64 != expected && !is_open(at) {
            return Err(TrackingError::OnsetsContradicted { at, found, expected }.into());
        }
    }
    Ok(())
}
