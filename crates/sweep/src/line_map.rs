//! The stability map of a brake whose contact points open and close within its ranges, or of which growing modes enter the band or leave it there.
//!
//! Eigenvalues jump where a point with a spring of constant stiffness opens, and a boundary then runs along the opening for a while: it is no
//! curve on which one mode is at the threshold; nor is it one where a growing mode enters the band that is studied. So it is not followed. On equal lines across the ranges changes of the number of unstable modes
//! are found piece by piece between the openings of the line, to full accuracy, and those at openings by counting on both sides; between two lines
//! the nearer one is taken. Lines run along the parameter over which more points open.

use montecarlo::Progress;
use rayon::prelude::*;
use serde::Serialize;
use study::UncertainBrake;

use super::change::{Along, ChangeOf, by};
use super::family::{Evaluations, Family, Part};
use super::openings::openings;
use super::part_sweep::steps_of_piece;
use super::regions::{CELLS, Run};
use crate::Error;

/// Number of equal steps of a line without openings at which unstable modes are counted; chosen.
const STEPS: usize = 64;
/// Number of lines each way on whose crossings contact points are asked for their state; chosen: with fewer, an opening between two crossings is passed over;
/// with more, more states are computed.
const ASKED: usize = 17;

/// A change of the number of unstable modes on a line of a map.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LineChange {
    /// Values of the two parameters.
    pub at: [f64; 2],
    /// Change of the number of unstable modes, beyond against before.
    pub by: i64,
    /// Frequency Im lambda of the mode, rad/s; 0 of divergence, and at an opening.
    pub omega: f64,
    /// Kind of the change; `None` where eigenvalues jump over the threshold, as contact points open or close.
    pub of: Option<ChangeOf>,
}

/// Lines of a map with openings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MapLines {
    /// Index of the parameter that lines run along.
    pub along: usize,
    /// Number of lines, at equal distances.
    pub lines: usize,
    /// Number of openings on all lines.
    pub openings: usize,
    /// Changes on all lines.
    pub changes: Vec<LineChange>,
}

/// A line: its openings, and the number of unstable modes along it.
struct OnLine {
    /// Number of unstable modes at its beginning.
    start: i64,
    /// Place of each change with the change, ascending, the frequency, and its kind, which one at an opening does not have.
    changes: Vec<(f64, i64, f64, Option<ChangeOf>)>,
    openings: usize,
    unresolved: usize,
    spectra: u64,
}

/// What the lines of a part say.
pub(super) struct LinesOfPart {
    pub lines: MapLines,
    pub rows: Vec<Run>,
    pub unresolved: usize,
    pub evaluations: Evaluations,
}

/// The parameter over which more contact points change their state, of two; `None` where no state changes on a grid over both.
///
/// # Errors
/// Those of the brake.
pub(super) fn opens_along<B: UncertainBrake>(family: &Family<'_, B>) -> Result<Option<usize>, Error> {
    if family.contact_points().is_empty() {
        return Ok(None);
    }
    let place = |at: usize| (at / ASKED, at % ASKED);
    let state = |at: usize| {
        let (x, y) = place(at);
        let parts = [x, y].map(|step| step as f64 / (ASKED - 1) as f64);
        let values: Vec<f64> =
            family.parameters.iter().zip(parts).map(|(parameter, part)| parameter.at(part)).collect();
        family.closed_points(&values)
    };
    let states = (0..ASKED * ASKED).into_par_iter().map(state).collect::<Result<Vec<_>, Error>>()?;
    let differ = |by: [usize; 2]| {
        let of = |at: usize| {
            let (x, y) = place(at);
            let next = (x + by[0], y + by[1]);
            let is_inside = next.0 < ASKED && next.1 < ASKED;
            let differs = |next: &Vec<bool>| next.iter().zip(&states[at]).filter(|(a, b)| a != b).count();
            if is_inside { differs(&states[next.0 * ASKED + next.1]) } else { 0 }
        };
        (0..ASKED * ASKED).map(of).sum::<usize>()
    };
    Ok(match [differ([1, 0]), differ([0, 1])] {
        [0, 0] => None,
        [x, y] => Some(usize::from(y > x)),
    })
}

