//! The model as a drawing: the lattice in plan view and one oscillator from the side.

use super::axis::{LINE_SPACING, PAGE_MARGIN, title};
use super::canvas::{Area, Canvas, Color, Label, Paint, TextAnchor};
use super::error::{FigureError, finite};
use super::figure::{Figure, Table};
use super::style::{BLUE, VERMILLION, arrow};

/// What the drawing shows of a lattice.
#[derive(Debug, Clone, Default)]
pub struct ModelDiagram {
    /// Above everything; may be empty.
    pub title: String,
    /// Rows of the lattice.
    pub rows: usize,
    /// Columns of the lattice.
    pub columns: usize,
    /// By rows: whether the oscillator touches the plate.
    pub in_contact: Vec<bool>,
    /// Angle between the inclined springs and the plane of the plate, degrees.
    pub theta_degrees: f64,
    /// Angle of the inclined springs in that plane, from the x axis, degrees.
    pub phi_degrees: f64,
    /// Whether the inclined springs lean in the direction of sliding.
    pub leans_with_sliding: bool,
}

/// Draws the model: numbered oscillators (grey: in contact) with the numbers of the springs between them, and one
/// oscillator from the side. The table lists the springs with the bodies that they join.
///
/// # Errors
/// [`FigureError::Empty`] without oscillators, [`FigureError::Length`] if the contacts do not fit the lattice,
/// [`FigureError::NotFinite`] for an angle that is not finite.
pub fn model_diagram(data: &ModelDiagram) -> Result<Figure, FigureError> {
    let oscillators = data.rows * data.columns;
    if oscillators == 0 {
        return Err(FigureError::Empty { what: "oscillator" });
    }
    if data.in_contact.len() != oscillators {
        let what = "contacts of the model diagram".to_owned();
        return Err(FigureError::Length { what, found: data.in_contact.len(), expected: oscillators });
    }
    finite(data.theta_degrees, || "angle theta".to_owned())?;
    finite(data.phi_degrees, || "angle phi".to_owned())?;

    let mut canvas = Canvas::new()?;
    let top = title(&mut canvas, &data.title) + 4.0;
    let width = 0.54 * canvas.width;
    let plan_bottom = plan(&mut canvas, data, Area { x: PAGE_MARGIN, y: top, width, height: width });
    let x = PAGE_MARGIN + width + 24.0;
    let side = Area { x, y: top, width: canvas.width - PAGE_MARGIN - x, height: 230.0 };
    let side_bottom = elevation(&mut canvas, data, side);
    canvas.height = plan_bottom.max(side_bottom) + PAGE_MARGIN;
    Ok(Figure { canvas, table: springs(data) })
}

/// Half the side of the square that stands for an oscillator, pt.
const OSCILLATOR_HALF_SIDE: f64 = 9.0;

