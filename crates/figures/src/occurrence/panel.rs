//! A panel, and the boxes in it.

use montecarlo::BoxStatistics;

use super::super::axis::{LINE_SPACING, frame};
use super::super::canvas::{Area, Canvas, Color, Label, Paint, SMALL_TEXT};
use super::super::error::FigureError;
use super::super::style::{BoxStyle, box_style, diamond, filled_box};
use super::data::{Occurrence, OccurrenceBox, OccurrenceFigure, OccurrenceLaw, OccurrencePanel};
use super::grid::{PanelGrid, series_of};

/// Behind the boxes: the 95 % intervals.
pub(super) const INTERVAL: Color = Color(222, 222, 222);
/// The rim of the part that open names leave open.
pub(super) const OPEN: Color = Color(110, 110, 110);
/// The line of a value to compare with.
pub(super) fn mark_paint(mark: usize) -> Paint {
    const DASHES: [f64; 3] = [1.2, 4.0, 2.4];
    Paint::stroke(Color(176, 0, 64), 1.0).dashed(DASHES[mark % DASHES.len()])
}

/// The title of a panel, with the numbers of arrangements and of different systems where there are several.
pub(super) fn panel_title(data: &OccurrenceFigure, panel: &OccurrencePanel) -> String {
    match panel.arrangements.len() {
        _ if !data.has_arrangements() => panel.title.clone(),
        1 => format!("{}: n\u{a0}=\u{a0}1", panel.title),
        n => format!("{}: n\u{a0}=\u{a0}{n}, {}\u{a0}different", panel.title, panel.systems()),
    }
}

/// The titles of one line of panels. Returns the y below them.
pub(super) fn headings(canvas: &mut Canvas, grid: &PanelGrid, law: &OccurrenceLaw, titles: &[String], top: f64) -> f64 {
    let mut bottom = top;
    for (c, title) in titles.iter().enumerate() {
        let area = grid.area(c, top, law);
        for (i, line) in canvas.fonts.wrap(title, SMALL_TEXT, false, area.width).into_iter().enumerate() {
            let y = top + LINE_SPACING * (i + 1) as f64;
            canvas.text(Label::new(area.x, y, line));
            bottom = y.max(bottom);
        }
    }
    bottom
}

/// Draws the panel of that number of a law, without the names of the modes.
pub(super) fn draw_panel(
    canvas: &mut Canvas,
    data: &OccurrenceFigure,
    grid: &PanelGrid,
    [of_law, number]: [usize; 2],
    area: Area,
) -> Result<(), FigureError> {
    let law = &data.laws[of_law];
    let panel = &law.panels[number];
    for tick in &grid.ticks {
        let x = grid.x_at(area, tick.at);
        canvas.line((x, area.y), (x, area.bottom()), Paint::stroke(Color::LIGHT_GREY, 0.5));
        canvas.line((x, area.bottom()), (x, area.bottom() + 2.5), Paint::stroke(Color::BLACK, 0.6));
        canvas.text(Label::new(x, area.bottom() + 2.5 + SMALL_TEXT, tick.label.clone()).middle());
    }
    let row = area.height / grid.modes.len().max(1) as f64;
    for i in 1..grid.modes.len() {
        let y = area.y + row * i as f64;
        canvas.line((area.x, y), (area.right(), y), Paint::stroke(Color::LIGHT_GREY, 0.4).dashed(1.5));
    }
    let series = series_of(law);
    let pitch = 0.9 * row / series.len().max(1) as f64;
    for b in &panel.boxes {
        let (Some(mode), Some(place)) =
            (grid.modes.iter().position(|&m| m == b.mode), series.iter().position(|&s| s == b.series))
        else {
            continue;
        };
        let y = area.y + row * (mode as f64 + 0.05) + pitch * (place as f64 + 0.5);
        let strip = Strip { y, height: pitch.min(9.0), style: box_style(b.series) };
        let name = format!("{}, mode {}, {}", panel.title, data.modes[b.mode].label, data.series[b.series].description);
        draw_box(canvas, &name, b, strip, &|percent| grid.x(area, percent))?;
    }
    for (m, mark) in data.marks.iter().enumerate().filter(|(_, mark)| mark.panels.contains(&[of_law, number])) {
        let x = grid.x(area, mark.percent);
        canvas.group("mark", mark.text.clone(), |canvas| {
            canvas.line((x, area.y), (x, area.bottom()), mark_paint(m));
        });
    }
    frame(canvas, area);
    if !panel.boxes.iter().any(OccurrenceBox::is_ever_unstable) {
        quiet(canvas, panel, area);
    }
    Ok(())
}

/// Says that nothing is unstable in a panel, and how sure that is.
fn quiet(canvas: &mut Canvas, panel: &OccurrencePanel, area: Area) {
    let all = || panel.boxes.iter().flat_map(|b| b.solved());
    let text = match all().map(|value| value.samples).min() {
        None => "no data".to_owned(),
        Some(samples) => {
            let most = all().map(|value| value.upper).fold(0.0, f64::max);
            format!("0 of {samples}: at most {} %", two_digits(most))
        }
    };
    canvas.text(Label::new(area.middle_x(), area.middle_y() + 2.9, text).middle().color(Color::DARK_GREY).halo());
}

