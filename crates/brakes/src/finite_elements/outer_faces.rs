//! The outer faces of the mesh of a finite element brake: for the sound of a motion.

use elements::FaceKind;
use formats::{Dof, Mesh, Surface};
use montecarlo::Progress;
use nalgebra::{DMatrix, Vector3};
use study::{FacesInMotion, OuterFaces, Scene};

use super::FiniteElementBrake;

/// Pieces of faces that are summed at once; chosen: a cancelled run ends soon.
const AT_ONCE: usize = 1024;

impl OuterFaces for FiniteElementBrake {
    fn faces_in_motion(&self, scene: &Scene, progress: &dyn Progress) -> Result<Option<FacesInMotion>, study::Error> {
        let Some(mesh) = &self.case.mesh else { return Ok(None) };
        let pieces = pieces(mesh);
        if pieces.is_empty() {
            return Ok(None);
        }
        let rows = mesh.rows_of_nodes(&self.free_rows(scene.key.constraints));
        // What the case, huge entries or the mesh fix is at rest.
        let case = &self.case;
        let known: Vec<Dof> = case.dofs.iter().chain(&case.held).chain(&case.held_in_mesh).copied().collect();
        Ok(Some(FacesInMotion {
            form: form(&pieces, &rows, &self.part(scene).reduced.basis(), progress)?,
            without_rows: part_without(&pieces, &mesh.rows_of_nodes(&known)),
        }))
    }
}

/// A piece of an outer face about a point of its rule.
struct Piece {
    /// Nodes of the mesh with their shape functions there.
    nodes: Vec<(usize, f64)>,
    /// The normal, of length 1.
    normal: Vector3<f64>,
    /// Area, twice that of a face whose both sides are outside.
    area: f64,
}

/// G of motions `V u`, where V is the basis and a row of V is a node in x, y or z: the sum of `(n^T V) (n^T V)^T dA` over the pieces.
fn form(
    pieces: &[Piece],
    rows: &[[Option<usize>; 3]],
    basis: &DMatrix<f64>,
    progress: &dyn Progress,
) -> Result<DMatrix<f64>, study::Error> {
    let mut form = DMatrix::zeros(basis.ncols(), basis.ncols());
    for pieces in pieces.chunks(AT_ONCE) {
        progress.go_on()?;
        let mut along = DMatrix::zeros(basis.ncols(), pieces.len());
        for (piece, mut along) in pieces.iter().zip(along.column_iter_mut()) {
            for (node, weight) in &piece.nodes {
                for (row, normal) in rows[*node].iter().zip(&piece.normal) {
                    let Some(row) = row else { continue };
                    let factor = piece.area.sqrt() * weight * normal;
                    along.iter_mut().zip(&basis.row(*row)).for_each(|(sum, v)| *sum += factor * v);
                }
            }
        }
        form.gemm(1.0, &along, &along.transpose(), 1.0);
    }
    Ok(form)
}

/// Fraction of the area whose motion along the normal is not known, because its nodes have no rows.
fn part_without(pieces: &[Piece], rows: &[[Option<usize>; 3]]) -> f64 {
    let of_node = |piece: &Piece, (node, weight): &(usize, f64)| {
        let lacking = rows[*node].iter().zip(&piece.normal).filter(|(row, _)| row.is_none());
        piece.area * weight * lacking.map(|(_, normal)| normal * normal).sum::<f64>()
    };
    let without: f64 = pieces.iter().flat_map(|piece| piece.nodes.iter().map(move |node| of_node(piece, node))).sum();
    // The sum over no nodes is -0.
    (0.0 + without) / pieces.iter().map(|piece| piece.area).sum::<f64>()
}

