//! Faces of elements where they lie in the mesh, and those that are seen from outside.

use std::collections::{HashMap, HashSet};

use nalgebra::Vector3;

use crate::faces::{FaceKind, FaceShape};
use crate::{ElementsError, Mesh};

/// Face of an element: the index of the element in the mesh, and the number of the face from 1 (S1, S2, ...).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FaceId {
    /// Index of the element in the mesh, from 0.
    pub element: usize,
    /// The number of the face, from 1.
    pub number: usize,
}

/// Face of an element with its nodes where they are.
#[derive(Debug, Clone, PartialEq)]
pub struct Face {
    /// Element and number of the face.
    pub id: FaceId,
    /// Kind of the face.
    pub kind: FaceKind,
    /// Nodes of the face, by their indices in the mesh: corners so that from outside they go around against the clock, then middles.
    pub nodes: Vec<usize>,
    /// Positions of these nodes.
    pub positions: Vec<Vector3<f64>>,
}

/// Point on a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Position of the point.
    pub position: Vector3<f64>,
    /// Tangents `dx/dr` and `dx/ds` by the own coordinates of the face.
    pub tangents: [Vector3<f64>; 2],
    /// Normal `dx/dr x dx/ds`, which points out of the element; its length is the area by area in own coordinates.
    pub area: Vector3<f64>,
    /// Shape functions of the face.
    pub shape: FaceShape,
}

impl Face {
    /// The point at own coordinates, also beyond the border.
    #[must_use]
    pub fn at(&self, own: [f64; 2]) -> SurfacePoint {
        self.kind.at(&self.positions, own)
    }

    /// Area of the face with its normal, `int n dA`; its length is the area where it is flat.
    #[must_use]
    pub fn area(&self) -> Vector3<f64> {
        self.kind.rule().into_iter().map(|(own, weight)| self.at(own).area * weight).sum()
    }
}

impl FaceKind {
    /// The point at own coordinates, also beyond the border, of a face with its nodes at these positions.
    #[must_use]
    pub fn at(self, positions: &[Vector3<f64>], own: [f64; 2]) -> SurfacePoint {
        let shape = self.shape(own);
        let mut position = Vector3::zeros();
        let mut tangents = [Vector3::zeros(); 2];
        for ((node, &n), d) in positions.iter().zip(shape.values()).zip(shape.derivatives()) {
            position += node * n;
            tangents[0] += node * d[0];
            tangents[1] += node * d[1];
        }
        SurfacePoint { position, tangents, area: tangents[0].cross(&tangents[1]), shape }
    }
}

impl Mesh {
    /// A face.
    ///
    /// # Errors
    /// No such element, no such face of it.
    pub fn face(&self, id: FaceId) -> Result<Face, ElementsError> {
        let element = self.element(id.element)?;
        let Some(own) = element.kind.face(id.number) else {
            let faces = element.kind.faces();
            return Err(ElementsError::NoFace { element: element.label, face: id.number, faces });
        };
        let nodes: Vec<usize> = own.iter().map(|&node| element.nodes[node]).collect();
        let positions = nodes.iter().map(|&node| self.positions()[node]).collect();
        Ok(Face { id, kind: FaceKind::of_nodes(own.len()), nodes, positions })
    }

    /// The faces of these elements that have an element of the mesh on one side alone, element by element. Of elements that lie on each other the first one has
    /// the face.
    ///
    /// # Errors
    /// An index without an element.
    pub fn outer_faces(&self, elements: &[usize]) -> Result<Vec<FaceId>, ElementsError> {
        let mut sides: HashMap<Vec<usize>, [bool; 2]> = HashMap::new();
        for element in 0..self.elements().len() {
            for number in 1..=self.elements()[element].kind.faces() {
                let corners = self.corners(FaceId { element, number })?;
                let side = usize::from(self.side(element, &corners));
                sides.entry(corners).or_default()[side] = true;
            }
        }
        let mut outer = Vec::new();
        for &element in elements {
            for number in 1..=self.element(element)?.kind.faces() {
                let id = FaceId { element, number };
                if sides.remove(&self.corners(id)?).is_some_and(|sides| sides != [true; 2]) {
                    outer.push(id);
                }
            }
        }
        Ok(outer)
    }

    /// Side of a face, by its corners around it, on which the middle of an element lies, whichever way the element is numbered.
    fn side(&self, element: usize, corners: &[usize]) -> bool {
        let middle = |nodes: &[usize]| -> Vector3<f64> {
            nodes.iter().map(|&node| self.positions()[node]).sum::<Vector3<f64>>() / nodes.len() as f64
        };
        let own = middle(corners);
        let from = |node: &usize| self.positions()[*node] - own;
        let next = corners.iter().cycle().skip(1);
        let normal: Vector3<f64> = corners.iter().zip(next).map(|(a, b)| from(a).cross(&from(b))).sum();
        normal.dot(&(middle(&self.elements()[element].nodes) - own)) > 0.0
    }

    /// Outer faces all of whose corners are among these nodes, given by their indices: the surface that a node set means.
    ///
    /// # Errors
    /// None: all faces are faces of the mesh.
    pub fn faces_on(&self, nodes: &[usize]) -> Result<Vec<FaceId>, ElementsError> {
        let nodes: HashSet<usize> = nodes.iter().copied().collect();
        let mut on = Vec::new();
        for id in self.outer_faces(&self.all())? {
            if self.corners(id)?.iter().all(|node| nodes.contains(node)) {
                on.push(id);
            }
        }
        Ok(on)
    }

