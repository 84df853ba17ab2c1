//! Mode shape on the lattice above the net work of each body, one column per friction law.

use num_complex::Complex64;

use super::axis::{MARGIN, Scale, frame, signed, title, widest, y_axis, y_title, y_title_width};
use super::canvas::{Area, Canvas, Color, Label, Paint, SMALL};
use super::error::{FigureError, finite};
use super::figure::{Figure, Table};
use super::lattice::{Lattice, key};
use super::legend::legend;
use super::style::{BLUE, VERMILLION};

/// One mode under several friction laws.
#[derive(Debug, Clone, Default)]
pub struct ModeWorkFigure {
    /// Above everything; may be empty.
    pub title: String,
    /// Rows of the lattice.
    pub rows: usize,
    /// Columns of the lattice.
    pub columns: usize,
    /// One column of the figure each.
    pub laws: Vec<LawMode>,
}

/// The mode under one law.
#[derive(Debug, Clone, Default)]
pub struct LawMode {
    /// Its name.
    pub law: String,
    /// Below the name, for example frequency and growth rate; may be empty.
    pub caption: String,
    /// The oscillators by rows, then the plate: `rows * columns + 1`.
    pub bodies: Vec<Body>,
}

/// One oscillator, or the plate.
#[derive(Debug, Clone, Default)]
pub struct Body {
    /// Components x, y, z of the eigenvector, in any unit and phase.
    pub displacement: [Complex64; 3],
    /// Which of x, y, z are held.
    pub constrained: [bool; 3],
    /// Its net work over the samples.
    pub work: NetWork,
}

/// Normalised net work of one body (no unit).
#[derive(Debug, Clone, Default)]
pub struct NetWork {
    /// Over the samples.
    pub median: f64,
    /// 25th and 75th percentile.
    pub quartiles: Option<[f64; 2]>,
}

const GAP: f64 = 10.0;
const WORK_HEIGHT: f64 = 105.0;
const WORK_TITLE: &str = "normalised median net work";

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
    let scale = Scale::linear(values, 5.0);
    let ticks = scale.ticks(0);
    let tick_width = widest(&canvas, &ticks) + 6.0;
    let left = MARGIN + y_title_width(&canvas, WORK_HEIGHT, WORK_TITLE) + tick_width;
    let width = (canvas.width - MARGIN - left - GAP * (count - 1) as f64) / count as f64;
    let column = |c: usize| left + c as f64 * (width + GAP);

    let mut y = title(&mut canvas, &data.title);
    y = legend(&mut canvas, y + 2.0, &key(data)) + 2.0;
    let tops: Vec<f64> = data
        .laws
        .iter()
        .enumerate()
        .map(|(c, law)| heading(&mut canvas, c, &law.law, &law.caption, (column(c), y), width))
        .collect();
    y = tops.into_iter().fold(y, f64::max) + 4.0;
    let lattice = Lattice::new(data.rows, data.columns, width);
    let mut bottom = y;
    for (c, law) in data.laws.iter().enumerate() {
        bottom = bottom.max(lattice.draw(&mut canvas, (column(c), y), &law.bodies, c == 0));
    }
    y = bottom + 8.0;
    for c in 0..count {
        canvas.text(Label::new(column(c), y + SMALL, format!("({})", letter(count + c))).size(9.0).bold());
    }
    y += 13.0;
    for (c, law) in data.laws.iter().enumerate() {
        let area = Area { x: column(c), y, width, height: WORK_HEIGHT };
        y_axis(&mut canvas, area, &ticks, c == 0);
        bars(&mut canvas, area, scale, law);
    }
    y_title(&mut canvas, left - tick_width, Area { x: left, y, width, height: WORK_HEIGHT }, WORK_TITLE);
    y += WORK_HEIGHT + 12.0;
    let middle = (left + canvas.width - MARGIN) / 2.0;
    canvas.text(Label::new(middle, y + 10.0, "oscillator (p: plate)").middle());
    canvas.height = y + 10.0 + MARGIN;
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
    for line in canvas.fonts.wrap(caption, SMALL, false, width) {
        y += 10.0;
        canvas.text(Label::new(x, y, line).color(Color::DARK_GREY));
    }
    y
}

/// Bars of the oscillators and the plate; those that feed the mode and those that drain it differ in colour and side.
fn bars(canvas: &mut Canvas, area: Area, scale: Scale, law: &LawMode) {
    let y_of = |value: f64| area.bottom() - scale.at(value) * area.height;
    let slot = area.width / law.bodies.len() as f64;
    let every = ((canvas.fonts.width("00", SMALL, false) + 2.0) / slot).ceil() as usize;
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
