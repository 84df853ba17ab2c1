//! Nodes and solid elements, and the degrees of freedom of a model that belong to them.

use std::collections::{HashMap, HashSet};

use nalgebra::Vector3;

use crate::{ElementsError, Kind};

/// Solid element of a mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Element {
    /// Number of the element in the model.
    pub label: i64,
    /// Kind of the element.
    pub kind: Kind,
    /// Nodes of the element, by their indices in the mesh from 0.
    pub nodes: Vec<usize>,
}

/// Mesh of solid elements, checked: numbers are there once, and each element has the nodes of its kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    labels: Vec<i64>,
    positions: Vec<Vector3<f64>>,
    places: HashMap<i64, usize>,
    elements: Vec<Element>,
}

impl Mesh {
    /// The mesh of nodes (number, x, y, z) and elements (number, kind, numbers of its nodes in the order of Abaqus and CalculiX).
    ///
    /// # Errors
    /// No nodes or no elements, a number twice, coordinates that are not finite, an element of unknown nodes or with more or fewer than its
    /// kind has.
    ///
    /// ```
    /// use elements::{Kind, Mesh};
    /// let nodes = vec![(1, [0.0; 3]), (2, [1.0, 0.0, 0.0]), (5, [0.0, 1.0, 0.0]), (7, [0.0, 0.0, 1.0])];
    /// let mesh = Mesh::new(nodes, vec![(10, Kind::Tetrahedron4, vec![1, 2, 5, 7])])?;
    /// assert!((mesh.volume(0)? - 1.0 / 6.0).abs() < 1e-15);
    /// # Ok::<(), elements::ElementsError>(())
    /// ```
    pub fn new(nodes: Vec<(i64, [f64; 3])>, elements: Vec<(i64, Kind, Vec<i64>)>) -> Result<Self, ElementsError> {
        for (what, is_empty) in [("nodes", nodes.is_empty()), ("elements", elements.is_empty())] {
            if is_empty {
                return Err(ElementsError::Empty { what });
            }
        }
        let mut mesh = Self {
            labels: Vec::with_capacity(nodes.len()),
            positions: Vec::with_capacity(nodes.len()),
            places: HashMap::with_capacity(nodes.len()),
            elements: Vec::with_capacity(elements.len()),
        };
        for (label, position) in nodes {
            if !position.iter().all(|x| x.is_finite()) {
                return Err(ElementsError::Position { node: label });
            }
            if mesh.places.insert(label, mesh.labels.len()).is_some() {
                return Err(ElementsError::Twice { what: "node", label });
            }
            mesh.labels.push(label);
            mesh.positions.push(position.into());
        }
        let mut known = HashSet::with_capacity(elements.len());
        for (label, kind, nodes) in elements {
            let (found, expected) = (nodes.len(), kind.nodes());
            if found != expected {
                return Err(ElementsError::NodeCount { element: label, kind, found, expected });
            }
            if !known.insert(label) {
                return Err(ElementsError::Twice { what: "element", label });
            }
            let place = |node: i64| mesh.place(node).ok_or(ElementsError::UnknownNode { element: label, node });
            let nodes = nodes.into_iter().map(place).collect::<Result<_, _>>()?;
            mesh.elements.push(Element { label, kind, nodes });
        }
        Ok(mesh)
    }

    /// Numbers of the nodes in the model, by their indices.
    #[must_use]
    pub fn labels(&self) -> &[i64] {
        &self.labels
    }

    /// Positions of the nodes, by their indices.
    #[must_use]
    pub fn positions(&self) -> &[Vector3<f64>] {
        &self.positions
    }

    /// Index of a node by its number in the model; `None` where the mesh lacks it.
    #[must_use]
    pub fn place(&self, label: i64) -> Option<usize> {
        self.places.get(&label).copied()
    }

    /// Elements, by their indices.
    #[must_use]
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// The element with an index, from 0.
    ///
    /// # Errors
    /// No such element.
    pub fn element(&self, place: usize) -> Result<&Element, ElementsError> {
        let total = self.elements.len();
        self.elements.get(place).ok_or(ElementsError::NoElement { place, total })
    }

    /// Indices of all elements.
    #[must_use]
    pub fn all(&self) -> Vec<usize> {
        (0..self.elements.len()).collect()
    }
}

/// Degrees of freedom of a model, from 0: the row of each node of a mesh in x, y and z, where the model has one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rows {
    order: usize,
    of: Vec<[Option<usize>; 3]>,
}

