//! Normal force and sliding of contacts over the period of cycles, and when contacts are open or stick.

use output::Table;

use super::axis::{AxisScale, PAGE_MARGIN, frame, note, title, x_axis};
use super::canvas::{Area, Canvas, Color, Label, Paint, SMALL_TEXT, TextAnchor};
use super::error::{FigureError, finite};
use super::figure::Figure;
use super::legend::{Entry, legend};
use super::plot::{BELOW, Plot};
use super::style::{BLUE, box_style, filled_box, point_style};

/// Contacts over the period of cycles.
#[derive(Debug, Clone, Default)]
pub struct CycleContactsFigure {
    /// Title above everything; may be empty.
    pub title: String,
    /// Names of the contacts that are drawn.
    pub contacts: Vec<String>,
    /// The cycles.
    pub cycles: Vec<ContactsOfCycle>,
    /// Note below everything; may be empty.
    pub note: String,
}

/// Motion of the contacts of a cycle.
#[derive(Debug, Clone, Default)]
pub struct ContactsOfCycle {
    /// Heading of the cycle.
    pub name: String,
    /// Each contact, as the figure names them, at equal steps of the period.
    pub contacts: Vec<Vec<ContactPoint>>,
}

/// A contact at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPoint {
    /// Normal force, N.
    pub normal_force: f64,
    /// Sliding velocity, m/s.
    pub sliding_velocity: f64,
    /// State of the contact.
    pub does: ContactDoes,
}

/// State of a contact at a moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactDoes {
    /// It slides.
    Slides,
    /// It is closed and sticks.
    Sticks,
    /// It is open.
    Open,
}

/// Height of the panels of a cycle, pt; chosen.
const HEIGHT: f64 = 120.0;
/// Distance between panels, pt; chosen: some two heights of small text.
const GAP: f64 = 16.0;
/// Room for the name of a contact beside its row, pt; chosen: a fifth of the page leaves the panels theirs.
const MOST_NAME: f64 = 100.0;
/// Least height of the row of a contact, pt, in which its name stands.
const ROW: f64 = 11.0;

/// Draws for each cycle normal forces and sliding velocities over a period, a line for each contact, and beside them when each contact is open or
/// sticks. The table has one row per cycle, contact and step.
///
/// # Errors
/// [`FigureError::Empty`] without cycles or contacts, [`FigureError::NotFinite`].
pub fn cycle_contacts_figure(data: &CycleContactsFigure) -> Result<Figure, FigureError> {
    let table = check(data)?;
    let mut canvas = Canvas::new()?;
    let points = || data.cycles.iter().flat_map(|cycle| cycle.contacts.iter().flatten());
    let part = AxisScale::Linear { low: 0.0, high: 1.0, step: 0.2 };
    let period = "part of the period (1)";
    let plot = |label: &str, of: &dyn Fn(&ContactPoint) -> f64| Plot {
        scales: [part, AxisScale::linear(points().map(of), 5.0)],
        labels: [period.to_owned(), label.to_owned()],
    };
    let plots = [
        plot("normal force (N)", &|point| point.normal_force),
        plot("sliding velocity (m/s)", &|point| point.sliding_velocity),
    ];
    let mut y = title(&mut canvas, &data.title);
    y = legend(&mut canvas, y + 4.0, &key(data));
    let height = HEIGHT.max(ROW * data.contacts.len() as f64);
    let margins = plots.each_ref().map(|plot| plot.left(&canvas, height));
    let rows: Vec<String> = data.contacts.iter().map(|name| end_of(&canvas, name)).collect();
    let names = rows.iter().map(|name| canvas.fonts.width(name, SMALL_TEXT, false)).fold(0.0, f64::max) + 6.0;
    let right = canvas.width - PAGE_MARGIN - 6.0;
    let width = (right - PAGE_MARGIN - 2.0 * GAP - margins[0] - margins[1] - names) / 3.0;
    for cycle in &data.cycles {
        for line in canvas.fonts.wrap(&cycle.name, 9.0, true, right - PAGE_MARGIN) {
            y += 12.0;
            canvas.text(Label::new(PAGE_MARGIN, y, line).size(9.0).bold());
        }
        y += 6.0;
        let mut x = PAGE_MARGIN;
        for (at, (plot, margin)) in plots.iter().zip(margins).enumerate() {
            let area = Area { x: x + margin, y, width, height };
            plot.axes(&mut canvas, area);
            lines(&mut canvas, (plot, area), data, cycle, at);
            frame(&mut canvas, area);
            x += margin + width + GAP;
        }
        states(&mut canvas, Area { x: x + names, y, width, height }, (data, &rows), cycle, part);
        y += height + BELOW + 4.0;
    }
    note(&mut canvas, y, &data.note);
    Ok(Figure { canvas, table })
}

/// Lines of normal force, `axis` 0, or of sliding velocity, 1; the end of a period is its begin.
fn lines(
    canvas: &mut Canvas,
    (plot, area): (&Plot, Area),
    data: &CycleContactsFigure,
    cycle: &ContactsOfCycle,
    axis: usize,
) {
    if axis == 1 {
        canvas.line(plot.place(area, [0.0, 0.0]), plot.place(area, [1.0, 0.0]), Paint::stroke(Color::DARK_GREY, 0.8));
    }
    for (series, (name, points)) in data.contacts.iter().zip(&cycle.contacts).enumerate() {
        let value = |point: &ContactPoint| [point.normal_force, point.sliding_velocity][axis];
        let ends = points
            .iter()
            .map(value)
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], value| [least.min(value), most.max(value)]);
        let unit = ["N", "m/s"][axis];
        let words = format!("contact {name}: {:.4} to {:.4} {unit}", ends[0], ends[1]);
        let steps = points.len() as f64;
        let line = points.iter().chain(points.first()).enumerate();
        let line = line.map(|(step, point)| plot.place(area, [step as f64 / steps, value(point)])).collect();
        let style = point_style(series);
        let paint = Paint { dash: style.dash, ..Paint::stroke(style.color, 1.1) };
        canvas.group("contact", words, |canvas| canvas.polyline(line, paint));
    }
}

