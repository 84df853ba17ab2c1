//! The display list as PNG.

use std::io::Write;

use tiny_skia::{FillRule, Pixmap, Stroke, StrokeDash, Transform};

use super::canvas::{Canvas, Color};
use super::error::FigureError;
use super::paths::paths;

const DOTS_PER_INCH: f64 = 300.0;

/// The whole picture at 300 dots per inch of its printed size, which the file states.
pub(super) fn to_png(canvas: &Canvas) -> Result<Vec<u8>, FigureError> {
    let scale = DOTS_PER_INCH / 72.0;
    let (width, height) = ((canvas.width * scale).round() as u32, (canvas.height * scale).round() as u32);
    let mut pixels = Pixmap::new(width, height).ok_or(FigureError::PictureSize { width, height })?;
    let transform = Transform::from_scale(scale as f32, scale as f32);
    pixels.fill(tiny_skia::Color::WHITE);
    for (path, paint) in paths(canvas) {
        if let Some(color) = paint.fill {
            pixels.fill_path(&path, &solid(color), FillRule::Winding, transform, None);
        }
        if let Some((color, width)) = paint.stroke {
            let dash = paint.dash.and_then(|length| StrokeDash::new(vec![length as f32; 2], 0.0));
            let stroke = Stroke { width: width as f32, dash, ..Stroke::default() };
            pixels.stroke_path(&path, &solid(color), &stroke, transform, None);
        }
    }
    encode(&pixels)
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
    // Chosen: level 6 and a filter for each row take nine times as long, a third of a small study, for files of two thirds the size.
    encoder.set_deflate_compression(png::DeflateCompression::Level(1));
    encoder.set_filter(png::Filter::Up);
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
