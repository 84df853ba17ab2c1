//! Occurrence of instability per mode, as box plots over the contact arrangements.

mod data;
mod grid;
mod panel;

use super::axis::{LINE_SPACING, PAGE_MARGIN, title};
use super::canvas::{Area, Canvas, Color, Label, Paint, SMALL_TEXT};
use super::error::{FigureError, finite};
use super::figure::Figure;
use super::legend::{Entry, legend};
use super::style::{box_style, filled_box};
pub use data::{
    Occurrence, OccurrenceArrangement, OccurrenceBox, OccurrenceFigure, OccurrenceLaw, OccurrenceMark, OccurrenceMode,
    OccurrencePanel, OccurrenceSeries,
};
use grid::{HEADINGS, PanelGrid};
use output::Table;
use panel::{INTERVAL, cross, draw_panel, headings, mark_paint, open_names, panel_title, two_digits};

const OCCURRENCE_AXIS_TITLE: &str = "occurrence of instability (% of the samples)";

/// Draws the occurrence of instability: a row for each mode with its frequency, the series below each other, a box
/// ([`BoxStatistics`](montecarlo::BoxStatistics)) over the arrangements, or a diamond where there is only one.
///
/// Behind each box lies the range of the 95 % intervals of its arrangements; open names are drawn on from the value of the
/// arrangement that has most of them. The scale goes to 100 %, or as far as the values do where all are below 50 %. A mode that
/// is never unstable has no row, and the note says how sure that is. The table has one row per law, panel, mode, series and
/// arrangement, modes without a row included.
///
/// # Errors
/// [`FigureError::Empty`] without panels, [`FigureError::Index`] or [`FigureError::Length`] if the lists do not fit
/// together, [`FigureError::NotFinite`] or [`FigureError::OutOfRange`] for a value that is no percentage.
pub fn occurrence_boxes(data: &OccurrenceFigure) -> Result<Figure, FigureError> {
    let table = check(data)?;
    let mut canvas = Canvas::new()?;
    let grid = PanelGrid::new(data, &canvas);

    let mut y = title(&mut canvas, &data.title);
    y = legend(&mut canvas, y + 2.0, &key(data));
    let mut titles_above = Vec::new();
    for (l, law) in data.laws.iter().enumerate() {
        if !law.title.is_empty() {
            y += 12.0;
            canvas.text(Label::new(PAGE_MARGIN, y, law.title.clone()).size(9.0).bold());
            y += 1.0;
        }
        for first in (0..law.panels.len()).step_by(grid.columns) {
            let of_line = law.panels[first..].iter().take(grid.columns);
            let titles: Vec<String> = of_line.map(|panel| panel_title(data, panel)).collect();
            let is_new = titles != titles_above;
            if is_new {
                y = headings(&mut canvas, &grid, law, &titles, y);
                titles_above = titles;
            }
            y += 4.0;
            let area = grid.area(0, y, law);
            mode_labels(&mut canvas, &grid, area, is_new);
            for c in 0..grid.columns.min(law.panels.len() - first) {
                draw_panel(&mut canvas, data, &grid, [l, first + c], grid.area(c, y, law))?;
            }
            y += area.height + SMALL_TEXT + 5.0;
        }
    }
    y += LINE_SPACING - 2.0;
    canvas.text(Label::new(grid.middle(&canvas), y, OCCURRENCE_AXIS_TITLE).middle());
    y += 4.0;
    for note in [data.mode_note.clone(), quiet_modes(data, &grid)] {
        for line in canvas.fonts.wrap(&note, SMALL_TEXT, false, canvas.width - 2.0 * PAGE_MARGIN) {
            y += LINE_SPACING;
            canvas.text(Label::new(PAGE_MARGIN, y, line).color(Color::DARK_GREY));
        }
    }
    canvas.height = y + PAGE_MARGIN;
    Ok(Figure { canvas, table })
}

