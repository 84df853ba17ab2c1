//! The model as a drawing: the lattice in plan view, and one oscillator from the side and from above.

mod diagram;
mod elements;
mod oscillator;
mod plan;

use super::axis::{PAGE_MARGIN, title};
use super::canvas::{Area, Canvas};
use super::error::{FigureError, finite};
use super::figure::Figure;
pub use diagram::ModelDiagram;
use oscillator::{from_above, from_the_side};
use output::Table;
use plan::plan;

/// Draws the model: numbered oscillators (grey: in contact) with the numbers of the springs between them, and one
/// oscillator in the upright plane of its inclined spring, where theta has its true size, and from above, where phi has.
/// Stiffnesses and damping coefficients have the symbols of the paper's Table 1. The table lists the springs with the bodies
/// that they join.
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
    let y = from_the_side(&mut canvas, data, side) + 14.0;
    let oscillator_bottom = from_above(&mut canvas, data, Area { y, ..side });
    canvas.height = plan_bottom.max(oscillator_bottom) + PAGE_MARGIN;
    Ok(Figure { canvas, table: springs(data) })
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
    Table::new("figure", ["axis", "spring", "from", "to"], rows)
}
