//! Sobol' indices as bars with their intervals: which input explains which part of the variance of an output.

use output::Table;

use super::axis::{AxisScale, PAGE_MARGIN, frame, note, title, x_axis};
use super::canvas::{Area, Canvas, Color, Label, Paint, SMALL_TEXT, TextAnchor};
use super::error::{FigureError, finite};
use super::figure::Figure;
use super::legend::{Entry, legend};
use super::style::{BLUE, SKY};

/// Panels of bars, two side by side.
#[derive(Debug, Clone, Default)]
pub struct IndexFigure {
    /// Title above everything; may be empty.
    pub title: String,
    /// Words for the first bar of each input; `None` for the words of a first-order index.
    pub first_bar: Option<String>,
    /// Panels, one for each output.
    pub panels: Vec<IndexPanel>,
    /// Note below everything; may be empty.
    pub note: String,
}

/// The indices of one output.
#[derive(Debug, Clone, Default)]
pub struct IndexPanel {
    /// Name of the output.
    pub title: String,
    /// Bars, from the top.
    pub bars: Vec<IndexBar>,
}

/// The indices of one input, each with its value and the limits of its interval, 0 to 1.
#[derive(Debug, Clone, Default)]
pub struct IndexBar {
    /// Name of the input.
    pub input: String,
    /// First-order index: value and limits.
    pub first_order: [f64; 3],
    /// Total index, where it is known: value and limits.
    pub total: Option<[f64; 3]>,
}

/// Height of the row of an input, pt; chosen.
const ROW: f64 = 17.0;
/// Height of a bar in it, pt; chosen.
const BAR: f64 = 6.0;
/// Distance between two columns of panels, pt; chosen: two heights of small text.
const GAP: f64 = 16.0;

/// Draws the bars in percent of the variance. The table has one row per panel, input and index.
///
/// # Errors
/// [`FigureError::Empty`] without panels, [`FigureError::NotFinite`] or [`FigureError::OutOfRange`] for a value outside of 0 to 1.
pub fn index_bars(data: &IndexFigure) -> Result<Figure, FigureError> {
    let table = check(data)?;
    let mut canvas = Canvas::new()?;
    let mut y = title(&mut canvas, &data.title);
    y = legend(&mut canvas, y + 4.0, &key(data)) + 4.0;
    let names = data.panels.iter().flat_map(|panel| &panel.bars);
    let left = names.map(|bar| canvas.fonts.width(&bar.input, SMALL_TEXT, false)).fold(0.0, f64::max) + 8.0;
    let columns = data.panels.len().min(2) as f64;
    let width = (canvas.width - 2.0 * PAGE_MARGIN - 10.0 - GAP * (columns - 1.0)) / columns - left;
    for pair in data.panels.chunks(2) {
        let rows = pair.iter().map(|panel| panel.bars.len()).max().unwrap_or(0) as f64;
        let headings: Vec<Vec<String>> =
            pair.iter().map(|panel| canvas.fonts.wrap(&panel.title, 9.0, true, width + left)).collect();
        let lines = headings.iter().map(Vec::len).max().unwrap_or(0) as f64;
        let top = y + 12.0 * lines + 4.0;
        for (at, (panel, heading)) in pair.iter().zip(headings).enumerate() {
            let x = PAGE_MARGIN + at as f64 * (left + width + GAP);
            for (i, line) in heading.into_iter().enumerate() {
                canvas.text(Label::new(x, y + 12.0 * (i + 1) as f64, line).size(9.0).bold());
            }
            let height = ROW * panel.bars.len() as f64;
            draw(&mut canvas, Area { x: x + left, y: top, width, height }, panel);
        }
        y = top + ROW * rows + SMALL_TEXT + 18.0;
    }
    let middle = canvas.width / 2.0;
    canvas.text(Label::new(middle, y - 4.0, "part of the variance (%)").middle());
    y += 4.0;
    note(&mut canvas, y, &data.note);
    Ok(Figure { canvas, table })
}

