//! The display list as SVG.

use svg::node::element::path::Data;
use svg::node::element::{Circle, Element, Path, Rectangle, Text, Title};
use svg::{Document, Node};

use super::canvas::{Canvas, Color, Item, Label, Paint, TextAnchor};
use super::font::{FONT_FAMILIES, Fonts};

/// The whole picture as one SVG document with its printed size in millimetres.
pub(super) fn to_svg(canvas: &Canvas) -> String {
    let (width, height) = (canvas.width, canvas.height);
    let millimetres = |points: f64| format!("{}mm", round(points / 72.0 * 25.4));
    let mut document = Document::new()
        .set("width", millimetres(width))
        .set("height", millimetres(height))
        .set("viewBox", (0, 0, round(width), round(height)))
        .set("font-family", FONT_FAMILIES)
        .add(Rectangle::new().set("width", "100%").set("height", "100%").set("fill", "#ffffff"));
    let mut open: Vec<Element> = Vec::new();
    for item in &canvas.items {
        let node: Element = match item {
            Item::Open { class, title } => {
                let mut group = Element::new("g");
                group.assign("class", *class);
                group.append(Title::new(without_control(title)));
                open.push(group);
                continue;
            }
            Item::Close => match open.pop() {
                Some(group) => group,
                None => continue,
            },
            Item::Path { points, closed, paint } => path(points, *closed, paint),
            Item::Circle { center, radius, paint } => {
                let mut circle: Element = Circle::new().into();
                for (name, value) in [("cx", center.0), ("cy", center.1), ("r", *radius)] {
                    circle.assign(name, round(value));
                }
                painted(circle, paint)
            }
            Item::Text(label) => text(label, &canvas.fonts),
        };
        match open.last_mut() {
            Some(group) => group.append(node),
            None => document.append(node),
        }
    }
    format!("{document}\n")
}

/// Hundredths of a point are finer than any printer; more digits would only make the file longer.
fn round(value: f64) -> f64 {
    // Adding zero turns -0 into 0.
    (value * 100.0).round() / 100.0 + 0.0
}

fn path(points: &[(f64, f64)], closed: bool, paint: &Paint) -> Element {
    let mut data = Data::new();
    for (i, &(x, y)) in points.iter().enumerate() {
        let point = (round(x), round(y));
        data = if i == 0 { data.move_to(point) } else { data.line_to(point) };
    }
    let data = if closed { data.close() } else { data };
    painted(Path::new().set("d", data).into(), paint)
}

fn painted(mut element: Element, paint: &Paint) -> Element {
    element.assign("fill", paint.fill.map_or("none".to_owned(), hex));
    if let Some((color, width)) = paint.stroke {
        element.assign("stroke", hex(color));
        element.assign("stroke-width", round(width));
    }
    if let Some(length) = paint.dash {
        element.assign("stroke-dasharray", round(length));
    }
    element
}

fn text(label: &Label, fonts: &Fonts) -> Element {
    let (x, y) = (round(label.at.0), round(label.at.1));
    let anchor = match label.anchor {
        TextAnchor::Start => "start",
        TextAnchor::Middle => "middle",
        TextAnchor::End => "end",
    };
    // The length keeps the layout whole where a viewer has none of the fonts.
    let length = fonts.width(&label.text, label.size, label.bold);
    let mut text = Text::new(without_control(&label.text))
        .set("x", x)
        .set("y", y)
        .set("font-size", label.size)
        .set("fill", hex(label.color))
        .set("text-anchor", anchor)
        .set("textLength", round(length))
        .set("lengthAdjust", "spacingAndGlyphs");
    if label.bold {
        text = text.set("font-weight", "bold");
    }
    if label.upward {
        text = text.set("transform", format!("rotate(-90 {x} {y})"));
    }
    if label.halo {
        text = text.set("stroke", "#ffffff").set("stroke-width", 2).set("paint-order", "stroke");
    }
    text.into()
}

/// Text without the characters that XML cannot hold, not even escaped; a box stands for each, as for those that the font lacks.
fn without_control(text: &str) -> String {
    text.chars().map(|c| if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') { '\u{fffd}' } else { c }).collect()
}

fn hex(color: Color) -> String {
    format!("#{:02x}{:02x}{:02x}", color.0, color.1, color.2)
}
