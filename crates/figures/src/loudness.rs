//! Loudness of motions against the growth of the modes that they start from.

use output::Table;

use super::axis::{AxisScale, PAGE_MARGIN, frame, note, title};
use super::canvas::{Area, Canvas, Color, Label, Paint};
use super::error::{FigureError, finite};
use super::figure::Figure;
use super::legend::{Entry, legend};
use super::plot::{BELOW, Plot};
use super::style::{marker, point_style};

/// Motions by the growth of their mode and their loudness.
#[derive(Debug, Clone, Default)]
pub struct LoudnessFigure {
    /// Title above everything; may be empty.
    pub title: String,
    /// Names of the modes, in the order of their marks.
    pub modes: Vec<String>,
    /// The panels, one or more.
    pub panels: Vec<LoudnessPanel>,
    /// Note below everything; may be empty.
    pub note: String,
}

/// Motions of a panel.
#[derive(Debug, Clone, Default)]
pub struct LoudnessPanel {
    /// Heading of the panel.
    pub name: String,
    /// Motions.
    pub motions: Vec<LoudMotion>,
}

/// A motion from a mode.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LoudMotion {
    /// Index of the mode among the names.
    pub mode: usize,
    /// Growth rate of the mode, 1/s.
    pub growth: f64,
    /// Loudness of the motion, m/s.
    pub loudness: f64,
    /// Kind of the motion, in words.
    pub kind: &'static str,
    /// The motion is a limit cycle.
    pub is_cycle: bool,
    /// Index of the sample.
    pub sample: u64,
}

/// Height of a panel, pt; chosen.
const HEIGHT: f64 = 130.0;

/// Draws the loudness of each motion over the growth of the mode that it starts from, with a mark for each mode and a ring about cycles. All panels have one axis of growth, and each
/// its own of loudness. The table has one row for each motion.
///
/// # Errors
/// [`FigureError::Empty`] without motions, [`FigureError::NotFinite`].
pub fn loudness_figure(data: &LoudnessFigure) -> Result<Figure, FigureError> {
    let table = check(data)?;
    let mut canvas = Canvas::new()?;
    let growth = AxisScale::linear(data.panels.iter().flat_map(|of| &of.motions).map(|motion| motion.growth), 8.0);
    let plots = data.panels.iter().map(|of| Plot {
        scales: [growth, AxisScale::linear(of.motions.iter().map(|motion| motion.loudness), 5.0)],
        labels: ["growth of the mode (1/s)".to_owned(), "loudness (m/s)".to_owned()],
    });
    let plots: Vec<Plot> = plots.collect();
    let mut y = title(&mut canvas, &data.title);
    let mut entries: Vec<Entry> = Vec::new();
    for (at, mode) in data.modes.iter().enumerate() {
        entries.push(Entry::new(format!("mode {mode}"), 8.0, move |canvas, place| {
            marker(canvas, place, point_style(at));
        }));
    }
    entries.push(Entry::new("a cycle", 11.0, ring));
    y = legend(&mut canvas, y + 4.0, &entries);
    let left = PAGE_MARGIN + plots.iter().map(|plot| plot.left(&canvas, HEIGHT)).fold(0.0, f64::max);
    let right = canvas.width - PAGE_MARGIN - 10.0;
    for (panel, plot) in data.panels.iter().zip(&plots) {
        for line in canvas.fonts.wrap(&panel.name, 9.0, true, right - PAGE_MARGIN) {
            y += 12.0;
            canvas.text(Label::new(PAGE_MARGIN, y, line).size(9.0).bold());
        }
        let area = Area { x: left, y: y + 6.0, width: right - left, height: HEIGHT };
        plot.axes(&mut canvas, area);
        for motion in &panel.motions {
            let LoudMotion { mode, growth, loudness, kind, sample, .. } = motion;
            let words = format!(
                "mode {} of sample {sample}: growth {growth:.1} 1/s, {kind}, loudness {loudness:.4} m/s",
                data.modes[*mode]
            );
            canvas.group("motion", words, |canvas| {
                let at = plot.place(area, [motion.growth, motion.loudness]);
                if motion.is_cycle {
                    ring(canvas, at);
                }
                marker(canvas, at, point_style(motion.mode));
            });
        }
        frame(&mut canvas, area);
        y = area.bottom() + BELOW + 4.0;
    }
    note(&mut canvas, y, &data.note);
    Ok(Figure { canvas, table })
}

fn ring(canvas: &mut Canvas, at: (f64, f64)) {
    canvas.circle(at, 4.6, Paint::stroke(Color::BLACK, 0.8));
}

/// Checks every value and writes it into the table.
fn check(data: &LoudnessFigure) -> Result<Table, FigureError> {
    let mut rows = Vec::new();
    for panel in &data.panels {
        for motion in &panel.motions {
            let name = data.modes.get(motion.mode).ok_or(FigureError::Empty { what: "names of modes" })?;
            for value in [motion.growth, motion.loudness] {
                finite(value, || format!("a motion of mode {name}"))?;
            }
            let numbers = [motion.growth, motion.loudness].map(|value| value.to_string());
            let own = [panel.name.clone(), motion.sample.to_string(), name.clone(), motion.kind.to_owned()];
            rows.push(own.into_iter().chain(numbers).collect::<Vec<_>>());
        }
    }
    if rows.is_empty() {
        return Err(FigureError::Empty { what: "motions" });
    }
    Ok(Table::new("figure", ["panel", "sample", "mode", "kind", "growth_per_s", "loudness_m_per_s"], rows))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_motion_has_its_mark_and_a_cycle_its_ring() {
        let motion = |mode, growth, loudness, kind| LoudMotion {
            mode,
            growth,
            loudness,
            kind,
            is_cycle: kind == "cycle",
            sample: 12,
        };
        let panel = LoudnessPanel {
            name: "nine in contact".into(),
            motions: vec![
                motion(0, 120.0, 2.5, "cycle"),
                motion(1, 250.0, 1.5, "not settled"),
                motion(0, 130.0, 0.0, "rest"),
            ],
        };
        let data = LoudnessFigure {
            title: "a brake".into(),
            modes: vec!["16".into(), "20|22".into()],
            panels: vec![panel],
            note: "a note".into(),
        };
        let figure = loudness_figure(&data).unwrap();
        let svg = figure.svg();
        for words in [
            "mode 20|22 of sample 12: growth 250.0 1/s, not settled, loudness 1.5000 m/s",
            "nine in contact",
            "a note",
            "a cycle",
        ] {
            assert!(svg.contains(words), "{words:?} is missing");
        }
        assert_eq!(svg.matches("r=\"4.6\"").count(), 2); // a cycle and the key
        assert_eq!(figure.table.rows.len(), 3);
        assert!(matches!(loudness_figure(&LoudnessFigure::default()), Err(FigureError::Empty { .. })));
        let mut wrong = data.clone();
        wrong.panels[0].motions[0].loudness = f64::NAN;
        assert!(matches!(loudness_figure(&wrong), Err(FigureError::NotFinite { .. })));
        wrong.panels[0].motions[0] = motion(7, 1.0, 1.0, "cycle");
        assert!(matches!(loudness_figure(&wrong), Err(FigureError::Empty { .. })));
    }
}
