//! The boundary curves of one part of a brake over two parameters.

use std::collections::BTreeSet;

use montecarlo::Progress;
use nalgebra::{Vector2, vector};
use num_complex::Complex;
use rayon::prelude::*;
use tracking::{Branches, Onsets, find_onsets, follow_branch};

use super::beyond::Beyond;
use super::boundary::{BoundaryCurve, BoundaryPoint, CurveEnd, KnownPoint, Tracer, passes};
use super::curve_point::CurvePoint;
use super::divergence::{DIVERGENCE, SignChanges, sign_changes};
use super::family::{DIFFERENCE, Evaluations, Line, Part, SHORTEST_STEP};
use super::names::{Names, in_words};
use crate::Error;
use crate::study::UncertainBrake;

/// Intervals of the grid of lines on which boundary curves are looked for; chosen: a curve that meets no line is not found.
pub(super) const GRID: usize = 8;

/// A line of the grid: the coordinate that is constant on it, and its value.
#[derive(Debug, Clone, Copy)]
struct GridLine {
    axis: usize,
    at: f64,
}

impl GridLine {
    /// The place at a part of the line.
    fn place(self, along: f64) -> Vector2<f64> {
        let mut place = vector![along, along];
        place[self.axis] = self.at;
        place
    }
}

/// Where a mode crosses the axis on a line, with the frequency, rad/s, of divergence zero; whether it grows beyond.
struct Met {
    along: f64,
    omega: f64,
    starts: bool,
    /// Bound of the error of `along`.
    error: f64,
}

/// What is found on a line.
struct OnLine {
    line: GridLine,
    met: Vec<Met>,
    unresolved: usize,
    unstable_at_start: usize,
    evaluations: Evaluations,
}

/// The map of one part.
#[derive(Default)]
pub(super) struct PartMap {
    /// The boundary, in values and in parts of the ranges.
    pub curves: Vec<(BoundaryCurve, Vec<[f64; 2]>)>,
    /// Unstable modes at the lower left corner, and the onsets on the left edge.
    pub on_left: (i64, Vec<(f64, i64)>),
    pub unresolved: usize,
    pub from_whole: Option<f64>,
    pub evaluations: Evaluations,
}

/// The map of one part, a step of progress for each line and one for the curves.
///
/// # Errors
/// Those of the brake and of [`find_onsets`].
pub(super) fn of_part<B: UncertainBrake>(part: &Part<'_, B>, progress: &dyn Progress) -> Result<PartMap, Error> {
    let places = (0..=GRID).map(|i| i as f64 / GRID as f64);
    let lines: Vec<GridLine> = places.flat_map(|at| [0, 1].map(|axis| GridLine { axis, at })).collect();
    let of_line = |line: &GridLine| {
        let found = on_line(part, *line);
        progress.advance(1);
        found
    };
    let found = lines.par_iter().map(of_line).collect::<Result<Vec<_>, Error>>()?;
    let mut map = PartMap::default();
    let mut starts: Vec<KnownPoint> = Vec::new();
    for OnLine { line, met, unresolved, unstable_at_start, evaluations } in found {
        map.unresolved += unresolved;
        map.evaluations += evaluations;
        if line.axis == 0 && line.at == 0.0 {
            let changes = met.iter().map(|met| (met.along, if met.starts { 1 } else { -1 }));
            map.on_left = (unstable_at_start as i64, changes.collect());
        }
        starts.extend(met.iter().map(|met| KnownPoint {
            at: line.place(met.along),
            omega: met.omega,
            error: met.error,
        }));
    }
    let mut tracer = Tracer { part, continued: 0 };
    let mut open: Vec<bool> = vec![true; starts.len()];
    for first in 0..starts.len() {
        if !open[first] {
            continue;
        }
        let KnownPoint { at, omega, .. } = starts[first];
        let Some(start) = CurvePoint::start(part, at, omega)? else {
            map.unresolved += 1;
            continue;
        };
        let (points, ends) = tracer.curve(start)?;
        // The last point of a closed curve is the first one.
        for at in BTreeSet::from([0, points.len() / 2, if ends[0] == CurveEnd::Closed { 0 } else { points.len() - 1 }])
        {
            let distance = points[at].distance_from_whole(part)?;
            map.evaluations.whole += u64::from(distance.is_some());
            map.from_whole = map.from_whole.into_iter().chain(distance).reduce(f64::max);
        }
        let on_curve = |known: &KnownPoint| points.windows(2).any(|step| passes(&step[0], &step[1], 1.0, known));
        let met: Vec<usize> = (0..starts.len()).filter(|&i| i == first || (open[i] && on_curve(&starts[i]))).collect();
        met.iter().for_each(|&i| open[i] = false);
        // The name is that at the point nearest to the medians, where the way there is shortest.
        let medians = part.medians();
        let median = vector![medians[0], medians[1]];
        let distance = |i: &usize| (starts[*i].at - median).norm();
        let named_at = met.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(first);
        let mode = if omega == 0.0 {
            DIVERGENCE.to_owned()
        } else {
            let (names, evaluations) = name(part, &starts[named_at]);
            map.evaluations += evaluations;
            in_words(&names)
        };
        map.curves.push((curve(part, &points, ends, mode), points.iter().map(|p| [p.at.x, p.at.y]).collect()));
    }
    map.evaluations.continued += tracer.continued;
    progress.advance(1);
    Ok(map)
}

