//! Bars with intervals: by how much each change of a brake lowers a number.

use output::Table;

use super::axis::{AxisScale, LINE_SPACING, PAGE_MARGIN, frame, note, title, x_axis};
use super::canvas::{Area, Canvas, Color, Label, Paint, SMALL_TEXT, TextAnchor};
use super::error::{FigureError, finite};
use super::figure::Figure;
use super::legend::{Entry, legend};
use super::style::{BLUE, VERMILLION};

/// Drops, group by group.
#[derive(Debug, Clone, Default)]
pub struct DropsFigure {
    /// Title above everything; may be empty.
    pub title: String,
    /// Name of the quantity that drops, with its unit.
    pub x_label: String,
    /// Groups of bars: at least one, each with a bar or more.
    pub groups: Vec<DropGroup>,
    /// True where values are rises, so that what is above zero is worse and has the colour of it.
    pub are_rises: bool,
    /// The most that anything can drop, drawn as a line.
    pub most: Option<f64>,
    /// Note below everything; may be empty.
    pub note: String,
}

/// Bars under one heading.
#[derive(Debug, Clone, Default)]
pub struct DropGroup {
    /// Heading of the group.
    pub title: String,
    /// Bars of the group.
    pub bars: Vec<DropBar>,
}

/// A drop.
#[derive(Debug, Clone, Default)]
pub struct DropBar {
    /// Name of the cause.
    pub name: String,
    /// Size of the drop.
    pub value: f64,
    /// Interval of the drop: lower and upper limit; `None` where nothing is known of it.
    pub limits: Option<[f64; 2]>,
    /// Size that was predicted.
    pub predicted: Option<f64>,
}

/// Distance from the middle of a bar to the middle of the next, pt; chosen.
const PITCH: f64 = 13.0;
/// Thickness of a bar, pt; chosen.
const THICKNESS: f64 = 8.0;
/// Part of the page that names may take; longer ones are broken. Chosen: about half is left for the bars.
const MOST_FOR_NAMES: f64 = 0.45;

/// Draws a bar for each drop from zero on, with a whisker over its interval and a diamond at what was predicted. The table has one row
/// per bar.
///
/// # Errors
/// [`FigureError::Empty`] without bars, [`FigureError::NotFinite`].
pub fn drops(data: &DropsFigure) -> Result<Figure, FigureError> {
    let table = check(data)?;
    let mut canvas = Canvas::new()?;
    let bars = || data.groups.iter().flat_map(|group| &group.bars);
    let values = bars()
        .flat_map(|bar| [bar.value, bar.predicted.unwrap_or(0.0)].into_iter().chain(bar.limits.into_iter().flatten()));
    let scale = AxisScale::linear(values.chain(data.most), 6.0);
    let headings = data.groups.iter().map(|group| canvas.fonts.width(&group.title, SMALL_TEXT, true));
    let widest = bars().map(|bar| canvas.fonts.width(&bar.name, SMALL_TEXT, false)).chain(headings).fold(0.0, f64::max);
    let names = widest.min(MOST_FOR_NAMES * canvas.width);

    let mut y = title(&mut canvas, &data.title);
    y = legend(&mut canvas, y + 2.0, &key(data));
    let left = PAGE_MARGIN + names + 8.0;
    let mut area = Area { x: left, y: y + 4.0, width: canvas.width - PAGE_MARGIN - 10.0 - left, height: 0.0 };
    let mut rows: Vec<(f64, Option<&DropBar>, Vec<String>)> = Vec::new();
    y = area.y;
    for group in &data.groups {
        y += PITCH;
        rows.push((y - 3.0, None, vec![group.title.clone()]));
        for bar in &group.bars {
            let lines = canvas.fonts.wrap(&bar.name, SMALL_TEXT, false, names);
            let height = PITCH + LINE_SPACING * (lines.len().max(1) - 1) as f64;
            rows.push((y + 0.5 * height, Some(bar), lines));
            y += height;
        }
        y += 3.0;
    }
    area.height = y - area.y;
    x_axis(&mut canvas, area, &scale.ticks((area.width / 32.0) as i32), true, true);
    let x = |value: f64| area.x + scale.at(value) * area.width;
    if let Some(most) = data.most {
        canvas.line((x(most), area.y), (x(most), area.bottom()), Paint::stroke(Color::DARK_GREY, 0.8).dashed(3.0));
    }
    for (y, bar, lines) in rows {
        match bar {
            None => canvas.text(Label::new(PAGE_MARGIN, y, lines.concat()).bold()),
            Some(bar) => {
                let first = y + 2.9 - 0.5 * LINE_SPACING * (lines.len().max(1) - 1) as f64;
                for (i, line) in lines.into_iter().enumerate() {
                    let baseline = first + LINE_SPACING * i as f64;
                    canvas.text(Label::new(area.x - 6.0, baseline, line).anchor(TextAnchor::End));
                }
                let fill = if (bar.value < 0.0) == data.are_rises { BLUE } else { VERMILLION };
                draw(&mut canvas, bar, fill, y, &x);
            }
        }
    }
    canvas.line((x(0.0), area.y), (x(0.0), area.bottom()), Paint::stroke(Color::BLACK, 0.8));
    frame(&mut canvas, area);
    y = area.bottom() + SMALL_TEXT + LINE_SPACING + 4.0;
    // Below the names too, where it is longer than its axis.
    let half = 0.5 * canvas.fonts.width(&data.x_label, SMALL_TEXT, false);
    let middle = area.middle_x().min(canvas.width - PAGE_MARGIN - half).max(PAGE_MARGIN + half);
    canvas.text(Label::new(middle, y, data.x_label.clone()).middle());
    note(&mut canvas, y, &data.note);
    Ok(Figure { canvas, table })
}

