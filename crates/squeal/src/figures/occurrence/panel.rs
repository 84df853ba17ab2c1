//! One panel, and the boxes in it.

use montecarlo::BoxStatistics;

use super::super::axis::{AxisScale, LINE_SPACING, frame, x_axis, y_axis};
use super::super::canvas::{Area, Canvas, Color, Label, Paint, SMALL_TEXT, TextAnchor};
use super::super::error::FigureError;
use super::super::style::{BoxStyle, box_style, diamond, filled_box};
use super::grid::{PanelGrid, Slots};
use super::{OccurrenceFigure, OccurrencePanel};

/// The titles of one line of panels, with the number of arrangements. Returns the y below them.
pub(super) fn headings(canvas: &mut Canvas, grid: &PanelGrid, panels: &[OccurrencePanel], top: f64) -> f64 {
    let mut bottom = top;
    for (c, panel) in panels.iter().enumerate() {
        let area = grid.area(c, top);
        let text = match panel.has_arrangements() {
            true => format!("{}, n\u{a0}=\u{a0}{}", panel.title, panel.arrangements.len()),
            false => panel.title.clone(),
        };
        for (i, line) in canvas.fonts.wrap(&text, SMALL_TEXT, false, area.width).into_iter().enumerate() {
            let y = top + LINE_SPACING * (i + 1) as f64;
            canvas.text(Label::new(area.x, y, line));
            bottom = y.max(bottom);
        }
    }
    bottom
}

/// Draws a panel; `first` in its line it carries the labels of the vertical axis, `lowest` those of the modes.
pub(super) fn draw_panel(
    canvas: &mut Canvas,
    data: &OccurrenceFigure,
    grid: &PanelGrid,
    slots: &Slots,
    panel: &OccurrencePanel,
    area: Area,
    (first, lowest): (bool, bool),
) -> Result<(), FigureError> {
    y_axis(canvas, area, &AxisScale::PERCENT.ticks(5), first);
    x_axis(canvas, area, &grid.ticks, lowest && !grid.upward, false);
    if lowest && grid.upward {
        for tick in &grid.ticks {
            let x = area.x + tick.at * area.width + 2.9;
            canvas.text(Label::new(x, area.bottom() + 4.5, tick.label.clone()).anchor(TextAnchor::End).upward());
        }
    }
    for i in 1..grid.modes.len() {
        let x = area.x + area.width * i as f64 / grid.modes.len() as f64;
        canvas.line((x, area.y), (x, area.bottom()), Paint::stroke(Color::LIGHT_GREY, 0.4).dashed(1.5));
    }
    frame(canvas, area);
    if panel.boxes.iter().all(|b| b.percent.iter().all(|&p| p <= 0.0)) {
        let label = Label::new(area.middle_x(), area.middle_y() - 4.0, "no instability");
        canvas.text(label.middle().color(Color::DARK_GREY).halo());
        return Ok(());
    }
    for b in &panel.boxes {
        let Some(place) = grid.modes.iter().position(|&m| m == b.mode) else { continue };
        let x = area.x + grid.ticks[place].at * area.width + slots.offset(b.series);
        let statistics = BoxStatistics::of(&b.percent)?;
        let (mode, series) = (&data.modes[b.mode], &data.series[b.series]);
        let text = format!(
            "{}, mode {mode}, {series}: median {:.1} %, quartiles {:.1} % and {:.1} %, n = {}",
            panel.title,
            statistics.median,
            statistics.lower_quartile,
            statistics.upper_quartile,
            b.percent.len()
        );
        canvas.group("box", text, |canvas| {
            let y_of = |percent: f64| area.bottom() - AxisScale::PERCENT.at(percent) * area.height;
            let style = box_style(b.series);
            if b.percent.len() == 1 {
                diamond(canvas, (x, y_of(statistics.median)), (0.55 * slots.pitch).min(3.6), style);
            } else {
                draw_box(canvas, x, slots.box_width, &statistics, style, y_of);
            }
        });
    }
    Ok(())
}

fn draw_box(
    canvas: &mut Canvas,
    x: f64,
    width: f64,
    statistics: &BoxStatistics,
    style: BoxStyle,
    y_of: impl Fn(f64) -> f64,
) {
    let line = Paint::stroke(style.line, 0.6);
    for (whisker, edge) in
        [(statistics.lower_whisker, statistics.lower_quartile), (statistics.upper_whisker, statistics.upper_quartile)]
    {
        canvas.line((x, y_of(whisker)), (x, y_of(edge)), line);
        canvas.line((x - width / 4.0, y_of(whisker)), (x + width / 4.0, y_of(whisker)), line);
    }
    let (top, bottom) = (y_of(statistics.upper_quartile), y_of(statistics.lower_quartile));
    let half = width / 2.0;
    // A box thinner than its median line would vanish under it.
    if bottom - top > 2.4 {
        filled_box(canvas, Area { x: x - half, y: top, width, height: bottom - top }, style);
        // A median on the edge of its box would break the outline: half a line inwards it stays visible.
        let y = y_of(statistics.median).clamp(top + 0.9, bottom - 0.9);
        canvas.line((x - half, y), (x + half, y), Paint::stroke(style.median, 1.2));
    } else {
        canvas.line(
            (x - half, y_of(statistics.median)),
            (x + half, y_of(statistics.median)),
            Paint::stroke(style.line, 1.4),
        );
    }
    for &value in &statistics.outliers {
        canvas.circle((x, y_of(value)), (width / 4.0).clamp(0.8, 1.4), Paint::stroke(style.line, 0.5));
    }
}
