//! Levels of the harmonics of cycles.

use output::Table;

use super::axis::{AxisScale, PAGE_MARGIN, frame, note, title};
use super::canvas::{Area, Canvas, Label, Paint};
use super::error::{FigureError, finite};
use super::figure::Figure;
use super::legend::{Entry, legend};
use super::plot::{BELOW, Plot};
use super::style::{BLUE, VERMILLION};

/// Harmonics of cycles.
#[derive(Debug, Clone, Default)]
pub struct CycleSpectrumFigure {
    /// Title above everything; may be empty.
    pub title: String,
    /// The cycles, one or more.
    pub cycles: Vec<SpectrumOfCycle>,
    /// Note below everything; may be empty.
    pub note: String,
}

/// Harmonics of a cycle.
#[derive(Debug, Clone, Default)]
pub struct SpectrumOfCycle {
    /// Heading of the cycle.
    pub name: String,
    /// Frequency of the mode that it starts from, Hz.
    pub mode_hz: f64,
    /// Frequency, Hz, and root mean square of the velocity, m/s, of each harmonic, from the first on.
    pub harmonics: Vec<[f64; 2]>,
}

/// Height of the panel of a cycle, pt; chosen.
const HEIGHT: f64 = 95.0;
/// Decades below the strongest harmonic that are drawn; chosen: 80 dB.
const DECADES: i32 = 4;

/// Draws the harmonics of each cycle as lines over the frequency, their levels on an axis of four decades, and marks the frequency of the mode. How
/// many harmonics are weaker is said. The table has one row per cycle and harmonic.
///
/// # Errors
/// [`FigureError::Empty`] without cycles or harmonics that move, [`FigureError::NotFinite`].
pub fn cycle_spectrum_figure(data: &CycleSpectrumFigure) -> Result<Figure, FigureError> {
    let table = check(data)?;
    let mut canvas = Canvas::new()?;
    let all = || data.cycles.iter().flat_map(|cycle| &cycle.harmonics);
    let strongest = all().map(|[_, rms]| *rms).fold(0.0, f64::max);
    if strongest <= 0.0 {
        return Err(FigureError::Empty { what: "harmonics" });
    }
    let high = strongest.log10().ceil() as i32;
    let level = AxisScale::Log { low: high - DECADES, high };
    let is_shown = |[_, rms]: &&[f64; 2]| *rms > 0.0 && level.at(*rms) > 0.0;
    let modes = data.cycles.iter().map(|cycle| cycle.mode_hz);
    let hertz = AxisScale::linear(all().filter(is_shown).map(|[hz, _]| *hz).chain(modes), 8.0);
    let plot = Plot { scales: [hertz, level], labels: ["frequency (Hz)".to_owned(), "rms velocity (m/s)".to_owned()] };
    let mut y = title(&mut canvas, &data.title);
    y = legend(&mut canvas, y + 4.0, &key());
    let left = PAGE_MARGIN + plot.left(&canvas, HEIGHT);
    let right = canvas.width - PAGE_MARGIN - 10.0;
    for cycle in &data.cycles {
        let weaker = cycle.harmonics.len() - cycle.harmonics.iter().filter(is_shown).count();
        let heading = match weaker {
            0 => cycle.name.clone(),
            1 => format!("{}; 1 weaker harmonic is not drawn", cycle.name),
            more => format!("{}; {more} weaker harmonics are not drawn", cycle.name),
        };
        for line in canvas.fonts.wrap(&heading, 9.0, true, right - PAGE_MARGIN) {
            y += 12.0;
            canvas.text(Label::new(PAGE_MARGIN, y, line).size(9.0).bold());
        }
        let area = Area { x: left, y: y + 6.0, width: right - left, height: HEIGHT };
        plot.axes(&mut canvas, area);
        let (at, _) = plot.place(area, [cycle.mode_hz, strongest]);
        canvas.group("mode", format!("mode at {} Hz", cycle.mode_hz), |canvas| mode_line(canvas, at, area));
        for (order, [hz, rms]) in (1..).zip(&cycle.harmonics).filter(|(_, harmonic)| is_shown(harmonic)) {
            canvas.group("harmonic", format!("harmonic {order}: {hz} Hz, {rms} m/s"), |canvas| {
                let (x, top) = plot.place(area, [*hz, *rms]);
                stem(canvas, (x, top), area.bottom());
            });
        }
        frame(&mut canvas, area);
        y = area.bottom() + BELOW + 4.0;
    }
    note(&mut canvas, y, &data.note);
    Ok(Figure { canvas, table })
}

fn stem(canvas: &mut Canvas, (x, top): (f64, f64), bottom: f64) {
    canvas.line((x, bottom), (x, top), Paint::stroke(BLUE, 1.3));
    canvas.circle((x, top), 2.2, Paint::fill(BLUE));
}

fn mode_line(canvas: &mut Canvas, x: f64, area: Area) {
    canvas.line((x, area.y), (x, area.bottom()), Paint::stroke(VERMILLION, 1.0).dashed(3.0));
}

fn key() -> [Entry; 2] {
    [
        Entry::new("harmonic of the cycle", 8.0, |canvas, (x, y)| stem(canvas, (x, y - 2.0), y + 5.0)),
        Entry::new("mode that it starts from, or grows fastest", 8.0, |canvas, (x, y)| {
            mode_line(canvas, x, Area { x, y: y - 5.0, width: 0.0, height: 10.0 });
        }),
    ]
}

/// Checks every value and writes it into the table.
fn check(data: &CycleSpectrumFigure) -> Result<Table, FigureError> {
    if data.cycles.is_empty() {
        return Err(FigureError::Empty { what: "cycles" });
    }
    let mut rows = Vec::new();
    for cycle in &data.cycles {
        finite(cycle.mode_hz, || format!("the mode of {}", cycle.name))?;
        for (order, harmonic) in (1..).zip(&cycle.harmonics) {
            for value in harmonic {
                finite(*value, || format!("harmonic {order} of {}", cycle.name))?;
            }
            let [hz, rms] = harmonic.map(|value| value.to_string());
            rows.push(vec![cycle.name.clone(), format!("{order}"), hz, rms]);
        }
    }
    Ok(Table::new("figure", ["cycle", "harmonic", "frequency_hz", "rms_velocity_m_per_s"], rows))
}