/// The onsets on a line of the grid, in parts of the range.
fn on_line<B: UncertainBrake>(part: &Part<'_, B>, line: GridLine) -> Result<OnLine, Error> {
    let (mut start, mut direction) = (vec![0.0; 2], vec![0.0; 2]);
    start[line.axis] = line.at;
    direction[1 - line.axis] = 1.0;
    let mut branches = part.along(Line { start, direction, bounds: [0.0, 1.0], difference: DIFFERENCE });
    let Onsets { onsets, unresolved } =
        find_onsets(&mut Beyond::new(&mut branches, part.threshold()), 0.0, 1.0, SHORTEST_STEP)?;
    let studied = onsets.iter().filter(|onset| part.is_studied(onset.omega));
    let flutter = studied.map(|onset| Met {
        along: onset.at,
        omega: onset.omega,
        starts: onset.destabilises,
        error: onset.error,
    });
    let is_counted = |lambda: &&Complex<f64>| part.threshold().margin(**lambda) >= 0.0 && part.is_studied(lambda.im);
    let mut unstable_at_start = branches.lambdas(0.0)?.iter().filter(is_counted).count();
    let mut met: Vec<Met> = flutter.collect();
    if part.is_studied(0.0) {
        let system = |along: f64| part.system(line.place(along).as_slice());
        let SignChanges { found, negative_at_start } = sign_changes(&system, part.real_onset(), &[])?;
        unstable_at_start += usize::from(negative_at_start);
        met.extend(found.iter().map(|change| Met {
            along: change.at,
            omega: 0.0,
            starts: change.to_negative,
            error: change.width,
        }));
    }
    let evaluations = Evaluations::of(branches.counters());
    Ok(OnLine { line, met, unresolved: unresolved.len(), unstable_at_start, evaluations })
}

/// The names of the mode that crosses the axis at a point with a frequency, followed on the straight line to the medians; none where
/// it cannot be followed.
fn name<B: UncertainBrake>(part: &Part<'_, B>, &KnownPoint { at, omega, .. }: &KnownPoint) -> (Names, Evaluations) {
    let start = part.medians();
    let direction = vec![at.x - start[0], at.y - start[1]];
    let mut branches = part.along(Line { start, direction, bounds: [0.0, 1.0], difference: DIFFERENCE });
    let lambda = part.threshold().at_margin(0.0, omega);
    let mut followed = || -> Result<Names, Error> {
        let lambdas = branches.lambdas(1.0)?;
        let nearest = |&a: &usize, &b: &usize| (lambdas[a] - lambda).norm().total_cmp(&(lambdas[b] - lambda).norm());
        let Some(index) = (0..lambdas.len()).min_by(nearest) else { return Ok(Names::new()) };
        let there = follow_branch(&mut branches, 1.0, index, 0.0, SHORTEST_STEP)?;
        let at_median = branches.lambdas(0.0)?;
        let mode_of = |index: usize| {
            let distance = |&mode: &usize| (part.reference.modes[mode].lambda - at_median[index]).norm();
            (0..part.reference.modes.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
        };
        Ok(part.reference.names_of(there.into_iter().filter_map(mode_of)))
    };
    let names = followed().unwrap_or_default();
    (names, Evaluations::of(branches.counters()))
}

fn curve<B: UncertainBrake>(
    part: &Part<'_, B>,
    points: &[CurvePoint],
    ends: [CurveEnd; 2],
    mode: String,
) -> BoundaryCurve {
    let parameters = &part.family.parameters;
    let point = |point: &CurvePoint| BoundaryPoint {
        at: [parameters[0].at(point.at.x), parameters[1].at(point.at.y)],
        omega: point.omega(),
    };
    BoundaryCurve { mode, ends, points: points.iter().map(point).collect() }
}
