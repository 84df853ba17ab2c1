//! Colours for numbers, from dark to light, in an order that colour-blind readers and grey print keep.

use super::axis::{AxisScale, LINE_SPACING, PAGE_MARGIN, x_axis};
use super::canvas::{Area, Canvas, Color, Label, Paint, SMALL_TEXT};

/// Colours at equal steps of viridis (van der Walt and Smith, matplotlib 2015, CC0), without its lightest part.
const COLORS: [Color; 7] = [
    Color(68, 1, 84),
    Color(70, 50, 127),
    Color(54, 92, 141),
    Color(39, 127, 142),
    Color(31, 161, 135),
    Color(74, 194, 109),
    Color(159, 218, 58),
];

/// The colour at a part of the scale, 0 to 1.
pub(super) fn color(part: f64) -> Color {
    let place = part.clamp(0.0, 1.0) * (COLORS.len() - 1) as f64;
    let lower = (place as usize).min(COLORS.len() - 2);
    let (a, b, part) = (COLORS[lower], COLORS[lower + 1], place - lower as f64);
    let mixed = |a: u8, b: u8| (f64::from(a) + part * (f64::from(b) - f64::from(a))).round() as u8;
    Color(mixed(a.0, b.0), mixed(a.1, b.1), mixed(a.2, b.2))
}

/// A bar of the colours between `from` and `to` with its axis and name, from (left margin, `top`) on. Returns the y below it.
pub(super) fn bar(canvas: &mut Canvas, top: f64, axis: AxisScale, [from, to]: [f64; 2], name: &str) -> f64 {
    const STEPS: usize = 64;
    let name_width = canvas.fonts.width(name, SMALL_TEXT, false) + 10.0;
    let area = Area { x: PAGE_MARGIN + name_width, y: top, width: 200.0, height: 8.0 };
    canvas.text(Label::new(PAGE_MARGIN, area.bottom(), name).color(Color::DARK_GREY));
    let ends = [axis.at(from), axis.at(to)];
    let [left, right] = ends.map(|part| area.x + part * area.width);
    let width = (right - left) / STEPS as f64;
    for step in 0..STEPS {
        // Half a point of overlap: no seams.
        let piece = Area { x: left + step as f64 * width, width: width + 0.5, ..area };
        canvas.rect(piece, Paint::fill(color((step as f64 + 0.5) / STEPS as f64)));
    }
    // Marks beyond the colours only where there are not two beside them, as of a part of a decade.
    let (beside, beyond): (Vec<_>, Vec<_>) =
        axis.ticks(8).into_iter().partition(|tick| (ends[0] - 1e-9..=ends[1] + 1e-9).contains(&tick.at));
    x_axis(canvas, area, &beside, true, false);
    if beside.len() < 2 {
        x_axis(canvas, area, &beyond, true, false);
    }
    area.bottom() + SMALL_TEXT + LINE_SPACING
}

/// White to dark orange: `step` of `steps`, for counts from 0 on.
pub(super) fn count_color(step: usize, steps: usize) -> Color {
    const ENDS: [Color; 3] = [Color(255, 255, 255), Color(245, 190, 110), Color(150, 55, 0)];
    let place = 2.0 * step as f64 / steps.max(1) as f64;
    let lower = (place as usize).min(1);
    let (a, b, part) = (ENDS[lower], ENDS[lower + 1], place - lower as f64);
    let mixed = |a: u8, b: u8| (f64::from(a) + part * (f64::from(b) - f64::from(a))).round() as u8;
    Color(mixed(a.0, b.0), mixed(a.1, b.1), mixed(a.2, b.2))
}
