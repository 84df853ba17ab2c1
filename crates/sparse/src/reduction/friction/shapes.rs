//! The shapes of modes in the coordinates of the reduced system.

use nalgebra::DVector;
use num_complex::Complex;

use super::real::{Real, cast};
use super::rows::{Rows, add_rows};

/// What the shapes of k degrees of freedom are made of.
#[derive(Debug, Clone)]
pub(super) struct Shapes<T = f64> {
    /// k.
    pub order: usize,
    /// Y of the near modes, by modes.
    pub near: Rows<T>,
    /// The other eigenvalues, rad/s.
    pub others: Vec<Complex<f64>>,
    /// `(V^H B)^T` of the others, by ports.
    pub others_force: Rows<T>,
    /// Y of the others, by modes.
    pub others_right: Rows<T>,
}

impl Shapes {
    /// The same in single precision.
    pub fn single(&self) -> Shapes<f32> {
        Shapes {
            order: self.order,
            near: self.near.single(),
            others: self.others.clone(),
            others_force: self.others_force.single(),
            others_right: self.others_right.single(),
        }
    }
}

impl<T: Real> Shapes<T> {
    /// The shape `Y d - F B c` of amplitudes d of the near modes and forces c.
    pub fn shape(&self, lambda: Complex<f64>, d: &[Complex<T>], forces: &[Complex<T>]) -> DVector<Complex<f64>> {
        let (mut driven, mut shape) = (Rows::zeros(1, self.others.len()), Rows::zeros(1, self.order));
        add_rows(0, forces, &self.others_force, &mut driven);
        let factor = |(at, other): (usize, &Complex<f64>)| -driven.at(0, at) * cast::<f64, T>((lambda - other).inv());
        let factors: Vec<Complex<T>> = self.others.iter().enumerate().map(factor).collect();
        add_rows(0, d, &self.near, &mut shape);
        add_rows(0, &factors, &self.others_right, &mut shape);
        DVector::from_fn(self.order, |at, _| cast(shape.at(0, at)))
    }
}