/// Draws a bar in a colour at the height y.
fn draw(canvas: &mut Canvas, bar: &DropBar, fill: Color, y: f64, x: &dyn Fn(f64) -> f64) {
    let limits = bar.limits.map_or_else(String::new, |[lower, upper]| format!(" ({lower:.4} to {upper:.4})"));
    let words = format!("{}: {:.4}{limits}", bar.name, bar.value);
    canvas.group("mark", words, |canvas| {
        let (from, to) = (x(bar.value.min(0.0)), x(bar.value.max(0.0)));
        canvas.rect(Area { x: from, y: y - 0.5 * THICKNESS, width: to - from, height: THICKNESS }, Paint::fill(fill));
        if let Some(limits) = bar.limits {
            whisker(canvas, limits.map(x), y);
        }
        if let Some(predicted) = bar.predicted {
            diamond(canvas, (x(predicted), y));
        }
    });
}

fn whisker(canvas: &mut Canvas, [from, to]: [f64; 2], y: f64) {
    for (color, width) in [(Color::WHITE, 2.4), (Color::BLACK, 1.0)] {
        canvas.line((from, y), (to, y), Paint::stroke(color, width));
        for end in [from, to] {
            canvas.line((end, y - 2.5), (end, y + 2.5), Paint::stroke(color, width));
        }
    }
}

fn diamond(canvas: &mut Canvas, (x, y): (f64, f64)) {
    let r = 3.0;
    let corners = vec![(x, y - r), (x + r, y), (x, y + r), (x - r, y)];
    canvas.polygon(corners, Paint::fill(Color::WHITE).outlined(Color::BLACK, 0.8));
}

fn key(data: &DropsFigure) -> Vec<Entry> {
    let mut entries = vec![Entry::new("95 % interval", 14.0, |canvas, (x, y)| whisker(canvas, [x - 6.0, x + 6.0], y))];
    if data.groups.iter().flat_map(|group| &group.bars).any(|bar| bar.predicted.is_some()) {
        entries.push(Entry::new("predicted", 8.0, diamond));
    }
    if data.most.is_some() {
        entries.push(Entry::new("all there are", 10.0, |canvas, (x, y)| {
            canvas.line((x, y - 4.0), (x, y + 4.0), Paint::stroke(Color::DARK_GREY, 0.8).dashed(3.0));
        }));
    }
    entries
}

/// Checks every value and writes it into the table.
fn check(data: &DropsFigure) -> Result<Table, FigureError> {
    let mut rows = Vec::new();
    for group in &data.groups {
        for bar in &group.bars {
            let named = |what: &str| format!("{what} of {} {}", group.title, bar.name);
            let mut row = vec![group.title.clone(), bar.name.clone()];
            row.push(finite(bar.value, || named("drop"))?.to_string());
            for (at, what) in ["lower limit", "upper limit"].into_iter().enumerate() {
                let limit = bar.limits.map(|limits| finite(limits[at], || named(what))).transpose()?;
                row.push(limit.map_or_else(String::new, |limit| limit.to_string()));
            }
            let predicted = bar.predicted.map(|value| finite(value, || named("prediction"))).transpose()?;
            row.push(predicted.map_or_else(String::new, |value| value.to_string()));
            rows.push(row);
        }
    }
    if rows.is_empty() {
        return Err(FigureError::Empty { what: "bars" });
    }
    data.most.map(|most| finite(most, || "most".into())).transpose()?;
    Ok(Table::new("figure", ["group", "change", "drop", "lower", "upper", "predicted"], rows))
}
