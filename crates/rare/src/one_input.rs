//! The probability of failure of a system of one input, along which all failure lies on one line: by a scan of it.
//!
//! Where nothing is proven ([`LimitState::proven`]) the line is looked at from end to end, half of the points at equal steps and half at equal steps of
//! probability. Every change between two points is an end of an interval of failure; the probability of failure is the probability of these intervals under
//! the normal distribution. Failure between two points that is at neither of them is not seen: the widest step is told.

use rayon::prelude::*;

use crate::answer::{Estimate, Probability};
use crate::limit_state::{AT_ONCE, Asked, Counted, LimitState};
use crate::line_sampling::Witness;
use crate::normal::{Interval, tail};
use crate::options::Options;
use crate::search::DesignPoint;

/// Distance from the median up to which is looked, in standard deviations; chosen: quantiles have no digits farther out.
const REACH: f64 = 8.0;
/// Error of an end of an interval, in standard deviations; chosen: far below the width of any interval that a scan finds.
const PRECISION: f64 = 1e-9;
/// Fraction of the budget for the scan; chosen: the ends of intervals take the rest.
const SCANNED: f64 = 0.8;
/// Fewest points of a range, chosen: its ends are always looked at.
const FEWEST: f64 = 3.0;
/// Failing points of an interval that stand for it, each with as much of its probability; chosen: modes are told apart to a part in as many.
const WITNESSES: usize = 48;

/// The estimate; `None` where the scan finds no failure.
///
/// # Errors
/// Those of the limit state.
pub(crate) fn estimate<L: LimitState>(of: &Counted<'_, L>, options: &Options) -> Result<Option<Estimate>, L::Error> {
    let open = between(&of.proven());
    let places: Vec<Vec<f64>> = points(&open, SCANNED * options.budget as f64);
    let flat: Vec<f64> = places.iter().flatten().copied().collect();
    let evaluate = |chunk: &[f64]| -> Result<Vec<f64>, L::Error> {
        let all: Vec<Vec<f64>> = chunk.iter().map(|u| vec![*u]).collect();
        Ok(of.worst_of_all(&all)?.iter().map(|mode| mode.margin).collect())
    };
    let found = flat.par_chunks(AT_ONCE).map(evaluate).collect::<Result<Vec<_>, L::Error>>()?;
    let mut margins = found.into_iter().flatten();
    let mut margin = |u: f64| Ok::<f64, L::Error>(of.worst(&[u])?.margin);
    let (mut intervals, mut widest) = (Vec::new(), 0.0_f64);
    for range in &places {
        let known: Vec<(f64, f64)> = range.iter().copied().zip(margins.by_ref()).collect();
        // A range that fails at its end fails beyond it where nothing was looked at.
        let is_outermost = |u: f64| u.abs() >= REACH;
        let mut open = known
            .first()
            .filter(|first| first.1 > 0.0)
            .map(|first| if is_outermost(first.0) { f64::NEG_INFINITY } else { first.0 });
        for pair in known.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            widest = widest.max(b.0 - a.0);
            if (a.1 > 0.0) == (b.1 > 0.0) {
                continue;
            }
            let end = end(&mut margin, a.0, b.0)?;
            match open.take() {
                Some(from) => intervals.push(Interval { from, to: end }),
                None => open = Some(end),
            }
        }
        let to = range.last().copied().filter(|to| !is_outermost(*to)).unwrap_or(f64::INFINITY);
        intervals.extend(open.map(|from| Interval { from, to }));
    }
    intervals.retain(|interval| interval.from < interval.to);
    if intervals.is_empty() {
        return Ok(None);
    }
    intervals.sort_by(|a, b| nearest(a).abs().total_cmp(&nearest(b).abs()));
    let value: f64 = intervals.iter().map(Interval::probability).sum();
    let design_points = intervals.iter().map(|interval| design_point(of, interval)).collect::<Result<Vec<_>, _>>()?;
    let witness = |(design_point, interval): (usize, &Interval)| {
        let (interval, weight) = (*interval, interval.probability());
        (0..WITNESSES).map(move |at| {
            let part = (at as f64 + 0.5) / WITNESSES as f64;
            Witness { point: vec![interval.point(part)], design_point, lines: WITNESSES, weight }
        })
    };
    let witnesses: Vec<Witness> = intervals.iter().enumerate().flat_map(witness).collect();
    let of_end = |u: f64| PRECISION * (-0.5 * u * u).exp();
    let ends: f64 = intervals.iter().flat_map(|interval| [interval.from, interval.to]).map(of_end).sum();
    let unproven = ends + 2.0 * tail(REACH);
    Ok(Some(Estimate {
        probability: Probability::new(value, 0.0, WITNESSES, unproven),
        unproven,
        design_points,
        lines: witnesses.len(),
        witnesses,
        elsewhere: [flat.len(), 0],
        plain: 0,
        scanned: Some(widest),
        evaluations: of.evaluations(),
        is_reached: true,
    }))
}

/// The place between two at which failure begins or ends, by bisection: margins may jump there.
fn end<E>(margin: &mut impl FnMut(f64) -> Result<f64, E>, mut a: f64, mut b: f64) -> Result<f64, E> {
    let is_failing = margin(a)? > 0.0;
    while b - a > PRECISION {
        let middle = 0.5 * (a + b);
        if (margin(middle)? > 0.0) == is_failing { a = middle } else { b = middle }
    }
    Ok(0.5 * (a + b))
}

