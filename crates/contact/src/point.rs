//! Contact points: where a small area of the slave meets the master.

use elements::FaceId;
use nalgebra::Vector3;

/// Contact point: a point of integration of the slave's faces, with the point of the master opposite to it.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactPoint {
    /// Position x of the point, on the slave.
    pub position: Vector3<f64>,
    /// Normal n, from the master into the slave, of length 1: the master's normal to the outside.
    pub normal: Vector3<f64>,
    /// Direction of sliding t, in which the master slides under the slave, of length 1 and perpendicular to n.
    pub sliding: Vector3<f64>,
    /// Speed of sliding along t, m/s.
    pub speed: f64,
    /// Gap: the distance along n, negative where the meshes overlap.
    pub gap: f64,
    /// The area that it stands for, by the rule of integration.
    pub area: f64,
    /// The face of the slave that it is on.
    pub slave_face: FaceId,
    /// The face of the master opposite to it.
    pub master_face: FaceId,
    /// Nodes of the slave, by their indices in the mesh, with the shape function of each at the point.
    pub slave: Vec<(usize, f64)>,
    /// Nodes of the master, by their indices in the mesh, with the shape function of each at the point opposite.
    pub master: Vec<(usize, f64)>,
}

impl ContactPoint {
    /// Index in the mesh of the slave's node that is weighed most here: a name for the point.
    #[must_use]
    pub fn node(&self) -> usize {
        let largest = self.slave.iter().max_by(|(_, a), (_, b)| a.total_cmp(b));
        largest.map_or(0, |(node, _)| *node)
    }

    /// Direction across the sliding: `n x t`.
    #[must_use]
    pub fn across(&self) -> Vector3<f64> {
        self.normal.cross(&self.sliding)
    }

    /// Nodes of both sides with the weights that make `u_slave - u_master` of their displacements.
    pub fn relative(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.slave.iter().copied().chain(self.master.iter().map(|&(node, weight)| (node, -weight)))
    }
}
