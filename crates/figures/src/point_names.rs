//! Names of points in a panel, where they do not cover each other.

use super::axis::LINE_SPACING;
use super::canvas::{Area, Canvas, Color, Label, Paint, SMALL_TEXT};

/// Room in the corner of a panel for how many points have no name, pt; chosen: the width of that text.
const NOT_NAMED_WIDTH: f64 = 90.0;

/// Writes names above their points, as low as there is room in the panel; how many have none is written in its corner.
pub(super) fn write_names(canvas: &mut Canvas, area: Area, mut points: Vec<(&str, (f64, f64))>) {
    points.sort_by(|a, b| a.1.0.total_cmp(&b.1.0));
    // Left and right end and baseline of each name that is written, the corner's first.
    let corner = area.y + SMALL_TEXT + 2.0;
    let mut written = vec![[area.right() - NOT_NAMED_WIDTH, area.right(), corner]];
    let mut not_named = 0;
    for (name, (x, y)) in points {
        let width = canvas.fonts.width(name, SMALL_TEXT, false);
        let left = (x - 0.5 * width).clamp(area.x + 1.0, (area.right() - width - 1.0).max(area.x + 1.0));
        let is_free = |baseline: &f64| {
            let is_over = |[from, to, at]: &[f64; 3]| {
                *from < left + width + 3.0 && left < *to + 3.0 && (at - baseline).abs() < LINE_SPACING
            };
            !written.iter().any(is_over)
        };
        let levels = (0..).map(|level| y - 7.0 - LINE_SPACING * f64::from(level)).take_while(|at| *at >= corner);
        let Some(baseline) = levels.into_iter().find(is_free) else {
            not_named += 1;
            continue;
        };
        written.push([left, left + width, baseline]);
        if baseline < y - 7.0 {
            canvas.line((x, y - 4.0), (x, baseline + 1.0), Paint::stroke(Color::DARK_GREY, 0.4));
        }
        canvas.text(Label::new(left, baseline, name.to_owned()).halo());
    }
    if not_named > 0 {
        let text = format!("{not_named} more in the table");
        let left = area.right() - canvas.fonts.width(&text, SMALL_TEXT, false) - 2.0;
        canvas.text(Label::new(left, corner, text).color(Color::DARK_GREY).halo());
    }
}
