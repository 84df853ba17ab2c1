//! The display list as PNG.

use std::io::Write;

use tiny_skia::{FillRule, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform};
use ttf_parser::OutlineBuilder;

use super::canvas::{Canvas, Color, Item, Label, Paint, TextAnchor};
use super::error::FigureError;

const DOTS_PER_INCH: f64 = 300.0;

/// The whole picture at 300 dots per inch of its printed size, which the file states.
pub(super) fn to_png(canvas: &Canvas) -> Result<Vec<u8>, FigureError> {
    let scale = DOTS_PER_INCH / 72.0;
    let (width, height) = ((canvas.width * scale).round() as u32, (canvas.height * scale).round() as u32);
    let mut page = Page {
        pixels: Pixmap::new(width, height).ok_or(FigureError::PictureSize { width, height })?,
        transform: Transform::from_scale(scale as f32, scale as f32),
    };
    page.pixels.fill(tiny_skia::Color::WHITE);
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
                page.draw(path.finish(), paint);
            }
            Item::Circle { center, radius, paint } => {
                page.draw(PathBuilder::from_circle(center.0 as f32, center.1 as f32, *radius as f32), paint);
            }
            Item::Text(label) => page.write(label, canvas),
        }
    }
    encode(&page.pixels)
}

struct Page {
    pixels: Pixmap,
    transform: Transform,
}

impl Page {
    /// Draws a path; none (an empty one) draws nothing.
    fn draw(&mut self, path: Option<Path>, paint: &Paint) {
        let Some(path) = path else { return };
        if let Some(color) = paint.fill {
            self.pixels.fill_path(&path, &solid(color), FillRule::Winding, self.transform, None);
        }
        if let Some((color, width)) = paint.stroke {
            let dash = paint.dash.and_then(|length| StrokeDash::new(vec![length as f32; 2], 0.0));
            let stroke = Stroke { width: width as f32, dash, ..Stroke::default() };
            self.pixels.stroke_path(&path, &solid(color), &stroke, self.transform, None);
        }
    }

    fn write(&mut self, label: &Label, canvas: &Canvas) {
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
        let path = pen.0.finish();
        if label.halo {
            self.draw(path.clone(), &Paint::stroke(Color::WHITE, 2.0));
        }
        self.draw(path, &Paint::fill(label.color));
    }
}

fn solid(color: Color) -> tiny_skia::Paint<'static> {
    let mut paint = tiny_skia::Paint { anti_alias: true, ..tiny_skia::Paint::default() };
    paint.set_color_rgba8(color.0, color.1, color.2, 255);
    paint
}

/// The picture as PNG: without transparency, since the page is white throughout, and with the resolution that gives the printed size.
fn encode(pixels: &Pixmap) -> Result<Vec<u8>, FigureError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, pixels.width(), pixels.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let per_metre = (DOTS_PER_INCH / 0.0254).round() as u32;
    encoder.set_pixel_dims(Some(png::PixelDimensions { xppu: per_metre, yppu: per_metre, unit: png::Unit::Meter }));
    let mut header = encoder.write_header()?;
    let mut writer = header.stream_writer()?;
    for row in pixels.pixels().chunks(pixels.width() as usize) {
        let rgb: Vec<u8> = row.iter().flat_map(|p| [p.red(), p.green(), p.blue()]).collect();
        writer.write_all(&rgb).map_err(png::EncodingError::from)?;
    }
    writer.finish()?;
    drop(header);
    Ok(bytes)
}

/// Collects glyph outlines.
struct Pen(PathBuilder);

impl OutlineBuilder for Pen {
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
