//! The display list as PDF: one page of the printed size, letters as outlines, so that no reader needs the font.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::{Content, Filter, Finish, Pdf, Rect, Ref};
use tiny_skia::{Path, PathSegment, Point};

use super::canvas::{Canvas, Color, Paint};
use super::error::FigureError;
use super::paths::paths;

/// The whole picture as a PDF document.
pub(super) fn to_pdf(canvas: &Canvas) -> Result<Vec<u8>, FigureError> {
    let (width, height) = (canvas.width as f32, canvas.height as f32);
    let mut content = Content::new();
    // Downwards, as everywhere else.
    content.transform([1.0, 0.0, 0.0, -1.0, 0.0, height]);
    for (path, paint) in paths(canvas) {
        draw(&mut content, &path, &paint);
    }
    let mut packed = ZlibEncoder::new(Vec::new(), Compression::default());
    packed.write_all(&content.finish()).map_err(FigureError::Pdf)?;
    let packed = packed.finish().map_err(FigureError::Pdf)?;
    let [catalog, pages, page, contents] = [1, 2, 3, 4].map(Ref::new);
    let mut pdf = Pdf::new();
    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).kids([page]).count(1);
    let mut only = pdf.page(page);
    only.parent(pages).media_box(Rect::new(0.0, 0.0, width, height)).contents(contents);
    only.resources();
    only.finish();
    pdf.stream(contents, &packed).filter(Filter::FlateDecode);
    Ok(pdf.finish())
}

fn draw(content: &mut Content, path: &Path, paint: &Paint) {
    let share = |part: u8| f32::from(part) / 255.0;
    if let Some(Color(r, g, b)) = paint.fill {
        content.set_fill_rgb(share(r), share(g), share(b));
    }
    if let Some((Color(r, g, b), width)) = paint.stroke {
        content.set_stroke_rgb(share(r), share(g), share(b)).set_line_width(width as f32);
        content.set_dash_pattern(paint.dash.map(|length| length as f32), 0.0);
    }
    // Hundredths of a point are finer than any printer.
    let short = |point: Point| [point.x, point.y].map(|x| (100.0 * x).round() / 100.0);
    let mut from = Point::zero();
    for segment in path.segments() {
        match segment {
            PathSegment::MoveTo(to) => {
                let [x, y] = short(to);
                content.move_to(x, y);
                from = to;
            }
            PathSegment::LineTo(to) => {
                let [x, y] = short(to);
                content.line_to(x, y);
                from = to;
            }
            PathSegment::QuadTo(by, to) => {
                // The same parabola as a cubic.
                let third = |end: Point| Point::from_xy(end.x + (by.x - end.x) / 1.5, end.y + (by.y - end.y) / 1.5);
                cubic(content, [third(from), third(to), to].map(short));
                from = to;
            }
            PathSegment::CubicTo(by, and, to) => {
                cubic(content, [by, and, to].map(short));
                from = to;
            }
            PathSegment::Close => {
                content.close_path();
            }
        }
    }
    match (paint.fill, paint.stroke) {
        (Some(_), Some(_)) => content.fill_nonzero_and_stroke(),
        (Some(_), None) => content.fill_nonzero(),
        (None, Some(_)) => content.stroke(),
        (None, None) => content.end_path(),
    };
}

fn cubic(content: &mut Content, [[x1, y1], [x2, y2], [x3, y3]]: [[f32; 2]; 3]) {
    content.cubic_to(x1, y1, x2, y2, x3, y3);
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;
    use crate::canvas::Label;

    #[test]
    fn the_document_has_one_page_of_the_size_of_the_picture_with_every_path_drawn_once() {
        let mut canvas = Canvas::new().unwrap();
        canvas.height = 100.0;
        canvas.line((0.0, 0.0), (10.0, 10.0), Paint::stroke(Color::BLACK, 1.0).dashed(2.0));
        canvas.circle((20.0, 20.0), 5.0, Paint::fill(Color::DARK_GREY).outlined(Color::BLACK, 0.5));
        canvas.text(Label::new(5.0, 50.0, "2 kHz").halo());
        let bytes = to_pdf(&canvas).unwrap();
        assert_eq!(bytes, to_pdf(&canvas).unwrap());
        let at = |wanted: &[u8]| bytes.windows(wanted.len()).position(|there| there == wanted).unwrap();
        assert_eq!(at(b"%PDF-"), 0);
        at(b"/MediaBox [0 0 510.2");
        let (from, to) = (at(b"stream\n") + b"stream\n".len(), at(b"\nendstream"));
        let mut drawn = String::new();
        flate2::read::ZlibDecoder::new(&bytes[from..to]).read_to_string(&mut drawn).unwrap();
        let painted: Vec<&str> = drawn.lines().filter(|line| ["f", "S", "B"].contains(line)).collect();
        assert_eq!(painted, ["S", "B", "S", "f"], "{drawn}");
        assert!(drawn.starts_with("1 0 0 -1 0 100 cm\n") && drawn.contains("[2] 0 d"), "{drawn}");
    }
}