/// The name of a contact, or its end, by which names of nodes and points differ, where it is too long for its row.
fn end_of(canvas: &Canvas, name: &str) -> String {
    let fits = |text: &str| canvas.fonts.width(text, SMALL_TEXT, false) <= MOST_NAME;
    let mut ends = name.char_indices().map(|(at, _)| format!("..{}", &name[at..]));
    if fits(name) { name.to_owned() } else { ends.find(|end| fits(end)).unwrap_or_default() }
}

/// Bars where contacts are open or stick, a row for each.
fn states(
    canvas: &mut Canvas,
    area: Area,
    (data, rows): (&CycleContactsFigure, &[String]),
    cycle: &ContactsOfCycle,
    part: AxisScale,
) {
    x_axis(canvas, area, &part.ticks(4), true, true);
    canvas.text(Label::new(area.middle_x(), area.bottom() + BELOW, "part of the period (1)").middle());
    let row = area.height / data.contacts.len() as f64;
    for (at, (name, points)) in data.contacts.iter().zip(&cycle.contacts).enumerate() {
        let y = area.y + at as f64 * row;
        canvas.text(Label::new(area.x - 4.0, y + 0.5 * row + 2.9, rows[at].clone()).anchor(TextAnchor::End));
        let shares = [ContactDoes::Open, ContactDoes::Sticks]
            .map(|does| points.iter().filter(|point| point.does == does).count() as f64 / points.len() as f64);
        let words = format!("contact {name}: open in {:.3} of the steps, sticks in {:.3}", shares[0], shares[1]);
        canvas.group("state", words, |canvas| {
            let middle = y + 0.5 * row;
            canvas.line((area.x, middle), (area.right(), middle), Paint::stroke(Color::LIGHT_GREY, 0.8));
            let mut first = 0;
            for run in points.chunk_by(|a, b| a.does == b.does) {
                let step = area.width / points.len() as f64;
                // A step is from half before its moment to half after it, and no bar leaves the panel.
                let end = |at: usize| (area.x + (at as f64 - 0.5) * step).clamp(area.x, area.right());
                let bar =
                    [end(first), if first + run.len() == points.len() { area.right() } else { end(first + run.len()) }];
                let bar = Area { x: bar[0], y: middle - 3.5, width: bar[1] - bar[0], height: 7.0 };
                draw_state(canvas, bar, run[0].does);
                first += run.len();
            }
        });
    }
    frame(canvas, area);
}

fn draw_state(canvas: &mut Canvas, bar: Area, does: ContactDoes) {
    match does {
        ContactDoes::Slides => {}
        ContactDoes::Sticks => canvas.rect(bar, Paint::fill(BLUE)),
        ContactDoes::Open => filled_box(canvas, bar, box_style(1)),
    }
}

fn key(data: &CycleContactsFigure) -> Vec<Entry> {
    let line = |(series, name): (usize, &String)| {
        let style = point_style(series);
        Entry::new(format!("contact {name}"), 16.0, move |canvas: &mut Canvas, (x, y)| {
            canvas.line((x - 8.0, y), (x + 8.0, y), Paint { dash: style.dash, ..Paint::stroke(style.color, 1.1) });
        })
    };
    let bar = |does: ContactDoes, text: &str| {
        Entry::new(text, 16.0, move |canvas: &mut Canvas, (x, y)| {
            draw_state(canvas, Area { x: x - 8.0, y: y - 3.5, width: 16.0, height: 7.0 }, does);
        })
    };
    let states = [bar(ContactDoes::Open, "open"), bar(ContactDoes::Sticks, "closed, sticks")];
    data.contacts.iter().enumerate().map(line).chain(states).collect()
}

/// Checks every value and writes it into the table.
fn check(data: &CycleContactsFigure) -> Result<Table, FigureError> {
    if data.cycles.is_empty() {
        return Err(FigureError::Empty { what: "cycles" });
    }
    if data.contacts.is_empty() || data.cycles.iter().flat_map(|cycle| &cycle.contacts).any(Vec::is_empty) {
        return Err(FigureError::Empty { what: "contacts" });
    }
    let mut rows = Vec::new();
    for cycle in &data.cycles {
        for (name, points) in data.contacts.iter().zip(&cycle.contacts) {
            for (step, point) in points.iter().enumerate() {
                let what = || format!("contact {name} of {}", cycle.name);
                let does = match point.does {
                    ContactDoes::Slides => "slides",
                    ContactDoes::Sticks => "sticks",
                    ContactDoes::Open => "open",
                };
                rows.push(vec![
                    cycle.name.clone(),
                    name.clone(),
                    (step as f64 / points.len() as f64).to_string(),
                    finite(point.normal_force, what)?.to_string(),
                    finite(point.sliding_velocity, what)?.to_string(),
                    does.to_owned(),
                ]);
            }
        }
    }
    let header = ["cycle", "contact", "part_of_period", "normal_force_n", "sliding_velocity_m_per_s", "does"];
    Ok(Table::new("figure", header, rows))
}
