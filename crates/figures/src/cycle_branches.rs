//! Cycles over a parameter: how loud they are and how fast, with the modes of the complex eigenvalue analysis beside them.

use output::Table;

use super::axis::{AxisScale, PAGE_MARGIN, frame, note, title};
use super::canvas::{Area, Canvas, Color, Paint};
use super::error::{FigureError, finite};
use super::figure::Figure;
use super::legend::{Entry, legend};
use super::plot::{BELOW, Plot, inside};
use super::root_locus::LocusBranch;
use super::style::{VERMILLION, point_style};

/// Branches of cycles over one parameter.
#[derive(Debug, Clone, Default)]
pub struct CycleBranchesFigure {
    /// Title above everything; may be empty.
    pub title: String,
    /// The parameter, with its unit.
    pub parameter: String,
    /// Range of the parameter.
    pub range: [f64; 2],
    /// The axis of the parameter is logarithmic; the range must then be positive.
    pub is_logarithmic: bool,
    /// The branches of cycles.
    pub branches: Vec<CycleBranch>,
    /// The modes over the same parameter.
    pub modes: Vec<LocusBranch>,
    /// Note below everything; may be empty.
    pub note: String,
}

/// A branch of cycles that starts at an onset.
#[derive(Debug, Clone, Default)]
pub struct CycleBranch {
    /// Name of the mode that begins to grow there.
    pub mode: String,
    /// The parameter and the frequency, Hz, at the onset.
    pub onset: [f64; 2],
    /// The cycles, along the branch.
    pub points: Vec<CyclePoint>,
}

/// A cycle of a branch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CyclePoint {
    /// The parameter.
    pub at: f64,
    /// Frequency, Hz.
    pub hz: f64,
    /// Root mean square of the velocity, m/s, and whether the cycle is stable; `None` of one that is known in harmonic balance alone.
    pub in_time: Option<(f64, bool)>,
    /// The parameter turns between the cycle before and this one.
    pub is_fold: bool,
}

/// Height of the panel of the loudness, pt; chosen.
const LOUDNESS_HEIGHT: f64 = 190.0;
/// Height of the panel of the frequency, pt; chosen.
const FREQUENCY_HEIGHT: f64 = 190.0;
/// Part of the frequencies of cycles and onsets that the axis has above and below them; chosen, so that modes beside them are seen.
const BESIDE: f64 = 0.1;

/// Line style of a piece of a branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Piece {
    Stable,
    Unstable,
    /// Known in harmonic balance alone.
    Balanced,
}

/// Draws loudness and frequency of cycles over the parameter, stable cycles solid, others dashed, with folds and onsets, and beside the frequencies of the
/// cycles the frequencies of the modes, thick where the modes grow. How many modes have other frequencies is said. The table has the onsets, the cycles and
/// the modes.
///
/// # Errors
/// [`FigureError::Empty`] without branches, [`FigureError::NotFinite`] or [`FigureError::OutOfRange`] for a value that the axes cannot show.
pub fn cycle_branches_figure(data: &CycleBranchesFigure) -> Result<Figure, FigureError> {
    let table = check(data)?;
    let mut canvas = Canvas::new()?;
    let [from, to] = data.range;
    let parameter = match data.is_logarithmic {
        true => AxisScale::log([from, to].into_iter()),
        false => AxisScale::between((from, to), 8.0),
    };
    let points = || data.branches.iter().flat_map(|branch| &branch.points);
    let loudness = AxisScale::linear(points().filter_map(|point| point.in_time).map(|(rms, _)| rms), 5.0);
    let hertz = points().map(|point| point.hz).chain(data.branches.iter().map(|branch| branch.onset[1]));
    let [least, most] = hertz.fold([f64::INFINITY, 0.0], |[least, most], hz| [hz.min(least), hz.max(most)]);
    let hertz = AxisScale::between(((1.0 - BESIDE) * least, (1.0 + BESIDE) * most), 6.0);
    let plot = |y, label: &str| Plot { scales: [parameter, y], labels: [data.parameter.clone(), label.to_owned()] };
    let above = plot(loudness, "loudness (m/s)");
    let below = plot(hertz, "frequency (Hz)");
    let is_seen = |point: &[f64; 3]| (0.0..=1.0).contains(&hertz.at(point[1]));
    let (modes, beyond): (Vec<_>, Vec<_>) = data.modes.iter().partition(|mode| mode.points.iter().any(is_seen));
    let mut y = title(&mut canvas, &data.title);
    y = legend(&mut canvas, y + 4.0, &key(data, beyond.len()));
    let left = PAGE_MARGIN + above.left(&canvas, LOUDNESS_HEIGHT).max(below.left(&canvas, FREQUENCY_HEIGHT));
    let width = canvas.width - PAGE_MARGIN - 10.0 - left;
    let area = Area { x: left, y: y + 4.0, width, height: LOUDNESS_HEIGHT };
    above.axes(&mut canvas, area);
    frame(&mut canvas, area);
    let loud = |point: &CyclePoint| point.in_time.map(|(rms, _)| [point.at, rms]);
    for (series, branch) in data.branches.iter().enumerate() {
        draw_branch(&mut canvas, (&above, area), (branch, point_style(series).color), 0.0, &loud, data);
    }
    let area = Area { y: area.bottom() + BELOW + 14.0, height: FREQUENCY_HEIGHT, ..area };
    below.axes(&mut canvas, area);
    for mode in modes {
        draw_mode(&mut canvas, (&below, area), mode);
    }
    frame(&mut canvas, area);
    let fast = |point: &CyclePoint| Some([point.at, point.hz]);
    for (series, branch) in data.branches.iter().enumerate() {
        draw_branch(&mut canvas, (&below, area), (branch, point_style(series).color), branch.onset[1], &fast, data);
    }
    y = area.bottom() + BELOW + 6.0;
    note(&mut canvas, y, &data.note);
    Ok(Figure { canvas, table })
}

