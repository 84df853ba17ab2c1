//! A mesh and a complex mode shape on it, to be written.

use std::collections::HashMap;

use num_complex::Complex;

use crate::{Dof, FormatsError};

/// A node of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Number of the node in the model.
    pub label: i64,
    /// Coordinates x, y, z.
    pub position: [f64; 3],
}

/// The shape of a cell, with its nodes in the order that VTK, Abaqus and CalculiX have alike for these shapes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CellKind {
    /// A single node.
    Vertex,
    /// Two nodes.
    Line,
    /// Three nodes around.
    Triangle,
    /// Four nodes around.
    Quadrilateral,
    /// A triangle and the node above it.
    Tetrahedron,
    /// Four nodes around the bottom, then the four above them.
    Hexahedron,
}

impl CellKind {
    /// Number of nodes of a cell.
    #[must_use]
    pub fn nodes(self) -> usize {
        match self {
            Self::Vertex => 1,
            Self::Line => 2,
            Self::Triangle => 3,
            Self::Quadrilateral | Self::Tetrahedron => 4,
            Self::Hexahedron => 8,
        }
    }

    /// Pairs of nodes that an edge joins.
    pub(crate) fn edges(self) -> &'static [(usize, usize)] {
        match self {
            Self::Vertex => &[],
            Self::Line => &[(0, 1)],
            Self::Triangle => &[(0, 1), (1, 2), (2, 0)],
            Self::Quadrilateral => &[(0, 1), (1, 2), (2, 3), (3, 0)],
            Self::Tetrahedron => &[(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)],
            Self::Hexahedron => {
                &[(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
            }
        }
    }

    /// The nodes around each face of a solid; empty for a flat shape, a line and a point.
    pub(crate) fn faces(self) -> &'static [&'static [usize]] {
        match self {
            Self::Vertex | Self::Line | Self::Triangle | Self::Quadrilateral => &[],
            Self::Tetrahedron => &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]],
            Self::Hexahedron => {
                &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]]
            }
        }
    }
}

/// A cell of a mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cell {
    /// Shape of the cell.
    pub kind: CellKind,
    /// Nodes of the cell, by their index in [`Mesh::nodes`] from 0.
    pub nodes: Vec<usize>,
}

/// Nodes and cells.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// The nodes, each number once.
    pub nodes: Vec<Node>,
    /// The cells; there may be none.
    pub cells: Vec<Cell>,
}

impl Mesh {
    /// Places, in a list of degrees of freedom, of x, y and z of each node; `None` where it lacks them.
    #[must_use]
    pub fn rows_of_nodes(&self, labels: &[Dof]) -> Vec<[Option<usize>; 3]> {
        let place: HashMap<i64, usize> = self.nodes.iter().map(|node| node.label).zip(0..).collect();
        let mut rows = vec![[None; 3]; self.nodes.len()];
        for (row, dof) in labels.iter().enumerate() {
            if let (Some(&node), 1..=3) = (place.get(&dof.node), dof.direction) {
                rows[node][dof.direction as usize - 1] = Some(row);
            }
        }
        rows
    }
}

/// A complex mode `u(t) = Re(phi e^{lambda t})`: its eigenvalue and the displacement of each node of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct ModeShape {
    /// A name in one line, such as `mode 3`.
    pub name: String,
    /// Eigenvalue lambda, 1/s.
    pub lambda: Complex<f64>,
    /// x, y and z of phi at each node of the mesh.
    pub displacements: Vec<[Complex<f64>; 3]>,
}

impl ModeShape {
    /// The shape at the nodes of `mesh`, from the entries of an eigenvector and the names of its rows. Directions that are missing
    /// (held in the model, or no node of the vector) are 0; rotations and nodes that the mesh does not have are left out.
    ///
    /// # Errors
    /// [`FormatsError::Shape`] where there are not as many names as entries.
    pub fn new(
        name: impl Into<String>,
        lambda: Complex<f64>,
        mesh: &Mesh,
        labels: &[Dof],
        phi: &[Complex<f64>],
    ) -> Result<Self, FormatsError> {
        if labels.len() != phi.len() {
            let (what, found) = ("the number of labels is", labels.len().to_string());
            return Err(FormatsError::Shape {
                what,
                found,
                allowed: format!("{}, the entries of the vector", phi.len()),
            });
        }
        let value = |at: Option<usize>| at.map_or(Complex::default(), |at| phi[at]);
        let displacements = mesh.rows_of_nodes(labels).into_iter().map(|rows| rows.map(value)).collect();
        Ok(Self { name: name.into(), lambda, displacements })
    }
}

/// Numbers or vectors at the nodes of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshField {
    /// A name in one line.
    pub name: String,
    /// Values at each node of the mesh: a list of numbers, or of vectors three lists, of x, y and z.
    pub values: Vec<Vec<f64>>,
}

impl MeshField {
    /// Checks that the field can be written.
    pub(crate) fn check(&self, mesh: &Mesh) -> Result<(), FormatsError> {
        let of_each = |values: &Vec<f64>| values.len() == mesh.nodes.len() && values.iter().all(|x| x.is_finite());
        let is_one = matches!(self.values.len(), 1 | 3) && self.values.iter().all(of_each);
        if is_one && !self.name.chars().any(char::is_control) {
            return Ok(());
        }
        let found = format!("{:?}", crate::shortened::cut(&self.name));
        let allowed = "one or three lists with a finite number for each node, a name of one line".to_owned();
        Err(FormatsError::Shape { what: "the field", found, allowed })
    }
}

/// Checks that a mesh and shapes on it can be written.
pub(crate) fn check(mesh: &Mesh, shapes: &[ModeShape]) -> Result<(), FormatsError> {
    let refused =
        |what, found: String, allowed: &str| Err(FormatsError::Shape { what, found, allowed: allowed.to_owned() });
    if mesh.nodes.is_empty() {
        return refused("the mesh has", "no nodes".to_owned(), "one or more");
    }
    if let Some(node) = mesh.nodes.iter().find(|node| node.position.iter().any(|x| !x.is_finite())) {
        return refused("the position of node", format!("{} is not finite", node.label), "finite coordinates");
    }
    for cell in &mesh.cells {
        if cell.nodes.len() != cell.kind.nodes() {
            let found = format!("{:?} has {} nodes", cell.kind, cell.nodes.len());
            return refused("a cell", found, &cell.kind.nodes().to_string());
        }
        if let Some(node) = cell.nodes.iter().find(|&&node| node >= mesh.nodes.len()) {
            return refused("a cell has node", node.to_string(), &format!("0 to {}", mesh.nodes.len() - 1));
        }
    }
    for shape in shapes {
        if shape.displacements.len() != mesh.nodes.len() {
            let allowed = format!("{}, one for each node", mesh.nodes.len());
            return refused("the number of displacements is", shape.displacements.len().to_string(), &allowed);
        }
        let mut numbers = shape.displacements.iter().flatten().chain([&shape.lambda]);
        if numbers.any(|z| !z.re.is_finite() || !z.im.is_finite()) || shape.name.chars().any(char::is_control) {
            return refused(
                "the shape",
                format!("{:?}", crate::shortened::cut(&shape.name)),
                "finite numbers, a name of one line",
            );
        }
    }
    Ok(())
}
