//! Matrices that turning adds to a body of revolution which is seen from axes that stand still.
//!
//! The displacement u(x, t) is the displacement of the particle that is at x, by its components along fixed axes. The particles move through the mesh
//! with `Omega axis x (x - through)`, so that the velocity of a displacement is `u' + Omega u_,theta`, its acceleration
//! `u'' + 2 Omega u'_,theta + Omega^2 u_,theta,theta`, and, integrated by parts over a body of revolution,
//!
//! ```text
//! C += 2 Omega G,     G = int rho N^T N_,theta                   skew
//! K -= Omega^2 P,     P = int rho N_,theta^T N_,theta
//! K += K_sigma,       K_sigma = int N_,i^T sigma_ij N_,j         sigma the stress of the centrifugal load, proportional to Omega^2
//! ```
//!
//! Coriolis forces are in G, and the softening by rotation is in P: nothing else belongs to them.

use nalgebra::{DVector, Vector3};
use nalgebra_sparse::CscMatrix;

use crate::ElementsError;
use crate::body::{Body, positive, symmetric};
use crate::elastic::{Material, gradient, pairs};
use crate::points::Point;

/// Axis of rotation, positive by the right hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    direction: Vector3<f64>,
    through: Vector3<f64>,
}

impl Axis {
    /// The axis along a direction of any length through a point.
    ///
    /// # Errors
    /// A direction that is zero or not finite, a point that is not finite.
    pub fn new(direction: [f64; 3], through: [f64; 3]) -> Result<Self, ElementsError> {
        let unit = Vector3::from(direction).try_normalize(0.0).filter(|unit| unit.iter().all(|x| x.is_finite()));
        let unit = unit.filter(|_| through.iter().all(|x| x.is_finite()));
        unit.map(|unit| Self { direction: unit, through: through.into() }).ok_or(ElementsError::Axis { direction })
    }

    /// Direction of the axis, of length 1.
    #[must_use]
    pub fn direction(&self) -> Vector3<f64> {
        self.direction
    }

    /// Velocity `axis x (x - through)` of a point at 1 rad/s.
    #[must_use]
    pub fn velocity(&self, at: &Vector3<f64>) -> Vector3<f64> {
        self.direction.cross(&(at - self.through))
    }
}

/// Matrices that turning adds by the motion of particles through the mesh, for a speed of 1 rad/s.
#[derive(Debug, Clone, PartialEq)]
pub struct Transport {
    /// Gyroscopic matrix G, exactly skew: the part of `int rho N^T N_,theta` that is.
    pub gyroscopic: CscMatrix<f64>,
    /// Centripetal matrix P, symmetric.
    pub centripetal: CscMatrix<f64>,
    /// The norm of the symmetric part of `int rho N^T N_,theta` over the norm of its skew part. The symmetric part is an integral over the surface that
    /// vanishes where the surface turns into itself: a few hundredths for a coarse mesh of a body of revolution, more for a body with holes or vanes, which
    /// is no body of revolution and which fixed axes describe in the mean alone.
    pub departure: f64,
}

impl Body<'_> {
    /// Matrices G and P of the body, which turns about an axis.
    ///
    /// # Errors
    /// A density that is not > 0.
    pub fn transport(&self, density: f64, axis: &Axis) -> Result<Transport, ElementsError> {
        positive("the density", density)?;
        let along = |point: &Point| {
            let velocity = axis.velocity(&point.position);
            point.gradients.iter().map(|gradient| gradient.dot(&velocity)).collect::<Vec<f64>>()
        };
        let whole = self.scalar(|_, point, matrix| {
            let (n, turned) = (point.shape.values(), along(point));
            for (a, b) in pairs(n.len()) {
                matrix[(a, b)] += density * point.weight * n[a] * turned[b];
            }
        })?;
        let centripetal = self.scalar(|_, point, matrix| {
            let turned = along(point);
            for (a, b) in pairs(turned.len()) {
                matrix[(a, b)] += density * point.weight * turned[a] * turned[b];
            }
        })?;
        let gyroscopic = (&whole - whole.transpose()) * 0.5;
        let norm = |matrix: &CscMatrix<f64>| matrix.values().iter().map(|value| value * value).sum::<f64>().sqrt();
        let departure = norm(&symmetric(&whole)) / norm(&gyroscopic).max(f64::MIN_POSITIVE);
        Ok(Transport { gyroscopic, centripetal: symmetric(&centripetal), departure })
    }

    /// The centrifugal load for a speed of 1 rad/s, `int rho N^T (distance from the axis)`, a force for each row.
    ///
    /// # Errors
    /// A density that is not > 0.
    pub fn centrifugal_load(&self, density: f64, axis: &Axis) -> Result<DVector<f64>, ElementsError> {
        positive("the density", density)?;
        self.load(|point| -axis.direction.cross(&axis.velocity(&point.position)) * density)
    }

    /// Stiffness `K_sigma = int N_,i^T sigma_ij N_,j` of the stress that displacements make in a material: the displacements of each node of the mesh under
    /// [`Body::centrifugal_load`], by the model's own stiffness or by [`Body::stiffness`]. K_sigma is proportional to the displacements, so that
    /// displacements at 1 rad/s give it for `Omega^2 = 1`.
    ///
    /// # Errors
    /// Displacements of another number of nodes.
    pub fn stress_stiffness(
        &self,
        material: &Material,
        displacements: &[Vector3<f64>],
    ) -> Result<CscMatrix<f64>, ElementsError> {
        let (found, expected) = (displacements.len(), self.mesh.labels().len());
        if found != expected {
            return Err(ElementsError::Displacements { found, expected });
        }
        let of_stress = self.scalar(|place, point, matrix| {
            let stress = material.stress(&gradient(self.mesh, place, point, displacements));
            let pulled: Vec<Vector3<f64>> = point.gradients.iter().map(|gradient| stress * gradient).collect();
            for (a, b) in pairs(pulled.len()) {
                matrix[(a, b)] += point.weight * point.gradients[a].dot(&pulled[b]);
            }
        })?;
        Ok(symmetric(&of_stress))
    }

    /// Displacements of all nodes of the mesh from a vector with an entry for each row; 0 where the model holds a node.
    #[must_use]
    pub fn displacements(&self, of_rows: &DVector<f64>) -> Vec<Vector3<f64>> {
        let entry = |row: Option<usize>| row.and_then(|row| of_rows.get(row).copied()).unwrap_or(0.0);
        let of_node = |node| Vector3::from_fn(|x, _| entry(self.rows.row(node, x)));
        (0..self.mesh.labels().len()).map(of_node).collect()
    }
}
