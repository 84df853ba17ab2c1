//! The lattice of oscillators in plan view, with a mode shape on it.

use super::super::axis::signed;
use super::super::canvas::{Area, Canvas, Color, Label, Paint, SMALL_TEXT};
use super::super::legend::Entry;
use super::super::style::{BLUE, ORANGE, arrow};
use super::data::ModeWorkFigure;

/// Motion of a body at the instant that is drawn.
pub(super) struct BodyAt {
    /// Displacements in x, y and z, as parts of the largest amplitude.
    pub displacement: [f64; 3],
    /// Directions x, y, z that are held.
    pub constrained: [bool; 3],
}

/// Geometry of one drawing: x to the right along a row, y downwards along a column, as the oscillators are numbered.
pub(super) struct LatticeDrawing {
    rows: usize,
    columns: usize,
    width: f64,
    /// Distance between neighbours, and between the outer oscillators and the walls, pt.
    pitch: f64,
}

impl LatticeDrawing {
    pub fn new(rows: usize, columns: usize, width: f64) -> Self {
        Self { rows, columns, width, pitch: (width / (columns as f64 + 0.5)).min(46.0) }
    }

    /// Longest arrow, of the largest component.
    fn reach(&self) -> f64 {
        0.42 * self.pitch
    }

    /// Radius of the disc of the largest component.
    fn full_disc(&self) -> f64 {
        LARGEST_DISC_RADIUS.min(0.3 * self.pitch)
    }

    /// Draws bodies (oscillators by rows, then the plate) and returns the y below. `axes` adds the directions.
    pub fn draw(&self, canvas: &mut Canvas, (x, y): (f64, f64), bodies: &[BodyAt], axes: bool) -> f64 {
        let left = x + (self.width - self.pitch * (self.columns as f64 - 1.0)) / 2.0;
        let top = y + (0.5 * self.pitch).max(20.0);
        let oscillators = self.rows * self.columns;
        let center = |i: usize| {
            let (row, column) = (i / self.columns, i % self.columns);
            (left + column as f64 * self.pitch, top + row as f64 * self.pitch)
        };
        self.springs(canvas, center(0), center(oscillators - 1));
        let plate = (x + self.width / 2.0, top + (self.rows as f64 - 0.5) * self.pitch + 16.0);
        let half = (0.24 * self.width).min(0.5 * self.pitch * self.columns as f64);
        canvas.rect(
            Area { x: plate.0 - half, y: plate.1 - 10.0, width: 2.0 * half, height: 20.0 },
            Paint::stroke(Color::LIGHT_GREY, 1.0),
        );
        canvas.text(Label::new(plate.0 + half + 4.0, plate.1 + 3.0, "plate").color(Color::DARK_GREY));
        for (i, body) in bodies.iter().enumerate() {
            let at = if i == oscillators { plate } else { center(i) };
            let name = (i < oscillators).then(|| (i + 1).to_string());
            let [u, v, w] = body.displacement.map(|u| signed(u, 2));
            let title = format!("{}: x {u}, y {v}, z {w}", name.as_deref().unwrap_or("plate"));
            canvas.group("body", title, |canvas| {
                self.body(canvas, at, body);
                if let Some(name) = name {
                    let aside = (0.38 * self.pitch).min(9.5);
                    canvas.text(Label::new(at.0 - aside, at.1 - aside, name).middle().color(Color::DARK_GREY).halo());
                }
            });
        }
        if axes {
            directions(canvas, (plate.0 - half - 28.0, plate.1 - 8.0));
        }
        plate.1 + 20.0
    }

    /// The undeformed springs with their walls.
    fn springs(&self, canvas: &mut Canvas, first: (f64, f64), last: (f64, f64)) {
        let wall = 0.5 * self.pitch;
        let line = Paint::stroke(Color::LIGHT_GREY, 0.8);
        for row in 0..self.rows {
            let y = first.1 + row as f64 * self.pitch;
            canvas.line((first.0 - wall, y), (last.0 + wall, y), line);
        }
        for column in 0..self.columns {
            let x = first.0 + column as f64 * self.pitch;
            canvas.line((x, first.1 - wall), (x, last.1 + wall), line);
        }
        let corners = [(first.0 - wall, first.1 - wall), (last.0 + wall, first.1 - wall)];
        let corners = [corners[0], corners[1], (last.0 + wall, last.1 + wall), (first.0 - wall, last.1 + wall)];
        canvas.polygon(corners.to_vec(), Paint::stroke(Color::LIGHT_GREY, 1.6));
    }

