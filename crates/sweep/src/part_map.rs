//! The boundary curves of one part of a brake over two parameters.

use std::collections::BTreeSet;

use montecarlo::Progress;
use nalgebra::{Vector2, vector};
use num_complex::Complex;
use rayon::prelude::*;
use study::{ModeLabel, UncertainBrake};
use tracking::{Branches, follow_branch};

use super::boundary::{BoundaryCurve, BoundaryPoint, CurveEnd, KnownPoint, Tracer, passes};
use super::change::{Along, Change, ChangeOf, by};
use super::changes::Changes;
use super::curve_point::{CurvePoint, PointOf};
use super::divergence::{DIVERGENCE, EXCHANGE};
use super::family::{DIFFERENCE, Evaluations, Line, Part, SHORTEST_STEP};
use super::names::Names;
use crate::Error;

/// Number of equal steps of a line at which unstable modes are counted; chosen.
const STEPS: usize = 64;

/// Line of the grid: the coordinate that is constant on it, and its value.
#[derive(Debug, Clone, Copy)]
struct GridLine {
    axis: usize,
    at: f64,
}

impl GridLine {
    /// Point at a fraction of the line.
    fn place(self, along: f64) -> Vector2<f64> {
        let mut place = vector![along, along];
        place[self.axis] = self.at;
        place
    }
}

/// Findings on a line of the grid.
struct OnLine {
    line: GridLine,
    met: Vec<Change>,
    unresolved: usize,
    unstable_at_start: usize,
    evaluations: Evaluations,
}

/// The map of one part.
#[derive(Default)]
pub(super) struct PartMap {
    /// Curves of the boundary, each in values and in fractions of the ranges.
    pub curves: Vec<(BoundaryCurve, Vec<[f64; 2]>)>,
    /// Number of unstable modes at the lower left corner, and the onsets on the left edge.
    pub on_left: (i64, Vec<(f64, i64)>),
    pub unresolved: usize,
    /// True if a growing mode enters the band that is studied, or leaves it, on a line: then no curves were followed.
    pub meets_band: bool,
    pub from_whole: Option<f64>,
    pub evaluations: Evaluations,
}

/// The map of one part from `grid` intervals of lines, a step of progress for each line and one for the curves.
///
/// # Errors
/// Those of the brake and of the solver.
pub(super) fn of_part<B: UncertainBrake>(
    part: &Part<'_, B>,
    grid: usize,
    progress: &dyn Progress,
) -> Result<PartMap, Error> {
    let places = (0..=grid).map(|i| i as f64 / grid as f64);
    let lines: Vec<GridLine> = places.flat_map(|at| [0, 1].map(|axis| GridLine { axis, at })).collect();
    let of_line = |line: &GridLine| {
        let found = on_line(part, *line);
        progress.advance(1);
        found
    };
    let found = lines.par_iter().map(of_line).collect::<Result<Vec<_>, Error>>()?;
    let mut map = PartMap::default();
    let (mut starts, mut real_parts): (Vec<KnownPoint>, Vec<f64>) = Default::default();
    for OnLine { line, met, unresolved, unstable_at_start, evaluations } in found {
        map.unresolved += unresolved;
        map.evaluations += evaluations;
        if line.axis == 0 && line.at == 0.0 {
            let changes = met.iter().map(|met| (met.at, by(met.starts)));
            map.on_left = (unstable_at_start as i64, changes.collect());
        }
        map.meets_band |= met.iter().any(|met| met.of == ChangeOf::Band);
        real_parts.extend(met.iter().map(|met| met.lambda.re));
        starts.extend(met.iter().map(|met| KnownPoint {
            at: line.place(met.at),
            omega: if met.of.oscillates() { met.lambda.im } else { 0.0 },
            of: match (met.of, met.is_double) {
                (ChangeOf::Divergence, _) => PointOf::Divergence,
                (_, true) => PointOf::Double,
                (_, false) => PointOf::Flutter,
            },
            error: met.error,
        }));
    }
    if map.meets_band {
        return Ok(map);
    }
    let mut tracer = Tracer { part, continued: 0 };
    let mut open: Vec<bool> = vec![true; starts.len()];
    for first in 0..starts.len() {
        if !open[first] {
            continue;
        }
        let KnownPoint { at, omega, of, .. } = starts[first];
        let Some(start) = CurvePoint::start(part, at, Complex::new(real_parts[first], omega), of)? else {
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
            if of == PointOf::Double { EXCHANGE.to_owned() } else { DIVERGENCE.to_owned() }
        } else {
            let (names, evaluations) = name(part, &starts[named_at]);
            map.evaluations += evaluations;
            ModeLabel::candidates(&names)
        };
        map.curves.push((curve(part, &points, ends, mode), points.iter().map(|p| [p.at.x, p.at.y]).collect()));
    }
    map.evaluations.continued += tracer.continued;
    progress.advance(1);
    Ok(map)
}

/// The onsets on a line of the grid, in fractions of the range.
fn on_line<B: UncertainBrake>(part: &Part<'_, B>, line: GridLine) -> Result<OnLine, Error> {
    let system = |along: f64| part.system(line.place(along).as_slice());
    let along = Along::new(&system, &part.family.solver, part.threshold(), part.band());
    let Changes { found, unresolved, ends: [start, _], spectra, .. } = along.changes(STEPS, &[])?;
    Ok(OnLine {
        line,
        met: found.into_iter().filter(|change| part.counts(change)).collect(),
        unresolved: unresolved.len(),
        unstable_at_start: part.counted(&start).iter().sum(),
        evaluations: Evaluations { spectra, ..Evaluations::default() },
    })
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
        growth: point.real_part(&part.threshold()),
    };
    BoundaryCurve { mode, ends, points: points.iter().map(point).collect() }
}
