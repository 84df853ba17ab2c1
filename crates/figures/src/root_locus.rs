//! A root locus: growth against frequency, coloured by a parameter, and both against the parameter.

use output::Table;

use super::axis::{AxisScale, PAGE_MARGIN, frame, note, title};
use super::canvas::{Area, Canvas, Color, Paint};
use super::error::{FigureError, finite};
use super::figure::Figure;
use super::legend::{Entry, legend};
use super::plot::{BELOW, Plot, inside};
use super::point_names::write_names;
use super::scale::{bar, color};
use super::style::{BLUE, VERMILLION};

/// Branches of eigenvalues over one parameter.
#[derive(Debug, Clone, Default)]
pub struct RootLocusFigure {
    /// Title above everything; may be empty.
    pub title: String,
    /// The parameter, with its unit.
    pub parameter: String,
    /// Range of the parameter.
    pub range: [f64; 2],
    /// The axis of the parameter is logarithmic; the range must then be positive.
    pub is_logarithmic: bool,
    /// Growth that is shown, 1/s, ascending; `None` for what is about zero.
    pub growth: Option<[f64; 2]>,
    /// The branches.
    pub branches: Vec<LocusBranch>,
    /// Onsets and coalescences.
    pub marks: Vec<LocusMark>,
    /// Words for what a mode does at an onset, as "starts to grow" and "stops growing".
    pub onsets: [&'static str; 2],
    /// Note below everything; may be empty.
    pub note: String,
}

/// A branch of a root locus.
#[derive(Debug, Clone, Default)]
pub struct LocusBranch {
    /// Name of the mode.
    pub mode: String,
    /// The parameter, ascending, the frequency, Hz, and the growth, 1/s.
    pub points: Vec<[f64; 3]>,
}

/// Event at a point of a root locus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LocusEvent {
    /// A mode starts to grow, or to count as unstable.
    Starts,
    /// A mode stops growing, or counting as unstable.
    Stops,
    /// A growing mode loses its frequency: flutter becomes divergence.
    ToDivergence,
    /// Divergence becomes flutter.
    ToFlutter,
    /// A growing mode enters the band that is studied.
    EntersBand,
    /// A growing mode leaves the band that is studied.
    LeavesBand,
    /// Two modes coalesce, or nearly.
    Coalescence,
}

/// A marked point.
#[derive(Debug, Clone)]
pub struct LocusMark {
    /// Event at the point.
    pub event: LocusEvent,
    /// Mode or modes of the event.
    pub mode: String,
    /// The parameter, the frequency, Hz, and the growth, 1/s.
    pub at: [f64; 3],
}

/// Height of the panel of the root locus, pt; chosen.
const LOCUS_HEIGHT: f64 = 210.0;
/// Height of the panels below it, pt; chosen.
const LOWER_HEIGHT: f64 = 170.0;
/// Part of the height beyond an end that is not seen; chosen: less than a line is thick.
const SEEN: f64 = 1e-3;
/// Distance between the panels below, pt; chosen: some two heights of small text.
const GAP: f64 = 18.0;

/// A panel: the indices, among parameter, frequency and growth, of what its axes show.
struct Panel {
    x: usize,
    y: usize,
    plot: Plot,
}

