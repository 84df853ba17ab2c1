//! Springs, dashpots, walls and symbols.

use super::super::canvas::{Canvas, Color, Label, Paint, SMALL_TEXT};

/// A zigzag along a line.
pub(super) fn spring(canvas: &mut Canvas, from: (f64, f64), to: (f64, f64), color: Color) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = dx.hypot(dy).max(1e-9);
    let (ux, uy) = (dx / length, dy / length);
    let teeth = 6;
    let lead = 0.2;
    let at = |along: f64, aside: f64| (from.0 + along * dx - aside * uy, from.1 + along * dy + aside * ux);
    let mut points = vec![from, at(lead, 0.0)];
    for k in 0..teeth {
        let along = lead + (1.0 - 2.0 * lead) * (f64::from(k) + 0.5) / f64::from(teeth);
        points.push(at(along, if k % 2 == 0 { 3.5 } else { -3.5 }));
    }
    points.extend([at(1.0 - lead, 0.0), to]);
    canvas.polyline(points, Paint::stroke(color, 0.9));
}

/// A vertical dashpot.
pub(super) fn dashpot(canvas: &mut Canvas, from: (f64, f64), to: (f64, f64)) {
    let line = Paint::stroke(Color::BLACK, 0.9);
    let middle = (from.1 + to.1) / 2.0;
    let toward = (to.1 - from.1).signum();
    canvas.line(from, (from.0, middle), line);
    canvas.line((from.0 - 3.2, middle), (from.0 + 3.2, middle), line);
    let (open, shut) = (middle - 4.0 * toward, middle + 5.0 * toward);
    let cup = vec![(from.0 - 4.8, open), (from.0 - 4.8, shut), (from.0 + 4.8, shut), (from.0 + 4.8, open)];
    canvas.polyline(cup, line);
    canvas.line((from.0, shut), to, line);
}

/// A fixed surface, hatched on its far side (`side` -1: above, 1: below).
pub(super) fn ground(canvas: &mut Canvas, (x, y): (f64, f64), width: f64, side: f64) {
    canvas.line((x, y), (x + width, y), Paint::stroke(Color::BLACK, 1.2));
    for k in 0..(width / 6.0) as usize {
        let start = x + 6.0 * k as f64;
        canvas.line((start, y + 5.0 * side), (start + 5.0, y), Paint::stroke(Color::DARK_GREY, 0.5));
    }
}

/// A letter with an index above and one below; either may be empty. Returns the x behind it.
pub(super) fn symbol(canvas: &mut Canvas, (x, y): (f64, f64), [letter, above, below]: [&str; 3], color: Color) -> f64 {
    let size = 10.0;
    canvas.text(Label::new(x, y, letter).size(size).color(color));
    let behind = x + canvas.fonts.width(letter, size, false) + 0.4;
    canvas.text(Label::new(behind, y - 5.0, above).color(color));
    canvas.text(Label::new(behind, y + 3.6, below).color(color));
    let width = |text: &str| canvas.fonts.width(text, SMALL_TEXT, false);
    behind + width(above).max(width(below))
}

/// The arc of an angle, from one direction to another, radians from the x axis towards y downwards.
pub(super) fn arc(canvas: &mut Canvas, center: (f64, f64), radius: f64, [from, to]: [f64; 2]) {
    let at = |k: i32| {
        let angle = from + (to - from) * f64::from(k) / 24.0;
        (center.0 + radius * angle.cos(), center.1 + radius * angle.sin())
    };
    canvas.polyline((0..=24).map(at).collect(), Paint::stroke(Color::BLACK, 0.7));
}
