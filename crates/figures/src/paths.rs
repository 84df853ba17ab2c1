//! The display list as filled and outlined paths, letters as their outlines: what pixels and PDF are made of.

use skrifa::outline::OutlinePen;
use tiny_skia::{Path, PathBuilder};

use super::canvas::{Canvas, Color, Item, Label, Paint, TextAnchor};

/// The paths of a picture, in points, from the lowest to the topmost; an empty item has no path.
pub(super) fn paths(canvas: &Canvas) -> Vec<(Path, Paint)> {
    let mut all = Vec::new();
    for item in &canvas.items {
        match item {
            Item::Open { .. } | Item::Close => {}
            Item::Path { points, closed, paint } => {
                let mut path = PathBuilder::new();
                for (i, &(x, y)) in points.iter().enumerate() {
                    let (x, y) = (x as f32, y as f32);
                    if i == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
                }
                if *closed {
                    path.close();
                }
                all.extend(path.finish().map(|path| (path, *paint)));
            }
            Item::Circle { center, radius, paint } => {
                let circle = PathBuilder::from_circle(center.0 as f32, center.1 as f32, *radius as f32);
                all.extend(circle.map(|circle| (circle, *paint)));
            }
            Item::Text(label) => {
                let Some(letters) = letters(label, canvas) else { continue };
                if label.halo {
                    all.push((letters.clone(), Paint::stroke(Color::WHITE, 2.0)));
                }
                all.push((letters, Paint::fill(label.color)));
            }
        }
    }
    all
}

/// Outlines of the letters of a label.
fn letters(label: &Label, canvas: &Canvas) -> Option<Path> {
    let width = canvas.fonts.width(&label.text, label.size, label.bold);
    let before = match label.anchor {
        TextAnchor::Start => 0.0,
        TextAnchor::Middle => width / 2.0,
        TextAnchor::End => width,
    } as f32;
    let (x0, y0) = (label.at.0 as f32, label.at.1 as f32);
    let place = |x: f32, y: f32| {
        let along = x - before;
        if label.upward { (x0 - y, y0 - along) } else { (x0 + along, y0 - y) }
    };
    let mut pen = Pen(PathBuilder::new());
    canvas.fonts.outline(&label.text, label.size, label.bold, place, &mut pen);
    pen.0.finish()
}

/// Collects glyph outlines.
struct Pen(PathBuilder);

impl OutlinePen for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.0.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.0.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.0.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.0.close();
    }
}
