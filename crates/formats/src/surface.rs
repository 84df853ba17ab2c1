//! Outside of a mesh: faces that belong to one cell alone.

use std::collections::{HashMap, HashSet};

use crate::mesh::{Cell, Mesh};

/// The outside of a mesh, for a picture of it.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Surface {
    /// Nodes on the outside, as indices into [`Mesh::nodes`], ascending.
    pub nodes: Vec<usize>,
    /// Faces: four indices into `nodes` around each. A triangle has its last node twice, a line three times, a point four times.
    pub faces: Vec<[usize; 4]>,
    /// Number of faces, the first ones, that bound a solid: seen from outside, their nodes go around against the clock.
    pub of_solids: usize,
}

impl Surface {
    /// The faces of solid cells that have cells on one side alone, then flat cells, lines and points; all nodes as points where the mesh has
    /// no cells. A face on which nodes coincide has fewer corners. Cells with nodes that the mesh lacks are passed over, and so are flat cells
    /// that lie on faces of solids or on another flat cell, corner on corner: a skin, whose face is there already.
    #[must_use]
    pub fn new(mesh: &Mesh) -> Self {
        let mut faces = outer_faces(mesh);
        let of_solids = faces.len();
        if mesh.cells.is_empty() {
            faces.extend((0..mesh.nodes.len()).map(|node| [node; 4]));
        }
        let thin = mesh.cells.iter().filter(|cell| cell.kind.faces().is_empty());
        let thin: Vec<_> = thin.filter(|cell| is_of(mesh, cell)).filter_map(|cell| four(&cell.nodes)).collect();
        if !thin.is_empty() {
            let mut skins = Skins::new(mesh, &thin);
            faces.extend(thin.into_iter().filter(|face| skins.is_new(face)));
        }
        let mut nodes: Vec<usize> = faces.iter().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        // Every node of a face is in the list that was made of them.
        let place = |node: usize| nodes.binary_search(&node).unwrap_or_default();
        let faces = faces.iter().map(|face| face.map(place)).collect();
        Self { nodes, faces, of_solids }
    }
}

/// Triangles between corners of faces that a surface has: by the places of nodes, as a skin may have nodes of its own.
struct Skins {
    /// The first node at the place of each.
    place: Vec<usize>,
    triangles: HashSet<[usize; 3]>,
}

impl Skins {
    /// The triangles of all faces of solids, inner ones among them, whose corners are places of thin cells.
    fn new(mesh: &Mesh, thin: &[[usize; 4]]) -> Self {
        let mut first = HashMap::new();
        // The sum makes one zero of both.
        let bits = |node: usize| mesh.nodes[node].position.map(|x| (x + 0.0).to_bits());
        let place: Vec<usize> = (0..mesh.nodes.len()).map(|node| *first.entry(bits(node)).or_insert(node)).collect();
        let of_thin: HashSet<usize> = thin.iter().flatten().map(|&node| place[node]).collect();
        let is_wanted = |triangle: &[usize; 3]| triangle.iter().all(|corner| of_thin.contains(corner));
        let mut skins = Self { place, triangles: HashSet::new() };
        for cell in mesh.cells.iter().filter(|cell| is_of(mesh, cell)) {
            for corners in cell.kind.faces() {
                let around: Vec<usize> = corners.iter().map(|&corner| cell.nodes[corner]).collect();
                let halves = four(&around).map_or(vec![], |face| skins.halves(&face));
                skins.triangles.extend(halves.into_iter().flatten().filter(is_wanted));
            }
        }
        skins
    }

    /// The two triangles into which either diagonal cuts a face; of a triangle the same ones. None of lines and points.
    fn halves(&self, face: &[usize; 4]) -> Vec<[[usize; 3]; 2]> {
        let [a, b, c, d] = face.map(|node| self.place[node]);
        let sorted = |mut triangle: [usize; 3]| {
            triangle.sort_unstable();
            triangle
        };
        match (b == c, c == d) {
            (true, _) => vec![],
            (_, true) => vec![[sorted([a, b, c]); 2]],
            _ => vec![[[a, b, c], [a, c, d]].map(sorted), [[b, c, d], [b, d, a]].map(sorted)],
        }
    }

