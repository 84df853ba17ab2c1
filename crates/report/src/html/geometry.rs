//! Places of the degrees of freedom of a brake, so that its modes can be seen to move.

use linsys::DofMap;
use nalgebra::DVector;
use num_complex::Complex;
use serde::Serialize;
use serde_json::{Value, json};
use squeal::study::{Plan, Scene};

use super::mesh::MeshSurface;
use crate::Error;

/// Drawing of a brake on a page, for moving mode shapes.
pub struct Geometry<'a>(Body<'a>);

enum Body<'a> {
    Points(Points),
    Mesh(MeshSurface, MeshMotion<'a>),
    /// Reason why there is nothing to be seen.
    Nothing(String),
}

/// Owner of the degrees of freedom of a mode; a reduced brake may have a basis for each.
#[derive(Debug, Clone, Copy)]
pub enum BasisOf<'m> {
    /// A set of constraints, by its index, where its modes have their names.
    Set(usize),
    /// A scene of the brake.
    Scene(&'m Scene),
}

/// A mode whose motion is to be drawn.
#[derive(Debug, Clone, Copy)]
pub struct ModeOf<'m> {
    /// Owner of the degrees of freedom in `shape`.
    pub basis: BasisOf<'m>,
    /// Degrees of freedom of the brake that are free in the mode.
    pub dofs: &'m DofMap,
    /// Right eigenvector over the free degrees of freedom.
    pub shape: &'m DVector<Complex<f64>>,
}

/// Motion of each node of a surface in x, y and z in a mode, node by node.
pub type MeshMotion<'a> = Box<dyn Fn(ModeOf<'_>) -> Result<Vec<Complex<f64>>, Error> + 'a>;

/// A point that moves, or a bar for each of several degrees of freedom that have no direction.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Point {
    /// Name of the point.
    name: String,
    /// Position at rest: x, y and z; of any unit.
    at: [f64; 3],
    /// Degrees of freedom, held ones counted, that move the point in x, y and z.
    dofs: [Option<usize>; 3],
}

/// Points and lines between them.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Points {
    points: Vec<Point>,
    /// Lines between pairs of points, as indices into `points`.
    lines: Vec<[usize; 2]>,
    /// x, y and z are directions of the brake; else each degree of freedom moves in z, beside the others of its body.
    is_spatial: bool,
}

/// Distance at which the plate of a lattice is drawn below its oscillators, in distances of these; chosen.
const PLATE_BELOW: f64 = 0.9;
/// Length by which the plate is drawn beyond the oscillators, in distances of these; chosen.
const PLATE_BEYOND: f64 = 0.5;

impl<'a> Geometry<'a> {
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

    /// The surface of a mesh, and how modes move it. One that is too large for a page is not drawn; the page says so.
    #[must_use]
    pub fn mesh(surface: MeshSurface, motion: MeshMotion<'a>) -> Self {
        Self(match surface.too_large() {
            Some(why) => Body::Nothing(why),
            None => Body::Mesh(surface, motion),
        })
    }

    /// A brake of which no place is known: the page says `why` instead of a picture.
    #[must_use]
    pub fn none(why: impl Into<String>) -> Self {
        Self(Body::Nothing(why.into()))
    }

    /// A brake whose degrees of freedom have no place: all of them side by side, the degrees of freedom of one body joined by a line.
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
    ///
    /// # Errors
    /// A mode that does not fit the mesh.
    pub(super) fn motion(&self, mode: ModeOf<'_>) -> Result<Option<Vec<Complex<f64>>>, Error> {
        Ok(match &self.0 {
            Body::Points(_) => Some(over_all_dofs(mode)),
            Body::Mesh(_, motion) => Some(motion(mode)?),
            Body::Nothing(_) => None,
        })
    }

    /// True of a point of a drawing of points, by its name.
    pub(super) fn has_point(&self, name: &str) -> bool {
        matches!(&self.0, Body::Points(Points { points, .. }) if points.iter().any(|point| point.name == name))
    }

    /// The drawing, or `why` there is nothing, for the script of the page.
    pub(super) fn json(&self) -> Value {
        match &self.0 {
            Body::Points(points) => json!(points),
            Body::Mesh(surface, _) => surface.json(),
            Body::Nothing(why) => json!({ "why": why }),
        }
    }
}

/// A mode over all degrees of freedom; those that are held do not move.
fn over_all_dofs(ModeOf { dofs, shape, .. }: ModeOf<'_>) -> Vec<Complex<f64>> {
    let order = dofs.free().iter().max().map_or(0, |last| last + 1);
    let mut full = vec![Complex::new(0.0, 0.0); order];
    for (&dof, &u) in dofs.free().iter().zip(shape.iter()) {
        full[dof] = u;
    }
    full
}