    fn body(&self, canvas: &mut Canvas, at: (f64, f64), body: &BodyAt) {
        let [u, v, w] = body.displacement;
        canvas.circle(at, 2.2, Paint::fill(Color::WHITE).outlined(Color::DARK_GREY, 0.6));
        disc(canvas, at, self.full_disc(), w);
        held(canvas, at, self.full_disc() + 1.5, body.constrained);
        let tip = (at.0 + u * self.reach(), at.1 + v * self.reach());
        arrow(canvas, at, tip, Color::BLACK);
    }

    /// The legend of the symbols, of those that occur, in the scale of the drawing.
    pub fn symbols(&self, data: &ModeWorkFigure) -> Vec<Entry> {
        let (length, full) = (0.5 * self.reach(), self.full_disc());
        let mut entries = vec![
            Entry::new("x, y: half the largest amplitude", length, move |canvas: &mut Canvas, (x, y)| {
                arrow(canvas, (x - length / 2.0, y), (x + length / 2.0, y), Color::BLACK);
            }),
            Entry::new("z upwards, of that size", 1.5 * full, move |canvas: &mut Canvas, at| {
                disc(canvas, at, full, 0.5)
            }),
            Entry::new("downwards", 1.5 * full, move |canvas: &mut Canvas, at| disc(canvas, at, full, -0.5)),
        ];
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            if data.laws.iter().flat_map(|law| &law.bodies).any(|body| body.constrained[axis]) {
                let text = format!("{name} constrained");
                let draw = move |canvas: &mut Canvas, at| held(canvas, at, 4.0, [axis == 0, axis == 1, axis == 2]);
                entries.push(Entry::new(text, 10.0, draw));
            }
        }
        if data.laws.iter().flat_map(|law| &law.bodies).any(|body| body.work.quartiles.is_some()) {
            entries.push(Entry { symbol: None, text: "whiskers on the bars: quartiles over the samples".to_owned() });
        }
        entries
    }
}

/// Radius of the disc of z = 1 where there is room, pt; chosen.
const LARGEST_DISC_RADIUS: f64 = 8.5;

/// z as a disc with its sign, `full` the radius of z = 1 and the area proportional to |z|; nothing where it would not be
/// seen.
fn disc(canvas: &mut Canvas, at: (f64, f64), full: f64, z: f64) {
    let radius = full * z.abs().sqrt();
    if radius < 1.0 {
        return;
    }
    let (fill, line) = if z > 0.0 { (ORANGE, Color(140, 90, 0)) } else { (Color(214, 234, 248), BLUE) };
    canvas.circle(at, radius, Paint::fill(fill).outlined(line, 0.8));
    let arm = 0.55 * radius;
    canvas.line((at.0 - arm, at.1), (at.0 + arm, at.1), Paint::stroke(line, 0.8));
    if z > 0.0 {
        canvas.line((at.0, at.1 - arm), (at.0, at.1 + arm), Paint::stroke(line, 0.8));
    }
}

/// Bars across the directions that are held, `distance` away; a square for z, whose disc is then absent.
fn held(canvas: &mut Canvas, at: (f64, f64), distance: f64, [x, y, z]: [bool; 3]) {
    let line = Paint::stroke(Color::BLACK, 1.6);
    let half = 4.5;
    for side in [-distance, distance] {
        if x {
            canvas.line((at.0 + side, at.1 - half), (at.0 + side, at.1 + half), line);
        }
        if y {
            canvas.line((at.0 - half, at.1 + side), (at.0 + half, at.1 + side), line);
        }
    }
    if z {
        let square = Area { x: at.0 - half, y: at.1 - half, width: 2.0 * half, height: 2.0 * half };
        canvas.rect(square, Paint::stroke(Color::BLACK, 1.0));
    }
}

/// The directions x and y, small.
fn directions(canvas: &mut Canvas, at: (f64, f64)) {
    arrow(canvas, at, (at.0 + 15.0, at.1), Color::DARK_GREY);
    arrow(canvas, at, (at.0, at.1 + 15.0), Color::DARK_GREY);
    canvas.text(Label::new(at.0 + 17.0, at.1 + 2.5, "x").color(Color::DARK_GREY));
    canvas.text(Label::new(at.0, at.1 + 15.0 + SMALL_TEXT, "y").middle().color(Color::DARK_GREY));
}
