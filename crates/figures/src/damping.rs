//! Damping ratio against frequency: the picture of complex eigenvalue analyses, with the ranges that modes have over the draws.

use output::Table;

use super::axis::{
    AxisScale, LINE_SPACING, PAGE_MARGIN, frame, note, title, widest, x_axis, y_axis, y_title, y_title_width,
};
use super::canvas::{Area, Canvas, Color, Label, Paint, SMALL_TEXT};
use super::error::{FigureError, finite};
use super::figure::Figure;
use super::legend::{Entry, legend};
use super::point_names::write_names;
use super::style::VERMILLION;

/// Modes by frequency and damping ratio.
#[derive(Debug, Clone, Default)]
pub struct DampingFigure {
    /// Title above everything; may be empty.
    pub title: String,
    /// Modes that are unstable in some draws.
    pub unstable: Vec<UnstableRange>,
    /// Modes that never surely are: name, frequency, Hz, and damping ratio.
    pub stable: Vec<(String, [f64; 2])>,
    /// Note below everything; may be empty.
    pub note: String,
}

/// An unstable mode over the draws in which it is unstable.
#[derive(Debug, Clone, Default)]
pub struct UnstableRange {
    /// Name of the mode.
    pub mode: String,
    /// Lowest, median and highest frequency, Hz.
    pub hz: [f64; 3],
    /// Worst, median and best damping ratio.
    pub damping_ratio: [f64; 3],
}

/// Height of the panel, pt; chosen.
const HEIGHT: f64 = 230.0;
/// Least damping ratio that the axis reaches on either side; chosen.
const LEAST_REACH: f64 = 1e-3;

/// Draws damping ratio against frequency. The axis reaches as far above zero as below, so that what happens about zero is not squeezed by modes
/// with much damping; how many lie beyond is said.
///
/// # Errors
/// [`FigureError::Empty`] without modes, [`FigureError::NotFinite`].
pub fn damping_figure(data: &DampingFigure) -> Result<Figure, FigureError> {
    let table = check(data)?;
    let mut canvas = Canvas::new()?;
    let worst = data.unstable.iter().map(|mode| -mode.damping_ratio[0]).fold(LEAST_REACH, f64::max);
    let (shown, beyond): (Vec<_>, Vec<_>) = data.stable.iter().partition(|(_, [_, ratio])| *ratio <= worst);
    let hertz = data.unstable.iter().flat_map(|mode| mode.hz).chain(shown.iter().map(|(_, [hz, _])| *hz));
    let [least, most] = hertz.fold([f64::INFINITY, 0.0], |[least, most], hz| [hz.min(least), hz.max(most)]);
    // Of modes at one frequency the axis reaches to both sides.
    let margin = if most > least { 0.02 * (most - least) } else { 0.05 * most };
    let hertz = AxisScale::between(((least - margin).max(0.0), most + margin), 8.0);
    let ratio = AxisScale::between((-worst, worst), 6.0);
    let label = "damping ratio (1)";
    let mut y = title(&mut canvas, &data.title);
    let range = |canvas: &mut Canvas, (x, y): (f64, f64)| {
        canvas.line((x, y - 5.0), (x, y + 5.0), Paint::stroke(VERMILLION, 1.3));
        canvas.circle((x, y), 2.7, Paint::fill(VERMILLION));
    };
    let mut entries = vec![
        Entry::new("unstable in some draws: median and range over these", 8.0, range),
        Entry::new("never surely unstable, at median parameters", 8.0, stable_mark),
    ];
    if !beyond.is_empty() {
        let lie = if beyond.len() == 1 { "mode with more damping lies" } else { "modes with more damping lie" };
        entries.push(Entry { symbol: None, text: format!("{} {lie} above the picture", beyond.len()) });
    }
    y = legend(&mut canvas, y + 4.0, &entries);
    let ticks = ratio.ticks(8);
    let numbers = widest(&canvas, &ticks) + 6.0;
    let left = PAGE_MARGIN + y_title_width(&canvas, HEIGHT, label) + numbers;
    let area = Area { x: left, y: y + 4.0, width: canvas.width - PAGE_MARGIN - 10.0 - left, height: HEIGHT };
    y_axis(&mut canvas, area, &ticks, true);
    x_axis(&mut canvas, area, &hertz.ticks(12), true, true);
    y_title(&mut canvas, area.x - numbers, area, label);
    y = area.bottom() + SMALL_TEXT + LINE_SPACING + 2.0;
    canvas.text(Label::new(area.middle_x(), y, "frequency (Hz)").middle());
    let place = |hz: f64, at: f64| (area.x + hertz.at(hz) * area.width, area.bottom() - ratio.at(at) * area.height);
    let zero = place(0.0, 0.0).1;
    canvas.line((area.x, zero), (area.right(), zero), Paint::stroke(Color::BLACK, 0.8));
    for (mode, [hz, at]) in shown {
        canvas.group("stable", format!("mode {mode}: {hz} Hz, damping ratio {at}"), |canvas| {
            stable_mark(canvas, place(*hz, *at));
        });
    }
    for UnstableRange { mode, hz, damping_ratio } in &data.unstable {
        let words = format!(
            "mode {mode}: {} Hz ({} to {}), damping ratio {} ({} to {})",
            hz[1], hz[0], hz[2], damping_ratio[1], damping_ratio[0], damping_ratio[2]
        );
        canvas.group("unstable", words, |canvas| {
            let at = place(hz[1], damping_ratio[1]);
            let paint = Paint::stroke(VERMILLION, 1.3);
            canvas.line(place(hz[1], damping_ratio[0]), place(hz[1], damping_ratio[2]), paint);
            canvas.line(place(hz[0], damping_ratio[1]), place(hz[2], damping_ratio[1]), paint);
            canvas.circle(at, 2.7, Paint::fill(VERMILLION));
        });
    }
    frame(&mut canvas, area);
    let points = data.unstable.iter().map(|of| (of.mode.as_str(), place(of.hz[1], of.damping_ratio[2])));
    write_names(&mut canvas, area, points.collect());
    y += 8.0;
    note(&mut canvas, y, &data.note);
    Ok(Figure { canvas, table })
}

