//! Occurrence of instability per mode, as box plots over the contact arrangements.

use super::axis::{LINE, MARGIN, Scale, Tick, frame, title, widest, x_axis, y_axis, y_title, y_title_width};
use super::canvas::{Anchor, Area, Canvas, Color, Label, Paint, SMALL};
use super::error::{FigureError, finite};
use super::figure::{Figure, Table};
use super::legend::{Entry, legend};
use super::style::{BoxStyle, box_style, diamond, filled_box};
use super::tukey::Tukey;

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
    /// One per number of oscillators in contact.
    pub panels: Vec<OccurrencePanel>,
}

/// One number of oscillators in contact.
#[derive(Debug, Clone, Default)]
pub struct OccurrencePanel {
    /// For example "(a) nine in contact".
    pub title: String,
    /// Names of the arrangements, for the table.
    pub arrangements: Vec<String>,
    /// At most one per mode and series; a mode without one is not drawn.
    pub boxes: Vec<OccurrenceBox>,
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

const Y_TITLE: &str = "occurrence of instability (%)";
const GAP: f64 = 9.0;

/// Draws the occurrence of instability: panels with one shared mode axis and 0 to 100 %, the series side by side, a box
/// (quartiles, median, Tukey's whiskers, outliers) over the arrangements, or a diamond where there is only one.
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
    let grid = Grid::new(data, &canvas, modes);

    let mut y = title(&mut canvas, &data.title);
    y = legend(&mut canvas, y + 2.0, &key(data));
    let mut titles_above: Vec<&str> = Vec::new();
    for (r, row) in data.rows.iter().enumerate() {
        if !row.law.is_empty() {
            y += 12.0;
            canvas.text(Label::new(MARGIN, y, row.law.clone()).size(9.0).bold());
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
                );
            }
            y_title(&mut canvas, grid.left - grid.tick_width, grid.area(0, y), Y_TITLE);
            y += grid.height + 6.0;
        }
    }
    y += grid.label_height + LINE - 5.0;
    canvas.text(Label::new((grid.left + canvas.width - MARGIN) / 2.0, y, data.mode_axis.clone()).middle());
    canvas.height = y + MARGIN;
    Ok(Figure { canvas, table })
}

/// Where the panels stand, and the axis that they share.
struct Grid {
    columns: usize,
    left: f64,
    tick_width: f64,
    width: f64,
    height: f64,
    /// Of the tick labels below the lowest panels.
    label_height: f64,
    /// Modes on the axis.
    modes: Vec<usize>,
    ticks: Vec<Tick>,
    /// Labels read upwards.
    upward: bool,
}

impl Grid {
    fn new(data: &OccurrenceFigure, canvas: &Canvas, modes: Vec<usize>) -> Self {
        let y_ticks = Scale::PERCENT.ticks(5);
        let tick_width = widest(canvas, &y_ticks) + 6.0;
        let most = data.rows.iter().map(|row| row.panels.len()).max().unwrap_or(1);
        let height = if data.rows.len() == 1 { 120.0 } else { 88.0 };
        let left = MARGIN + y_title_width(canvas, height, Y_TITLE) + tick_width;
        let width_of = |columns: usize| (canvas.width - MARGIN - left - GAP * (columns - 1) as f64) / columns as f64;
        let count = modes.len().max(1) as f64;
        let mut columns = if data.rows.len() == 1 && most > 2 { most.div_ceil(2) } else { most };
        // A mode needs room for its label, if only upwards.
        while columns > 1 && width_of(columns) / count < SMALL + 0.5 {
            columns = columns.div_ceil(2);
        }
        let width = width_of(columns);
        let slot = width / count;
        let every = ((SMALL + 0.5) / slot).ceil() as usize;
        let ticks: Vec<Tick> = modes
            .iter()
            .enumerate()
            .map(|(i, &m)| Tick {
                at: (i as f64 + 0.5) / count,
                label: if i % every == 0 { data.modes[m].clone() } else { String::new() },
            })
            .collect();
        let longest = widest(canvas, &ticks);
        let upward = longest + 3.0 > slot * every as f64;
        let label_height = if upward { longest + 3.0 } else { SMALL + 2.0 };
        Self { columns, left, tick_width, width, height, label_height, modes, ticks, upward }
    }

    fn area(&self, column: usize, y: f64) -> Area {
        let x = self.left + column as f64 * (self.width + GAP);
        Area { x, y, width: self.width, height: self.height }
    }
}

/// The series that a row shows, side by side around the middle of each mode.
struct Slots {
    series: Vec<usize>,
    /// Between two neighbours.
    pitch: f64,
    box_width: f64,
}

impl Slots {
    fn new(data: &OccurrenceFigure, row: &OccurrenceRow, grid: &Grid) -> Self {
        let shown = |s: &usize| row.panels.iter().flat_map(|panel| &panel.boxes).any(|b| b.series == *s);
        let series: Vec<usize> = (0..data.series.len()).filter(shown).collect();
        let slot = grid.width / grid.modes.len().max(1) as f64;
        let pitch = (0.86 * slot / series.len().max(1) as f64).min(18.0);
        Self { series, pitch, box_width: (0.78 * pitch).min(12.0) }
    }

