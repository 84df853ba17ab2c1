//! A stability map: how many modes are unstable over two parameters, and whose boundary is where.

use output::Table;

use super::axis::{
    AxisScale, LINE_SPACING, PAGE_MARGIN, Tick, frame, note, title, widest, x_axis, y_axis, y_title, y_title_width,
};
use super::canvas::{Area, Canvas, Color, Label, Paint, SMALL_TEXT};
use super::error::{FigureError, finite};
use super::figure::Figure;
use super::legend::{Entry, legend};
use super::scale::count_color;

/// A map over two parameters. Places are given as parts of the two ranges, 0 to 1.
#[derive(Debug, Clone, Default)]
pub struct MapFigure {
    /// Title above everything; may be empty.
    pub title: String,
    /// The horizontal and the vertical axis.
    pub axes: [MapAxis; 2],
    /// Curves by the names of their modes.
    pub curves: Vec<MapCurve>,
    /// Runs of one count: ends along x, row from below, count.
    pub runs: Vec<([f64; 2], usize, usize)>,
    /// Number of rows of the map.
    pub rows: usize,
    /// Counts to be written, each with its place (x, y).
    pub counts: Vec<(usize, [f64; 2])>,
    /// Note below everything; may be empty.
    pub note: String,
}

/// An axis of the map.
#[derive(Debug, Clone, Default)]
pub struct MapAxis {
    /// The parameter, with its unit.
    pub label: String,
    /// Range of the parameter.
    pub range: [f64; 2],
    /// The axis is logarithmic; the range must then be positive.
    pub is_logarithmic: bool,
}

/// A boundary curve.
#[derive(Debug, Clone, Default)]
pub struct MapCurve {
    /// Name of the mode.
    pub mode: String,
    /// Text beside the curve.
    pub label: String,
    /// Points of the curve (x, y), as parts of the two ranges, 0 to 1.
    pub points: Vec<[f64; 2]>,
}

/// Height of the map, pt; chosen.
const HEIGHT: f64 = 330.0;
/// Number of places along a curve that are tried for its name; chosen.
const PLACES: usize = 24;
/// Largest distance, as a fraction of the range, of a mark beyond an end that is on that end: rounding.
const ON_END: f64 = 1e-9;
/// Overlap of the rows of a map, pt; chosen: a pixel of a screen.
const OVERLAP: f64 = 1.0;

impl MapAxis {
    /// Round numbers within the range, at parts of it; its ends where there are not two.
    fn ticks(&self) -> Vec<Tick> {
        let [from, to] = self.range;
        let scale = if self.is_logarithmic {
            AxisScale::log([from, to].into_iter())
        } else {
            AxisScale::between((from, to), 6.0)
        };
        let [start, end] = self.range.map(|value| scale.at(value));
        let part = |tick: Tick| Tick { at: (tick.at - start) / (end - start), ..tick };
        let is_inside = |tick: &Tick| (-ON_END..=1.0 + ON_END).contains(&tick.at);
        let mut ticks: Vec<Tick> = scale.ticks(8).into_iter().map(part).filter(is_inside).collect();
        if ticks.len() < 2 {
            ticks.extend([(0.0, from), (1.0, to)].map(|(at, value)| Tick { at, label: value.to_string() }));
        }
        ticks
    }
}