/// Draws the root locus above frequency and growth against the parameter. Onsets are labelled by their modes. The axis of growth shows what
/// happens about zero, and how many branches go on below is said. The table has one row per branch and point, then the marks.
///
/// # Errors
/// [`FigureError::Empty`] without branches and marks, [`FigureError::NotFinite`] or [`FigureError::OutOfRange`] for a value that the axes cannot
/// show.
pub fn root_locus_figure(data: &RootLocusFigure) -> Result<Figure, FigureError> {
    let table = check(data)?;
    let mut canvas = Canvas::new()?;
    let points = || data.branches.iter().flat_map(|branch| &branch.points);
    let [from, to] = data.range;
    let parameter = match data.is_logarithmic {
        true => AxisScale::log([from, to].into_iter()),
        false => AxisScale::between((from, to), 5.0),
    };
    // A divergence is at rest, on no branch: the axes reach it, with room for its name.
    let at_rest = data.marks.iter().filter(|mark| mark.at[1] == 0.0).map(|mark| mark.at);
    let room = at_rest.clone().map(|_| -0.1 * data.least_shown());
    let hertz = points().copied().chain(at_rest).map(|point| point[1]);
    let ends = hertz.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), f| (f.min(least), f.max(most)));
    let frequency = AxisScale::between(ends, 6.0);
    let growth = match data.growth {
        Some([least, most]) => AxisScale::between((least, most), 6.0),
        None => AxisScale::linear(
            [data.least_shown()].into_iter().chain(points().map(|point| point[2]).filter(|at| *at > 0.0)).chain(room),
            6.0,
        ),
    };
    let (hertz, per_second) = ("frequency (Hz)".to_owned(), "growth Re \u{3bb} (1/s)".to_owned());
    let panel = |x, y, scales, labels| Panel { x, y, plot: Plot { scales, labels } };
    let locus = panel(1, 2, [frequency, growth], [hertz.clone(), per_second.clone()]);
    let below = [
        panel(0, 1, [parameter, frequency], [data.parameter.clone(), hertz]),
        panel(0, 2, [parameter, growth], [data.parameter.clone(), per_second]),
    ];
    let mut y = title(&mut canvas, &data.title);
    y = bar(&mut canvas, y + 4.0, parameter, data.range, &data.parameter);
    let below_the_picture = |branch: &&LocusBranch| branch.points.iter().any(|point| growth.at(point[2]) < -SEEN);
    let mut entries = key(data);
    match data.branches.iter().filter(below_the_picture).count() {
        0 => {}
        1 => entries.push(Entry { symbol: None, text: "1 branch goes on below the picture".into() }),
        more => entries.push(Entry { symbol: None, text: format!("{more} branches go on below the picture") }),
    }
    y = legend(&mut canvas, y, &entries);
    let left = PAGE_MARGIN + locus.plot.left(&canvas, LOCUS_HEIGHT);
    let right = canvas.width - PAGE_MARGIN - 10.0;
    let area = Area { x: left, y: y + 4.0, width: right - left, height: LOCUS_HEIGHT };
    locus.draw(&mut canvas, area, data);
    y = area.bottom() + BELOW + 12.0;
    let margins = below.each_ref().map(|panel| panel.plot.left(&canvas, LOWER_HEIGHT));
    let width = (right - PAGE_MARGIN - GAP - margins[0] - margins[1]) / 2.0;
    let mut x = PAGE_MARGIN;
    for (panel, margin) in below.iter().zip(margins) {
        panel.draw(&mut canvas, Area { x: x + margin, y, width, height: LOWER_HEIGHT }, data);
        x += margin + width + GAP;
    }
    y += LOWER_HEIGHT + BELOW + 6.0;
    note(&mut canvas, y, &data.note);
    Ok(Figure { canvas, table })
}

impl Panel {
    fn draw(&self, canvas: &mut Canvas, area: Area, data: &RootLocusFigure) {
        self.plot.axes(canvas, area);
        let y = self.plot.scales[1];
        let place = |point: &[f64; 3]| self.plot.place(area, [point[self.x], point[self.y]]);
        let is_inside = |mark: &&LocusMark| (-SEEN..=1.0 + SEEN).contains(&y.at(mark.at[self.y]));
        if self.y == 2 {
            let zero = area.bottom() - y.at(0.0) * area.height;
            canvas.line((area.x, zero), (area.right(), zero), Paint::stroke(Color::BLACK, 0.8));
        }
        for branch in &data.branches {
            canvas.group("branch", format!("mode {}", branch.mode), |canvas| {
                for step in branch.points.windows(2) {
                    let paint = Paint::stroke(color(data.part(0.5 * (step[0][0] + step[1][0]))), 1.3);
                    if let Some((from, to)) = inside(place(&step[0]), place(&step[1]), area) {
                        canvas.line(from, to, paint);
                    }
                }
            });
        }
        frame(canvas, area);
        for mark in data.marks.iter().filter(is_inside) {
            canvas.group("mark", mark.title(&data.parameter, data.onsets), |canvas| {
                symbol(canvas, place(&mark.at), mark.event)
            });
        }
        // Onsets at the axis of growth are beside each other: their names stand on several levels.
        if self.y == 2 {
            let onsets = data.marks.iter().filter(is_inside).filter(|mark| mark.event != LocusEvent::Coalescence);
            write_names(canvas, area, onsets.map(|mark| (mark.mode.as_str(), place(&mark.at))).collect());
        }
    }
}

impl RootLocusFigure {
    /// Least growth that is shown, 1/s: as far below zero as a third of the branches go, or twice as far as the highest grows, but no farther than any.
    fn least_shown(&self) -> f64 {
        let growth = |branch: &LocusBranch| branch.points.iter().map(|point| point[2]).collect::<Vec<_>>();
        let mut ends: Vec<f64> =
            self.branches.iter().map(|branch| growth(branch).into_iter().fold(0.0, f64::min)).collect();
        ends.sort_by(|a, b| b.total_cmp(a));
        let highest = self.branches.iter().flat_map(growth).fold(0.0, f64::max);
        let (third, lowest) = (ends.get(ends.len() / 3).copied().unwrap_or(0.0), ends.last().copied().unwrap_or(0.0));
        third.min(-2.0 * highest).max(lowest)
    }

    /// The part of the range at which the parameter has a value.
    fn part(&self, value: f64) -> f64 {
        let [from, to] = self.range;
        if self.is_logarithmic { (value / from).ln() / (to / from).ln() } else { (value - from) / (to - from) }
    }
}

