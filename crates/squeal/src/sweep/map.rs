//! The stability map over two parameters.

use std::collections::BTreeSet;

use cea::EigenSolver;
use montecarlo::Progress;
use nalgebra::{Vector2, vector};
use num_complex::Complex;
use rayon::prelude::*;
use serde::Serialize;
use tracking::{Branches, Onset, Onsets, find_onsets, follow_branch};

use super::boundary::{CurveEnd, CurvePoint, Tracer, passes};
use super::family::{DIFFERENCE, Evaluations, Family, Line, Part, SHORTEST_STEP};
use super::names::{Names, in_words};
use super::parameter::{Over, SweptParameter};
use super::regions::{CELLS, Region, Run, regions, runs};
use crate::Error;
use crate::study::{Study, UncertainBrake};

/// Intervals of the grid of lines on which boundary curves are looked for; chosen: a curve that meets no line is not found.
const GRID: usize = 8;

/// A point of a boundary curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BoundaryPoint {
    /// Values of the two parameters.
    pub at: [f64; 2],
    /// Im lambda, rad/s.
    pub omega: f64,
}

/// A curve on which one mode neither grows nor decays. It grows on the right of the curve, seen along it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BoundaryCurve {
    /// Candidates for the name of the mode where the curve was found, on the straight line from the medians.
    pub mode: String,
    /// How it begins and ends.
    pub ends: [CurveEnd; 2],
    /// Its points; the first again at the end of a closed one.
    pub points: Vec<BoundaryPoint>,
}

/// A stability map.
#[derive(Debug, Clone, PartialEq)]
pub struct StabilityMap {
    /// The two parameters.
    pub parameters: [SweptParameter; 2],
    /// The boundary.
    pub curves: Vec<BoundaryCurve>,
    /// Regions, the largest first.
    pub regions: Vec<Region>,
    /// The number of unstable modes along rows of cells, from below.
    pub rows: Vec<Run>,
    /// Intervals of the grid of lines: a closed curve between two neighbouring lines of both directions is not found.
    pub grid: usize,
    /// Steps on lines of the grid in which a mode comes so near the axis that it is not known whether it crosses.
    pub unresolved: usize,
    /// Regions in which a spectrum has another number of unstable modes than the curves say: a curve is missing there.
    pub contradicted: Vec<Region>,
    /// The largest distance of the boundary from that of the brake that this one is a reduction of, as a part of the ranges, at the ends
    /// and in the middle of each curve; `None` of a brake that is not reduced.
    pub from_whole: Option<f64>,
    /// What was computed.
    pub evaluations: Evaluations,
    /// Spectra on a grid with one in each cell of the figure, of all sectors.
    pub fine_grid: u64,
}

/// A line of the grid: the coordinate that is constant on it, and its value.
#[derive(Debug, Clone, Copy)]
struct GridLine {
    axis: usize,
    at: f64,
}

/// What is found on a line.
struct OnLine {
    line: GridLine,
    onsets: Vec<Onset>,
    unresolved: usize,
    unstable_at_start: usize,
    evaluations: Evaluations,
}

/// The map of one part.
#[derive(Default)]
struct PartMap {
    curves: Vec<(BoundaryCurve, Vec<[f64; 2]>)>,
    /// Unstable modes at the lower left corner, and the onsets on the left edge.
    on_left: (i64, Vec<(f64, i64)>),
    unresolved: usize,
    from_whole: Option<f64>,
    evaluations: Evaluations,
}

/// The stability map of a scene of a study over two parameters. Only modes that oscillate are looked at.
///
/// # Errors
/// Parameters or ranges that the scene does not have, a value that the brake refuses, and those of [`find_onsets`].
pub fn stability_map<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    over: &[Over; 2],
    solver: &dyn EigenSolver,
    progress: &dyn Progress,
) -> Result<StabilityMap, Error> {
    let family = Family::new(study, scene, over, solver)?;
    let parts = family.parts()?;
    // A step for each line of the grid, and one for following the curves.
    progress.begin((parts.len() * (2 * (GRID + 1) + 1)) as u64, 0);
    let of_part = |part: &Part<'_, B>| of_part(part, progress);
    let found = parts.par_iter().map(of_part).collect::<Result<Vec<_>, Error>>();
    progress.end();
    let found = found.map_err(|source| {
        let at = format!("sweep over {} and {}", over[0], over[1]);
        Error::Sweep { at, source: Box::new(source) }
    })?;
    let (mut curves, mut lines) = (Vec::new(), Vec::new());
    let (mut evaluations, mut unresolved, mut edges) = (Evaluations::default(), 0, Vec::new());
    let mut from_whole: Option<f64> = None;
    for part in found {
        for (curve, line) in part.curves {
            curves.push(curve);
            lines.push(line);
        }
        edges.push(part.on_left);
        unresolved += part.unresolved;
        from_whole = from_whole.into_iter().chain(part.from_whole).reduce(f64::max);
        evaluations += part.evaluations;
    }
    let on_left = |y: f64| -> i64 {
        let of_edge = |(start, onsets): &(i64, Vec<(f64, i64)>)| {
            start + onsets.iter().filter(|(at, _)| *at < y).map(|(_, change)| change).sum::<i64>()
        };
        edges.iter().map(of_edge).sum()
    };
    let rows = runs(&lines, &on_left);
    let regions = regions(&rows);
    let counts = regions.par_iter().map(|region| unstable(&parts, &region.at));
    let counts = counts.collect::<Result<Vec<_>, Error>>()?;
    evaluations.spectra += (parts.len() * regions.len()) as u64;
    let differs = |(region, count): (&Region, usize)| (region.unstable != count).then_some(*region);
    Ok(StabilityMap {
        contradicted: regions.iter().zip(counts).filter_map(differs).collect(),
        parameters: [family.parameters[0].clone(), family.parameters[1].clone()],
        curves,
        regions,
        rows,
        grid: GRID,
        unresolved,
        from_whole,
        evaluations,
        fine_grid: (CELLS * CELLS * parts.len()) as u64,
    })
}