    /// The corners around a face, each once, from the first node of the mesh on towards the lower one of its neighbours: alike from both sides, for a linear and a
    /// quadratic element, and for one of whose corners some are one node.
    fn corners(&self, id: FaceId) -> Result<Vec<usize>, ElementsError> {
        let face = self.face(id)?;
        let mut corners = face.nodes[..face.kind.corners()].to_vec();
        let first = corners.iter().enumerate().min_by_key(|(_, node)| **node).map_or(0, |(at, _)| at);
        corners.rotate_left(first);
        corners.dedup();
        while corners.len() > 1 && corners.last() == corners.first() {
            corners.pop();
        }
        if corners.len() > 2 && corners[corners.len() - 1] < corners[1] {
            corners[1..].reverse();
        }
        Ok(corners)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Kind;

    fn cube(kinds: Kind) -> Mesh {
        let nodes: Vec<(i64, [f64; 3])> = (1..).zip(kinds.places()).collect();
        let labels = nodes.iter().map(|(label, _)| *label).collect();
        Mesh::new(nodes, vec![(1, kinds, labels)]).unwrap()
    }

    #[test]
    fn all_faces_of_one_element_enclose_its_volume() {
        for kind in Kind::ALL {
            let mesh = cube(kind);
            let faces = mesh.outer_faces(&[0]).unwrap();
            assert_eq!(faces.len(), kind.faces());
            // The divergence theorem: 3 V = int x . n dA.
            let mut volume = 0.0;
            for id in faces {
                let face = mesh.face(id).unwrap();
                for (own, weight) in face.kind.rule() {
                    let point = face.at(own);
                    volume += point.position.dot(&point.area) * weight / 3.0;
                }
            }
            assert!((volume - mesh.volume(0).unwrap()).abs() < 1e-13, "{kind:?} {volume}");
            let error = mesh.face(FaceId { element: 0, number: 9 });
            assert_eq!(error, Err(ElementsError::NoFace { element: 1, face: 9, faces: kind.faces() }));
        }
    }

    #[test]
    fn a_face_between_two_elements_is_not_outside() {
        let mut nodes: Vec<(i64, [f64; 3])> = (1..).zip(Kind::Hexahedron8.places()).collect();
        nodes.extend(
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].iter().zip(9..).map(|(p, n)| (n, [p[0], p[1], 3.0])),
        );
        let elements = vec![
            (1, Kind::Hexahedron8, vec![1, 2, 3, 4, 5, 6, 7, 8]),
            (2, Kind::Hexahedron8, vec![5, 6, 7, 8, 9, 10, 11, 12]),
        ];
        let mesh = Mesh::new(nodes, elements).unwrap();
        assert_eq!(mesh.outer_faces(&mesh.all()).unwrap().len(), 10);
        let top: Vec<usize> = [9, 10, 11, 12].iter().map(|&label| mesh.place(label).unwrap()).collect();
        assert_eq!(mesh.faces_on(&top).unwrap(), [FaceId { element: 1, number: 2 }]);
        let between: Vec<usize> = [5, 6, 7, 8].iter().map(|&label| mesh.place(label).unwrap()).collect();
        assert!(mesh.faces_on(&between).unwrap().is_empty());
        let normal = mesh.face(FaceId { element: 1, number: 2 }).unwrap().area();
        assert!((normal - Vector3::new(0.0, 0.0, 4.0)).norm() < 1e-15);
    }

    /// A column of two cubes with more elements on them: each face of the column is outside once, from whichever nodes the others begin and however they go
    /// around.
    #[test]
    fn elements_that_lie_on_others_hide_no_face() {
        let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let layers = [-1.0, 1.0, 3.0].iter().flat_map(|&z| square.map(|[x, y]| [x, y, z]));
        let nodes: Vec<(i64, [f64; 3])> = (1..).zip(layers).collect();
        let column = [[1, 2, 3, 4, 5, 6, 7, 8], [5, 6, 7, 8, 9, 10, 11, 12]];
        let again = [
            [1, 2, 3, 4, 5, 6, 7, 8],
            [6, 7, 8, 5, 10, 11, 12, 9],
            [12, 11, 10, 9, 8, 7, 6, 5],
            [4, 3, 2, 1, 8, 7, 6, 5],
        ];
        for others in 0..16_usize {
            let on = again.iter().enumerate().filter(|(at, _)| others >> at & 1 == 1).map(|(_, nodes)| nodes);
            let all = column.iter().chain(on).zip(1..);
            let mesh = Mesh::new(
                nodes.clone(),
                all.map(|(nodes, label)| (label, Kind::Hexahedron8, nodes.to_vec())).collect(),
            )
            .unwrap();
            let faces = mesh.outer_faces(&mesh.all()).unwrap();
            assert!(faces.len() == 10 && faces.iter().all(|face| face.element < 2), "{others}: {faces:?}");
        }
        // A wedge, and half a cube of which two corners are one node each, meet in a face.
        let nodes: Vec<(i64, [f64; 3])> =
            (1..).zip([-1.0, 1.0].iter().flat_map(|&z| square.map(|[x, y]| [x, y, z]))).collect();
        let halves =
            vec![(1, Kind::Wedge6, vec![1, 2, 3, 5, 6, 7]), (2, Kind::Hexahedron8, vec![1, 3, 4, 4, 5, 7, 8, 8])];
        let mesh = Mesh::new(nodes, halves).unwrap();
        let faces = mesh.outer_faces(&mesh.all()).unwrap();
        let with_area = faces.iter().filter(|id| mesh.face(**id).unwrap().area().norm() > 0.0);
        assert_eq!(with_area.count(), 8, "{faces:?}");
    }
}
