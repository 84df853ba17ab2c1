//! Residuals of samples that have one structure: its terms are summed once, friction is applied in its few directions, and all vectors are
//! multiplied together.

use linsys::{AffineSystem, ChannelGain, OperatingPoint, SecondOrder};
use nalgebra::DMatrix;
use num_complex::Complex;

use super::shapes::{Found, Shapes};
use crate::residual::{Pairs, ResidualForm};
use crate::shared::Friction;
use crate::{Reduced, ReducedModes, Route, split};

/// The terms of residuals.
#[derive(Debug, Clone)]
pub(super) struct Residuals {
    form: ResidualForm,
    structure: SecondOrder,
    friction: Friction,
}

/// The modes of a sample, in order.
pub(super) struct OfSample {
    pub point: OperatingPoint,
    pub found: Vec<Found>,
    pub route: Route,
}

impl Residuals {
    pub fn new(form: &ResidualForm, coefficients: &[f64], structure: SecondOrder, system: &AffineSystem) -> Self {
        Self { form: form.summed(coefficients), structure, friction: Friction::new(system) }
    }

    /// The modes of samples, with residuals in the whole brake.
    pub fn judged(&self, reduced: &Reduced, shapes: &Shapes, samples: &[OfSample]) -> Vec<ReducedModes> {
        let forms: Vec<_> = samples.iter().map(|OfSample { point, .. }| self.form.at(point)).collect();
        let all = samples.iter().enumerate().flat_map(|(sample, of)| of.found.iter().map(move |mode| (sample, mode)));
        let (of, found): (Vec<usize>, Vec<&Found>) = all.unzip();
        let lambdas: Vec<Complex<f64>> = found.iter().map(|mode| mode.lambda).collect();
        let shapes = shapes.shapes(&found);
        let inner = split::norms(&self.inner(|at| &samples[of[at]].point.channels, &lambdas, &shapes));
        let at = of.iter().map(|&sample| &forms[sample]).collect();
        let residuals = reduced.residuals(&Pairs { at, lambdas: &lambdas, y: &shapes, inner: &inner });
        let mut first = 0;
        let of_sample = |OfSample { found, route, .. }: &OfSample| {
            let own: Vec<usize> = (first..first + found.len()).collect();
            first += found.len();
            let (lambdas, residuals) = own.iter().map(|&at| (lambdas[at], residuals[at])).unzip();
            reduced.with_residuals(lambdas, &split::selected(&shapes, &own), residuals, *route, 0)
        };
        samples.iter().map(of_sample).collect()
    }

    /// `Q(lambda_j) y_j` of the reduced system with the gains of each vector j.
    fn inner<'a>(
        &self,
        gains: impl Fn(usize) -> &'a [ChannelGain],
        lambdas: &[Complex<f64>],
        shapes: &DMatrix<f64>,
    ) -> DMatrix<f64> {
        let SecondOrder { m, c, k, .. } = &self.structure;
        let mut out = split::quadratic([m, c, k], lambdas, shapes);
        self.friction.add(gains, lambdas, shapes, &mut out);
        out
    }
}