/// The number of unstable modes by spectra.
fn unstable<B: UncertainBrake>(parts: &[Part<'_, B>], at: &[f64; 2]) -> Result<usize, Error> {
    let of_part = |part: &Part<'_, B>| {
        let spectrum = part.family.solver.eigenvalues(&part.system(at)?, &mut cea::Workspace::default())?;
        Ok(spectrum.oscillatory().filter(|lambda| lambda.re >= 0.0 && part.is_studied(lambda.im)).count())
    };
    parts.iter().map(of_part).sum()
}

fn of_part<B: UncertainBrake>(part: &Part<'_, B>, progress: &dyn Progress) -> Result<PartMap, Error> {
    let places = (0..=GRID).map(|i| i as f64 / GRID as f64);
    let lines: Vec<GridLine> = places.flat_map(|at| [0, 1].map(|axis| GridLine { axis, at })).collect();
    let of_line = |line: &GridLine| {
        let found = on_line(part, *line);
        progress.advance(1);
        found
    };
    let found = lines.par_iter().map(of_line).collect::<Result<Vec<_>, Error>>()?;
    let mut map = PartMap::default();
    let mut starts: Vec<(Vector2<f64>, f64)> = Vec::new();
    for OnLine { line, onsets, unresolved, unstable_at_start, evaluations } in found {
        map.unresolved += unresolved;
        map.evaluations += evaluations;
        if line.axis == 0 && line.at == 0.0 {
            let changes = onsets.iter().map(|onset| (onset.at, if onset.destabilises { 1 } else { -1 }));
            map.on_left = (unstable_at_start as i64, changes.collect());
        }
        starts.extend(onsets.iter().map(|onset| {
            let mut at = vector![onset.at, onset.at];
            at[line.axis] = line.at;
            (at, onset.omega)
        }));
    }
    let mut tracer = Tracer { part, continued: 0 };
    let mut open: Vec<bool> = vec![true; starts.len()];
    for first in 0..starts.len() {
        if !open[first] {
            continue;
        }
        let (at, omega) = starts[first];
        let start = tracer.start(at, omega)?;
        let (points, ends) = tracer.curve(start)?;
        // The last point of a closed curve is the first one.
        for at in BTreeSet::from([0, points.len() / 2, if ends[0] == CurveEnd::Closed { 0 } else { points.len() - 1 }])
        {
            let distance = points[at].distance_from_whole(part)?;
            map.evaluations.whole += u64::from(distance.is_some());
            map.from_whole = map.from_whole.into_iter().chain(distance).reduce(f64::max);
        }
        let on_curve = |&(at, omega): &(Vector2<f64>, f64)| {
            points.windows(2).any(|step| passes(&step[0], &step[1], 1.0, at, omega))
        };
        let met: Vec<usize> = (0..starts.len()).filter(|&i| i == first || (open[i] && on_curve(&starts[i]))).collect();
        met.iter().for_each(|&i| open[i] = false);
        // The name is that at the point nearest to the medians, where the way there is shortest.
        let medians = part.medians();
        let median = vector![medians[0], medians[1]];
        let distance = |i: &usize| (starts[*i].0 - median).norm();
        let named_at = met.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(first);
        let (names, evaluations) = name(part, starts[named_at]);
        map.evaluations += evaluations;
        map.curves.push((curve(part, &points, ends, &names), points.iter().map(|p| [p.at.x, p.at.y]).collect()));
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
    let Onsets { mut onsets, unresolved } = find_onsets(&mut branches, 0.0, 1.0, SHORTEST_STEP)?;
    onsets.retain(|onset| part.is_studied(onset.omega));
    let is_counted = |lambda: &&Complex<f64>| lambda.re >= 0.0 && part.is_studied(lambda.im);
    let unstable_at_start = branches.lambdas(0.0)?.iter().filter(is_counted).count();
    let evaluations = Evaluations::of(branches.counters());
    Ok(OnLine { line, onsets, unresolved: unresolved.len(), unstable_at_start, evaluations })
}

/// The names of the mode that crosses the axis at a point with a frequency, followed on the straight line to the medians; none where
/// it cannot be followed.
fn name<B: UncertainBrake>(part: &Part<'_, B>, (at, omega): (Vector2<f64>, f64)) -> (Names, Evaluations) {
    let start = part.medians();
    let direction = vec![at.x - start[0], at.y - start[1]];
    let mut branches = part.along(Line { start, direction, bounds: [0.0, 1.0], difference: DIFFERENCE });
    let lambda = Complex::new(0.0, omega);
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
    names: &Names,
) -> BoundaryCurve {
    let parameters = &part.family.parameters;
    let point = |point: &CurvePoint| BoundaryPoint {
        at: [parameters[0].at(point.at.x), parameters[1].at(point.at.y)],
        omega: point.omega(),
    };
    BoundaryCurve { mode: in_words(names), ends, points: points.iter().map(point).collect() }
}