impl Rows {
    /// Three rows for each node, in the order of the nodes.
    #[must_use]
    pub fn all(mesh: &Mesh) -> Self {
        let nodes = mesh.labels().len();
        Self { order: 3 * nodes, of: (0..nodes).map(|node| [0, 1, 2].map(|x| Some(3 * node + x))).collect() }
    }

    /// Rows of a model of `order` of them: what a function says of the number of a node and a direction, 0 to 2 for x to z. Where it
    /// says `None` the model holds the node.
    ///
    /// # Errors
    /// A row that is not below the order.
    pub fn new(
        mesh: &Mesh,
        order: usize,
        mut row: impl FnMut(i64, usize) -> Option<usize>,
    ) -> Result<Self, ElementsError> {
        let of: Vec<[Option<usize>; 3]> = mesh.labels().iter().map(|&node| [0, 1, 2].map(|x| row(node, x))).collect();
        for (rows, &node) in of.iter().zip(mesh.labels()) {
            if let Some(&row) = rows.iter().flatten().find(|row| **row >= order) {
                return Err(ElementsError::Row { node, row, order });
            }
        }
        Ok(Self { order, of })
    }

    /// Number of rows of the model.
    #[must_use]
    pub fn order(&self) -> usize {
        self.order
    }

    /// Row of a node, by its index in the mesh, in a direction, 0 to 2 for x to z; `None` where the model has no such row.
    #[must_use]
    pub fn row(&self, place: usize, direction: usize) -> Option<usize> {
        self.of.get(place)?.get(direction).copied().flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [(i64, [f64; 3]); 4] =
        [(1, [0.0; 3]), (2, [1.0, 0.0, 0.0]), (3, [0.0, 1.0, 0.0]), (9, [0.0, 0.0, 1.0])];

    fn of(nodes: &[(i64, [f64; 3])], elements: &[(i64, Kind, &[i64])]) -> Result<Mesh, ElementsError> {
        let elements = elements.iter().map(|&(label, kind, nodes)| (label, kind, nodes.to_vec())).collect();
        Mesh::new(nodes.to_vec(), elements)
    }

    #[test]
    fn what_is_no_mesh_is_refused() {
        let tetrahedron = (4, Kind::Tetrahedron4, &[1, 2, 3, 9][..]);
        assert!(of(&CORNERS, &[tetrahedron]).is_ok());
        assert_eq!(of(&[], &[tetrahedron]), Err(ElementsError::Empty { what: "nodes" }));
        assert_eq!(of(&CORNERS, &[]), Err(ElementsError::Empty { what: "elements" }));
        let twice = ElementsError::Twice { what: "element", label: 4 };
        assert_eq!(of(&CORNERS, &[tetrahedron, tetrahedron]), Err(twice));
        let mut nodes = CORNERS;
        nodes[3].0 = 2;
        assert_eq!(of(&nodes, &[tetrahedron]), Err(ElementsError::Twice { what: "node", label: 2 }));
        nodes[3] = (9, [f64::NAN, 0.0, 0.0]);
        assert_eq!(of(&nodes, &[tetrahedron]), Err(ElementsError::Position { node: 9 }));
        let unknown = ElementsError::UnknownNode { element: 4, node: 8 };
        assert_eq!(of(&CORNERS, &[(4, Kind::Tetrahedron4, &[1, 2, 3, 8])]), Err(unknown));
        let kind = Kind::Hexahedron8;
        let count = ElementsError::NodeCount { element: 4, kind, found: 4, expected: 8 };
        assert_eq!(of(&CORNERS, &[(4, kind, &[1, 2, 3, 9])]), Err(count));
    }

    #[test]
    fn rows_are_those_of_the_model() {
        let mesh = of(&CORNERS, &[(4, Kind::Tetrahedron4, &[1, 2, 3, 9])]).unwrap();
        let rows = Rows::new(&mesh, 5, |node, x| (node == 9 && x == 2).then_some(4)).unwrap();
        assert_eq!((rows.order(), rows.row(3, 2), rows.row(3, 0), rows.row(7, 0)), (5, Some(4), None, None));
        let error = Rows::new(&mesh, 4, |node, _| (node == 2).then_some(4));
        assert_eq!(error, Err(ElementsError::Row { node: 2, row: 4, order: 4 }));
        assert_eq!(Rows::all(&mesh).row(1, 2), Some(5));
    }
}