/// A branch from its onset on, which stands at `onset` on the vertical axis; `of` are the coordinates of a cycle.
fn draw_branch(
    canvas: &mut Canvas,
    (plot, area): (&Plot, Area),
    (branch, color): (&CycleBranch, Color),
    onset: f64,
    of: &dyn Fn(&CyclePoint) -> Option<[f64; 2]>,
    data: &CycleBranchesFigure,
) {
    let start = plot.place(area, [branch.onset[0], onset]);
    canvas.group("branch", format!("cycles of mode {}", branch.mode), |canvas| {
        let piece = |point: &CyclePoint| match point.in_time {
            None => Piece::Balanced,
            Some((_, true)) => Piece::Stable,
            Some((_, false)) => Piece::Unstable,
        };
        // The begin of a branch is like its first cycle.
        let mut pieces: Vec<(Vec<(f64, f64)>, Piece)> = Vec::new();
        let mut before = branch.points.first().map(|first| (start, piece(first)));
        for point in &branch.points {
            let Some(place) = of(point).map(|at| plot.place(area, at)) else {
                before = None;
                continue;
            };
            if let Some((from, kind)) = before {
                // Solid between two stable cycles alone.
                let kind = match [kind, piece(point)] {
                    [a, b] if a == b => a,
                    kinds if kinds.contains(&Piece::Balanced) => Piece::Balanced,
                    _ => Piece::Unstable,
                };
                match pieces.last_mut().filter(|(line, last)| *last == kind && line.last() == Some(&from)) {
                    Some((line, _)) => line.push(place),
                    None => pieces.push((vec![from, place], kind)),
                }
            }
            before = Some((place, piece(point)));
        }
        for (line, kind) in pieces {
            canvas.polyline(line, paint(kind, color));
        }
    });
    let folds = branch.folds();
    for (at, point) in branch.points.iter().enumerate() {
        let Some(place) = of(point).map(|at| plot.place(area, at)) else { continue };
        let is_fold = folds.contains(&at);
        let class = if is_fold { "fold" } else { "point" };
        canvas.group(class, point.title(&branch.mode, &data.parameter, is_fold), |canvas| match is_fold {
            true => fold(canvas, place),
            false => canvas.circle(place, 1.5, Paint::fill(color)),
        });
    }
    let words = format!(
        "mode {} starts to grow at {} = {}, {} Hz",
        branch.mode, data.parameter, branch.onset[0], branch.onset[1]
    );
    canvas.group("mark", words, |canvas| onset_mark(canvas, start));
}

impl CycleBranch {
    /// Cycles that are nearest to where the parameter turns, by their places: the outer one of the two between which it does.
    fn folds(&self) -> Vec<usize> {
        let at = |place: usize| self.points[place].at;
        let outer = |place: usize| {
            let rises_after = match self.points.get(place + 1) {
                Some(next) => next.at > at(place),
                None => place > 1 && at(place - 1) < at(place - 2),
            };
            if rises_after == (at(place - 1) < at(place)) { place - 1 } else { place }
        };
        (1..self.points.len()).filter(|place| self.points[*place].is_fold).map(outer).collect()
    }
}

impl CyclePoint {
    fn title(&self, mode: &str, parameter: &str, is_fold: bool) -> String {
        let what = match self.in_time {
            Some((rms, true)) => format!("stable, {rms} m/s"),
            Some((rms, false)) => format!("unstable, {rms} m/s"),
            None => "in harmonic balance alone".to_owned(),
        };
        let fold = if is_fold { ", fold" } else { "" };
        format!("cycle of mode {mode} at {parameter} = {}: {} Hz, {what}{fold}", self.at, self.hz)
    }
}