/// The lattice from above. Returns the y below.
fn plan(canvas: &mut Canvas, data: &ModelDiagram, area: Area) -> f64 {
    canvas.text(Label::new(area.x, area.y + 9.0, "(a) plan view").size(9.0).bold());
    let pitch = (area.width / (data.columns as f64 + 1.0)).min(area.height / (data.rows as f64 + 1.0));
    let (x0, y0) = (area.x + 4.0, area.y + 20.0);
    let (right, bottom) = (x0 + pitch * (data.columns as f64 + 1.0), y0 + pitch * (data.rows as f64 + 1.0));
    let center = |row: usize, column: usize| (x0 + pitch * (column as f64 + 1.0), y0 + pitch * (row as f64 + 1.0));
    let walls = Area { x: x0, y: y0, width: right - x0, height: bottom - y0 };
    canvas.rect(walls, Paint::stroke(Color::DARK_GREY, 1.8));
    let gap = |k: usize, count: usize| {
        (if k == 0 { 0.0 } else { OSCILLATOR_HALF_SIDE }, if k == count { 0.0 } else { OSCILLATOR_HALF_SIDE })
    };
    for row in 0..data.rows {
        for k in 0..=data.columns {
            let (before, after) = gap(k, data.columns);
            let (x, y) = (x0 + pitch * k as f64, center(row, 0).1);
            spring(canvas, (x + before, y), (x + pitch - after, y), BLUE);
            let number = (row * (data.columns + 1) + k + 1).to_string();
            canvas.text(Label::new(x + (pitch + before - after) / 2.0, y - 5.5, number).middle().color(BLUE));
        }
    }
    for column in 0..data.columns {
        for k in 0..=data.rows {
            let (before, after) = gap(k, data.rows);
            let (x, y) = (center(0, column).0, y0 + pitch * k as f64);
            spring(canvas, (x, y + before), (x, y + pitch - after), VERMILLION);
            let number = (column * (data.rows + 1) + k + 1).to_string();
            canvas.text(Label::new(x + 6.0, y + (pitch + before - after) / 2.0 + 3.0, number).color(VERMILLION));
        }
    }
    for (i, &contact) in data.in_contact.iter().enumerate() {
        let (x, y) = center(i / data.columns, i % data.columns);
        let fill = if contact { Color::LIGHT_GREY } else { Color::WHITE };
        let square = Area {
            x: x - OSCILLATOR_HALF_SIDE,
            y: y - OSCILLATOR_HALF_SIDE,
            width: 2.0 * OSCILLATOR_HALF_SIDE,
            height: 2.0 * OSCILLATOR_HALF_SIDE,
        };
        canvas.group("body", format!("oscillator {}", i + 1), |canvas| {
            canvas.rect(square, Paint::fill(fill).outlined(Color::BLACK, 0.8));
            canvas.text(Label::new(x, y + 3.0, (i + 1).to_string()).bold().middle());
        });
    }
    let y = bottom + 14.0;
    arrow(canvas, (x0, y), (x0 + 18.0, y), Color::BLACK);
    canvas.text(Label::new(x0 + 21.0, y + 2.5, "x, and sliding of the plate at v"));
    arrow(canvas, (right - 8.0, y - 8.0), (right - 8.0, y + 10.0), Color::BLACK);
    canvas.text(Label::new(right - 2.0, y + 6.0, "y"));
    let text = "Blue and orange: numbers of the springs in x and y, each with a dashpot beside it. \
                Grey: in contact with the plate.";
    let mut y = y + 8.0;
    for line in canvas.fonts.wrap(text, 8.0, false, right - x0) {
        y += LINE_SPACING;
        canvas.text(Label::new(x0, y, line).color(Color::DARK_GREY));
    }
    y
}

/// One oscillator between foundation and plate, x to the right and z upwards. Returns the y below.
fn elevation(canvas: &mut Canvas, data: &ModelDiagram, area: Area) -> f64 {
    canvas.text(Label::new(area.x, area.y + 9.0, "(b) one oscillator, from the side").size(9.0).bold());
    let (x, y) = (area.x + 0.46 * area.width, area.y + 112.0);
    let foundation = area.y + 24.0;
    ground(canvas, (area.x, foundation), area.width, -1.0);
    canvas.text(Label::new(area.right(), foundation + 10.0, "foundation").anchor(TextAnchor::End));

    let (half_width, half_height) = (20.0, 13.0);
    let mass = Area { x: x - half_width, y: y - half_height, width: 2.0 * half_width, height: 2.0 * half_height };
    canvas.rect(mass, Paint::fill(Color::LIGHT_GREY).outlined(Color::BLACK, 0.8));
    canvas.text(Label::new(x, y + 3.0, "m").bold().middle());

    let (theta, phi) = (data.theta_degrees.to_radians(), data.phi_degrees.to_radians());
    let lean = if data.leans_with_sliding { 1.0 } else { -1.0 };
    let (dx, dz) = (lean * theta.cos() * phi.cos(), theta.sin());
    let foot = (x + lean * 10.0, y - half_height);
    let rise = foot.1 - foundation;
    let slope = if dz.abs() > 1e-6 { (dx / dz).clamp(-0.6, 0.6) } else { 0.6 * lean };
    spring(canvas, foot, (foot.0 + slope * rise, foundation), Color::BLACK);
    let foot = (x - lean * 10.0, y - half_height);
    dashpot(canvas, foot, (foot.0, foundation));
    let (spring_side, dashpot_side) = (x + lean * 36.0, x - lean * 20.0);
    let label = |canvas: &mut Canvas, x: f64, right: bool, lines: &[&str]| {
        let anchor = if right { TextAnchor::Start } else { TextAnchor::End };
        for (i, line) in lines.iter().enumerate() {
            canvas.text(Label::new(x, y - 52.0 + LINE_SPACING * i as f64, *line).anchor(anchor));
        }
    };
    let angles = format!("θ {:.0}°, φ {:.0}°", data.theta_degrees, data.phi_degrees);
    label(canvas, spring_side, lean > 0.0, &["inclined spring", &angles]);
    label(canvas, dashpot_side, lean < 0.0, &["dashpot"]);

    let plate = Area { x: area.x, y: y + 62.0, width: area.width, height: 18.0 };
    spring(canvas, (x, y + half_height), (x, plate.y), Color::BLACK);
    canvas.text(Label::new(x + 10.0, y + half_height + 28.0, "contact spring"));
    arrow(canvas, (x + half_width, y), (x + half_width + 26.0, y), VERMILLION);
    canvas.text(Label::new(x + half_width + 30.0, y + 3.0, "friction μN").color(VERMILLION));
    canvas.rect(plate, Paint::fill(Color::WHITE).outlined(Color::BLACK, 0.8));
    canvas.text(Label::new(plate.x + 5.0, plate.y + 12.0, "plate"));
    arrow(canvas, (plate.x + 42.0, plate.middle_y()), (plate.x + 72.0, plate.middle_y()), Color::BLACK);
    canvas.text(Label::new(plate.x + 76.0, plate.y + 12.0, "v"));

    let floor = plate.bottom() + 34.0;
    spring(canvas, (x - 8.0, plate.bottom()), (x - 8.0, floor), Color::BLACK);
    dashpot(canvas, (x + 8.0, plate.bottom()), (x + 8.0, floor));
    canvas.text(Label::new(x + 20.0, plate.bottom() + 20.0, "in x, y and z"));
    ground(canvas, (area.x, floor), area.width, 1.0);
    floor + 8.0
}