    fn offset(&self, series: usize) -> f64 {
        let place = self.series.iter().position(|&s| s == series).unwrap_or(0) as f64;
        (place - (self.series.len() as f64 - 1.0) / 2.0) * self.pitch
    }
}

/// The titles of one line of panels, with the number of arrangements. Returns the y below them.
fn headings(canvas: &mut Canvas, grid: &Grid, panels: &[OccurrencePanel], top: f64) -> f64 {
    let mut bottom = top;
    for (c, panel) in panels.iter().enumerate() {
        let area = grid.area(c, top);
        let text = format!("{}, n\u{a0}=\u{a0}{}", panel.title, panel.arrangements.len());
        for (i, line) in canvas.fonts.wrap(&text, SMALL, false, area.width).into_iter().enumerate() {
            let y = top + LINE * (i + 1) as f64;
            canvas.text(Label::new(area.x, y, line));
            bottom = y.max(bottom);
        }
    }
    bottom
}

fn draw_panel(
    canvas: &mut Canvas,
    data: &OccurrenceFigure,
    grid: &Grid,
    slots: &Slots,
    panel: &OccurrencePanel,
    area: Area,
    (first, lowest): (bool, bool),
) {
    y_axis(canvas, area, &Scale::PERCENT.ticks(5), first);
    x_axis(canvas, area, &grid.ticks, lowest && !grid.upward, false);
    if lowest && grid.upward {
        for tick in &grid.ticks {
            let x = area.x + tick.at * area.width + 2.9;
            canvas.text(Label::new(x, area.bottom() + 4.5, tick.label.clone()).anchor(Anchor::End).upward());
        }
    }
    for i in 1..grid.modes.len() {
        let x = area.x + area.width * i as f64 / grid.modes.len() as f64;
        canvas.line((x, area.y), (x, area.bottom()), Paint::stroke(Color::LIGHT_GREY, 0.4).dashed(1.5));
    }
    frame(canvas, area);
    if panel.boxes.iter().all(|b| b.percent.iter().all(|&p| p <= 0.0)) {
        let label = Label::new(area.middle_x(), area.middle_y() - 4.0, "no instability");
        canvas.text(label.middle().color(Color::DARK_GREY).halo());
        return;
    }
    for b in &panel.boxes {
        let Some(place) = grid.modes.iter().position(|&m| m == b.mode) else { continue };
        let x = area.x + grid.ticks[place].at * area.width + slots.offset(b.series);
        let tukey = Tukey::of(&b.percent);
        let (mode, series) = (&data.modes[b.mode], &data.series[b.series]);
        let text = format!(
            "{}, mode {mode}, {series}: median {:.1} %, quartiles {:.1} % and {:.1} %, n = {}",
            panel.title,
            tukey.median,
            tukey.lower,
            tukey.upper,
            b.percent.len()
        );
        canvas.group("box", text, |canvas| {
            let y_of = |percent: f64| area.bottom() - Scale::PERCENT.at(percent) * area.height;
            let style = box_style(b.series);
            if b.percent.len() == 1 {
                diamond(canvas, (x, y_of(tukey.median)), (0.55 * slots.pitch).min(3.6), style);
            } else {
                draw_box(canvas, x, slots.box_width, &tukey, style, y_of);
            }
        });
    }
}

fn draw_box(canvas: &mut Canvas, x: f64, width: f64, tukey: &Tukey, style: BoxStyle, y_of: impl Fn(f64) -> f64) {
    let line = Paint::stroke(style.line, 0.6);
    for (whisker, edge) in [(tukey.whiskers.0, tukey.lower), (tukey.whiskers.1, tukey.upper)] {
        canvas.line((x, y_of(whisker)), (x, y_of(edge)), line);
        canvas.line((x - width / 4.0, y_of(whisker)), (x + width / 4.0, y_of(whisker)), line);
    }
    let (top, bottom) = (y_of(tukey.upper), y_of(tukey.lower));
    let half = width / 2.0;
    // A box thinner than its median line would vanish under it.
    if bottom - top > 1.5 {
        filled_box(canvas, Area { x: x - half, y: top, width, height: bottom - top }, style);
        canvas.line((x - half, y_of(tukey.median)), (x + half, y_of(tukey.median)), Paint::stroke(style.median, 1.2));
    } else {
        canvas.line((x - half, y_of(tukey.median)), (x + half, y_of(tukey.median)), Paint::stroke(style.line, 1.4));
    }
    for &value in &tukey.outliers {
        canvas.circle((x, y_of(value)), (width / 4.0).clamp(0.8, 1.4), Paint::stroke(style.line, 0.5));
    }
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
    if all().any(|b| b.percent.len() > 1) {
        let text = "box: quartiles and median; whiskers: within 1.5 times the box; rings: beyond";
        entries.push(Entry { symbol: None, text: text.to_owned() });
    }
    if all().any(|b| b.percent.len() == 1) {
        entries.push(Entry { symbol: None, text: "diamond: one arrangement".to_owned() });
    }
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