/// Frequency of a mode, thick where it grows.
fn draw_mode(canvas: &mut Canvas, (plot, area): (&Plot, Area), mode: &LocusBranch) {
    canvas.group("cea", format!("mode {} of the complex eigenvalue analysis", mode.mode), |canvas| {
        for step in mode.points.windows(2) {
            let place = |[at, hz, _]: [f64; 3]| plot.place(area, [at, hz]);
            if let Some((from, to)) = inside(place(step[0]), place(step[1]), area) {
                canvas.line(from, to, mode_paint(0.5 * (step[0][2] + step[1][2]) > 0.0));
            }
        }
    });
}

fn mode_paint(grows: bool) -> Paint {
    Paint::stroke(GREY, if grows { 2.6 } else { 0.7 })
}

/// Grey of modes, which cycles stand out from on white and on black.
const GREY: Color = Color(150, 150, 150);

fn paint(piece: Piece, color: Color) -> Paint {
    let line = Paint::stroke(color, 1.4);
    match piece {
        Piece::Stable => line,
        Piece::Unstable => line.dashed(3.5),
        Piece::Balanced => Paint::stroke(color, 0.8).dashed(1.2),
    }
}

fn onset_mark(canvas: &mut Canvas, (x, y): (f64, f64)) {
    let triangle = vec![(x, y - 3.6), (x + 3.2, y + 2.4), (x - 3.2, y + 2.4)];
    canvas.polygon(triangle, Paint::fill(VERMILLION).outlined(Color::WHITE, 0.4));
}

fn fold(canvas: &mut Canvas, at: (f64, f64)) {
    canvas.circle(at, 2.8, Paint::fill(Color::WHITE).outlined(Color::BLACK, 0.9));
}

fn key(data: &CycleBranchesFigure, beyond: usize) -> Vec<Entry> {
    let line = |text: String, paint: Paint| {
        Entry::new(text, 18.0, move |canvas: &mut Canvas, (x, y)| canvas.line((x - 9.0, y), (x + 9.0, y), paint))
    };
    let mut entries: Vec<Entry> = data
        .branches
        .iter()
        .enumerate()
        .map(|(series, branch)| {
            line(format!("cycles of mode {}", branch.mode), paint(Piece::Stable, point_style(series).color))
        })
        .collect();
    let points = || data.branches.iter().flat_map(|branch| &branch.points);
    if points().any(|point| matches!(point.in_time, Some((_, false)))) {
        entries.push(line("unstable cycles".into(), paint(Piece::Unstable, Color::BLACK)));
    }
    if points().any(|point| point.in_time.is_none()) {
        entries.push(line("in harmonic balance alone: no loudness".into(), paint(Piece::Balanced, Color::BLACK)));
    }
    entries.push(Entry::new("onset of the mode", 8.0, onset_mark));
    if points().any(|point| point.is_fold) {
        entries.push(Entry::new("fold: the parameter turns", 8.0, fold));
    }
    if !data.modes.is_empty() {
        entries.push(line("mode of the complex eigenvalue analysis".into(), mode_paint(false)));
        entries.push(line("where it grows".into(), mode_paint(true)));
    }
    match beyond {
        0 => {}
        1 => entries.push(Entry { symbol: None, text: "1 mode has other frequencies".into() }),
        more => entries.push(Entry { symbol: None, text: format!("{more} modes have other frequencies") }),
    }
    entries
}

/// Checks every value and writes it into the table.
fn check(data: &CycleBranchesFigure) -> Result<Table, FigureError> {
    if data.branches.is_empty() {
        return Err(FigureError::Empty { what: "branches" });
    }
    let [from, to] = data.range;
    if from >= to || (data.is_logarithmic && from <= 0.0) {
        return Err(FigureError::OutOfRange { what: "range".into(), value: from, allowed: "a range of the parameter" });
    }
    let mut rows = Vec::new();
    let mut row = |kind: &str, mode: &str, [at, hz]: [f64; 2], last: Option<f64>| -> Result<(), FigureError> {
        for value in [at, hz].into_iter().chain(last) {
            finite(value, || format!("{kind} of mode {mode}"))?;
        }
        let last = last.map_or(String::new(), |value| value.to_string());
        rows.push(vec![kind.to_owned(), mode.to_owned(), at.to_string(), hz.to_string(), last]);
        Ok(())
    };
    for branch in &data.branches {
        row("onset", &branch.mode, branch.onset, None)?;
        for point in &branch.points {
            let kind = match (point.in_time, point.is_fold) {
                (Some((_, true)), false) => "stable",
                (Some((_, false)), false) => "unstable",
                (None, false) => "balance",
                (Some((_, true)), true) => "stable fold",
                (Some((_, false)), true) => "unstable fold",
                (None, true) => "balance fold",
            };
            row(kind, &branch.mode, [point.at, point.hz], point.in_time.map(|(rms, _)| rms))?;
        }
    }
    for mode in &data.modes {
        for [at, hz, growth] in &mode.points {
            row("cea", &mode.mode, [*at, *hz], Some(*growth))?;
        }
    }
    Ok(Table::new("figure", ["kind", "mode", "parameter", "frequency_hz", "loudness_or_growth"], rows))
}
