//! Two positive quantities against each other on logarithmic axes, such as time against error.

use output::Table;

use super::axis::{
    AxisScale, LINE_SPACING, PAGE_MARGIN, Tick, frame, title, widest, x_axis, y_axis, y_title, y_title_width,
};
use super::canvas::{Area, Canvas, Color, Label, Paint, SMALL_TEXT};
use super::error::{FigureError, finite};
use super::figure::Figure;
use super::legend::{Entry, legend};
use super::style::{marker, point_style};

/// Panels side by side with the same two axes.
#[derive(Debug, Clone, Default)]
pub struct LogLogFigure {
    /// Title above everything; may be empty.
    pub title: String,
    /// Title of the horizontal axis, with its unit.
    pub x_label: String,
    /// Title of the vertical axis, with its unit.
    pub y_label: String,
    /// Panels; one or two fit the page.
    pub panels: Vec<LogLogPanel>,
}

/// A panel and its series.
#[derive(Debug, Clone, Default)]
pub struct LogLogPanel {
    /// Title above the panel; may be empty.
    pub title: String,
    /// A series looks the same in every panel where its name occurs.
    pub series: Vec<LogLogSeries>,
}

/// A series of points.
#[derive(Debug, Clone, Default)]
pub struct LogLogSeries {
    /// Name in the key.
    pub name: String,
    /// Points (x, y): x > 0, y >= 0.
    pub points: Vec<[f64; 2]>,
    /// The points are joined by a line, in the order given.
    pub joined: bool,
}

/// Height of the strip for exact zeros, pt; chosen: two heights of small text, for its label.
const ZERO_STRIP_HEIGHT: f64 = 16.0;

/// Draws the panels with shared axes and one key for all series. A y of exactly zero has no place on a logarithmic axis
/// and is drawn in a strip of its own below, marked 0. The table has one row per panel, series and point.
///
/// # Errors
/// [`FigureError::Empty`] without panels, [`FigureError::NotFinite`] or [`FigureError::OutOfRange`] for a value that the
/// axes cannot show.
pub fn loglog(data: &LogLogFigure) -> Result<Figure, FigureError> {
    let table = check(data)?;
    let mut canvas = Canvas::new()?;
    let points = || data.panels.iter().flat_map(|panel| &panel.series).flat_map(|series| &series.points);
    let axes = Axes {
        x: AxisScale::log(points().map(|p| p[0])),
        y: AxisScale::log(points().map(|p| p[1]).filter(|&y| y > 0.0)),
        strip: if points().any(|p| p[1] == 0.0) { ZERO_STRIP_HEIGHT } else { 0.0 },
    };
    let names = names(data);
    let count = data.panels.len();
    let height = 190.0;
    let tick_width = widest(&canvas, &axes.y.ticks(8)) + 6.0;
    let left = PAGE_MARGIN + y_title_width(&canvas, height, &data.y_label) + tick_width;
    let gap = 26.0;
    // The last label of the horizontal axis is centred on the right edge.
    let width = (canvas.width - PAGE_MARGIN - 8.0 - left - gap * (count - 1) as f64) / count as f64;

    let mut y = title(&mut canvas, &data.title);
    y = legend(&mut canvas, y + 2.0, &key(&names));
    let area = |c: usize, y: f64| Area { x: left + c as f64 * (width + gap), y, width, height };
    let mut top = y;
    for (c, panel) in data.panels.iter().enumerate() {
        for (i, line) in canvas.fonts.wrap(&panel.title, 9.0, true, width).into_iter().enumerate() {
            let baseline = y + 12.0 * (i + 1) as f64;
            canvas.text(Label::new(area(c, y).x, baseline, line).size(9.0).bold());
            top = top.max(baseline);
        }
    }
    y = top + 5.0;
    for (c, panel) in data.panels.iter().enumerate() {
        axes.draw(&mut canvas, area(c, y), panel, &names, c == 0);
    }
    y_title(&mut canvas, left - tick_width, area(0, y), &data.y_label);
    y += height + SMALL_TEXT + 4.0;
    let middle = (left + canvas.width - PAGE_MARGIN - 8.0) / 2.0;
    for line in canvas.fonts.wrap(&data.x_label, SMALL_TEXT, false, canvas.width - left) {
        y += LINE_SPACING;
        canvas.text(Label::new(middle, y, line).middle());
    }
    canvas.height = y + PAGE_MARGIN;
    Ok(Figure { canvas, table })
}

