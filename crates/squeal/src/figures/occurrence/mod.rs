//! Occurrence of instability per mode, as box plots over the contact arrangements.

mod grid;
mod panel;

use super::axis::{LINE_SPACING, PAGE_MARGIN, title, y_title};
use super::canvas::{Area, Canvas, Label, Paint};
use super::error::{FigureError, finite};
use super::figure::{Figure, Table};
use super::legend::{Entry, legend};
use super::style::{box_style, filled_box};
use grid::{PanelGrid, Slots};
use panel::{draw_panel, headings};

/// Box plots in panels, one row of panels per friction law.
#[derive(Debug, Clone, Default)]
pub struct OccurrenceFigure {
    /// Above everything; may be empty.
    pub title: String,
    /// Title of the horizontal axes, for example "tracked mode".
    pub mode_axis: String,
    /// Labels of the modes, in the order of the axis. All panels share them; modes that are never unstable are left out.
    pub modes: Vec<String>,
    /// Names of the series (speed ranges), left to right within a mode.
    pub series: Vec<String>,
    /// One per friction law.
    pub rows: Vec<OccurrenceRow>,
}

/// The panels of one friction law.
#[derive(Debug, Clone, Default)]
pub struct OccurrenceRow {
    /// Above the panels; may be empty.
    pub law: String,
    /// One per number of contacts closed.
    pub panels: Vec<OccurrencePanel>,
}

/// One number of contacts closed, or a brake that has none.
#[derive(Debug, Clone, Default)]
pub struct OccurrencePanel {
    /// For example "(a) nine in contact".
    pub title: String,
    /// Names of the arrangements, for the table; a single empty one of a brake without contacts.
    pub arrangements: Vec<String>,
    /// At most one per mode and series; a mode without one is not drawn.
    pub boxes: Vec<OccurrenceBox>,
}

impl OccurrencePanel {
    /// Whether there are contacts to arrange: without, nothing is said of their arrangements.
    fn has_arrangements(&self) -> bool {
        self.arrangements.iter().any(|name| !name.is_empty())
    }
}

/// One mode under one series.
#[derive(Debug, Clone, Default)]
pub struct OccurrenceBox {
    /// Index into [`OccurrenceFigure::modes`].
    pub mode: usize,
    /// Index into [`OccurrenceFigure::series`].
    pub series: usize,
    /// Occurrence of instability in percent, one value per arrangement.
    pub percent: Vec<f64>,
}

const OCCURRENCE_AXIS_TITLE: &str = "occurrence of instability (%)";

/// Draws the occurrence of instability: panels with one shared mode axis and 0 to 100 %, the series side by side, a box
/// ([`BoxStatistics`](montecarlo::BoxStatistics)) over the arrangements, or a diamond where there is only one.
///
/// The panels of a law stand in one row; four panels of a single law in two. A panel where no mode is ever unstable says
/// so. The table has one row per law, panel, mode, series and arrangement.
///
/// # Errors
/// [`FigureError::Empty`] without panels, [`FigureError::Index`] or [`FigureError::Length`] if the lists do not fit
/// together, [`FigureError::NotFinite`] or [`FigureError::OutOfRange`] for a value that is no percentage.
pub fn occurrence_boxes(data: &OccurrenceFigure) -> Result<Figure, FigureError> {
    let table = check(data)?;
    let mut canvas = Canvas::new()?;
    let modes: Vec<usize> = (0..data.modes.len()).filter(|&m| unstable(data, m)).collect();
    let grid = PanelGrid::new(data, &canvas, modes);

    let mut y = title(&mut canvas, &data.title);
    y = legend(&mut canvas, y + 2.0, &key(data));
    let mut titles_above: Vec<&str> = Vec::new();
    for (r, row) in data.rows.iter().enumerate() {
        if !row.law.is_empty() {
            y += 12.0;
            canvas.text(Label::new(PAGE_MARGIN, y, row.law.clone()).size(9.0).bold());
            y += 1.0;
        }
        let slots = Slots::new(data, row, &grid);
        let lines: Vec<_> = row.panels.chunks(grid.columns).collect();
        for (l, panels) in lines.iter().enumerate() {
            let titles: Vec<&str> = panels.iter().map(|panel| panel.title.as_str()).collect();
            if titles != titles_above {
                y = headings(&mut canvas, &grid, panels, y);
                titles_above = titles;
            }
            y += 5.0;
            let last = r + 1 == data.rows.len() && l + 1 == lines.len();
            for (c, panel) in panels.iter().enumerate() {
                let area = grid.area(c, y);
                let below = lines.get(l + 1).is_none_or(|next| c >= next.len());
                draw_panel(
                    &mut canvas,
                    data,
                    &grid,
                    &slots,
                    panel,
                    area,
                    (c == 0, last || (below && l + 1 < lines.len())),
                )?;
            }
            y_title(&mut canvas, grid.left - grid.tick_width, grid.area(0, y), OCCURRENCE_AXIS_TITLE);
            y += grid.height + 6.0;
        }
    }
    y += grid.label_height + LINE_SPACING - 5.0;
    canvas.text(Label::new((grid.left + canvas.width - PAGE_MARGIN) / 2.0, y, data.mode_axis.clone()).middle());
    canvas.height = y + PAGE_MARGIN;
    Ok(Figure { canvas, table })
}