fn stable_mark(canvas: &mut Canvas, at: (f64, f64)) {
    canvas.circle(at, 2.4, Paint::fill(Color::WHITE).outlined(Color::DARK_GREY, 1.0));
}

/// Checks every value and writes it into the table.
fn check(data: &DampingFigure) -> Result<Table, FigureError> {
    if data.unstable.is_empty() && data.stable.is_empty() {
        return Err(FigureError::Empty { what: "modes" });
    }
    let mut rows = Vec::new();
    let mut row = |kind: &str, mode: &str, numbers: [f64; 6]| -> Result<(), FigureError> {
        for value in numbers {
            finite(value, || format!("mode {mode}"))?;
        }
        let numbers = numbers.map(|value| value.to_string());
        rows.push([kind.to_owned(), mode.to_owned()].into_iter().chain(numbers).collect::<Vec<_>>());
        Ok(())
    };
    for UnstableRange { mode, hz: [a, b, c], damping_ratio: [d, e, f] } in &data.unstable {
        row("unstable", mode, [*a, *b, *c, *d, *e, *f])?;
    }
    for (mode, [hz, ratio]) in &data.stable {
        row("stable", mode, [*hz, *hz, *hz, *ratio, *ratio, *ratio])?;
    }
    let header = [
        "kind",
        "mode",
        "lowest_hz",
        "median_hz",
        "highest_hz",
        "worst_damping_ratio",
        "median_damping_ratio",
        "best_damping_ratio",
    ];
    Ok(Table::new("damping", header, rows))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axis_is_about_zero_and_says_what_lies_beyond() {
        let unstable =
            UnstableRange { mode: "14".into(), hz: [2590.0, 2600.0, 2610.0], damping_ratio: [-0.02, -0.01, -0.001] };
        let stable = vec![("1".into(), [900.0, 0.015]), ("2".into(), [1200.0, 0.4])];
        let data = DampingFigure { title: "a brake".into(), unstable: vec![unstable], stable, note: "a note".into() };
        let figure = damping_figure(&data).unwrap();
        let svg = figure.svg();
        for words in [
            "1 mode with more damping lies",
            "mode 14: 2600 Hz (2590 to 2610), damping ratio -0.01",
            "mode 1: 900 Hz",
            "a note",
        ] {
            assert!(svg.contains(words), "{words:?} is missing");
        }
        assert!(!svg.contains("mode 2: 1200 Hz"));
        assert_eq!(figure.table.rows.len(), 3);
        assert!(matches!(damping_figure(&DampingFigure::default()), Err(FigureError::Empty { .. })));
        let wrong = DampingFigure { stable: vec![("1".into(), [900.0, f64::NAN])], ..data };
        assert!(matches!(damping_figure(&wrong), Err(FigureError::NotFinite { .. })));
    }
}