    /// True of a line, a point, and a flat cell of which a part is on no face before; from then on its face is one of them.
    fn is_new(&mut self, face: &[usize; 4]) -> bool {
        let halves = self.halves(face);
        if halves.iter().any(|both| both.iter().all(|half| self.triangles.contains(half))) {
            return false;
        }
        self.triangles.extend(halves.into_iter().flatten());
        true
    }
}

/// The faces of solid cells that have cells on one side alone, in the order of the cells; of cells that lie on each other the first one has the face.
fn outer_faces(mesh: &Mesh) -> Vec<[usize; 4]> {
    // The corners of a face in ascending order are the same from both sides.
    let mut found = Vec::new();
    for (at, cell) in mesh.cells.iter().enumerate().filter(|(_, cell)| is_of(mesh, cell)) {
        for corners in cell.kind.faces() {
            let around: Vec<usize> = corners.iter().map(|&corner| cell.nodes[corner]).collect();
            if let Some(face) = four(&around).filter(|face| face[1] != face[2]) {
                let mut key = face;
                key.sort_unstable();
                // Of a triangle any corner may be the one that is there twice.
                let twice = key.windows(2).position(|pair| pair[0] == pair[1]);
                if let Some(twice) = twice {
                    key[twice] = usize::MAX;
                    key.sort_unstable();
                }
                found.push((key, at, face));
            }
        }
    }
    found.sort_unstable();
    let mut outer = Vec::new();
    for alike in found.chunk_by(|a, b| a.0 == b.0) {
        let turned: Vec<[usize; 4]> =
            alike.iter().map(|(_, at, face)| outwards(mesh, &mesh.cells[*at], *face)).collect();
        if turned.iter().all(|face| after_first(face) == after_first(&turned[0])) {
            outer.push((alike[0].1, alike[0].2, turned[0]));
        }
    }
    outer.sort_unstable();
    outer.into_iter().map(|(.., turned)| turned).collect()
}

/// The node of a face that comes after its first one of the mesh, which tells the way around; the last node may be there twice.
fn after_first(face: &[usize; 4]) -> usize {
    let first = face.iter().min();
    let mut after = face.iter().cycle().skip_while(|node| Some(*node) != first).skip_while(|node| Some(*node) == first);
    after.next().copied().unwrap_or_default()
}

/// True if a cell has as many nodes as it must, all of the mesh.
fn is_of(mesh: &Mesh, cell: &Cell) -> bool {
    cell.nodes.len() == cell.kind.nodes() && cell.nodes.iter().all(|&node| node < mesh.nodes.len())
}

/// Nodes in order without a node that equals the node before it, the last node repeated so that there are four; `None` for an empty list.
fn four(nodes: &[usize]) -> Option<[usize; 4]> {
    let mut nodes = nodes.to_vec();
    nodes.dedup();
    if nodes.len() > 1 && nodes.first() == nodes.last() {
        nodes.pop();
    }
    let last = *nodes.last()?;
    Some([0, 1, 2, 3].map(|at| nodes.get(at).copied().unwrap_or(last)))
}

