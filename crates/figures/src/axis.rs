//! Scales and axes.

use super::canvas::{Area, Canvas, Color, Label, Paint, SMALL_TEXT, TextAnchor};

/// Mapping of values onto an axis.
#[derive(Debug, Clone, Copy)]
pub(super) enum AxisScale {
    Linear {
        low: f64,
        high: f64,
        /// Distance between two ticks.
        step: f64,
    },
    /// Powers of ten from 10^low to 10^high.
    Log { low: i32, high: i32 },
}

/// A mark on an axis.
#[derive(Debug, Clone)]
pub(super) struct Tick {
    /// Position: 0 at the start of the axis, 1 at its end.
    pub at: f64,
    /// Text; empty for a minor tick.
    pub label: String,
}

impl AxisScale {
    pub const PERCENT: AxisScale = AxisScale::Linear { low: 0.0, high: 100.0, step: 25.0 };

    /// Covers zero and all values with round ends and at most `intervals + 2` steps of 1, 2 or 5 times a power of ten.
    pub fn linear(values: impl Iterator<Item = f64>, intervals: f64) -> Self {
        Self::between(range(values, (0.0, 0.0)), intervals)
    }

    /// Covers the values from `least` to `most` as [`AxisScale::linear`] does.
    pub fn between((least, most): (f64, f64), intervals: f64) -> Self {
        let most = if most > least { most } else { 1.0 };
        let span = most - least;
        let decade = 10f64.powf((span / intervals).log10().floor());
        let step = [1.0, 2.0, 5.0].map(|m| m * decade).into_iter().find(|s| span / s <= intervals);
        let step = step.unwrap_or(10.0 * decade);
        // A value beyond a mark by less than a line is thick needs no further step.
        let (low, high) = ((least / step + UNSEEN).floor() * step, (most / step - UNSEEN).ceil() * step);
        AxisScale::Linear { low, high, step }
    }

    /// Covers all (positive) values with whole decades, two at least.
    pub fn log(values: impl Iterator<Item = f64>) -> Self {
        let (least, most) = range(values.map(f64::log10), (f64::INFINITY, f64::NEG_INFINITY));
        let (low, high) = if least <= most { (least.floor() as i32, most.ceil() as i32) } else { (0, 2) };
        AxisScale::Log { low, high: high.max(low + 2) }
    }

    /// Position of a value: 0 at the start of the axis, 1 at its end.
    pub fn at(&self, value: f64) -> f64 {
        match *self {
            AxisScale::Linear { low, high, .. } => (value - low) / (high - low),
            AxisScale::Log { low, high } => (value.log10() - f64::from(low)) / f64::from(high - low),
        }
    }

    /// Marks, at most `labels` of them labelled if the scale is logarithmic.
    pub fn ticks(&self, labels: i32) -> Vec<Tick> {
        match *self {
            AxisScale::Linear { low, high, step } => {
                let decimals = (-step.log10().floor()).max(0.0) as usize;
                let count = ((high - low) / step).round() as i32;
                (0..=count)
                    .map(|k| low + f64::from(k) * step)
                    .map(|value| Tick { at: self.at(value), label: signed(value, decimals) })
                    .collect()
            }
            AxisScale::Log { low, high } => {
                let stride = (high - low).div_euclid(labels) + 1;
                (low..=high)
                    .map(|exponent| Tick {
                        at: f64::from(exponent - low) / f64::from(high - low),
                        label: if (exponent - low) % stride == 0 { power_of_ten(exponent) } else { String::new() },
                    })
                    .collect()
            }
        }
    }
}

/// Largest part of a step that is not seen; chosen: a step has some 30 pt, a line 0.6.
const UNSEEN: f64 = 5e-3;

fn range(values: impl Iterator<Item = f64>, start: (f64, f64)) -> (f64, f64) {
    values.fold(start, |(least, most), v| (least.min(v), most.max(v)))
}

/// A number with a proper minus sign and no minus before a zero.
pub(super) fn signed(value: f64, decimals: usize) -> String {
    let text = format!("{:.decimals$}", value.abs());
    let is_zero = text.chars().all(|c| c == '0' || c == '.');
    if value < 0.0 && !is_zero { format!("\u{2212}{text}") } else { text }
}

fn power_of_ten(exponent: i32) -> String {
    let digits = exponent.to_string();
    let raised = digits.chars().map(|c| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        _ => '⁰',
    });
    format!("10{}", raised.collect::<String>())
}

/// Length of a tick, pt; chosen, as all lengths of the figures.
const TICK_LENGTH: f64 = 2.5;

/// The box around a plot.
pub(super) fn frame(canvas: &mut Canvas, area: Area) {
    canvas.rect(area, Paint::stroke(Color::BLACK, 0.6));
}

/// Horizontal grid lines, and ticks on the left; their labels too where this panel carries them for its row.
pub(super) fn y_axis(canvas: &mut Canvas, area: Area, ticks: &[Tick], labelled: bool) {
    for tick in ticks {
        let y = area.bottom() - tick.at * area.height;
        if tick.at > 0.0 && tick.at < 1.0 && !tick.label.is_empty() {
            canvas.line((area.x, y), (area.right(), y), Paint::stroke(Color::LIGHT_GREY, 0.5));
        }
        canvas.line((area.x - TICK_LENGTH, y), (area.x, y), Paint::stroke(Color::BLACK, 0.6));
        if labelled && !tick.label.is_empty() {
            canvas.text(Label::new(area.x - TICK_LENGTH - 2.0, y + 2.9, tick.label.clone()).anchor(TextAnchor::End));
        }
    }
}

