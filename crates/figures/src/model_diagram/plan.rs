//! The lattice from above.

use super::super::axis::LINE_SPACING;
use super::super::canvas::{Area, Canvas, Color, Label, Paint};
use super::super::style::{BLUE, VERMILLION, arrow};
use super::diagram::ModelDiagram;
use super::elements::{spring, symbol};

/// Half the side of the square that stands for an oscillator, pt; chosen: its number fits into it.
const OSCILLATOR_HALF_SIDE: f64 = 9.0;

/// The lattice from above. Returns the y below.
pub(super) fn plan(canvas: &mut Canvas, data: &ModelDiagram, area: Area) -> f64 {
    canvas.text(Label::new(area.x, area.y + 9.0, "(a) plan view").size(9.0).bold());
    let pitch = (area.width / (data.columns as f64 + 1.0)).min(area.height / (data.rows as f64 + 1.0));
    let (x0, y0) = (area.x + 4.0, area.y + 20.0);
    let (right, bottom) = (x0 + pitch * (data.columns as f64 + 1.0), y0 + pitch * (data.rows as f64 + 1.0));
    let center = |row: usize, column: usize| (x0 + pitch * (column as f64 + 1.0), y0 + pitch * (row as f64 + 1.0));
    let walls = Area { x: x0, y: y0, width: right - x0, height: bottom - y0 };
    canvas.rect(walls, Paint::stroke(Color::DARK_GREY, 1.8));
    let gap = |k: usize, count: usize| {
        (if k == 0 { 0.0 } else { OSCILLATOR_HALF_SIDE }, if k == count { 0.0 } else { OSCILLATOR_HALF_SIDE })
    };
    for row in 0..data.rows {
        for k in 0..=data.columns {
            let (before, after) = gap(k, data.columns);
            let (x, y) = (x0 + pitch * k as f64, center(row, 0).1);
            spring(canvas, (x + before, y), (x + pitch - after, y), BLUE);
            let number = (row * (data.columns + 1) + k + 1).to_string();
            canvas.text(Label::new(x + (pitch + before - after) / 2.0, y - 5.5, number).middle().color(BLUE));
        }
    }
    for column in 0..data.columns {
        for k in 0..=data.rows {
            let (before, after) = gap(k, data.rows);
            let (x, y) = (center(0, column).0, y0 + pitch * k as f64);
            spring(canvas, (x, y + before), (x, y + pitch - after), VERMILLION);
            let number = (column * (data.rows + 1) + k + 1).to_string();
            canvas.text(Label::new(x + 6.0, y + (pitch + before - after) / 2.0 + 3.0, number).color(VERMILLION));
        }
    }
    for (i, &contact) in data.in_contact.iter().enumerate() {
        let (x, y) = center(i / data.columns, i % data.columns);
        let fill = if contact { Color::LIGHT_GREY } else { Color::WHITE };
        let square = Area {
            x: x - OSCILLATOR_HALF_SIDE,
            y: y - OSCILLATOR_HALF_SIDE,
            width: 2.0 * OSCILLATOR_HALF_SIDE,
            height: 2.0 * OSCILLATOR_HALF_SIDE,
        };
        canvas.group("body", format!("oscillator {}", i + 1), |canvas| {
            canvas.rect(square, Paint::fill(fill).outlined(Color::BLACK, 0.8));
            canvas.text(Label::new(x, y + 3.0, (i + 1).to_string()).bold().middle());
        });
    }
    let y = bottom + 14.0;
    arrow(canvas, (x0, y), (x0 + 18.0, y), Color::BLACK);
    canvas.text(Label::new(x0 + 21.0, y + 2.5, "x, and sliding of the plate at v"));
    arrow(canvas, (right - 8.0, y - 8.0), (right - 8.0, y + 10.0), Color::BLACK);
    canvas.text(Label::new(right - 2.0, y + 6.0, "y"));
    let mut y = y + 22.0;
    let counts = [data.rows * (data.columns + 1), data.columns * (data.rows + 1)];
    for (axis, count, color) in [("x", counts[0], BLUE), ("y", counts[1], VERMILLION)] {
        let range = format!("1\u{2013}{count}");
        spring(canvas, (x0, y - 3.0), (x0 + 36.0, y - 3.0), color);
        let behind = symbol(canvas, (x0 + 41.0, y), ["k", axis, &range], color);
        let behind = symbol(canvas, (behind + 8.0, y), ["c", axis, &range], color);
        canvas.text(Label::new(behind + 8.0, y, format!("springs in {axis}, by number, a dashpot beside each")));
        y += 20.0;
    }
    let text = format!("m\u{a0}1\u{2013}{}: oscillators; grey: in contact with the plate", data.rows * data.columns);
    canvas.text(Label::new(x0, y - 4.0, text));
    y - 4.0 + 0.2 * LINE_SPACING
}