/// The face turned so that from outside of its cell the nodes go around against the clock.
fn outwards(mesh: &Mesh, cell: &Cell, face: [usize; 4]) -> [usize; 4] {
    let at = |node: usize| mesh.nodes[node].position;
    let middle = |nodes: &[usize]| {
        [0, 1, 2].map(|axis| nodes.iter().map(|&node| at(node)[axis]).sum::<f64>() / nodes.len() as f64)
    };
    let less = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|axis| a[axis] - b[axis]);
    let [a, b, c, d] = face;
    let (u, v) = (less(at(c), at(a)), less(at(d), at(b)));
    let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let out = less(middle(&face), middle(&cell.nodes));
    let is_outwards = normal.iter().zip(out).map(|(n, o)| n * o).sum::<f64>() >= 0.0;
    match (is_outwards, c == d) {
        (true, _) => face,
        (false, true) => [b, a, c, c],
        (false, false) => [d, c, b, a],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{CellKind, Node};

    fn mesh(positions: &[[f64; 3]], cells: &[(CellKind, &[usize])]) -> Mesh {
        let nodes = positions.iter().zip(1..).map(|(&position, label)| Node { label, position }).collect();
        let cells = cells.iter().map(|&(kind, nodes)| Cell { kind, nodes: nodes.to_vec() }).collect();
        Mesh { nodes, cells }
    }

    /// Three layers of the corners of a unit square, at z = 0, 1 and 2.
    fn tower() -> Vec<[f64; 3]> {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        [0.0, 1.0, 2.0].iter().flat_map(|&z| square.map(|[x, y]| [x, y, z])).collect()
    }

    /// Six times the volume that the faces enclose: the volume of the solid where all faces face outwards and no face is missing.
    fn volume(mesh: &Mesh, surface: &Surface) -> f64 {
        let tetrahedron = |[a, b, c]: [usize; 3]| {
            let [a, b, c] = [a, b, c].map(|place| mesh.nodes[surface.nodes[place]].position);
            (a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0]))
                / 6.0
        };
        surface.faces.iter().map(|&[a, b, c, d]| tetrahedron([a, b, c]) + tetrahedron([a, c, d])).sum()
    }

    #[test]
    fn two_hexahedra_share_one_face() {
        let below: Vec<usize> = (0..8).collect();
        let above: Vec<usize> = (4..12).collect();
        // The second one upside down: its own order of nodes turns all faces inwards.
        let mirrored = [8, 9, 10, 11, 4, 5, 6, 7];
        for above in [&above[..], &mirrored[..]] {
            let mesh = mesh(&tower(), &[(CellKind::Hexahedron, &below), (CellKind::Hexahedron, above)]);
            let surface = Surface::new(&mesh);
            assert_eq!((surface.faces.len(), surface.of_solids, surface.nodes.len()), (10, 10, 12));
            assert!(!surface.faces.iter().any(|face| face.iter().all(|node| (4..8).contains(node))));
            assert!((volume(&mesh, &surface) - 2.0).abs() < 1e-12);
        }
    }

    #[test]
    fn cells_that_lie_on_others_hide_no_face() {
        let (below, above): (Vec<usize>, Vec<usize>) = ((0..8).collect(), (4..12).collect());
        let (again, turned) = ([1, 2, 3, 0, 5, 6, 7, 4], [8, 9, 10, 11, 4, 5, 6, 7]);
        let hexahedra = [&below[..], &above, &again, &turned].map(|nodes| (CellKind::Hexahedron, nodes));
        for count in 2..=4 {
            let mesh = mesh(&tower(), &hexahedra[..count]);
            let surface = Surface::new(&mesh);
            assert_eq!((surface.faces.len(), surface.of_solids, surface.nodes.len()), (10, 10, 12));
            assert!((volume(&mesh, &surface) - 2.0).abs() < 1e-12);
        }
    }

    #[test]
    fn tetrahedra_have_triangles() {
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 1.0]];
        // They share the triangle 1 2 3, which their orders of nodes begin at different corners.
        let cells: [(CellKind, &[usize]); 2] =
            [(CellKind::Tetrahedron, &[0, 1, 2, 3]), (CellKind::Tetrahedron, &[3, 1, 2, 4])];
        let mesh = mesh(&corners, &cells);
        let surface = Surface::new(&mesh);
        assert_eq!((surface.faces.len(), surface.of_solids), (6, 6));
        assert!(surface.faces.iter().all(|face| face[2] == face[3]));
        assert!((volume(&mesh, &surface) - (1.0 / 6.0 + 1.0 / 3.0)).abs() < 1e-12);
    }

    #[test]
    fn a_wedge_written_as_a_hexahedron_has_two_triangles_and_three_quadrilaterals() {
        let mesh = mesh(&tower(), &[(CellKind::Hexahedron, &[0, 1, 2, 2, 4, 5, 6, 6])]);
        let surface = Surface::new(&mesh);
        assert_eq!(surface.nodes, [0, 1, 2, 4, 5, 6]);
        assert_eq!(surface.faces.iter().map(|face| face[2] == face[3]).filter(|&is_triangle| is_triangle).count(), 2);
        assert_eq!(surface.faces.len(), 5);
        assert!((volume(&mesh, &surface) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn the_node_in_the_middle_is_not_outside() {
        let grid: Vec<[f64; 3]> = (0..27).map(|i| [i % 3, i / 3 % 3, i / 9].map(f64::from)).collect();
        let corner = |i: usize| i % 2 + i / 2 % 2 * 3 + i / 4 * 9;
        let cells: Vec<Vec<usize>> =
            (0..8).map(|i| [0, 1, 4, 3, 9, 10, 13, 12].map(|step| corner(i) + step).to_vec()).collect();
        let cells: Vec<(CellKind, &[usize])> = cells.iter().map(|nodes| (CellKind::Hexahedron, &nodes[..])).collect();
        let mesh = mesh(&grid, &cells);
        let surface = Surface::new(&mesh);
        assert_eq!((surface.faces.len(), surface.nodes.len()), (24, 26));
        assert!(!surface.nodes.contains(&13));
        assert!((volume(&mesh, &surface) - 8.0).abs() < 1e-12);
    }

    #[test]
    fn flat_cells_lines_and_nodes_alone_are_shown_as_they_are() {
        let cells: [(CellKind, &[usize]); 4] = [
            (CellKind::Quadrilateral, &[0, 1, 2, 3]),
            (CellKind::Triangle, &[4, 5, 6]),
            (CellKind::Line, &[6, 7]),
            (CellKind::Hexahedron, &[0, 1, 2, 3, 4, 5, 6, 99]),
        ];
        let surface = Surface::new(&mesh(&tower(), &cells));
        assert_eq!((surface.of_solids, surface.nodes.len()), (0, 8));
        assert_eq!(surface.faces, [[0, 1, 2, 3], [4, 5, 6, 6], [6, 7, 7, 7]]);
        assert_eq!(Surface::new(&mesh(&tower()[..2], &[])).faces, [[0; 4], [1; 4]]);
        assert_eq!(Surface::new(&Mesh::default()), Surface::default());
    }

    /// A skin is passed over on an outer and on an inner face, in triangles, with nodes of its own, and where there are two; one that sticks out is not.
    #[test]
    fn flat_cells_on_faces_of_solids_are_their_skin() {
        use CellKind::{Hexahedron, Quadrilateral, Triangle};
        let below: Vec<usize> = (0..8).collect();
        let above: Vec<usize> = (4..12).collect();
        let mut nodes = tower();
        // Nodes of a skin's own on the upper face, one with the other zero, and two beside it.
        nodes.extend([
            [-0.0, 0.0, 2.0],
            [1.0, 0.0, 2.0],
            [1.0, 1.0, 2.0],
            [0.0, 1.0, 2.0],
            [2.0, 1.0, 2.0],
            [2.0, 0.0, 2.0],
        ]);
        let solids: [(CellKind, &[usize]); 2] = [(Hexahedron, &below), (Hexahedron, &above)];
        let with = |skins: &[(CellKind, &[usize])]| {
            let surface = Surface::new(&mesh(&nodes, &[&solids, skins].concat()));
            (surface.of_solids, surface.faces.len())
        };
        assert_eq!(with(&[(Quadrilateral, &[3, 2, 1, 0]), (Quadrilateral, &[4, 5, 6, 7])]), (10, 10));
        assert_eq!(with(&[(Triangle, &[0, 1, 2]), (Triangle, &[2, 3, 0]), (Triangle, &[1, 2, 3])]), (10, 10));
        assert_eq!(with(&[(Quadrilateral, &[12, 13, 14, 15])]), (10, 10));
        assert_eq!(with(&[(Quadrilateral, &[13, 14, 16, 17]), (Quadrilateral, &[10, 16, 17, 9])]), (10, 11));
        // Corners of two faces of the solid, on neither of them.
        assert_eq!(with(&[(Quadrilateral, &[0, 1, 6, 7])]), (10, 11));
        // A quadrilateral on two triangles.
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 1.0]];
        let cells: [(CellKind, &[usize]); 3] = [
            (CellKind::Tetrahedron, &[0, 1, 2, 4]),
            (CellKind::Tetrahedron, &[0, 2, 3, 4]),
            (Quadrilateral, &[0, 1, 2, 3]),
        ];
        assert_eq!(Surface::new(&mesh(&corners, &cells)).faces.len(), 6);
    }
}