/// Draws the map. The table has one row per curve and point, in parts of the ranges.
///
/// # Errors
/// [`FigureError::Empty`] without rows, [`FigureError::NotFinite`] for a value that the axes cannot show.
pub fn stability_map_figure(data: &MapFigure) -> Result<Figure, FigureError> {
    let table = check(data)?;
    let mut canvas = Canvas::new()?;
    let [x_ticks, ticks] = data.axes.each_ref().map(MapAxis::ticks);
    let most = data.runs.iter().map(|run| run.2).max().unwrap_or(0);
    let mut y = title(&mut canvas, &data.title);
    y = legend(&mut canvas, y + 2.0, &key(most)) + 4.0;
    let tick_width = widest(&canvas, &ticks) + 6.0;
    let left = PAGE_MARGIN + y_title_width(&canvas, HEIGHT, &data.axes[1].label) + tick_width;
    let area = Area { x: left, y, width: canvas.width - PAGE_MARGIN - 10.0 - left, height: HEIGHT };
    let place = |at: [f64; 2]| (area.x + at[0] * area.width, area.bottom() - at[1] * area.height);
    for &([from, to], row, count) in &data.runs {
        let (x0, y0) = place([from, row as f64 / data.rows as f64]);
        let (x1, y1) = place([to, (row + 1) as f64 / data.rows as f64]);
        // Rows overlap: no seams, whatever the resolution of a screen.
        let over = OVERLAP.min(y1 - area.y).max(0.0);
        let cell = Area { x: x0, y: y1 - over, width: x1 - x0, height: y0 - y1 + over };
        if count > 0 {
            canvas.rect(cell, Paint::fill(count_color(count, most)));
        }
    }
    y_axis(&mut canvas, area, &ticks, true);
    x_axis(&mut canvas, area, &x_ticks, true, false);
    y_title(&mut canvas, area.x - tick_width, area, &data.axes[1].label);
    let below = area.bottom() + SMALL_TEXT + LINE_SPACING + 2.0;
    canvas.text(Label::new(area.middle_x(), below, data.axes[0].label.clone()).middle());
    for curve in &data.curves {
        canvas.group("boundary", curve.label.clone(), |canvas| {
            canvas.polyline(curve.points.iter().map(|&at| place(at)).collect(), Paint::stroke(Color::BLACK, 1.0));
        });
    }
    frame(&mut canvas, area);
    let mut taken: Vec<(f64, f64)> = Vec::new();
    for &(count, at) in &data.counts {
        let (x, y) = place(at);
        taken.push((x, y));
        canvas.text(Label::new(x, y + 3.5, count.to_string()).size(10.0).bold().middle().halo());
    }
    for curve in &data.curves {
        let (x, y) = best_place(curve, &taken, area, &place);
        taken.push((x, y));
        canvas.text(Label::new(x, y + 2.9, curve.label.clone()).middle().halo());
    }
    y = below;
    note(&mut canvas, y + 4.0, &data.note);
    Ok(Figure { canvas, table })
}

/// The place, of [`PLACES`] along a curve, that is farthest from all that are taken and from the frame.
fn best_place(
    curve: &MapCurve,
    taken: &[(f64, f64)],
    area: Area,
    place: &dyn Fn([f64; 2]) -> (f64, f64),
) -> (f64, f64) {
    let count = curve.points.len();
    let tried = (0..PLACES).filter_map(|i| curve.points.get(i * count / PLACES)).map(|&at| place(at));
    let inside = |x: f64, y: f64| {
        let (across, down) = ((x - area.x).min(area.right() - x) - 18.0, (y - area.y).min(area.bottom() - y) - 4.0);
        2.0 * across.min(down)
    };
    // A name is wider than it is high.
    let room = |&(x, y): &(f64, f64)| {
        let others = taken.iter().map(|other| (0.4 * (x - other.0)).hypot(y - other.1));
        others.fold(inside(x, y), f64::min)
    };
    tried.max_by(|a, b| room(a).total_cmp(&room(b))).unwrap_or((area.middle_x(), area.middle_y()))
}

fn key(most: usize) -> Vec<Entry> {
    let entry = |count: usize| {
        let text = match count {
            0 => "no mode unstable".into(),
            1 => "1 mode".into(),
            _ => count.to_string(),
        };
        Entry::new(text, 10.0, move |canvas: &mut Canvas, (x, y)| {
            let area = Area { x: x - 5.0, y: y - 4.0, width: 10.0, height: 8.0 };
            canvas.rect(area, Paint::fill(count_color(count, most)).outlined(Color::DARK_GREY, 0.4));
        })
    };
    (0..=most).map(entry).collect()
}

/// Checks every value and writes it into the table.
fn check(data: &MapFigure) -> Result<Table, FigureError> {
    if data.runs.is_empty() || data.rows == 0 {
        return Err(FigureError::Empty { what: "rows" });
    }
    let mut rows = Vec::new();
    for (index, curve) in data.curves.iter().enumerate() {
        for at in &curve.points {
            for value in at {
                finite(*value, || format!("curve of {}", curve.label))?;
            }
            rows.push(vec![(index + 1).to_string(), curve.mode.clone(), at[0].to_string(), at[1].to_string()]);
        }
    }
    Ok(Table::new("figure", ["curve", "mode", "x", "y"], rows))
}