/// Names and frequencies of the modes, to the left of a line of panels.
fn mode_labels(canvas: &mut Canvas, grid: &PanelGrid, area: Area, headed: bool) {
    let row = area.height / grid.modes.len().max(1) as f64;
    let mut write = |texts: [&str; 2], y: f64, color| {
        for (text, x) in texts.into_iter().zip(grid.label_ends) {
            let label = Label::new(x, y, text).anchor(super::canvas::TextAnchor::End).color(color);
            canvas.text(label);
        }
    };
    if headed && !grid.modes.is_empty() {
        write(HEADINGS, area.y - 4.0, Color::DARK_GREY);
    }
    for (i, [label, hertz]) in grid.labels.iter().enumerate() {
        write([label, hertz], area.y + row * (i as f64 + 0.5) + 2.9, Color::BLACK);
    }
}

/// The series, how to read a box, and what it is compared with.
fn key(data: &OccurrenceFigure) -> Vec<Entry> {
    let mut entries: Vec<Entry> = (0..data.series.len())
        .map(|s| {
            Entry::new(data.series[s].description.clone(), 14.0, move |canvas: &mut Canvas, (x, y)| {
                let style = box_style(s);
                filled_box(canvas, Area { x: x - 7.0, y: y - 3.5, width: 14.0, height: 7.0 }, style);
                canvas.line((x, y - 3.5), (x, y + 3.5), Paint::stroke(style.median, 1.2));
            })
        })
        .collect();
    let all = || data.boxes().flat_map(|b| &b.values);
    let strip = |x: f64, y: f64| Area { x: x - 9.0, y: y - 4.0, width: 18.0, height: 8.0 };
    let intervals = match data.boxes().any(|b| b.values.len() > 1) {
        true => "from the lowest to the highest 95 % limit of an arrangement",
        false => "95 % interval",
    };
    entries.push(Entry::new(intervals, 18.0, move |canvas: &mut Canvas, (x, y)| {
        canvas.rect(strip(x, y), Paint::fill(INTERVAL));
    }));
    if all().any(|value| value.open > 0.0) {
        let text = "unstable, but the mode may be another one";
        entries.push(Entry::new(text, 18.0, |canvas: &mut Canvas, (x, y)| {
            open_names(canvas, [x - 9.0, x + 9.0], (y, 8.0));
        }));
    }
    if data.boxes().any(|b| b.solved().next().is_none()) {
        entries.push(Entry::new("no sample was solved", 5.0, |canvas: &mut Canvas, at| cross(canvas, at)));
    }
    for (m, mark) in data.marks.iter().enumerate() {
        entries.push(Entry::new(mark.text.clone(), 18.0, move |canvas: &mut Canvas, (x, y)| {
            canvas.line((x - 9.0, y), (x + 9.0, y), mark_paint(m));
        }));
    }
    let text = reading(data);
    if !text.is_empty() {
        entries.push(Entry { symbol: None, text });
    }
    entries
}

/// Explanation of how to read a box, empty where there is nothing to explain.
fn reading(data: &OccurrenceFigure) -> String {
    let mut reading = Vec::new();
    if data.has_arrangements() {
        let mirrored =
            data.laws.iter().flat_map(|law| &law.panels).any(|panel| panel.systems() < panel.arrangements.len());
        let which = if mirrored { ", of which mirror images are the same system" } else { "" };
        reading.push(format!("n: contact arrangements{which}"));
    }
    let shown = data.unstable_modes();
    if data.boxes().any(|b| shown.contains(&b.mode) && !b.is_ever_unstable()) {
        reading.push("short line at 0: stable in every sample".to_owned());
    }
    let several = data.boxes().any(|b| b.values.len() > 1);
    if several && data.boxes().any(|b| b.values.len() == 1) {
        reading.push("diamond: n\u{a0}=\u{a0}1".to_owned());
    }
    if several {
        let text = "box: median and quartiles (type 7) over the n; whiskers: farthest values within 1.5 box widths; rings: beyond";
        reading.push(text.to_owned());
    }
    reading.join("; ")
}

