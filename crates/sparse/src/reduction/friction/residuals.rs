//! Residuals of samples that have one structure: its terms are summed once, and friction is applied in its few directions.

use linsys::{AffineSystem, OperatingPoint, SecondOrder};
use nalgebra::DMatrix;
use num_complex::Complex;

use super::refinement::Pair;
use crate::reduction::residual::ResidualForm;
use crate::reduction::shared::Friction;
use crate::reduction::{Reduced, ReducedModes, Route, split};

/// The terms of residuals.
#[derive(Debug, Clone)]
pub(super) struct Residuals {
    form: ResidualForm,
    structure: SecondOrder,
    friction: Friction,
}

impl Residuals {
    pub fn new(form: &ResidualForm, coefficients: &[f64], structure: SecondOrder, system: &AffineSystem) -> Self {
        Self { form: form.summed(coefficients), structure, friction: Friction::new(system) }
    }

    /// The modes found at a point, with residuals in the whole brake.
    pub fn judged(
        &self,
        reduced: &Reduced,
        point: &OperatingPoint,
        found: Vec<Pair>,
        corrections: u64,
    ) -> ReducedModes {
        let lambdas: Vec<Complex<f64>> = found.iter().map(|(lambda, _)| *lambda).collect();
        let mut shapes = split::zeros(self.structure.order(), found.len());
        found.iter().enumerate().for_each(|(at, (_, shape))| split::set(&mut shapes, at, shape.iter().copied()));
        let inner = split::norms(&self.inner(point, &lambdas, &shapes));
        let point = OperatingPoint { coefficients: vec![1.0], channels: point.channels.clone() };
        let route = Route::Followed { corrections };
        reduced.judged(&self.form.at(&point), lambdas, shapes, &inner, route, 0)
    }

    /// `Q(lambda_j) y_j` of the reduced system.
    fn inner(&self, point: &OperatingPoint, lambdas: &[Complex<f64>], shapes: &DMatrix<f64>) -> DMatrix<f64> {
        let SecondOrder { m, c, k, .. } = &self.structure;
        let mut out = split::quadratic([m, c, k], lambdas, shapes);
        self.friction.add(&point.channels, lambdas, shapes, &mut out);
        out
    }
}
