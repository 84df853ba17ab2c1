//! Mode shape on the lattice above the net work of each body, one column per friction law.

mod data;
mod lattice;
mod phase;

use num_complex::Complex64;

use super::axis::{
    AxisScale, LINE_SPACING, PAGE_MARGIN, frame, note, signed, title, widest, x_axis, y_title, y_title_width,
};
use super::canvas::{Area, Canvas, Color, Label, Paint, SMALL_TEXT, TextAnchor};
use super::error::{FigureError, finite};
use super::figure::Figure;
use super::legend::legend;
use super::style::{BLUE, VERMILLION};
pub use data::{BodyInMode, LawMode, ModeWorkFigure, NetWork};
use lattice::{BodyAt, LatticeDrawing};
use output::Table;

/// Distance between the numbers on the scales of two columns, pt; as all lengths here chosen.
const SCALE_GAP: f64 = 6.0;
/// Height of the bar of one body with its white space, pt; chosen: a line of small text fits beside it.
const BAR_PITCH: f64 = 10.5;
/// Title of the axis of works.
const WORK_AXIS_TITLE: &str = "normalised median net work (1: that of the oscillator with most)";
/// Title of the axis of bodies.
const BODY_AXIS_TITLE: &str = "oscillator, p: plate";
/// The two instants at which the shape is drawn: together they are the whole motion.
const INSTANTS: [&str; 2] = ["shape", "shape, a quarter of a period later"];

/// Draws the mode shape in plan view at two instants a quarter of a period apart (arrows for x and y, discs for z, the
/// undeformed lattice behind) above bars of the net work of each oscillator and the plate (p), with quartiles as whiskers;
/// the axes of work are alike.
///
/// All shapes have the largest component 1 and one phase: the phase of the first law makes its real part largest, the phase of another
/// law makes its shape most like the first. The table has one row per law, body and quantity, with the eigenvector in that phase.
///
/// # Errors
/// [`FigureError::Empty`] without laws or with an empty lattice, [`FigureError::Length`] if the bodies do not fit the
/// lattice, [`FigureError::NotFinite`] for a value that is not finite.
pub fn mode_and_work(data: &ModeWorkFigure) -> Result<Figure, FigureError> {
    let factors = phase::factors(&data.laws);
    let table = check(data, &factors)?;
    let mut canvas = Canvas::new()?;
    let count = data.laws.len();
    let bodies = data.rows * data.columns + 1;
    let work_height = BAR_PITCH * bodies as f64;
    let left = PAGE_MARGIN + y_title_width(&canvas, work_height, BODY_AXIS_TITLE) + 14.0;
    let scale = work_scale(data);
    // The first and the last number of a scale stand half beyond its panel.
    let number = widest(&canvas, &scale.ticks(0));
    let (right, gap) = (canvas.width - PAGE_MARGIN - number / 2.0, number + SCALE_GAP);
    let width = (right - left - gap * (count - 1) as f64) / count as f64;
    let column = |c: usize| left + c as f64 * (width + gap);
    let lattice = LatticeDrawing::new(data.rows, data.columns, width);

    let mut y = title(&mut canvas, &data.title);
    y = legend(&mut canvas, y + 2.0, &lattice.symbols(data)) + 2.0;
    let tops: Vec<f64> = data
        .laws
        .iter()
        .enumerate()
        .map(|(c, law)| heading(&mut canvas, c, &law.law, &law.caption, (column(c), y), width))
        .collect();
    y = tops.into_iter().fold(y, f64::max) + 5.0;
    for (instant, text) in INSTANTS.into_iter().enumerate() {
        let top = y;
        for (c, law) in data.laws.iter().enumerate() {
            // Re(u e^(i omega t)) at omega t = 0 and pi / 2.
            let factor = if instant == 0 { factors[c] } else { factors[c] * Complex64::I };
            let at = |body: &BodyInMode| BodyAt {
                displacement: body.displacement.map(|u| (u * factor).re),
                constrained: body.constrained,
            };
            let bodies: Vec<BodyAt> = law.bodies.iter().map(at).collect();
            y = y.max(lattice.draw(&mut canvas, (column(c), top), &bodies, c == 0 && instant == 0));
        }
        y_title(&mut canvas, left - 2.0, Area { x: left, y: top, width, height: y - top }, text);
        y += 2.0;
    }
    for c in 0..count {
        canvas.text(Label::new(column(c), y + SMALL_TEXT, format!("({})", letter(count + c))).size(9.0).bold());
    }
    y += 13.0;
    for (c, law) in data.laws.iter().enumerate() {
        bars(&mut canvas, Area { x: column(c), y, width, height: work_height }, scale, law, c == 0);
    }
    y_title(&mut canvas, left - 14.0, Area { x: left, y, width, height: work_height }, BODY_AXIS_TITLE);
    y += work_height + 12.0;
    let middle = (left + canvas.width - PAGE_MARGIN) / 2.0;
    canvas.text(Label::new(middle, y + 10.0, WORK_AXIS_TITLE).middle());
    y += 12.0;
    note(&mut canvas, y, &data.note);
    Ok(Figure { canvas, table })
}