/// A zigzag along a line.
fn spring(canvas: &mut Canvas, from: (f64, f64), to: (f64, f64), color: Color) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = dx.hypot(dy).max(1e-9);
    let (ux, uy) = (dx / length, dy / length);
    let teeth = 6;
    let lead = 0.2;
    let at = |along: f64, aside: f64| (from.0 + along * dx - aside * uy, from.1 + along * dy + aside * ux);
    let mut points = vec![from, at(lead, 0.0)];
    for k in 0..teeth {
        let along = lead + (1.0 - 2.0 * lead) * (f64::from(k) + 0.5) / f64::from(teeth);
        points.push(at(along, if k % 2 == 0 { 3.5 } else { -3.5 }));
    }
    points.extend([at(1.0 - lead, 0.0), to]);
    canvas.polyline(points, Paint::stroke(color, 0.9));
}

/// A vertical dashpot.
fn dashpot(canvas: &mut Canvas, from: (f64, f64), to: (f64, f64)) {
    let line = Paint::stroke(Color::BLACK, 0.9);
    let middle = (from.1 + to.1) / 2.0;
    let toward = (to.1 - from.1).signum();
    canvas.line(from, (from.0, middle), line);
    canvas.line((from.0 - 3.2, middle), (from.0 + 3.2, middle), line);
    let (open, shut) = (middle - 4.0 * toward, middle + 5.0 * toward);
    let cup = vec![(from.0 - 4.8, open), (from.0 - 4.8, shut), (from.0 + 4.8, shut), (from.0 + 4.8, open)];
    canvas.polyline(cup, line);
    canvas.line((from.0, shut), to, line);
}

/// A fixed surface, hatched on its far side (`side` -1: above, 1: below).
fn ground(canvas: &mut Canvas, (x, y): (f64, f64), width: f64, side: f64) {
    canvas.line((x, y), (x + width, y), Paint::stroke(Color::BLACK, 1.2));
    for k in 0..(width / 6.0) as usize {
        let start = x + 6.0 * k as f64;
        canvas.line((start, y + 5.0 * side), (start + 5.0, y), Paint::stroke(Color::DARK_GREY, 0.5));
    }
}

/// Number and ends of every spring of the lattice, then the contacts.
fn springs(data: &ModelDiagram) -> Table {
    let mut rows = Vec::new();
    let mut add = |axis: &str, number: usize, from: Option<usize>, to: Option<usize>| {
        let name = |end: Option<usize>| end.map_or("wall".to_owned(), |i| (i + 1).to_string());
        rows.push(vec![axis.to_owned(), number.to_string(), name(from), name(to)]);
    };
    for row in 0..data.rows {
        for k in 0..=data.columns {
            let at = |c: usize| row * data.columns + c;
            let number = row * (data.columns + 1) + k + 1;
            add("x", number, k.checked_sub(1).map(at), (k < data.columns).then(|| at(k)));
        }
    }
    for column in 0..data.columns {
        for k in 0..=data.rows {
            let at = |r: usize| r * data.columns + column;
            let number = column * (data.rows + 1) + k + 1;
            add("y", number, k.checked_sub(1).map(at), (k < data.rows).then(|| at(k)));
        }
    }
    for (i, _) in data.in_contact.iter().enumerate().filter(|(_, contact)| **contact) {
        rows.push(vec!["z".to_owned(), (i + 1).to_string(), (i + 1).to_string(), "plate".to_owned()]);
    }
    Table { header: &["axis", "spring", "from", "to"], rows }
}
