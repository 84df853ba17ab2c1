//! What the operating points of one reduction have in common: most differ in friction alone, which acts in few directions.

use linsys::{AffineSystem, Channel, ChannelGain, OperatingPoint, SecondOrder, Term};
use nalgebra::DMatrix;
use num_complex::Complex;

use super::dense::{add_product, product};
use super::split;
use crate::ReductionError;

/// The systems without friction of some points, one for all of equal coefficients.
pub(super) struct Structures {
    distinct: Vec<SecondOrder>,
    of_points: Vec<usize>,
}

impl Structures {
    pub fn new<'a>(
        system: &AffineSystem,
        points: impl Iterator<Item = &'a OperatingPoint>,
    ) -> Result<Self, ReductionError> {
        let (mut known, mut out) = (Vec::<&[f64]>::new(), Self { distinct: Vec::new(), of_points: Vec::new() });
        for point in points {
            let place = known.iter().position(|coefficients| *coefficients == point.coefficients);
            out.of_points.push(place.unwrap_or(known.len()));
            if place.is_none() {
                known.push(&point.coefficients);
                out.distinct.push(system.structure(&point.coefficients)?);
            }
        }
        Ok(out)
    }

    /// The structure of a point, and its number.
    pub fn of(&self, point: usize) -> (usize, &SecondOrder) {
        (self.of_points[point], &self.distinct[self.of_points[point]])
    }
}

/// The friction of all channels: `sum_i b_i (mu_i r_i^T + lambda s_i(lambda) b_i^T)`.
#[derive(Debug, Clone)]
pub(super) struct Friction {
    /// b_i, n x m.
    force: DMatrix<f64>,
    /// b_i^T above r_i^T, 2 m x n.
    sides: DMatrix<f64>,
}

impl Friction {
    pub fn new(system: &AffineSystem) -> Self {
        Self::of(system.force_matrix(), &system.reading_matrix())
    }

    /// With b_i as columns and r_i^T as rows.
    pub fn of(force: DMatrix<f64>, reading: &DMatrix<f64>) -> Self {
        let (order, count) = force.shape();
        let mut sides = DMatrix::zeros(2 * count, order);
        sides.rows_mut(0, count).copy_from(&force.transpose());
        sides.rows_mut(count, count).copy_from(reading);
        Self { force, sides }
    }

    /// What each channel pulls with along its b_i, `mu_i r_i^T x_j + lambda_j s_i(lambda_j) b_i^T x_j` with the gains of each vector j, split,
    /// m x vectors; `None` where there is no friction.
    pub fn pulls<'a>(
        &self,
        gains: impl Fn(usize) -> &'a [ChannelGain],
        lambdas: &[Complex<f64>],
        shapes: &DMatrix<f64>,
    ) -> Option<DMatrix<f64>> {
        let is_none = |at: usize| gains(at).iter().all(|gain| *gain == ChannelGain::default());
        if (0..lambdas.len()).all(is_none) {
            return None;
        }
        let sides = product(&self.sides, shapes);
        let mut pulls = split::zeros(self.force.ncols(), lambdas.len());
        for (at, &lambda) in lambdas.iter().enumerate() {
            let (gains, motion) = (gains(at), split::vector(&sides, at));
            // Most channels have the gain of the one before.
            let mut last = (ChannelGain::default(), Complex::default());
            let pull = |(channel, gain): (usize, &ChannelGain)| {
                if *gain != last.0 {
                    last = (*gain, lambda * gain.complex_slope(lambda));
                }
                motion[gains.len() + channel] * gain.mu + motion[channel] * last.1
            };
            split::set(&mut pulls, at, gains.iter().enumerate().map(pull));
        }
        Some(pulls)
    }

    /// Adds what friction adds to `Q(lambda_j) x_j` with the gains of each vector j, all split.
    pub fn add<'a>(
        &self,
        gains: impl Fn(usize) -> &'a [ChannelGain],
        lambdas: &[Complex<f64>],
        shapes: &DMatrix<f64>,
        out: &mut DMatrix<f64>,
    ) {
        if let Some(pulls) = self.pulls(gains, lambdas, shapes) {
            add_product(out, 1.0, &self.force, &pulls);
        }
    }

    /// What friction changes Q by from some gains to others.
    pub fn change(&self, [from, to]: [&[ChannelGain]; 2], lambda: Complex<f64>) -> DMatrix<Complex<f64>> {
        let (count, columns) = (from.len(), self.sides.ncols());
        let pull = DMatrix::from_fn(count, columns, |channel, column| {
            let slope = to[channel].complex_slope(lambda) - from[channel].complex_slope(lambda);
            let by_reading = self.sides[(count + channel, column)] * (to[channel].mu - from[channel].mu);
            lambda * slope * self.sides[(channel, column)] + by_reading
        });
        let part = |of: fn(&Complex<f64>) -> f64| &self.force * pull.map(|value| of(&value));
        part(|value| value.re).zip_map(&part(|value| value.im), Complex::new)
    }
}

/// A system on fewer columns, put together at points of some structures.
pub(super) struct Smaller {
    basis: DMatrix<f64>,
    channels: Vec<Channel>,
    /// By number of the structure; made when a point is first asked for.
    structures: Vec<Option<AffineSystem>>,
}

impl Smaller {
    /// On the orthonormal columns of a basis.
    pub fn new(basis: DMatrix<f64>, system: &AffineSystem) -> Self {
        let channels = system.channels().iter().map(|channel| channel.projected(&basis)).collect();
        Self { basis, channels, structures: Vec::new() }
    }

    pub fn basis(&self) -> &DMatrix<f64> {
        &self.basis
    }

    pub fn into_basis(self) -> DMatrix<f64> {
        self.basis
    }

    /// The system of a structure, given with its number, with friction.
    pub fn at(
        &mut self,
        (number, structure): (usize, &SecondOrder),
        gains: &[ChannelGain],
    ) -> Result<SecondOrder, ReductionError> {
        if self.structures.len() <= number {
            self.structures.resize(number + 1, None);
        }
        let system = match &mut self.structures[number] {
            Some(system) => system,
            empty => {
                let term = Term::new("structure", "structure", structure.projected(&self.basis)?)?;
                empty.insert(AffineSystem::new(vec![term], self.channels.clone())?)
            }
        };
        Ok(system.assemble(&OperatingPoint { coefficients: vec![1.0], channels: gains.to_vec() })?)
    }
}