/// Ticks at the bottom; their labels too where this panel carries them for its column. `grid` adds vertical lines.
pub(super) fn x_axis(canvas: &mut Canvas, area: Area, ticks: &[Tick], labelled: bool, grid: bool) {
    for tick in ticks {
        let x = area.x + tick.at * area.width;
        if grid && tick.at > 0.0 && tick.at < 1.0 && !tick.label.is_empty() {
            canvas.line((x, area.y), (x, area.bottom()), Paint::stroke(Color::LIGHT_GREY, 0.5));
        }
        canvas.line((x, area.bottom()), (x, area.bottom() + TICK_LENGTH), Paint::stroke(Color::BLACK, 0.6));
        if labelled && !tick.label.is_empty() {
            canvas.text(Label::new(x, area.bottom() + TICK_LENGTH + SMALL_TEXT, tick.label.clone()).middle());
        }
    }
}

/// Width of the widest label.
pub(super) fn widest(canvas: &Canvas, ticks: &[Tick]) -> f64 {
    ticks.iter().map(|tick| canvas.fonts.width(&tick.label, SMALL_TEXT, false)).fold(0.0, f64::max)
}

/// The title of a vertical axis, read upwards, centred on the panel; broken into lines where the panel is short. It takes
/// [`y_title_width`] to the left of `right`.
pub(super) fn y_title(canvas: &mut Canvas, right: f64, area: Area, text: &str) {
    let lines = canvas.fonts.wrap(text, SMALL_TEXT, false, area.height + LARGEST_TITLE_OVERHANG);
    for (i, line) in lines.iter().rev().enumerate() {
        let x = right - LINE_SPACING * i as f64 - 2.5;
        canvas.text(Label::new(x, area.middle_y(), line.clone()).middle().upward());
    }
}

/// Largest excess of a vertical title over the length of its panel, pt; chosen: less breaks titles that have room, more lets them meet the titles of the next
/// panel.
const LARGEST_TITLE_OVERHANG: f64 = 14.0;

/// Width that [`y_title`] takes.
pub(super) fn y_title_width(canvas: &Canvas, height: f64, text: &str) -> f64 {
    LINE_SPACING * canvas.fonts.wrap(text, SMALL_TEXT, false, height + LARGEST_TITLE_OVERHANG).len() as f64
}

/// Distance of two lines of small text, pt; chosen: 1.25 times the height of the text.
pub(super) const LINE_SPACING: f64 = 10.0;

/// Bold lines at the top of the page, broken at its width. Returns the y below them.
pub(super) fn title(canvas: &mut Canvas, text: &str) -> f64 {
    let mut y = PAGE_MARGIN;
    for line in canvas.fonts.wrap(text, 10.0, true, canvas.width - 2.0 * PAGE_MARGIN) {
        y += 9.0;
        canvas.text(Label::new(PAGE_MARGIN, y, line).size(10.0).bold());
        y += 4.0;
    }
    y
}

/// Writes a note in grey below y, where the page ends.
pub(super) fn note(canvas: &mut Canvas, mut y: f64, text: &str) {
    for line in canvas.fonts.wrap(text, SMALL_TEXT, false, canvas.width - 2.0 * PAGE_MARGIN) {
        y += LINE_SPACING;
        canvas.text(Label::new(PAGE_MARGIN, y, line).color(Color::DARK_GREY));
    }
    canvas.height = y + PAGE_MARGIN;
}

/// White space around the page, pt; chosen: less cuts lines at the edge, more makes figures smaller.
pub(super) const PAGE_MARGIN: f64 = 4.0;

#[cfg(test)]
mod tests {
    use super::{AxisScale, signed};
    use proptest::prelude::*;

    fn labels(scale: AxisScale, most: i32) -> Vec<String> {
        scale.ticks(most).into_iter().map(|tick| tick.label).filter(|label| !label.is_empty()).collect()
    }

    #[test]
    fn ticks_are_round_numbers_with_as_many_decimals_as_they_need() {
        assert_eq!(
            labels(AxisScale::linear([-0.3, 1.07].into_iter(), 5.0), 0),
            ["\u{2212}0.5", "0.0", "0.5", "1.0", "1.5"]
        );
        assert_eq!(labels(AxisScale::linear([-1e-17, 1.3].into_iter(), 5.0), 0), ["0.0", "0.5", "1.0", "1.5"]);
        assert_eq!(labels(AxisScale::linear([812.0].into_iter(), 5.0), 0), ["0", "200", "400", "600", "800", "1000"]);
        assert_eq!(labels(AxisScale::log([2e-5, 3e-3].into_iter()), 8), ["10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²"]);
        assert_eq!(labels(AxisScale::log([1e-16, 1e4].into_iter()), 5), ["10⁻¹⁶", "10⁻¹¹", "10⁻⁶", "10⁻¹", "10⁴"]);
        assert_eq!(signed(-0.001, 2), "0.00");
    }

    proptest! {
        #[test]
        fn every_value_lies_on_its_axis(values in prop::collection::vec(-1e6..1e6f64, 1..9)) {
            let linear = AxisScale::linear(values.iter().copied(), 5.0);
            let log = AxisScale::log(values.iter().map(|v| v.abs() + 1e-9));
            for v in values {
                prop_assert!((-super::UNSEEN..=1.0 + super::UNSEEN).contains(&linear.at(v)));
                prop_assert!((-1e-9..=1.0 + 1e-9).contains(&log.at(v.abs() + 1e-9)));
            }
            prop_assert!(linear.ticks(0).len() <= 8);
        }
    }
}
