//! Mode shape on the lattice above the net work of each body, one column per friction law.

mod data;
mod lattice;

use super::axis::{AxisScale, PAGE_MARGIN, frame, signed, title, widest, y_axis, y_title, y_title_width};
use super::canvas::{Area, Canvas, Color, Label, Paint, SMALL_TEXT};
use super::error::{FigureError, finite};
use super::figure::{Figure, Table};
use super::legend::legend;
use super::style::{BLUE, VERMILLION};
pub use data::{BodyInMode, LawMode, ModeWorkFigure, NetWork};
use lattice::{LatticeDrawing, symbols};

/// Between the columns of two laws, pt.
const COLUMN_GAP: f64 = 10.0;
/// Height of the axes of net work, pt.
const WORK_HEIGHT: f64 = 105.0;
const WORK_AXIS_TITLE: &str = "normalised median net work";

/// Draws the mode shape in plan view (arrows for x and y, discs for z, the undeformed lattice behind) above bars of the
/// net work of each oscillator and the plate (p), with quartiles as whiskers; the work axis is shared.
///
/// A complex eigenvector is turned and scaled so that its largest component is 1, and its real part is drawn; each panel
/// states the largest imaginary part that is left, which the picture does not show. The table has one row per law,
/// body and quantity, with the eigenvector as given.
///
/// # Errors
/// [`FigureError::Empty`] without laws or with an empty lattice, [`FigureError::Length`] if the bodies do not fit the
/// lattice, [`FigureError::NotFinite`] for a value that is not finite.
pub fn mode_and_work(data: &ModeWorkFigure) -> Result<Figure, FigureError> {
    let table = check(data)?;
    let mut canvas = Canvas::new()?;
    let count = data.laws.len();
    let values = data.laws.iter().flat_map(|law| &law.bodies).flat_map(|body| {
        let [lower, upper] = body.work.quartiles.unwrap_or([body.work.median; 2]);
        [lower, body.work.median, upper]
    });
    let scale = AxisScale::linear(values, 5.0);
    let ticks = scale.ticks(0);
    let tick_width = widest(&canvas, &ticks) + 6.0;
    let left = PAGE_MARGIN + y_title_width(&canvas, WORK_HEIGHT, WORK_AXIS_TITLE) + tick_width;
    let width = (canvas.width - PAGE_MARGIN - left - COLUMN_GAP * (count - 1) as f64) / count as f64;
    let column = |c: usize| left + c as f64 * (width + COLUMN_GAP);

    let mut y = title(&mut canvas, &data.title);
    y = legend(&mut canvas, y + 2.0, &symbols(data)) + 2.0;
    let tops: Vec<f64> = data
        .laws
        .iter()
        .enumerate()
        .map(|(c, law)| heading(&mut canvas, c, &law.law, &law.caption, (column(c), y), width))
        .collect();
    y = tops.into_iter().fold(y, f64::max) + 4.0;
    let lattice = LatticeDrawing::new(data.rows, data.columns, width);
    let mut bottom = y;
    for (c, law) in data.laws.iter().enumerate() {
        bottom = bottom.max(lattice.draw(&mut canvas, (column(c), y), &law.bodies, c == 0));
    }
    y = bottom + 8.0;
    for c in 0..count {
        canvas.text(Label::new(column(c), y + SMALL_TEXT, format!("({})", letter(count + c))).size(9.0).bold());
    }
    y += 13.0;
    for (c, law) in data.laws.iter().enumerate() {
        let area = Area { x: column(c), y, width, height: WORK_HEIGHT };
        y_axis(&mut canvas, area, &ticks, c == 0);
        bars(&mut canvas, area, scale, law);
    }
    y_title(&mut canvas, left - tick_width, Area { x: left, y, width, height: WORK_HEIGHT }, WORK_AXIS_TITLE);
    y += WORK_HEIGHT + 12.0;
    let middle = (left + canvas.width - PAGE_MARGIN) / 2.0;
    canvas.text(Label::new(middle, y + 10.0, "oscillator (p: plate)").middle());
    canvas.height = y + 10.0 + PAGE_MARGIN;
    Ok(Figure { canvas, table })
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
    for line in canvas.fonts.wrap(caption, SMALL_TEXT, false, width) {
        y += 10.0;
        canvas.text(Label::new(x, y, line).color(Color::DARK_GREY));
    }
    y
}

