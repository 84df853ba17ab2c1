//! The font of the figures: Arimo, whose letters are as wide as those of Arial and Helvetica. The layout measures with it,
//! the PNG is drawn with it, and the SVG names it with its equals as substitutes.

use skrifa::charmap::Charmap;
use skrifa::instance::{LocationRef, Size};
use skrifa::metrics::GlyphMetrics;
use skrifa::outline::{DrawSettings, OutlineGlyphCollection, OutlinePen};
use skrifa::{FontRef, GlyphId, MetadataProvider};

use super::error::FigureError;

/// Families for the SVG, best first. The first four have the same widths; DejaVu is named because some viewers do not know
/// what "sans-serif" is on a machine that has no other.
pub(super) const FONT_FAMILIES: &str = "Arimo, Arial, Helvetica, 'Liberation Sans', 'DejaVu Sans', sans-serif";

/// The font in both weights.
pub(super) struct Fonts {
    regular: Face,
    bold: Face,
}

/// A weight of the font, in its own units.
struct Face {
    glyphs: Charmap<'static>,
    metrics: GlyphMetrics<'static>,
    outlines: OutlineGlyphCollection<'static>,
    units_per_em: f32,
}

impl Face {
    fn new(file: &'static [u8]) -> Result<Self, FigureError> {
        let font = FontRef::new(file)?;
        let (size, location) = (Size::unscaled(), LocationRef::default());
        Ok(Self {
            glyphs: font.charmap(),
            metrics: font.glyph_metrics(size, location),
            outlines: font.outline_glyphs(),
            units_per_em: f32::from(font.metrics(size, location).units_per_em),
        })
    }

    /// The glyph of a character; one that the font lacks becomes the box of glyph 0, as browsers show it.
    fn glyph(&self, c: char) -> GlyphId {
        self.glyphs.map(c).unwrap_or_default()
    }

    fn advance(&self, id: GlyphId) -> f32 {
        self.metrics.advance_width(id).unwrap_or_default()
    }
}

impl Fonts {
    pub fn load() -> Result<Self, FigureError> {
        Ok(Self {
            regular: Face::new(include_bytes!("fonts/arimo-regular.ttf"))?,
            bold: Face::new(include_bytes!("fonts/arimo-bold.ttf"))?,
        })
    }

    fn face(&self, bold: bool) -> &Face {
        if bold { &self.bold } else { &self.regular }
    }

    /// Width of one line of text in points.
    pub fn width(&self, text: &str, size: f64, bold: bool) -> f64 {
        let face = self.face(bold);
        let units: f64 = text.chars().map(|c| f64::from(face.advance(face.glyph(c)))).sum();
        units * size / f64::from(face.units_per_em)
    }

    /// Breaks text at its (breaking) spaces into lines no wider than `limit`; a single word that is wider stands alone.
    pub fn wrap(&self, text: &str, size: f64, bold: bool, limit: f64) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        for word in text.split(' ').filter(|word| !word.is_empty()) {
            match lines.last_mut() {
                Some(line) if self.width(&format!("{line} {word}"), size, bold) <= limit => {
                    line.push(' ');
                    line.push_str(word);
                }
                _ => lines.push(word.to_owned()),
            }
        }
        lines
    }

    /// Sends the outlines of a text to `pen`, one glyph after the other. `place` maps (x, y), in points from the start of
    /// the baseline with y upwards, onto the page.
    pub fn outline(
        &self,
        text: &str,
        size: f64,
        bold: bool,
        place: impl Fn(f32, f32) -> (f32, f32),
        pen: &mut impl OutlinePen,
    ) {
        let face = self.face(bold);
        let scale = size as f32 / face.units_per_em;
        let mut start = 0.0;
        for c in text.chars() {
            let id = face.glyph(c);
            let to_page = |x: f32, y: f32| place(start + x * scale, y * scale);
            let mut placed = Placed { pen, to_page };
            if id == GlyphId::NOTDEF {
                unknown(face.advance(id), &mut placed);
            } else if let Some(outline) = face.outlines.get(id) {
                let settings = DrawSettings::unhinted(Size::unscaled(), LocationRef::default());
                // The font is our own: its outlines can be read.
                let _ = outline.draw(settings, &mut placed);
            }
            start += face.advance(id) * scale;
        }
    }
}

/// The box that stands for a character that the font lacks, as in browsers: a ring, as wide as glyph 0, which is empty here.
fn unknown(width: f32, pen: &mut impl OutlinePen) {
    // Outwards from the middle of the box: half of its width, its height and the width of its line, in units of the font, 2,048 a size.
    let (middle, [half, height, line]) = (0.5 * width, [0.36 * width, 1400.0, 110.0]);
    let mut rectangle = |corners: [(f32, f32); 4]| {
        pen.move_to(corners[0].0, corners[0].1);
        corners[1..].iter().for_each(|&(x, y)| pen.line_to(x, y));
        pen.close();
    };
    let (left, right) = (middle - half, middle + half);
    rectangle([(left, 0.0), (right, 0.0), (right, height), (left, height)]);
    // The other way round, so that it is a hole.
    let (left, right) = (left + line, right - line);
    rectangle([(left, line), (left, height - line), (right, height - line), (right, line)]);
}

/// Moves an outline to its place on the page.
struct Placed<'a, P, F> {
    pen: &'a mut P,
    to_page: F,
}

impl<P: OutlinePen, F: Fn(f32, f32) -> (f32, f32)> OutlinePen for Placed<'_, P, F> {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = (self.to_page)(x, y);
        self.pen.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = (self.to_page)(x, y);
        self.pen.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = ((self.to_page)(x1, y1), (self.to_page)(x, y));
        self.pen.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = ((self.to_page)(x1, y1), (self.to_page)(x2, y2), (self.to_page)(x, y));
        self.pen.curve_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.pen.close();
    }
}
