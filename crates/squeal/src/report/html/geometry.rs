//! Where the degrees of freedom of a brake are, so that its modes can be seen to move.

use cea::Mode;
use num_complex::Complex;
use serde::Serialize;
use serde_json::{Value, json};

use super::mesh::MeshModes;
use crate::study::{ModeLabel, Plan, origin_of_set};

/// What a page draws of a brake, for moving mode shapes.
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry(Body);

#[derive(Debug, Clone, PartialEq)]
enum Body {
    Points(Points),
    Mesh(MeshModes),
    /// Why there is nothing to be seen.
    Nothing(String),
}

/// A point that moves, or a bar for each of several degrees of freedom that have no direction.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Point {
    /// What it is called.
    name: String,
    /// Where it is at rest: x, y and z; of any unit.
    at: [f64; 3],
    /// The degrees of freedom, held ones counted, that move it in x, y and z.
    dofs: [Option<usize>; 3],
}

/// Points and lines between them.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Points {
    points: Vec<Point>,
    /// Pairs of places in `points`.
    lines: Vec<[usize; 2]>,
    /// Whether x, y and z are directions of the brake; else each degree of freedom moves in z, beside the others of its body.
    is_spatial: bool,
}

/// How far the plate of a lattice is drawn below its oscillators, in distances of these; chosen.
const PLATE_BELOW: f64 = 0.9;
/// How far the plate is drawn beyond the oscillators; chosen.
const PLATE_BEYOND: f64 = 0.5;

impl Geometry {
    /// Oscillators numbered by rows with x along a row and y along a column, three degrees of freedom each, and the plate below them
    /// as the last body.
    #[must_use]
    pub fn lattice(rows: usize, columns: usize) -> Self {
        let dofs = |body: usize| [0, 1, 2].map(|axis| Some(3 * body + axis));
        let mut points = Vec::new();
        let mut lines = Vec::new();
        for i in 0..rows * columns {
            let (row, column) = (i / columns, i % columns);
            points.push(Point { name: (i + 1).to_string(), at: [column as f64, row as f64, 0.0], dofs: dofs(i) });
            if column > 0 {
                lines.push([i - 1, i]);
            }
            if row > 0 {
                lines.push([i - columns, i]);
            }
        }
        let first = points.len();
        let (right, back) = ((columns - 1) as f64 + PLATE_BEYOND, (rows - 1) as f64 + PLATE_BEYOND);
        for at in [[-PLATE_BEYOND, -PLATE_BEYOND], [right, -PLATE_BEYOND], [right, back], [-PLATE_BEYOND, back]] {
            let at = [at[0], at[1], -PLATE_BELOW];
            points.push(Point { name: "plate".into(), at, dofs: dofs(rows * columns) });
        }
        lines.extend((0..4).map(|corner| [first + corner, first + (corner + 1) % 4]));
        Self(Body::Points(Points { points, lines, is_spatial: true }))
    }

    /// The surface of a mesh and its modes. One that is too large for a page is not drawn; the page says so.
    #[must_use]
    pub fn mesh(modes: MeshModes) -> Self {
        Self(modes.too_large().map_or(Body::Mesh(modes), Body::Nothing))
    }

    /// Of a brake of which no place is known: the page says `why` instead of a picture.
    #[must_use]
    pub fn none(why: impl Into<String>) -> Self {
        Self(Body::Nothing(why.into()))
    }

    /// Of a brake whose degrees of freedom have no place: all of them side by side, those of one body joined by a line.
    #[must_use]
    pub fn bodies(plan: &Plan) -> Self {
        let (mut points, mut lines) = (Vec::new(), Vec::new());
        let Some(brake) = plan.origins.first().map(|origin| &origin.brake) else {
            return Self::none("The brake has no degrees of freedom.");
        };
        let mut x = 0.0;
        for body in &brake.bodies {
            for (i, &free) in body.dofs.iter().enumerate() {
                let dof = brake.dofs.free()[free];
                if i > 0 {
                    lines.push([points.len() - 1, points.len()]);
                }
                let name = format!("{}: {}", body.name, plan.labels.dof(dof));
                points.push(Point { name, at: [x, 0.0, 0.0], dofs: [None, None, Some(dof)] });
                x += 1.0;
            }
            x += 1.0;
        }
        Self(Body::Points(Points { points, lines, is_spatial: false }))
    }

    /// The numbers of a mode that move what is drawn; `None` where nothing is.
    pub(super) fn shape(
        &self,
        plan: &Plan,
        constraints: usize,
        name: ModeLabel,
        mode: &Mode,
    ) -> Option<Vec<Complex<f64>>> {
        match &self.0 {
            Body::Points(_) => full_shape(plan, constraints, mode),
            Body::Mesh(mesh) => mesh.shape(constraints, name),
            Body::Nothing(_) => None,
        }
    }

    /// What is drawn, or `why` there is nothing, for the script of the page.
    pub(super) fn json(&self) -> Value {
        match &self.0 {
            Body::Points(points) => json!(points),
            Body::Mesh(mesh) => mesh.json(),
            Body::Nothing(why) => json!({ "why": why }),
        }
    }
}

/// A mode over all degrees of freedom; those that are held do not move.
fn full_shape(plan: &Plan, constraints: usize, mode: &Mode) -> Option<Vec<Complex<f64>>> {
    let dofs = &plan.origins[origin_of_set(plan, constraints)?].brake.dofs;
    let order = dofs.free().iter().max().map_or(0, |last| last + 1);
    let mut full = vec![Complex::new(0.0, 0.0); order];
    for (&dof, &u) in dofs.free().iter().zip(mode.shape.iter()) {
        full[dof] = u;
    }
    Some(full)
}
