//! The display list: what a figure is made of before it becomes SVG or PNG. Both come from this one list, so they show
//! the same picture. Lengths are points (1/72 inch), x to the right and y downwards.

use super::error::FigureError;
use super::font::Fonts;

/// A colour: red, green, blue, 0 to 255.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Color(pub u8, pub u8, pub u8);

impl Color {
    pub const BLACK: Color = Color(0, 0, 0);
    pub const WHITE: Color = Color(255, 255, 255);
    /// Secondary text and marks, dark enough for print.
    pub const DARK_GREY: Color = Color(80, 80, 80);
    /// Grid lines and undeformed shapes.
    pub const LIGHT_GREY: Color = Color(215, 215, 215);
}

/// Fill and outline of a shape.
#[derive(Debug, Clone, Copy)]
pub(super) struct Paint {
    pub fill: Option<Color>,
    /// Colour and width of the outline, pt.
    pub stroke: Option<(Color, f64)>,
    /// Length of dashes and of the gaps between them, pt.
    pub dash: Option<f64>,
}

impl Paint {
    pub fn fill(color: Color) -> Self {
        Self { fill: Some(color), stroke: None, dash: None }
    }

    pub fn stroke(color: Color, width: f64) -> Self {
        Self { fill: None, stroke: Some((color, width)), dash: None }
    }

    pub fn outlined(self, color: Color, width: f64) -> Self {
        Self { stroke: Some((color, width)), ..self }
    }

    pub fn dashed(self, length: f64) -> Self {
        Self { dash: Some(length), ..self }
    }
}

/// Position of the reference point of a text along its line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TextAnchor {
    Start,
    Middle,
    End,
}

/// A line of text; `at` is on the baseline.
#[derive(Debug, Clone)]
pub(super) struct Label {
    pub at: (f64, f64),
    pub text: String,
    pub size: f64,
    pub bold: bool,
    pub color: Color,
    pub anchor: TextAnchor,
    /// The text is read from bottom to top.
    pub upward: bool,
    /// A white rim, for text on top of lines.
    pub halo: bool,
}

impl Label {
    /// Black text of the smallest size, starting at the point.
    pub fn new(x: f64, y: f64, text: impl Into<String>) -> Self {
        Self {
            at: (x, y),
            text: text.into(),
            size: SMALL_TEXT,
            bold: false,
            color: Color::BLACK,
            anchor: TextAnchor::Start,
            upward: false,
            halo: false,
        }
    }

    pub fn size(self, size: f64) -> Self {
        Self { size, ..self }
    }

    pub fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    pub fn color(self, color: Color) -> Self {
        Self { color, ..self }
    }

    pub fn anchor(self, anchor: TextAnchor) -> Self {
        Self { anchor, ..self }
    }

    pub fn middle(self) -> Self {
        self.anchor(TextAnchor::Middle)
    }

    pub fn upward(self) -> Self {
        Self { upward: true, ..self }
    }

    pub fn halo(self) -> Self {
        Self { halo: true, ..self }
    }
}

/// The smallest text of a figure, in points at its printed width; chosen: smaller is hard to read in print.
pub(super) const SMALL_TEXT: f64 = 8.0;

/// An entry of the display list.
#[derive(Debug, Clone)]
pub(super) enum Item {
    /// Everything up to the matching `Close` is one object with a class and a description (SVG only).
    Open {
        class: &'static str,
        title: String,
    },
    Close,
    Path {
        points: Vec<(f64, f64)>,
        closed: bool,
        paint: Paint,
    },
    Circle {
        center: (f64, f64),
        radius: f64,
        paint: Paint,
    },
    Text(Label),
}

/// A picture under construction.
pub(super) struct Canvas {
    pub width: f64,
    /// Height, pt, set when the layout is known.
    pub height: f64,
    pub items: Vec<Item>,
    pub fonts: Fonts,
}

impl Canvas {
    /// An empty picture of width 180 mm (A4 less its margins).
    pub fn new() -> Result<Self, FigureError> {
        Ok(Self { width: 180.0 / 25.4 * 72.0, height: 0.0, items: Vec::new(), fonts: Fonts::load()? })
    }

    /// Writes a label; an empty one leaves no trace.
    pub fn text(&mut self, label: Label) {
        if !label.text.is_empty() {
            self.items.push(Item::Text(label));
        }
    }

    pub fn line(&mut self, from: (f64, f64), to: (f64, f64), paint: Paint) {
        self.items.push(Item::Path { points: vec![from, to], closed: false, paint });
    }

    pub fn polyline(&mut self, points: Vec<(f64, f64)>, paint: Paint) {
        self.items.push(Item::Path { points, closed: false, paint });
    }

    pub fn polygon(&mut self, points: Vec<(f64, f64)>, paint: Paint) {
        self.items.push(Item::Path { points, closed: true, paint });
    }

    pub fn rect(&mut self, area: Area, paint: Paint) {
        let Area { x, y, width, height } = area;
        self.polygon(vec![(x, y), (x + width, y), (x + width, y + height), (x, y + height)], paint);
    }

    pub fn circle(&mut self, center: (f64, f64), radius: f64, paint: Paint) {
        self.items.push(Item::Circle { center, radius, paint });
    }

    /// Draws one described object: `class` for style sheets and tests, `title` for readers who point at it.
    pub fn group(&mut self, class: &'static str, title: String, draw: impl FnOnce(&mut Self)) {
        self.items.push(Item::Open { class, title });
        draw(self);
        self.items.push(Item::Close);
    }
}

/// A rectangle; (x, y) is its upper left corner.
#[derive(Debug, Clone, Copy)]
pub(super) struct Area {
    pub x: f64,
    pub y: f64,
    pub width: f64,
    pub height: f64,
}

impl Area {
    pub fn right(&self) -> f64 {
        self.x + self.width
    }

    pub fn bottom(&self) -> f64 {
        self.y + self.height
    }

    pub fn middle_x(&self) -> f64 {
        self.x + self.width / 2.0
    }

    pub fn middle_y(&self) -> f64 {
        self.y + self.height / 2.0
    }
}