/// Number of modes without a row, and how often they may be unstable all the same, in words.
fn quiet_modes(data: &OccurrenceFigure, grid: &PanelGrid) -> String {
    let quiet: Vec<_> = data.boxes().filter(|b| !grid.modes.contains(&b.mode) && b.solved().next().is_some()).collect();
    let mut modes: Vec<usize> = quiet.iter().map(|b| b.mode).collect();
    modes.sort_unstable();
    modes.dedup();
    let upper = quiet.iter().flat_map(|b| b.solved()).map(|value| value.upper).fold(0.0, f64::max);
    match (modes.len(), grid.modes.len()) {
        (0, _) => String::new(),
        (count, 0) => {
            format!("All {count} modes are stable in every sample (95 %: unstable in at most {} %).", two_digits(upper))
        }
        (count, _) => format!(
            "Modes without a row: {count}, stable in every sample (95 %: unstable in at most {} %).",
            two_digits(upper)
        ),
    }
}

/// Checks every value and writes it into the table.
fn check(data: &OccurrenceFigure) -> Result<Table, FigureError> {
    if data.laws.iter().all(|law| law.panels.is_empty()) {
        return Err(FigureError::Empty { what: "panels" });
    }
    let mut rows = Vec::new();
    for law in &data.laws {
        for panel in &law.panels {
            for b in &panel.boxes {
                let unknown = |what: &str, index, count| FigureError::Index { what: what.to_owned(), index, count };
                let mode = data.modes.get(b.mode).ok_or_else(|| unknown("mode of a box", b.mode, data.modes.len()))?;
                let series =
                    data.series.get(b.series).ok_or_else(|| unknown("series of a box", b.series, data.series.len()))?;
                let place = format!("{} {}, mode {}, {}", law.name, panel.title, mode.label, series.name);
                if b.values.is_empty() || b.values.len() != panel.arrangements.len() {
                    let (found, expected) = (b.values.len(), panel.arrangements.len().max(1));
                    return Err(FigureError::Length { what: format!("values at {place}"), found, expected });
                }
                let frequency = finite(mode.frequency_hz, || format!("frequency at {place}"))?.to_string();
                for (arrangement, value) in panel.arrangements.iter().zip(&b.values) {
                    let mut row = vec![
                        data.constraints.clone(),
                        law.name.clone(),
                        series.name.clone(),
                        panel.in_contact.to_string(),
                        if arrangement.name.is_empty() { "none".into() } else { arrangement.name.clone() },
                        arrangement.system.to_string(),
                        mode.label.clone(),
                        frequency.clone(),
                        value.samples.to_string(),
                    ];
                    for (quantity, percent) in [
                        ("occurrence", value.percent),
                        ("open names", value.open),
                        ("lower limit", value.lower),
                        ("upper limit", value.upper),
                    ] {
                        let what = || format!("{quantity} at {place}, arrangement {}", arrangement.name);
                        let value = finite(percent, what)?;
                        if !(0.0..=100.0).contains(&value) {
                            return Err(FigureError::OutOfRange { what: what(), value, allowed: "0 to 100 %" });
                        }
                        row.push(value.to_string());
                    }
                    rows.push(row);
                }
            }
        }
    }
    for mark in &data.marks {
        let what = || format!("mark \"{}\"", mark.text);
        let value = finite(mark.percent, what)?;
        if !(0.0..=100.0).contains(&value) {
            return Err(FigureError::OutOfRange { what: what(), value, allowed: "0 to 100 %" });
        }
    }
    Ok(Table::new("figure", HEADER, rows))
}

const HEADER: [&str; 13] = [
    "constraints",
    "law",
    "speed",
    "in_contact",
    "arrangement",
    "system",
    "mode",
    "frequency_hz",
    "samples",
    "occurrence_percent",
    "open_percent",
    "lower_percent",
    "upper_percent",
];
