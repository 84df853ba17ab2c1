//! A panel with two axes of numbers.

use super::axis::{AxisScale, LINE_SPACING, widest, x_axis, y_axis, y_title, y_title_width};
use super::canvas::{Area, Canvas, Label, SMALL_TEXT};

/// Room below a panel for the ticks and the name of its horizontal axis, pt.
pub(super) const BELOW: f64 = SMALL_TEXT + LINE_SPACING + 2.0;

/// Most labels of an axis of decades.
const LABELS: i32 = 8;

/// Horizontal and vertical axis of a panel, with their names.
pub(super) struct Plot {
    pub scales: [AxisScale; 2],
    pub labels: [String; 2],
}

impl Plot {
    /// Room for the vertical axis of a panel of that height.
    pub fn left(&self, canvas: &Canvas, height: f64) -> f64 {
        y_title_width(canvas, height, &self.labels[1]) + self.numbers(canvas)
    }

    fn numbers(&self, canvas: &Canvas) -> f64 {
        widest(canvas, &self.scales[1].ticks(LABELS)) + 6.0
    }

    /// Grid, ticks and names of the axes.
    pub fn axes(&self, canvas: &mut Canvas, area: Area) {
        let [x, y] = self.scales;
        y_axis(canvas, area, &y.ticks(LABELS), true);
        x_axis(canvas, area, &x.ticks((area.width / 32.0) as i32), true, true);
        y_title(canvas, area.x - self.numbers(canvas), area, &self.labels[1]);
        canvas.text(Label::new(area.middle_x(), area.bottom() + BELOW, self.labels[0].clone()).middle());
    }

    /// Place of a point.
    pub fn place(&self, area: Area, [x, y]: [f64; 2]) -> (f64, f64) {
        (area.x + self.scales[0].at(x) * area.width, area.bottom() - self.scales[1].at(y) * area.height)
    }
}

/// The part of a line between the upper and the lower edge of an area.
pub(super) fn inside(from: (f64, f64), to: (f64, f64), area: Area) -> Option<((f64, f64), (f64, f64))> {
    let (top, bottom) = (area.y, area.bottom());
    if from.1.max(to.1) < top || from.1.min(to.1) > bottom {
        return None;
    }
    let moved = |end: (f64, f64), other: (f64, f64)| {
        let y = end.1.clamp(top, bottom);
        let part = if y == end.1 { 0.0 } else { (y - end.1) / (other.1 - end.1) };
        (end.0 + part * (other.0 - end.0), y)
    };
    Some((moved(from, to), moved(to, from)))
}
