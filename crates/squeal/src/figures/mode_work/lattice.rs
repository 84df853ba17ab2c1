//! The lattice of oscillators in plan view, with a mode shape on it.

use num_complex::Complex64;

use super::super::canvas::{Area, Canvas, Color, Label, Paint, SMALL_TEXT};
use super::super::legend::Entry;
use super::super::style::{BLUE, ORANGE, arrow};
use super::data::{BodyInMode, ModeWorkFigure};

/// Geometry of one drawing: x to the right along a row, y downwards along a column, as the oscillators are numbered.
pub(super) struct LatticeDrawing {
    rows: usize,
    columns: usize,
    width: f64,
    /// Between neighbours, and between the outer oscillators and the walls.
    pitch: f64,
}

impl LatticeDrawing {
    pub fn new(rows: usize, columns: usize, width: f64) -> Self {
        Self { rows, columns, width, pitch: (width / (columns as f64 + 0.5)).min(52.0) }
    }

    /// Longest arrow, of the largest component.
    fn reach(&self) -> f64 {
        0.42 * self.pitch
    }

    /// Draws bodies (oscillators by rows, then the plate) and returns the y below. `axes` adds the directions.
    pub fn draw(&self, canvas: &mut Canvas, (x, y): (f64, f64), bodies: &[BodyInMode], axes: bool) -> f64 {
        let left = x + (self.width - self.pitch * (self.columns as f64 - 1.0)) / 2.0;
        let top = y + (0.6 * self.pitch).max(20.0);
        let oscillators = self.rows * self.columns;
        let center = |i: usize| {
            let (row, column) = (i / self.columns, i % self.columns);
            (left + column as f64 * self.pitch, top + row as f64 * self.pitch)
        };
        self.springs(canvas, center(0), center(oscillators - 1));
        let plate = (x + self.width / 2.0, top + (self.rows as f64 - 0.5) * self.pitch + 22.0);
        let half = (0.24 * self.width).min(0.5 * self.pitch * self.columns as f64);
        canvas.rect(
            Area { x: plate.0 - half, y: plate.1 - 13.0, width: 2.0 * half, height: 26.0 },
            Paint::stroke(Color::LIGHT_GREY, 1.0),
        );
        canvas.text(Label::new(plate.0 + half + 4.0, plate.1 + 3.0, "plate").color(Color::DARK_GREY));

        let phase = Phase::of(bodies);
        for (i, body) in bodies.iter().enumerate() {
            let at = if i == oscillators { plate } else { center(i) };
            let name = (i < oscillators).then(|| (i + 1).to_string());
            let title = format!("{}: {}", name.as_deref().unwrap_or("plate"), phase.describe(body));
            canvas.group("body", title, |canvas| {
                self.body(canvas, at, phase.shape(body), body.constrained);
                if let Some(name) = name {
                    canvas.text(Label::new(at.0 - 9.5, at.1 - 9.5, name).middle().color(Color::DARK_GREY).halo());
                }
            });
        }
        if axes {
            directions(canvas, (plate.0 - half - 28.0, plate.1 - 6.0));
        }
        let text = format!("largest imaginary part: {:.0} %", 100.0 * phase.left_out);
        canvas.text(Label::new(plate.0, plate.1 + 24.0, text).middle().color(Color::DARK_GREY));
        plate.1 + 26.0
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

    fn body(&self, canvas: &mut Canvas, at: (f64, f64), [u, v, w]: [f64; 3], constrained: [bool; 3]) {
        canvas.circle(at, 2.2, Paint::fill(Color::WHITE).outlined(Color::DARK_GREY, 0.6));
        let radius = LARGEST_DISC_RADIUS.min(0.3 * self.pitch);
        disc(canvas, at, radius, w);
        held(canvas, at, radius + 1.5, constrained);
        let tip = (at.0 + u * self.reach(), at.1 + v * self.reach());
        arrow(canvas, at, tip, Color::BLACK);
    }
}

/// Turns and scales an eigenvector so that its largest component is 1.
struct Phase {
    factor: Complex64,
    /// Largest imaginary part that remains.
    left_out: f64,
}

impl Phase {
    fn of(bodies: &[BodyInMode]) -> Self {
        let all = || bodies.iter().flat_map(|body| body.displacement);
        let largest = all().fold(Complex64::ZERO, |a, b| if b.norm() > a.norm() { b } else { a });
        let factor = if largest.norm() > 0.0 { largest.inv() } else { Complex64::ZERO };
        Self { factor, left_out: all().map(|u| (u * factor).im.abs()).fold(0.0, f64::max) }
    }

    fn shape(&self, body: &BodyInMode) -> [f64; 3] {
        body.displacement.map(|u| (u * self.factor).re)
    }

    fn describe(&self, body: &BodyInMode) -> String {
        let [x, y, z] = self.shape(body).map(|u| super::super::axis::signed(u, 2));
        format!("x {x}, y {y}, z {z}")
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

/// The legend of the symbols, of those that occur.
pub(super) fn symbols(data: &ModeWorkFigure) -> Vec<Entry> {
    let reach = 16.0;
    let mut entries = vec![
        Entry::new("x, y", reach, move |canvas: &mut Canvas, (x, y)| {
            arrow(canvas, (x - reach / 2.0, y), (x + reach / 2.0, y), Color::BLACK);
        }),
        Entry::new("+z, area by size", 12.0, |canvas: &mut Canvas, at| disc(canvas, at, 5.5, 1.0)),
        Entry::new("\u{2212}z", 12.0, |canvas: &mut Canvas, at| disc(canvas, at, 5.5, -1.0)),
    ];
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        if data.laws.iter().flat_map(|law| &law.bodies).any(|body| body.constrained[axis]) {
            let text = format!("{name} constrained");
            let draw = move |canvas: &mut Canvas, at| held(canvas, at, 4.0, [axis == 0, axis == 1, axis == 2]);
            entries.push(Entry::new(text, 10.0, draw));
        }
    }
    if data.laws.iter().flat_map(|law| &law.bodies).any(|body| body.work.quartiles.is_some()) {
        entries.push(Entry { symbol: None, text: "whiskers on the bars: quartiles".to_owned() });
    }
    entries
}
