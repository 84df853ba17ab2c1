//! The outer faces of a finite element brake, those of its mesh: for the sound of a motion.

use elements::FaceKind;
use formats::{Dof, Mesh, ModeShape, Surface};
use nalgebra::DVector;
use num_complex::Complex;
use study::{OuterFaces, Scene};

use super::FiniteElementBrake;

impl OuterFaces for FiniteElementBrake {
    fn squares_along_normals(
        &self,
        scene: &Scene,
        motions: &[Vec<Complex<f64>>],
    ) -> Result<Option<Vec<f64>>, study::Error> {
        let Some(mesh) = &self.case.mesh else { return Ok(None) };
        let pieces = pieces(mesh);
        if pieces.is_empty() {
            return Ok(None);
        }
        let (set, reduced) = (&self.sets[scene.key.constraints], &self.part(scene).reduced);
        let rows: Vec<Dof> = set.dofs.free().iter().map(|&row| self.case.dofs[row]).collect();
        let square = |motion: &Vec<Complex<f64>>| {
            let whole = reduced.lift(&DVector::from_column_slice(motion));
            let shape = ModeShape::new(String::new(), Complex::default(), mesh, &rows, whole.as_slice())
                .map_err(|error| study::Error::Brake(Box::new(error)))?;
            Ok(pieces.iter().map(|piece| piece.square(&shape.displacements)).sum())
        };
        motions.iter().map(square).collect::<Result<_, _>>().map(Some)
    }
}

/// A piece of an outer face about a point of its rule.
struct Piece {
    /// Nodes of the mesh with their shape functions there.
    nodes: Vec<(usize, f64)>,
    /// The normal, of length 1.
    normal: [f64; 3],
    /// Area, twice that of a face whose both sides are outside.
    area: f64,
}

impl Piece {
    /// `|u_n|^2 dA`.
    fn square(&self, displacements: &[[Complex<f64>; 3]]) -> f64 {
        let along = |u: &[Complex<f64>; 3]| (0..3).map(|axis| u[axis] * self.normal[axis]).sum::<Complex<f64>>();
        let u: Complex<f64> = self.nodes.iter().map(|&(node, weight)| along(&displacements[node]) * weight).sum();
        self.area * u.norm_sqr()
    }
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
        for (own, weight) in kind.rule() {
            let shape = kind.shape(own);
            let mut along = [[0.0; 3]; 2];
            for (node, by) in nodes.iter().zip(shape.derivatives()) {
                for (direction, by) in along.iter_mut().zip(by) {
                    direction.iter_mut().zip(mesh.nodes[*node].position).for_each(|(sum, x)| *sum += by * x);
                }
            }
            let [r, s] = along;
            let normal = [r[1] * s[2] - r[2] * s[1], r[2] * s[0] - r[0] * s[2], r[0] * s[1] - r[1] * s[0]];
            let size = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
            if size > 0.0 {
                let nodes = nodes.iter().copied().zip(shape.values().iter().copied()).collect();
                pieces.push(Piece { nodes, normal: normal.map(|n| n / size), area: sides * weight * size });
            }
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use formats::{Cell, CellKind, Node};

    use super::*;

    /// The integral over the faces of a mesh of a real motion.
    fn square(mesh: &Mesh, motion: impl Fn([f64; 3]) -> [f64; 3]) -> f64 {
        let u: Vec<_> = mesh.nodes.iter().map(|node| motion(node.position).map(Complex::from)).collect();
        pieces(mesh).iter().map(|piece| piece.square(&u)).sum()
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
        // A turn about z: u_n is y on the faces of x and x on those of y.
        let second = |length: f64| length.powi(3) / 12.0;
        close(square(&brick, |[x, y, _]| [-y, x, 0.0]), 2.0 * 4.0 * (second(3.0) + second(2.0)));
        // Both sides of a triangle of area 1; along it, nothing.
        let triangle = mesh(&[[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]], CellKind::Triangle);
        close(square(&triangle, |_| [5.0, 5.0, 2.0]), 2.0 * 4.0);
        // u_n = x: int x^2 (1 - x / 2) dx from 0 to 2 is 2 / 3.
        close(square(&triangle, |[x, ..]| [0.0, 0.0, x]), 2.0 * 8.0 / 12.0);
        assert!(pieces(&mesh(&[[0.0; 3], [1.0, 0.0, 0.0]], CellKind::Line)).is_empty());
    }
}
