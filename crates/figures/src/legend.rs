//! The key below or above the panels: symbols with their names, flowing over as many lines as they need.

use super::axis::{LINE_SPACING, PAGE_MARGIN};
use super::canvas::{Canvas, Color, Label, SMALL_TEXT};

/// Draws a symbol centred on a point.
pub(super) type Symbol = Box<dyn Fn(&mut Canvas, (f64, f64))>;

/// An entry of a legend: a symbol (none for plain text) with its width, pt, and its name.
pub(super) struct Entry {
    pub symbol: Option<(Symbol, f64)>,
    pub text: String,
}

impl Entry {
    /// A symbol of that width.
    pub fn new(text: impl Into<String>, width: f64, symbol: impl Fn(&mut Canvas, (f64, f64)) + 'static) -> Self {
        Self { symbol: Some((Box::new(symbol), width)), text: text.into() }
    }
}

/// Draws the entries from (left margin, `top`) on. Returns the y below them.
pub(super) fn legend(canvas: &mut Canvas, top: f64, entries: &[Entry]) -> f64 {
    let right = canvas.width - PAGE_MARGIN;
    let (mut x, mut y) = (PAGE_MARGIN, top);
    for entry in entries {
        let symbol_width = entry.symbol.as_ref().map_or(0.0, |(_, width)| width + 3.0);
        let limit = right - PAGE_MARGIN - symbol_width;
        let lines = canvas.fonts.wrap(&entry.text, SMALL_TEXT, false, limit);
        let text_width = lines.iter().map(|line| canvas.fonts.width(line, SMALL_TEXT, false)).fold(0.0, f64::max);
        if x > PAGE_MARGIN && x + symbol_width + text_width > right {
            (x, y) = (PAGE_MARGIN, y + LINE_SPACING + 2.0);
        }
        if let Some((draw, width)) = &entry.symbol {
            draw(canvas, (x + width / 2.0, y + LINE_SPACING / 2.0));
        }
        for (i, line) in lines.iter().enumerate() {
            y += if i > 0 { LINE_SPACING } else { 0.0 };
            canvas.text(Label::new(x + symbol_width, y + 7.9, line.clone()).color(Color::DARK_GREY));
        }
        x += symbol_width + text_width + 12.0;
    }
    y + LINE_SPACING + 2.0
}