/// Ranges within the reach that are not proven to be free of failure, ascending.
fn between(proven: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut open = Vec::new();
    let mut from = -REACH;
    let mut sorted: Vec<[f64; 2]> = proven.to_vec();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]));
    for [start, end] in sorted.into_iter().chain([[REACH, REACH]]) {
        if start > from {
            open.push([from, start.min(REACH)]);
        }
        from = from.max(end);
        if from >= REACH {
            break;
        }
    }
    open
}

/// Places in each range, ascending, about `number` in all.
fn points(ranges: &[[f64; 2]], number: f64) -> Vec<Vec<f64>> {
    let length: f64 = ranges.iter().map(|[from, to]| to - from).sum();
    let inside = |[from, to]: [f64; 2]| Interval { from, to }.probability();
    let probability: f64 = ranges.iter().copied().map(inside).sum();
    let of_range = |&[from, to]: &[f64; 2]| {
        let steps = |part: f64| (0.5 * number * part).max(FEWEST).ceil();
        let (by_length, by_probability) = (steps((to - from) / length), steps(inside([from, to]) / probability));
        let even = (0..=by_length as usize).map(|at| from + (to - from) * at as f64 / by_length);
        let weighted = (1..by_probability as usize).map(|at| Interval { from, to }.point(at as f64 / by_probability));
        let mut places: Vec<f64> = even.chain(weighted).filter(|u| (from..=to).contains(u)).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        places
    };
    ranges.iter().map(of_range).collect()
}

/// The end of an interval that is nearest to the median; 0 where the median is inside.
fn nearest(interval: &Interval) -> f64 {
    match () {
        () if interval.from > 0.0 => interval.from,
        () if interval.to < 0.0 => interval.to,
        () => 0.0,
    }
}

/// The likeliest failure of an interval.
fn design_point<A: Asked>(of: &A, interval: &Interval) -> Result<DesignPoint, A::Error> {
    let at = nearest(interval);
    let mode = of.worst(&[at])?;
    let outwards = if at < 0.0 { -1.0 } else { 1.0 };
    let slope = of.steepest(&[at], &mode)?.map_or(0.0, |(_, slope)| slope);
    Ok(DesignPoint { point: vec![at], direction: vec![outwards], beta: at.abs(), slope, mode, is_settled: true })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Error;
    use crate::limit_state::Mode;

    /// Failure in some ranges of the only input, with margins that a line search sees nothing of until it is there.
    struct Ranges {
        failing: Vec<[f64; 2]>,
        proven: Vec<[f64; 2]>,
    }

    impl LimitState for Ranges {
        type Error = Error;

        fn dimensions(&self) -> usize {
            1
        }

        fn modes(&self, u: &[f64]) -> Result<Vec<Mode>, Error> {
            let depth = |&[from, to]: &[f64; 2]| (u[0] - from).min(to - u[0]);
            let margin = self.failing.iter().map(depth).fold(-1e-3, f64::max);
            Ok(vec![Mode { margin, growth: margin, omega: 1.0 }])
        }

        fn gradient(&self, _: &[f64], _: &Mode) -> Result<Vec<f64>, Error> {
            Ok(vec![1.0])
        }

        fn proven(&self) -> Vec<[f64; 2]> {
            self.proven.clone()
        }
    }

    /// Islands of all places and widths: those wider than the step that is told are in the probability, to a part in a million.
    #[test]
    fn every_range_that_is_wider_than_the_step_that_is_told_is_counted() {
        let mut number = 0;
        for at in 0..200_u32 {
            let place = f64::from(at) * 0.061_803 % 6.0 + 0.3;
            let width = 10f64.powf(-0.5 - f64::from(at % 7) * 0.4);
            for sign in [1.0, -1.0] {
                let island = if sign > 0.0 { [place, place + width] } else { [-place - width, -place] };
                let system = Ranges { failing: vec![island, [4.5, 99.0]], proven: Vec::new() };
                let found = crate::estimate(&system, &Options::default()).unwrap();
                let step = found.scanned.unwrap();
                let own = Interval { from: island[0], to: island[1] }.probability();
                // Both together where they meet.
                let all = if island[1] < 4.5 { own + tail(4.5) } else { tail(4.5_f64.min(island[0])) };
                if width > step {
                    number += 1;
                    let error = (found.probability.value / all - 1.0).abs();
                    assert!(error < 1e-6, "{island:?} {found:?} {all:e}");
                }
            }
        }
        assert!(number > 150, "{number}");
    }

    /// Proven ranges are not looked at, so that the rest is looked at more closely.
    #[test]
    fn a_hole_in_what_is_proven_is_looked_at_closely() {
        let system =
            Ranges { failing: vec![[-0.4045, -0.3955], [5.04, 99.0]], proven: vec![[-9.0, -0.452], [-0.348, 3.0]] };
        let found = crate::estimate(&system, &Options::default()).unwrap();
        let exact = Interval { from: -0.4045, to: -0.3955 }.probability() + tail(5.04);
        assert!((found.probability.value / exact - 1.0).abs() < 1e-6, "{found:?} {exact:e}");
        assert_eq!(found.design_points.len(), 2);
        assert!(found.probability.lower <= exact && found.probability.upper >= exact);
    }
}