/// A percentage with two significant digits below ten.
pub(super) fn two_digits(percent: f64) -> String {
    let digits = if percent > 0.0 { percent.log10().floor() } else { 0.0 };
    let decimals = (1.0 - digits).clamp(0.0, 9.0) as usize;
    format!("{percent:.decimals$}")
}

/// Place and style of a box.
struct Strip {
    y: f64,
    height: f64,
    style: BoxStyle,
}

/// The intervals behind, the open names, and the box; a cross where nothing was solved.
fn draw_box(
    canvas: &mut Canvas,
    name: &str,
    b: &OccurrenceBox,
    strip: Strip,
    x_of: &dyn Fn(f64) -> f64,
) -> Result<(), FigureError> {
    let Strip { y, height, style } = strip;
    let values: Vec<Occurrence> = b.solved().copied().collect();
    let limits = |of: fn(&Occurrence) -> f64| values.iter().map(of);
    let (lower, upper) = (limits(|v| v.lower).fold(100.0, f64::min), limits(|v| v.upper).fold(0.0, f64::max));
    let Some(open) = values.iter().max_by(|a, b| a.open.total_cmp(&b.open)).copied() else {
        canvas.group("no-data", format!("{name}: no sample was solved"), |canvas| cross(canvas, (x_of(0.0), y)));
        return Ok(());
    };
    let statistics = BoxStatistics::of(&limits(|v| v.percent).collect::<Vec<_>>())?;
    let of_one = format!("{:.1} %; 95 % limits", statistics.median);
    let of_all = || {
        let BoxStatistics { median, lower_quartile, upper_quartile, .. } = statistics;
        let quartiles = format!("quartiles {lower_quartile:.1} % and {upper_quartile:.1} %");
        format!("median {median:.1} %, {quartiles}, n = {}; 95 % limits of an arrangement", values.len())
    };
    let found = if values.len() == 1 { of_one } else { of_all() };
    let title = format!("{name}: {found} {lower:.1} % to {upper:.1} %; name open in up to {:.1} %", open.open);
    canvas.group("box", title, |canvas| {
        let band = Area { x: x_of(lower), y: y - height / 2.0, width: x_of(upper) - x_of(lower), height };
        canvas.rect(band, Paint::fill(INTERVAL));
        if !b.is_ever_unstable() {
            // Stable in every sample: there, but not in the way of what is unstable.
            let (x, half) = (x_of(0.0), 0.25 * height);
            canvas.line((x, y - half), (x, y + half), Paint::stroke(style.line, 1.0));
        } else if values.len() == 1 {
            diamond(canvas, (x_of(statistics.median), y), (0.5 * height).min(3.6), style);
        } else {
            box_and_whiskers(canvas, (y, 0.72 * height), &statistics, style, x_of);
        }
        if open.open > 0.0 {
            open_names(canvas, [x_of(open.percent), x_of(open.percent + open.open)], (y, height));
        }
    });
    Ok(())
}

/// The part in which the name of an unstable mode is open.
pub(super) fn open_names(canvas: &mut Canvas, [from, to]: [f64; 2], (y, height): (f64, f64)) {
    let area = Area { x: from, y: y - height / 2.0 + 0.3, width: to - from, height: height - 0.6 };
    canvas.rect(area, Paint::stroke(OPEN, 0.6).dashed(1.2));
}

/// Marks a row without data.
pub(super) fn cross(canvas: &mut Canvas, (x, y): (f64, f64)) {
    for side in [-2.2, 2.2] {
        canvas.line((x - 2.2, y - side), (x + 2.2, y + side), Paint::stroke(OPEN, 0.8));
    }
}

fn box_and_whiskers(
    canvas: &mut Canvas,
    (y, height): (f64, f64),
    statistics: &BoxStatistics,
    style: BoxStyle,
    x_of: &dyn Fn(f64) -> f64,
) {
    let line = Paint::stroke(style.line, 0.6);
    for (whisker, edge) in
        [(statistics.lower_whisker, statistics.lower_quartile), (statistics.upper_whisker, statistics.upper_quartile)]
    {
        canvas.line((x_of(whisker), y), (x_of(edge), y), line);
        canvas.line((x_of(whisker), y - height / 4.0), (x_of(whisker), y + height / 4.0), line);
    }
    let (left, right) = (x_of(statistics.lower_quartile), x_of(statistics.upper_quartile));
    let (top, bottom) = (y - height / 2.0, y + height / 2.0);
    // A box thinner than its median line would vanish under it.
    if right - left > 2.4 {
        filled_box(canvas, Area { x: left, y: top, width: right - left, height }, style);
        // A median on the edge of its box would break the outline: half a line inwards it stays visible.
        let x = x_of(statistics.median).clamp(left + 0.9, right - 0.9);
        canvas.line((x, top), (x, bottom), Paint::stroke(style.median, 1.2));
    } else {
        let x = x_of(statistics.median);
        canvas.line((x, top), (x, bottom), Paint::stroke(style.line, 1.8));
    }
    for &value in &statistics.outliers {
        canvas.circle((x_of(value), y), (height / 4.0).clamp(0.7, 1.3), Paint::stroke(style.line, 0.5));
    }
}
