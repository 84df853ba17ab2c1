//! Mass and stiffness of a body, and the stress in it.

use nalgebra::{Matrix3, Vector3};
use nalgebra_sparse::CscMatrix;

use crate::body::{Body, positive, symmetric};
use crate::points::Point;
use crate::{ElementsError, Mesh};

/// Isotropic linear elastic material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Lame's first parameter, a pressure.
    lambda: f64,
    /// Shear modulus, a pressure.
    shear: f64,
}

impl Material {
    /// The material of Young's modulus E and Poisson's ratio nu.
    ///
    /// # Errors
    /// E that is not finite and > 0, nu that is not above -1 and below 0.5.
    pub fn new(young: f64, poisson: f64) -> Result<Self, ElementsError> {
        positive("Young's modulus", young)?;
        if !(poisson > -1.0 && poisson < 0.5) {
            return Err(ElementsError::Material {
                what: "Poisson's ratio",
                value: poisson,
                allowed: "above -1 and below 0.5",
            });
        }
        let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        Ok(Self { lambda, shear: young / (2.0 * (1.0 + poisson)) })
    }

    /// The stress of a gradient of displacements, `grad_ij = du_i / dx_j`.
    pub(crate) fn stress(&self, grad: &Matrix3<f64>) -> Matrix3<f64> {
        let strain = (grad + grad.transpose()) * 0.5;
        Matrix3::identity() * (self.lambda * strain.trace()) + strain * (2.0 * self.shear)
    }
}

/// `du_i / dx_j` at a point of an element.
pub(crate) fn gradient(mesh: &Mesh, place: usize, point: &Point, displacements: &[Vector3<f64>]) -> Matrix3<f64> {
    let nodes = mesh.elements()[place].nodes.iter();
    nodes.zip(&point.gradients).map(|(&node, gradient)| displacements[node] * gradient.transpose()).sum()
}

impl Body<'_> {
    /// The consistent mass matrix, `int rho N^T N`, by the rule of each kind: what CalculiX makes, and Abaqus of quadratic elements but C3D10M. Of linear ones and
    /// of C3D10M Abaqus lumps the mass, so that its own matrix differs.
    ///
    /// # Errors
    /// A density that is not finite and > 0.
    pub fn mass(&self, density: f64) -> Result<CscMatrix<f64>, ElementsError> {
        positive("the density", density)?;
        let mass = self.scalar(|_, point, matrix| {
            let n = point.shape.values();
            for (a, b) in pairs(n.len()) {
                matrix[(a, b)] += density * point.weight * n[a] * n[b];
            }
        })?;
        Ok(symmetric(&mass))
    }

    /// The stiffness matrix of a material, fully integrated by the rule of each kind. It is meant for auxiliary solutions, such as the stress under rotation, and is
    /// no substitute for the stiffness that a program exports: programs integrate hexahedra in other ways, as full integration of C3D8 is too stiff in bending.
    ///
    /// # Errors
    /// None, as the body was checked.
    pub fn stiffness(&self, material: &Material) -> Result<CscMatrix<f64>, ElementsError> {
        let Material { lambda, shear } = *material;
        let stiffness = self.blocks(|point, a, b| {
            let (a, b) = (point.gradients[a], point.gradients[b]);
            let block =
                a * b.transpose() * lambda + b * a.transpose() * shear + Matrix3::identity() * (shear * a.dot(&b));
            block * point.weight
        })?;
        Ok(symmetric(&stiffness))
    }
}

/// All pairs (a, b) of `nodes` nodes, by their indices.
pub(crate) fn pairs(nodes: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..nodes * nodes).map(move |i| (i / nodes, i % nodes))
}