/// The series that are drawn, and how to read a box.
fn key(data: &OccurrenceFigure) -> Vec<Entry> {
    let all = || data.rows.iter().flat_map(|row| &row.panels).flat_map(|panel| &panel.boxes);
    let mut entries: Vec<Entry> = (0..data.series.len())
        .filter(|&s| all().any(|b| b.series == s))
        .map(|s| {
            Entry::new(data.series[s].clone(), 14.0, move |canvas: &mut Canvas, (x, y)| {
                let style = box_style(s);
                filled_box(canvas, Area { x: x - 7.0, y: y - 3.5, width: 14.0, height: 7.0 }, style);
                canvas.line((x, y - 3.5), (x, y + 3.5), Paint::stroke(style.median, 1.2));
            })
        })
        .collect();
    if !data.rows.iter().flat_map(|row| &row.panels).any(OccurrencePanel::has_arrangements) {
        return entries;
    }
    let mut reading = "n: contact arrangements".to_owned();
    if all().any(|b| b.percent.len() == 1) {
        reading.push_str("; diamond: n\u{a0}=\u{a0}1");
    }
    if all().any(|b| b.percent.len() > 1) {
        reading.push_str("; box: quartiles and median; whiskers: within 1.5 box heights; rings: beyond");
    }
    entries.push(Entry { symbol: None, text: reading });
    entries
}

fn unstable(data: &OccurrenceFigure, mode: usize) -> bool {
    let boxes = || data.rows.iter().flat_map(|row| &row.panels).flat_map(|panel| &panel.boxes);
    boxes().any(|b| b.mode == mode && b.percent.iter().any(|&p| p > 0.0))
}

/// Checks every value and writes it into the table.
fn check(data: &OccurrenceFigure) -> Result<Table, FigureError> {
    if data.rows.iter().all(|row| row.panels.is_empty()) {
        return Err(FigureError::Empty { what: "panels" });
    }
    let label = |what: &str, index: usize, list: &[String]| {
        let unknown = || FigureError::Index { what: what.to_owned(), index, count: list.len() };
        list.get(index).cloned().ok_or_else(unknown)
    };
    let mut rows = Vec::new();
    for row in &data.rows {
        for panel in &row.panels {
            for b in &panel.boxes {
                let mode = label("mode of a box", b.mode, &data.modes)?;
                let series = label("series of a box", b.series, &data.series)?;
                let place = format!("{} {}, mode {mode}, {series}", row.law, panel.title);
                if b.percent.is_empty() || b.percent.len() != panel.arrangements.len() {
                    let (found, expected) = (b.percent.len(), panel.arrangements.len().max(1));
                    return Err(FigureError::Length { what: format!("values at {place}"), found, expected });
                }
                for (arrangement, &percent) in panel.arrangements.iter().zip(&b.percent) {
                    let what = || format!("occurrence at {place}, arrangement {arrangement}");
                    let value = finite(percent, what)?;
                    if !(0.0..=100.0).contains(&value) {
                        return Err(FigureError::OutOfRange { what: what(), value, allowed: "0 to 100 %" });
                    }
                    let cells = [&row.law, &panel.title, &mode, &series, arrangement];
                    rows.push(cells.into_iter().cloned().chain([value.to_string()]).collect());
                }
            }
        }
    }
    Ok(Table { header: &["law", "panel", "mode", "series", "arrangement", "occurrence_percent"], rows })
}