fn draw(canvas: &mut Canvas, area: Area, panel: &IndexPanel) {
    let scale = AxisScale::PERCENT;
    x_axis(canvas, area, &scale.ticks(5), true, true);
    for (row, bar) in panel.bars.iter().enumerate() {
        let middle = area.y + ROW * (row as f64 + 0.5);
        canvas.text(Label::new(area.x - 4.0, middle + 2.9, bar.input.clone()).anchor(TextAnchor::End));
        let words = |kind: &str, [value, lower, upper]: [f64; 3]| {
            let limits = match lower < upper {
                true => format!(" ({:.1} to {:.1} %)", 100.0 * lower, 100.0 * upper),
                false => String::new(),
            };
            format!("{}, {kind}: {:.1} %{limits}", bar.input, 100.0 * value)
        };
        let (above, below) = match bar.total {
            None => (middle - BAR / 2.0, None),
            Some(total) => (middle - BAR - 0.5, Some(total)),
        };
        canvas.group("first-order", words("alone", bar.first_order), |canvas| {
            one_bar(canvas, area, above, bar.first_order, Paint::fill(BLUE));
        });
        if let Some(total) = below {
            canvas.group("total", words("with others", total), |canvas| {
                one_bar(canvas, area, middle + 0.5, total, Paint::fill(SKY).outlined(BLUE, 0.5));
            });
        }
    }
    frame(canvas, area);
}

/// A bar from 0 to the value, and a whisker from limit to limit where there is a way between.
fn one_bar(canvas: &mut Canvas, area: Area, y: f64, [value, lower, upper]: [f64; 3], paint: Paint) {
    let x = |part: f64| area.x + part * area.width;
    canvas.rect(Area { x: area.x, y, width: value * area.width, height: BAR }, paint);
    if lower >= upper {
        return;
    }
    let line = Paint::stroke(Color::BLACK, 0.8);
    let middle = y + BAR / 2.0;
    canvas.line((x(lower), middle), (x(upper), middle), line);
    for end in [lower, upper] {
        canvas.line((x(end), middle - 2.0), (x(end), middle + 2.0), line);
    }
}

fn key(data: &IndexFigure) -> Vec<Entry> {
    let bar = |paint: Paint| {
        move |canvas: &mut Canvas, (x, y): (f64, f64)| {
            canvas.rect(Area { x: x - 6.0, y: y - BAR / 2.0, width: 12.0, height: BAR }, paint);
        }
    };
    let whisker = |canvas: &mut Canvas, (x, y): (f64, f64)| {
        canvas.line((x - 6.0, y), (x + 6.0, y), Paint::stroke(Color::BLACK, 0.8));
    };
    let bars = || data.panels.iter().flat_map(|panel| &panel.bars);
    let first = data.first_bar.as_deref().unwrap_or("alone (first order)");
    let mut entries = vec![Entry::new(first, 12.0, bar(Paint::fill(BLUE)))];
    if bars().any(|bar| bar.total.is_some()) {
        entries.push(Entry::new("with others (total)", 12.0, bar(Paint::fill(SKY).outlined(BLUE, 0.5))));
    }
    if bars().flat_map(|bar| bar.total.into_iter().chain([bar.first_order])).any(|[_, lower, upper]| lower < upper) {
        entries.push(Entry::new("95 % interval", 12.0, whisker));
    }
    entries
}

/// Checks every value and writes it into the table.
fn check(data: &IndexFigure) -> Result<Table, FigureError> {
    if data.panels.is_empty() {
        return Err(FigureError::Empty { what: "panels" });
    }
    let mut rows = Vec::new();
    for panel in &data.panels {
        for bar in &panel.bars {
            let indices = [Some(("first-order", bar.first_order)), bar.total.map(|total| ("total", total))];
            for (kind, numbers) in indices.into_iter().flatten() {
                let what = || format!("the {kind} index of {} in {}", bar.input, panel.title);
                for value in numbers {
                    finite(value, what)?;
                    if !(0.0..=1.0).contains(&value) {
                        return Err(FigureError::OutOfRange { what: what(), value, allowed: "0 to 1" });
                    }
                }
                let mut row = vec![panel.title.clone(), bar.input.clone(), kind.to_owned()];
                row.extend(numbers.map(|number| number.to_string()));
                rows.push(row);
            }
        }
    }
    Ok(Table::new("figure", ["panel", "input", "index", "value", "lower", "upper"], rows))
}
