//! The figures of a sweep.

use cea::frequency_hz;
use figures::{
    Figure, LocusBranch, LocusEvent, LocusMark, MapAxis, MapCurve, MapFigure, RootLocusFigure, root_locus_figure,
    stability_map_figure,
};
use num_complex::Complex;
use squeal::sweep::{CELLS, ChangeOf, Found, NamedBranch, StabilityMap, Sweep, SweptParameter, event, named};

use crate::Error;

/// Number of lines with which a branch over the whole range is drawn; chosen.
const LINES: f64 = 96.0;

/// The root locus or the stability map; `title` and `note` stand above and below, `growth` is what of it the root locus shows, 1/s, ascending, or
/// what is about zero.
///
/// # Errors
/// A picture that cannot be drawn.
pub fn sweep_figure(found: &Found, growth: Option<[f64; 2]>, title: &str, note: &str) -> Result<Figure, Error> {
    Ok(match found {
        Found::Branches(sweep) => root_locus_figure(&RootLocusFigure { growth, ..locus(sweep, title, note) })?,
        Found::Map(map) => stability_map_figure(&drawn(map, title, note))?,
    })
}

/// The root locus of a sweep, as data.
pub(super) fn locus(sweep: &Sweep, title: &str, note: &str) -> RootLocusFigure {
    let hertz = |omega: f64| frequency_hz(Complex::new(0.0, omega));
    let branch =
        |branch: &NamedBranch| LocusBranch { mode: branch.mode.clone(), points: fine(branch, &sweep.parameter) };
    let onsets = sweep.onsets.iter().map(|onset| LocusMark {
        event: match (onset.of, onset.starts) {
            (ChangeOf::Exchange, true) => LocusEvent::ToDivergence,
            (ChangeOf::Exchange, false) => LocusEvent::ToFlutter,
            (ChangeOf::Band, true) => LocusEvent::EntersBand,
            (ChangeOf::Band, false) => LocusEvent::LeavesBand,
            (_, true) => LocusEvent::Starts,
            (_, false) => LocusEvent::Stops,
        },
        mode: onset.mode.clone(),
        at: [onset.at, hertz(onset.omega), onset.growth],
    });
    let coalescences = sweep.coalescences.iter().map(|found| LocusMark {
        event: LocusEvent::Coalescence,
        mode: found.modes.join(" and "),
        at: [found.at, hertz(found.omega), found.growth],
    });
    let parameter = &sweep.parameter;
    RootLocusFigure {
        title: title.into(),
        parameter: parameter.label(),
        range: [parameter.from, parameter.to],
        is_logarithmic: parameter.is_logarithmic,
        growth: None,
        branches: sweep.branches.iter().map(branch).collect(),
        marks: coalescences.chain(onsets).collect(),
        onsets: [true, false].map(|starts| event(starts, &sweep.threshold)),
        note: note.into(),
    }
}

/// A branch in short lines, along its cubics.
fn fine(branch: &NamedBranch, parameter: &SweptParameter) -> Vec<[f64; 3]> {
    let row = |(at, lambda): (f64, Complex<f64>)| [at, frequency_hz(lambda), lambda.re];
    let mut points: Vec<[f64; 3]> =
        branch.points.first().map(|(at, point)| row((*at, point.lambda))).into_iter().collect();
    for step in 0..branch.points.len().saturating_sub(1) {
        let length = parameter.part(branch.points[step + 1].0) - parameter.part(branch.points[step].0);
        let lines = (LINES * length).ceil().max(1.0) as usize;
        points.extend((1..=lines).map(|line| row(branch.between(step, line as f64 / lines as f64))));
    }
    points
}

fn drawn(map: &StabilityMap, title: &str, note: &str) -> MapFigure {
    let axis = |parameter: &SweptParameter| MapAxis {
        label: parameter.label(),
        range: [parameter.from, parameter.to],
        is_logarithmic: parameter.is_logarithmic,
    };
    let [x, y] = &map.parameters;
    MapFigure {
        title: title.into(),
        axes: [axis(x), axis(y)],
        curves: map
            .curves
            .iter()
            .map(|curve| MapCurve {
                mode: curve.mode.clone(),
                label: named(&curve.mode),
                points: curve.points.iter().map(|point| [x.part(point.at[0]), y.part(point.at[1])]).collect(),
            })
            .collect(),
        runs: map.rows.iter().map(|run| (run.x, run.row, run.unstable)).collect(),
        rows: CELLS,
        counts: map.regions.iter().map(|region| (region.unstable, region.at)).collect(),
        note: note.into(),
    }
}