/// Bars of the oscillators and the plate; those that feed the mode and those that drain it differ in colour and side.
fn bars(canvas: &mut Canvas, area: Area, scale: AxisScale, law: &LawMode) {
    let y_of = |value: f64| area.bottom() - scale.at(value) * area.height;
    let slot = area.width / law.bodies.len() as f64;
    let every = ((canvas.fonts.width("00", SMALL_TEXT, false) + 2.0) / slot).ceil() as usize;
    for (i, body) in law.bodies.iter().enumerate() {
        let plate = i + 1 == law.bodies.len();
        let name = if plate { "p".to_owned() } else { (i + 1).to_string() };
        let x = area.x + (i as f64 + 0.5) * slot;
        let half = (0.36 * slot).min(9.0);
        let text = format!("{}, {name}: net work {}", law.law, signed(body.work.median, 3));
        canvas.group("bar", text, |canvas| {
            let (zero, end) = (y_of(0.0), y_of(body.work.median));
            let color = if body.work.median < 0.0 { BLUE } else { VERMILLION };
            let bar = Area { x: x - half, y: zero.min(end), width: 2.0 * half, height: (zero - end).abs() };
            canvas.rect(bar, Paint::fill(color));
            if let Some([lower, upper]) = body.work.quartiles {
                let (lower, upper, cap) = (y_of(lower), y_of(upper), half / 2.0);
                let line = Paint::stroke(Color::BLACK, 0.8);
                canvas.line((x, lower), (x, upper), line);
                for y in [lower, upper] {
                    canvas.line((x - cap, y), (x + cap, y), line);
                }
            }
        });
        if plate || i % every == 0 {
            canvas.text(Label::new(x, area.bottom() + 10.0, name).middle());
        }
    }
    canvas.line((area.x, y_of(0.0)), (area.right(), y_of(0.0)), Paint::stroke(Color::BLACK, 0.6));
    frame(canvas, area);
}

/// Checks every value and writes it into the table.
fn check(data: &ModeWorkFigure) -> Result<Table, FigureError> {
    if data.laws.is_empty() {
        return Err(FigureError::Empty { what: "friction law" });
    }
    let oscillators = data.rows * data.columns;
    if oscillators == 0 {
        return Err(FigureError::Empty { what: "oscillator" });
    }
    let mut rows = Vec::new();
    for law in &data.laws {
        if law.bodies.len() != oscillators + 1 {
            let what = format!("bodies under {}", law.law);
            return Err(FigureError::Length { what, found: law.bodies.len(), expected: oscillators + 1 });
        }
        for (i, body) in law.bodies.iter().enumerate() {
            let name = if i == oscillators { "plate".to_owned() } else { (i + 1).to_string() };
            let mut row = |quantity: String, value: f64| -> Result<(), FigureError> {
                let value = finite(value, || format!("{quantity} of {name} under {}", law.law))?;
                rows.push(vec![law.law.clone(), name.clone(), quantity, value.to_string()]);
                Ok(())
            };
            for ((axis, u), held) in ["x", "y", "z"].iter().zip(body.displacement).zip(body.constrained) {
                row(format!("{axis}_re"), u.re)?;
                row(format!("{axis}_im"), u.im)?;
                row(format!("{axis}_constrained"), f64::from(u8::from(held)))?;
            }
            row("net_work_median".to_owned(), body.work.median)?;
            if let Some([lower, upper]) = body.work.quartiles {
                row("net_work_q25".to_owned(), lower)?;
                row("net_work_q75".to_owned(), upper)?;
            }
        }
    }
    Ok(Table { header: &["law", "body", "quantity", "value"], rows })
}