struct Axes {
    x: AxisScale,
    y: AxisScale,
    /// Height of the strip for zeros; 0 if no value is 0.
    strip: f64,
}

impl Axes {
    fn draw(&self, canvas: &mut Canvas, area: Area, panel: &LogLogPanel, names: &[&str], first: bool) {
        let upper = Area { height: area.height - self.strip, ..area };
        let label_count = (area.width / 32.0) as i32;
        y_axis(canvas, upper, &self.y.ticks(8), first);
        x_axis(canvas, area, &self.x.ticks(label_count), true, true);
        if self.strip > 0.0 {
            canvas.line(
                (area.x, upper.bottom()),
                (area.right(), upper.bottom()),
                Paint::stroke(Color::DARK_GREY, 0.6).dashed(2.0),
            );
            let zero = [Tick { at: 0.5, label: "0".to_owned() }];
            let strip = Area { y: upper.bottom(), height: self.strip, ..area };
            y_axis(canvas, strip, if first { &zero } else { &[] }, true);
        }
        frame(canvas, area);
        for series in &panel.series {
            let style = point_style(names.iter().position(|&n| n == series.name).unwrap_or(0));
            let place = |point: &[f64; 2]| self.place(upper, *point);
            let points: Vec<(f64, f64)> = series.points.iter().map(place).collect();
            canvas.group("series", format!("{}, {}", panel.title, series.name), |canvas| {
                let line = Paint { dash: style.dash, ..Paint::stroke(style.color, 1.1) };
                // A line into the strip of zeros would suggest values in between.
                for run in series.points.split(|p| p[1] == 0.0).filter(|run| series.joined && run.len() > 1) {
                    canvas.polyline(run.iter().map(place).collect(), line);
                }
                for &at in &points {
                    marker(canvas, at, style);
                }
            });
        }
        if panel.series.is_empty() {
            let label = Label::new(area.middle_x(), area.middle_y(), "no data");
            canvas.text(label.middle().color(Color::DARK_GREY).halo());
        }
    }

    /// Position of a point in a panel, or in the strip of zeros below its `upper` part, pt.
    fn place(&self, upper: Area, [x, y]: [f64; 2]) -> (f64, f64) {
        let below = if y > 0.0 { -self.y.at(y) * upper.height } else { self.strip / 2.0 };
        (upper.x + self.x.at(x) * upper.width, upper.bottom() + below)
    }
}

/// The names of all series, each once, in the order of their appearance.
fn names(data: &LogLogFigure) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for series in data.panels.iter().flat_map(|panel| &panel.series) {
        if !names.contains(&series.name.as_str()) {
            names.push(&series.name);
        }
    }
    names
}

fn key(names: &[&str]) -> Vec<Entry> {
    let entry = |(i, name): (usize, &&str)| {
        Entry::new(*name, 10.0, move |canvas: &mut Canvas, at| marker(canvas, at, point_style(i)))
    };
    names.iter().enumerate().map(entry).collect()
}

/// Checks every value and writes it into the table.
fn check(data: &LogLogFigure) -> Result<Table, FigureError> {
    if data.panels.is_empty() {
        return Err(FigureError::Empty { what: "panels" });
    }
    let mut rows = Vec::new();
    for panel in &data.panels {
        for series in &panel.series {
            for (i, &[x, y]) in series.points.iter().enumerate() {
                let what = |axis: &str| format!("{axis} of point {} of {} {}", i + 1, panel.title, series.name);
                finite(x, || what("x"))?;
                finite(y, || what("y"))?;
                if x <= 0.0 {
                    return Err(FigureError::OutOfRange { what: what("x"), value: x, allowed: "x > 0" });
                }
                if y < 0.0 {
                    return Err(FigureError::OutOfRange { what: what("y"), value: y, allowed: "y >= 0" });
                }
                rows.push(vec![panel.title.clone(), series.name.clone(), x.to_string(), y.to_string()]);
            }
        }
    }
    Ok(Table::new("figure", ["panel", "series", "x", "y"], rows))
}