/// The lines of a part along one of its two parameters, a step of progress for each.
///
/// # Errors
/// Those of the brake and of the solver.
pub(super) fn lines<B: UncertainBrake>(
    part: &Part<'_, B>,
    along: usize,
    count: usize,
    progress: &dyn Progress,
) -> Result<LinesOfPart, Error> {
    let fixed = |line: usize| line as f64 / (count - 1) as f64;
    let on_line = |line: usize| {
        let found = on_line(part, along, fixed(line));
        progress.advance(1);
        found
    };
    let found = (0..count).into_par_iter().map(on_line).collect::<Result<Vec<_>, Error>>()?;
    let mut lines = MapLines { along, lines: count, openings: 0, changes: Vec::new() };
    let (mut unresolved, mut evaluations) = (0, Evaluations::default());
    for (at, line) in found.iter().enumerate() {
        lines.openings += line.openings;
        unresolved += line.unresolved;
        evaluations.spectra += line.spectra;
        lines.changes.extend(line.changes.iter().map(|&(place, by, omega, of)| {
            let parts = on(along, place, fixed(at));
            let at = [0, 1].map(|axis| part.family.parameters[axis].at(parts[axis]));
            LineChange { at, by, omega, of }
        }));
    }
    let unstable = |x: f64, y: f64| {
        let (place, across) = if along == 0 { (x, y) } else { (y, x) };
        let line = &found[(across * (count - 1) as f64).round() as usize];
        line.start + line.changes.iter().filter(|change| change.0 < place).map(|change| change.1).sum::<i64>()
    };
    Ok(LinesOfPart { rows: rows(&unstable), lines, unresolved, evaluations })
}

/// The point at a place of a line along an axis.
fn on(along: usize, place: f64, fixed: f64) -> [f64; 2] {
    if along == 0 { [place, fixed] } else { [fixed, place] }
}

/// Runs of all rows of cells with one number of unstable modes each, by the middles of the cells.
fn rows(unstable: &dyn Fn(f64, f64) -> i64) -> Vec<Run> {
    let middle = |cell: usize| (cell as f64 + 0.5) / CELLS as f64;
    let mut runs: Vec<Run> = Vec::new();
    for row in 0..CELLS {
        for column in 0..CELLS {
            let (from, count) = (column as f64 / CELLS as f64, unstable(middle(column), middle(row)).max(0) as usize);
            let to = (column + 1) as f64 / CELLS as f64;
            match runs.last_mut() {
                Some(last) if last.row == row && last.unstable == count => last.x[1] = to,
                _ => runs.push(Run { x: [from, to], row, unstable: count }),
            }
        }
    }
    runs
}

fn on_line<B: UncertainBrake>(part: &Part<'_, B>, along: usize, fixed: f64) -> Result<OnLine, Error> {
    let family = part.family;
    let values = |place: f64| {
        let parts = on(along, place, fixed);
        [0, 1].map(|axis| family.parameters[axis].at(parts[axis]))
    };
    let closed = |place: f64| family.closed_points(&values(place));
    let opened = openings(&closed, &|place| values(place)[along], [0.0, 1.0])?;
    let begins = std::iter::once(0.0).chain(opened.iter().map(|opening| opening.between[1]));
    let pieces = begins.zip(opened.iter().map(|opening| opening.between[0]).chain([1.0]));
    let mut line = OnLine { start: 0, changes: Vec::new(), openings: opened.len(), unresolved: 0, spectra: 0 };
    let mut count: Option<i64> = None;
    for (from, to) in pieces.filter(|(from, to)| to > from) {
        let place = |at: f64| if at == 1.0 { to } else { from + at * (to - from) };
        let system = |at: f64| part.system(&on(along, place(at), fixed));
        let steps = steps_of_piece(STEPS, to - from);
        let found = Along::new(&system, &family.solver, part.threshold(), part.band()).changes(steps, &[])?;
        let here = part.counted(&found.ends[0]).iter().sum::<usize>() as i64;
        match count {
            None => line.start = here,
            Some(before) if before != here => line.changes.push((from, here - before, 0.0, None)),
            Some(_) => {}
        }
        let inside = found.found.iter().filter(|change| part.counts(change)).map(|change| {
            let omega = if change.of.oscillates() { change.lambda.im } else { 0.0 };
            (place(change.at.clamp(0.0, 1.0)), by(change.starts), omega, Some(change.of))
        });
        let first = line.changes.len();
        line.changes.extend(inside);
        count = Some(here + line.changes[first..].iter().map(|change| change.1).sum::<i64>());
        line.unresolved += found.unresolved.len();
        line.spectra += found.spectra;
    }
    Ok(line)
}
