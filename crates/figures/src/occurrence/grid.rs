//! Layout of panels and rows, and the scale that all panels share.

use super::super::axis::{AxisScale, PAGE_MARGIN, Tick};
use super::super::canvas::{Area, Canvas, SMALL_TEXT};
use super::data::{OccurrenceFigure, OccurrenceLaw};

/// Distance of two panels, pt; as all lengths here chosen.
const PANEL_GAP: f64 = 8.0;
/// Distance between the frame and the ends of the scale, so that what lies at 0 or 100 % is seen.
const SCALE_MARGIN: f64 = 4.0;
/// Height of one series in the row of a mode, where there is room.
const SERIES_HEIGHT: f64 = 8.0;
/// Height of a row at least: a line of text.
const LEAST_ROW_HEIGHT: f64 = SMALL_TEXT + 1.0;
/// Height that rows are made lower for: A4 less margins of 25 mm.
const PAGE_HEIGHT: f64 = 247.0 / 25.4 * 72.0;
/// Part of the page height for title, legend and notes, pt; chosen: with less a full page is too high, with more rows are lower than need be.
const HEIGHT_OF_TEXT: f64 = 160.0;
/// Part of the page height for the heading and the scale of a line of panels, pt; chosen: three lines of small text.
const HEIGHT_BESIDE_PANELS: f64 = 32.0;
/// Most panels side by side; chosen: more leave no room for the labels of a scale.
const MOST_COLUMNS: usize = 4;
/// Largest value, in percent, for which the scale ends with the values; beyond it the scale ends at 100 %.
/// Chosen: above half the whole is as well read.
const OWN_SCALE_BELOW: f64 = 50.0;

/// Layout of the panels, and what they share.
pub(super) struct PanelGrid {
    pub columns: usize,
    pub scale: AxisScale,
    pub ticks: Vec<Tick>,
    /// Modes that have a row, by their index.
    pub modes: Vec<usize>,
    /// Names and frequencies, Hz, of the modes that have a row.
    pub labels: Vec<[String; 2]>,
    /// Right ends of the two columns of text.
    pub label_ends: [f64; 2],
    left: f64,
    width: f64,
    /// Factor on the height of rows.
    shrink: f64,
}

impl PanelGrid {
    pub fn new(data: &OccurrenceFigure, canvas: &Canvas) -> Self {
        let modes = data.unstable_modes();
        let labels: Vec<[String; 2]> =
            modes.iter().map(|&m| [data.modes[m].label.clone(), significant(data.modes[m].frequency_hz)]).collect();
        let widest = |column: usize, heading: &str| {
            let all = labels.iter().map(|label| label[column].as_str()).chain([heading]);
            all.map(|text| canvas.fonts.width(text, SMALL_TEXT, false)).fold(0.0, f64::max)
        };
        let first = PAGE_MARGIN + widest(0, HEADINGS[0]);
        let label_ends = [first, first + 8.0 + widest(1, HEADINGS[1])];
        let left = label_ends[1] + 5.0;
        let most = data.laws.iter().map(|law| law.panels.len()).max().unwrap_or(1);
        let columns = most.div_ceil(most.div_ceil(MOST_COLUMNS).max(1)).max(1);
        let width = (canvas.width - PAGE_MARGIN - left - PANEL_GAP * (columns - 1) as f64) / columns as f64;
        let lines = |law: &OccurrenceLaw| law.panels.len().div_ceil(columns) as f64;
        let comfortable: f64 = data.laws.iter().map(|law| lines(law) * comfortable_height(law, modes.len())).sum();
        let room = PAGE_HEIGHT - HEIGHT_OF_TEXT - data.laws.iter().map(lines).sum::<f64>() * HEIGHT_BESIDE_PANELS;
        let (scale, shrink) = (scale(data), (room / comfortable).clamp(0.0, 1.0));
        Self { columns, ticks: scale.ticks(0), scale, modes, labels, label_ends, left, width, shrink }
    }

    /// Height of a panel of this law: the height of its rows together.
    pub fn height(&self, law: &OccurrenceLaw) -> f64 {
        let least = LEAST_ROW_HEIGHT * self.modes.len() as f64;
        (self.shrink * comfortable_height(law, self.modes.len())).max(least).max(2.0 * LEAST_ROW_HEIGHT)
    }

    pub fn area(&self, column: usize, y: f64, law: &OccurrenceLaw) -> Area {
        let x = self.left + column as f64 * (self.width + PANEL_GAP);
        Area { x, y, width: self.width, height: self.height(law) }
    }

    /// Horizontal position in a panel of a value in percent, pt.
    pub fn x(&self, area: Area, percent: f64) -> f64 {
        self.x_at(area, self.scale.at(percent))
    }

    /// Horizontal position in a panel of a position on the scale, 0 at its start and 1 at its end, pt.
    pub fn x_at(&self, area: Area, at: f64) -> f64 {
        area.x + SCALE_MARGIN + at * (area.width - 2.0 * SCALE_MARGIN)
    }

    /// The middle of the panels.
    pub fn middle(&self, canvas: &Canvas) -> f64 {
        (self.left + canvas.width - PAGE_MARGIN) / 2.0
    }
}

/// Headings of the two columns of text.
pub(super) const HEADINGS: [&str; 2] = ["mode", "Hz"];

/// Height of a panel with that many rows where there is room.
fn comfortable_height(law: &OccurrenceLaw, modes: usize) -> f64 {
    modes.max(1) as f64 * (SERIES_HEIGHT * series_of(law).len().max(1) as f64 + 4.0)
}

/// The series that a law has, from above to below.
pub(super) fn series_of(law: &OccurrenceLaw) -> Vec<usize> {
    let mut series: Vec<usize> = law.panels.iter().flat_map(|panel| &panel.boxes).map(|b| b.series).collect();
    series.sort_unstable();
    series.dedup();
    series
}

/// Scale from 0 to 100 %, or, where values are small, to what covers all values and marks.
fn scale(data: &OccurrenceFigure) -> AxisScale {
    let tops = data.boxes().flat_map(|b| b.solved()).map(|value| value.upper.max(value.percent + value.open));
    let most = tops.chain(data.marks.iter().map(|mark| mark.percent)).fold(0.0, f64::max);
    if most > OWN_SCALE_BELOW { AxisScale::PERCENT } else { AxisScale::linear([most].into_iter(), 4.0) }
}

/// Four significant digits, whole from 1,000 on.
pub(super) fn significant(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let digits = value.abs().log10().floor();
    let decimals = (3.0 - digits).clamp(0.0, 12.0) as usize;
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn frequencies_have_four_digits() {
        for (value, text) in [(24170.4, "24170"), (1015.95, "1016"), (0.225461, "0.2255"), (1.1779e-4, "0.0001178")] {
            assert_eq!(significant(value), text);
        }
        assert_eq!(significant(0.0), "0");
    }
}