impl LocusMark {
    /// Description of the event, with its numbers.
    fn title(&self, parameter: &str, [starts, stops]: [&str; 2]) -> String {
        let Self { event, mode, at: [at, frequency, growth] } = self;
        // A divergence is at rest, and of no mode.
        let name = if *frequency == 0.0 { mode.clone() } else { format!("mode {mode}") };
        let what = match event {
            LocusEvent::Starts => format!("{name} {starts}"),
            LocusEvent::Stops => format!("{name} {stops}"),
            LocusEvent::ToDivergence => format!("mode {mode}: flutter becomes divergence, with growth {growth} 1/s,"),
            LocusEvent::ToFlutter => format!("mode {mode}: divergence becomes flutter, with growth {growth} 1/s,"),
            LocusEvent::EntersBand => format!("{name} enters the band with growth {growth} 1/s"),
            LocusEvent::LeavesBand => format!("{name} leaves the band with growth {growth} 1/s"),
            LocusEvent::Coalescence => format!("modes {mode} coalesce, or nearly, with growth {growth} 1/s"),
        };
        format!("{what} at {parameter} = {at}, {frequency} Hz")
    }
}

fn symbol(canvas: &mut Canvas, (x, y): (f64, f64), event: LocusEvent) {
    let triangle = |tip: f64| vec![(x, y - 3.6 * tip), (x + 3.2, y + 2.4 * tip), (x - 3.2, y + 2.4 * tip)];
    match event {
        LocusEvent::Starts => canvas.polygon(triangle(1.0), Paint::fill(VERMILLION).outlined(Color::WHITE, 0.4)),
        LocusEvent::Stops => canvas.polygon(triangle(-1.0), Paint::fill(BLUE).outlined(Color::WHITE, 0.4)),
        LocusEvent::ToDivergence | LocusEvent::ToFlutter => {
            let diamond = vec![(x, y - 3.6), (x + 3.2, y), (x, y + 3.6), (x - 3.2, y)];
            canvas.polygon(diamond, Paint::fill(VERMILLION).outlined(Color::WHITE, 0.4));
        }
        LocusEvent::EntersBand | LocusEvent::LeavesBand => {
            let color = if event == LocusEvent::EntersBand { VERMILLION } else { BLUE };
            let square = vec![(x - 2.6, y - 2.6), (x + 2.6, y - 2.6), (x + 2.6, y + 2.6), (x - 2.6, y + 2.6)];
            canvas.polygon(square, Paint::fill(color).outlined(Color::WHITE, 0.4));
        }
        LocusEvent::Coalescence => canvas.circle((x, y), 2.6, Paint::stroke(Color::BLACK, 0.9)),
    }
}

fn key(data: &RootLocusFigure) -> Vec<Entry> {
    let [starts, stops] = data.onsets;
    let entry =
        |event: LocusEvent, text: &str| Entry::new(text, 8.0, move |canvas: &mut Canvas, at| symbol(canvas, at, event));
    let mut entries = vec![
        entry(LocusEvent::Starts, &format!("the mode named there {starts}")),
        entry(LocusEvent::Stops, &format!("it {stops}")),
        entry(LocusEvent::Coalescence, "two modes coalesce, or damping keeps them just apart"),
    ];
    if data.marks.iter().any(|mark| matches!(mark.event, LocusEvent::ToDivergence | LocusEvent::ToFlutter)) {
        entries.push(entry(LocusEvent::ToDivergence, "flutter becomes divergence, or divergence flutter"));
    }
    for (event, text) in [
        (LocusEvent::EntersBand, "a growing mode enters the band"),
        (LocusEvent::LeavesBand, "it leaves the band, still growing"),
    ] {
        if data.marks.iter().any(|mark| mark.event == event) {
            entries.push(entry(event, text));
        }
    }
    entries
}

/// Checks every value and writes it into the table.
fn check(data: &RootLocusFigure) -> Result<Table, FigureError> {
    if data.marks.is_empty() && data.branches.iter().all(|branch| branch.points.is_empty()) {
        return Err(FigureError::Empty { what: "branches" });
    }
    let [from, to] = data.range;
    if from >= to || (data.is_logarithmic && from <= 0.0) {
        return Err(FigureError::OutOfRange { what: "range".into(), value: from, allowed: "a range of the parameter" });
    }
    let mut rows = Vec::new();
    let mut row = |kind: &str, mode: &str, at: &[f64; 3]| -> Result<(), FigureError> {
        for value in at {
            finite(*value, || format!("{kind} of mode {mode}"))?;
        }
        let numbers = at.map(|value| value.to_string());
        rows.push([kind.to_owned(), mode.to_owned()].into_iter().chain(numbers).collect());
        Ok(())
    };
    for branch in &data.branches {
        branch.points.iter().try_for_each(|point| row("branch", &branch.mode, point))?;
    }
    for LocusMark { event, mode, at } in &data.marks {
        let kind = match event {
            LocusEvent::Starts => "starts",
            LocusEvent::Stops => "stops",
            LocusEvent::ToDivergence => "flutter-to-divergence",
            LocusEvent::ToFlutter => "divergence-to-flutter",
            LocusEvent::EntersBand => "enters-band",
            LocusEvent::LeavesBand => "leaves-band",
            LocusEvent::Coalescence => "coalescence",
        };
        row(kind, mode, at)?;
    }
    Ok(Table::new("figure", ["kind", "mode", "parameter", "frequency_hz", "growth"], rows))
}
