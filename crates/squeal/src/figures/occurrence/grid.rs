//! Where the panels stand, the axis that they share, and the places of the series on it.

use super::super::axis::{AxisScale, PAGE_MARGIN, Tick, widest, y_title_width};
use super::super::canvas::{Area, Canvas, SMALL_TEXT};
use super::{OCCURRENCE_AXIS_TITLE, OccurrenceFigure, OccurrenceRow};

/// Distance of two panels, pt.
const PANEL_GAP: f64 = 9.0;

/// Where the panels stand, and the axis that they share.
pub(super) struct PanelGrid {
    pub columns: usize,
    pub left: f64,
    pub tick_width: f64,
    pub width: f64,
    pub height: f64,
    /// Of the tick labels below the lowest panels.
    pub label_height: f64,
    /// Modes on the axis.
    pub modes: Vec<usize>,
    pub ticks: Vec<Tick>,
    /// Labels read upwards.
    pub upward: bool,
}

impl PanelGrid {
    pub fn new(data: &OccurrenceFigure, canvas: &Canvas, modes: Vec<usize>) -> Self {
        let y_ticks = AxisScale::PERCENT.ticks(5);
        let tick_width = widest(canvas, &y_ticks) + 6.0;
        let most = data.rows.iter().map(|row| row.panels.len()).max().unwrap_or(1);
        let height = if data.rows.len() == 1 { 120.0 } else { 96.0 };
        let left = PAGE_MARGIN + y_title_width(canvas, height, OCCURRENCE_AXIS_TITLE) + tick_width;
        let width_of =
            |columns: usize| (canvas.width - PAGE_MARGIN - left - PANEL_GAP * (columns - 1) as f64) / columns as f64;
        let count = modes.len().max(1) as f64;
        let mut columns = if data.rows.len() == 1 && most > 2 { most.div_ceil(2) } else { most };
        // A mode needs room for its label, if only upwards.
        while columns > 2 && width_of(columns) / count < SMALL_TEXT + 0.5 {
            columns = columns.div_ceil(2);
        }
        let width = width_of(columns);
        let slot = width / count;
        let every = ((SMALL_TEXT + 0.5) / slot).ceil() as usize;
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
        let label_height = if upward { longest + 3.0 } else { SMALL_TEXT + 2.0 };
        Self { columns, left, tick_width, width, height, label_height, modes, ticks, upward }
    }

    pub fn area(&self, column: usize, y: f64) -> Area {
        let x = self.left + column as f64 * (self.width + PANEL_GAP);
        Area { x, y, width: self.width, height: self.height }
    }
}

/// The series that a row shows, side by side around the middle of each mode.
pub(super) struct Slots {
    pub series: Vec<usize>,
    /// Between two neighbours.
    pub pitch: f64,
    pub box_width: f64,
}

impl Slots {
    pub fn new(data: &OccurrenceFigure, row: &OccurrenceRow, grid: &PanelGrid) -> Self {
        let shown = |s: &usize| row.panels.iter().flat_map(|panel| &panel.boxes).any(|b| b.series == *s);
        let series: Vec<usize> = (0..data.series.len()).filter(shown).collect();
        let slot = grid.width / grid.modes.len().max(1) as f64;
        let pitch = (0.86 * slot / series.len().max(1) as f64).min(18.0);
        Self { series, pitch, box_width: (0.78 * pitch).min(12.0) }
    }

    pub fn offset(&self, series: usize) -> f64 {
        let place = self.series.iter().position(|&s| s == series).unwrap_or(0) as f64;
        (place - (self.series.len() as f64 - 1.0) / 2.0) * self.pitch
    }
}