/// The scale that covers all medians and quartiles.
fn work_scale(data: &ModeWorkFigure) -> AxisScale {
    let values = data.laws.iter().flat_map(|law| &law.bodies).flat_map(|body| {
        let [lower, upper] = body.work.quartiles.unwrap_or([body.work.median; 2]);
        [lower, body.work.median, upper]
    });
    AxisScale::linear(values, 4.0)
}

fn letter(index: usize) -> char {
    char::from_u32('a' as u32 + index as u32).unwrap_or('?')
}

/// Letter, law and caption of a column. Returns the y below them.
fn heading(canvas: &mut Canvas, index: usize, law: &str, caption: &str, (x, top): (f64, f64), width: f64) -> f64 {
    let mut y = top;
    for line in canvas.fonts.wrap(&format!("({}) {law}", letter(index)), 9.0, true, width) {
        y += 11.0;
        canvas.text(Label::new(x, y, line).size(9.0).bold());
    }
    let lines: Vec<String> =
        caption.lines().flat_map(|line| canvas.fonts.wrap(line, SMALL_TEXT, false, width)).collect();
    for line in lines {
        y += LINE_SPACING;
        canvas.text(Label::new(x, y, line).color(Color::DARK_GREY));
    }
    y
}

/// Bars of the oscillators and the plate, from above to below; bars that feed the mode and bars that drain it differ in
/// colour and side.
fn bars(canvas: &mut Canvas, area: Area, scale: AxisScale, law: &LawMode, named: bool) {
    x_axis(canvas, area, &scale.ticks(0), true, true);
    let x_of = |value: f64| area.x + scale.at(value) * area.width;
    for (i, body) in law.bodies.iter().enumerate() {
        let plate = i + 1 == law.bodies.len();
        let name = if plate { "p".to_owned() } else { (i + 1).to_string() };
        let y = area.y + (i as f64 + 0.5) * BAR_PITCH;
        let half = 0.36 * BAR_PITCH;
        let text = format!("{}, {name}: net work {}", law.law, signed(body.work.median, 3));
        canvas.group("bar", text, |canvas| {
            let (zero, end) = (x_of(0.0), x_of(body.work.median));
            let color = if body.work.median < 0.0 { BLUE } else { VERMILLION };
            let bar = Area { x: zero.min(end), y: y - half, width: (zero - end).abs(), height: 2.0 * half };
            canvas.rect(bar, Paint::fill(color));
            if let Some([lower, upper]) = body.work.quartiles {
                let line = Paint::stroke(Color::BLACK, 0.8);
                canvas.line((x_of(lower), y), (x_of(upper), y), line);
                for x in [x_of(lower), x_of(upper)] {
                    canvas.line((x, y - half / 2.0), (x, y + half / 2.0), line);
                }
            }
        });
        if named {
            canvas.text(Label::new(area.x - 3.0, y + 2.9, name).anchor(TextAnchor::End));
        }
    }
    canvas.line((x_of(0.0), area.y), (x_of(0.0), area.bottom()), Paint::stroke(Color::BLACK, 0.6));
    frame(canvas, area);
}

/// Checks every value and writes it into the table.
fn check(data: &ModeWorkFigure, factors: &[Complex64]) -> Result<Table, FigureError> {
    if data.laws.is_empty() {
        return Err(FigureError::Empty { what: "friction law" });
    }
    let oscillators = data.rows * data.columns;
    if oscillators == 0 {
        return Err(FigureError::Empty { what: "oscillator" });
    }
    let mut rows = Vec::new();
    for (law, factor) in data.laws.iter().zip(factors) {
        if law.bodies.len() != oscillators + 1 {
            let what = format!("bodies under {}", law.law);
            return Err(FigureError::Length { what, found: law.bodies.len(), expected: oscillators + 1 });
        }
        for (i, body) in law.bodies.iter().enumerate() {
            let name = if i == oscillators { "plate".to_owned() } else { (i + 1).to_string() };
            let mut row = |quantity: String, value: f64| {
                rows.push(vec![law.law.clone(), name.clone(), quantity, value.to_string()]);
            };
            let check =
                |quantity: String, value: f64| finite(value, || format!("{quantity} of {name} under {}", law.law));
            for ((axis, u), held) in ["x", "y", "z"].iter().zip(body.displacement).zip(body.constrained) {
                check(format!("{axis}_re"), u.re)?;
                check(format!("{axis}_im"), u.im)?;
                let turned = u * factor;
                row(format!("{axis}_re"), turned.re);
                row(format!("{axis}_im"), turned.im);
                row(format!("{axis}_constrained"), f64::from(u8::from(held)));
            }
            let quartiles = body.work.quartiles.into_iter().flat_map(|[q25, q75]| [("q25", q25), ("q75", q75)]);
            for (statistic, value) in [("median", body.work.median)].into_iter().chain(quartiles) {
                let quantity = format!("net_work_{statistic}");
                row(quantity.clone(), check(quantity, value)?);
            }
        }
    }
    Ok(Table::new("figure", ["law", "body", "quantity", "value"], rows))
}
