//! Colours of Okabe and Ito, hatching and markers: every distinction is made twice, once in colour and once without.

use super::canvas::{Area, Canvas, Color, Paint};

pub(super) const BLUE: Color = Color(0, 114, 178);
pub(super) const ORANGE: Color = Color(230, 159, 0);
pub(super) const GREEN: Color = Color(0, 158, 115);
pub(super) const VERMILLION: Color = Color(213, 94, 0);
pub(super) const PURPLE: Color = Color(204, 121, 167);
pub(super) const SKY: Color = Color(86, 180, 233);

/// Look of the boxes of one series.
#[derive(Debug, Clone, Copy)]
pub(super) struct BoxStyle {
    pub fill: Color,
    pub line: Color,
    pub median: Color,
    /// Colour of the diagonal hatching.
    pub hatch: Option<Color>,
}

/// Look of the boxes of a series, by its index: dark and solid, light and hatched, white; then the same in other colours.
pub(super) fn box_style(series: usize) -> BoxStyle {
    const STYLES: [BoxStyle; 4] = [
        BoxStyle { fill: BLUE, line: Color(0, 62, 102), median: Color::WHITE, hatch: None },
        BoxStyle {
            fill: Color(253, 232, 190),
            line: Color(140, 90, 0),
            median: Color::BLACK,
            hatch: Some(Color(214, 148, 0)),
        },
        BoxStyle { fill: Color::WHITE, line: Color(0, 110, 80), median: Color(0, 110, 80), hatch: None },
        BoxStyle { fill: PURPLE, line: Color(110, 50, 85), median: Color::BLACK, hatch: Some(Color(150, 75, 115)) },
    ];
    STYLES[series % STYLES.len()]
}

/// A box with its outline and hatching.
pub(super) fn filled_box(canvas: &mut Canvas, area: Area, style: BoxStyle) {
    canvas.rect(area, Paint::fill(style.fill));
    if let Some(color) = style.hatch {
        let spacing = 3.0;
        let first = ((area.x - area.bottom()) / spacing).ceil() as i64;
        let last = ((area.right() - area.y) / spacing).floor() as i64;
        for k in first..=last {
            // The line x - y = d, cut at the sides of the box. Anchored to the page, so that neighbours match.
            let d = k as f64 * spacing;
            let (from, to) = (area.x.max(area.y + d), area.right().min(area.bottom() + d));
            if from < to {
                canvas.line((from, from - d), (to, to - d), Paint::stroke(color, 0.6));
            }
        }
    }
    canvas.rect(area, Paint::stroke(style.line, 0.6));
}

/// Colour, shape and dash of one series of points.
#[derive(Debug, Clone, Copy)]
pub(super) struct PointStyle {
    pub color: Color,
    pub dash: Option<f64>,
    shape: usize,
    filled: bool,
}

/// Seven colours and seven shapes, filled at first and open for the next seven series.
pub(super) fn point_style(series: usize) -> PointStyle {
    const COLORS: [Color; 7] = [BLUE, VERMILLION, GREEN, Color::BLACK, PURPLE, ORANGE, SKY];
    let (round, i) = (series / COLORS.len(), series % COLORS.len());
    let shape = (i + round) % 7;
    PointStyle { color: COLORS[i], dash: (round % 2 == 1).then_some(3.0), shape, filled: round % 2 == 0 }
}

/// The marker of a series.
pub(super) fn marker(canvas: &mut Canvas, at: (f64, f64), style: PointStyle) {
    let r = 2.7;
    let paint = if style.filled {
        Paint::fill(style.color).outlined(Color::WHITE, 0.4)
    } else {
        Paint::fill(Color::WHITE).outlined(style.color, 1.0)
    };
    let around = |corners: &[(f64, f64)]| corners.iter().map(|c| (at.0 + r * c.0, at.1 + r * c.1)).collect::<Vec<_>>();
    match style.shape {
        0 => canvas.circle(at, r, paint),
        1 => canvas.polygon(around(&[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)]), paint),
        2 => canvas.polygon(around(&[(0.0, -1.2), (1.1, 0.8), (-1.1, 0.8)]), paint),
        3 => canvas.polygon(around(&[(0.0, -1.3), (1.3, 0.0), (0.0, 1.3), (-1.3, 0.0)]), paint),
        4 => canvas.polygon(around(&[(0.0, 1.2), (1.1, -0.8), (-1.1, -0.8)]), paint),
        5 => {
            let (a, b) = (0.45, 1.2);
            let plus =
                [(-a, -b), (a, -b), (a, -a), (b, -a), (b, a), (a, a), (a, b), (-a, b), (-a, a), (-b, a), (-b, -a)];
            canvas.polygon(around(&[&plus[..], &[(-a, -a)]].concat()), paint);
        }
        _ => canvas.polygon(around(&[(-1.2, -0.7), (0.0, -1.3), (1.2, -0.7), (0.75, 1.0), (-0.75, 1.0)]), paint),
    }
}

/// A full diamond: a box of one value.
pub(super) fn diamond(canvas: &mut Canvas, (x, y): (f64, f64), r: f64, style: BoxStyle) {
    let fill = style.hatch.unwrap_or(style.fill);
    canvas.polygon(vec![(x, y - r), (x + r, y), (x, y + r), (x - r, y)], Paint::fill(fill).outlined(style.line, 0.6));
}

/// An arrow with a head no longer than itself; nothing where it would not be seen.
pub(super) fn arrow(canvas: &mut Canvas, from: (f64, f64), to: (f64, f64), color: Color) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = dx.hypot(dy);
    if length < 0.8 {
        return;
    }
    let (ux, uy) = (dx / length, dy / length);
    let head = (0.55 * length).min(5.0);
    let neck = (to.0 - head * ux, to.1 - head * uy);
    canvas.line(from, neck, Paint::stroke(color, 1.3));
    let half = 0.42 * head;
    let side = |s: f64| (neck.0 - s * half * uy, neck.1 + s * half * ux);
    canvas.polygon(vec![to, side(1.0), side(-1.0)], Paint::fill(color));
}