/// The outer faces of solids, and flat cells from both sides, in pieces. Lines and points have no area.
fn pieces(mesh: &Mesh) -> Vec<Piece> {
    let surface = Surface::new(mesh);
    let mut pieces = Vec::new();
    for (at, face) in surface.faces.iter().enumerate() {
        let sides = if at < surface.of_solids { 1.0 } else { 2.0 };
        let kind = match face {
            [_, b, c, _] if b == c => continue,
            [_, _, c, d] if c == d => FaceKind::Triangle3,
            _ => FaceKind::Quadrilateral4,
        };
        let nodes: Vec<usize> = face[..kind.corners()].iter().map(|&node| surface.nodes[node]).collect();
        let positions: Vec<Vector3<f64>> = nodes.iter().map(|&node| mesh.nodes[node].position.into()).collect();
        for (own, weight) in kind.rule() {
            let point = kind.at(&positions, own);
            let size = point.area.norm();
            if size > 0.0 {
                let nodes = nodes.iter().copied().zip(point.shape.values().iter().copied()).collect();
                pieces.push(Piece { nodes, normal: point.area / size, area: sides * weight * size });
            }
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use formats::{Cell, CellKind, Node};

    use super::*;

    /// Rows of x, y and z of all nodes, one after the other.
    fn all_rows(mesh: &Mesh) -> Vec<[Option<usize>; 3]> {
        (0..mesh.nodes.len()).map(|node| [0, 1, 2].map(|axis| Some(3 * node + axis))).collect()
    }

    /// The integral over the faces of a mesh of a motion, the only one of a basis.
    fn square(mesh: &Mesh, motion: impl Fn([f64; 3]) -> [f64; 3]) -> f64 {
        let u: Vec<f64> = mesh.nodes.iter().flat_map(|node| motion(node.position)).collect();
        form(&pieces(mesh), &all_rows(mesh), &DMatrix::from_vec(u.len(), 1, u), &()).unwrap()[(0, 0)]
    }

    fn mesh(positions: &[[f64; 3]], kind: CellKind) -> Mesh {
        let nodes = positions.iter().zip(1..).map(|(&position, label)| Node { label, position }).collect();
        Mesh { nodes, cells: vec![Cell { kind, nodes: (0..positions.len()).collect() }] }
    }

    #[test]
    fn motions_of_a_box_and_of_a_triangle_have_their_integrals() {
        // Sides of 2, 3 and 4 about the origin.
        let square_of = |z: f64| [[-1.0, -1.5, z], [1.0, -1.5, z], [1.0, 1.5, z], [-1.0, 1.5, z]];
        let brick = mesh(&[square_of(-2.0), square_of(2.0)].concat(), CellKind::Hexahedron);
        let close = |found: f64, exact: f64| assert!((found / exact - 1.0).abs() < 1e-14, "{found} {exact}");
        close(square(&brick, |_| [3.0, 0.0, 0.0]), 9.0 * 2.0 * 12.0);
        // A skin on one of its faces adds nothing to it.
        let mut skinned = brick.clone();
        skinned.cells.push(Cell { kind: CellKind::Quadrilateral, nodes: vec![1, 2, 6, 5] });
        close(square(&skinned, |_| [3.0, 0.0, 0.0]), 9.0 * 2.0 * 12.0);
        // A turn about z: u_n is y on the faces of x and x on those of y.
        let second = |length: f64| length.powi(3) / 12.0;
        close(square(&brick, |[x, y, _]| [-y, x, 0.0]), 2.0 * 4.0 * (second(3.0) + second(2.0)));
        // Both sides of a triangle of area 1; along it, nothing.
        let triangle = mesh(&[[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]], CellKind::Triangle);
        close(square(&triangle, |_| [5.0, 5.0, 2.0]), 2.0 * 4.0);
        // u_n = x: int x^2 (1 - x / 2) dx from 0 to 2 is 2 / 3.
        close(square(&triangle, |[x, ..]| [0.0, 0.0, x]), 2.0 * 8.0 / 12.0);
        assert!(pieces(&mesh(&[[0.0; 3], [1.0, 0.0, 0.0]], CellKind::Line)).is_empty());
        // Two motions at once: their product is x times z on the two faces of x.
        let both = brick.nodes.iter().map(|node| node.position).flat_map(|[.., z]| [3.0, z]);
        let basis = DMatrix::from_row_iterator(8, 2, both);
        let rows: Vec<_> = (0..8).map(|node| [Some(node), None, None]).collect();
        let g = form(&pieces(&brick), &rows, &basis, &()).unwrap();
        close(g[(0, 0)], 9.0 * 2.0 * 12.0);
        close(g[(1, 1)], 2.0 * 3.0 * second(4.0));
        assert!(g[(0, 1)].abs() < 1e-13 && g[(0, 1)] == g[(1, 0)], "{g}");
    }

    struct Enough;

    impl Progress for Enough {
        fn begin(&self, _: u64, _: u64) {}
        fn advance(&self, _: u64) {}
        fn end(&self) {}
        fn is_cancelled(&self) -> bool {
            true
        }
    }

    #[test]
    fn a_form_ends_where_it_is_cancelled() {
        let triangle = mesh(&[[0.0; 3], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]], CellKind::Triangle);
        let found = form(&pieces(&triangle), &all_rows(&triangle), &DMatrix::zeros(9, 2), &Enough);
        assert!(found.is_err_and(|error| error.is_cancelled()));
    }

    /// The upper four nodes of a box without rows: its upper face and half of those beside it; without rows in z the upper face alone.
    #[test]
    fn area_without_rows_is_that_of_the_nodes_that_lack_them() {
        let square_of = |z: f64| [[0.0, 0.0, z], [2.0, 0.0, z], [2.0, 3.0, z], [0.0, 3.0, z]];
        let brick = mesh(&[square_of(0.0), square_of(4.0)].concat(), CellKind::Hexahedron);
        let pieces = pieces(&brick);
        let part = |rows: &[[Option<usize>; 3]]| part_without(&pieces, rows);
        let mut rows = all_rows(&brick);
        assert_eq!(part(&rows), 0.0);
        rows[4..].iter_mut().for_each(|rows| rows[2] = None);
        assert!((part(&rows) - 6.0 / 52.0).abs() < 1e-15, "{}", part(&rows));
        rows[4..].fill([None; 3]);
        assert!((part(&rows) - 26.0 / 52.0).abs() < 1e-15, "{}", part(&rows));
        assert!((part(&[[None; 3]; 8]) - 1.0).abs() < 1e-15);
    }
}
