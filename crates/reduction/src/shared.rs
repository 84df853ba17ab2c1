//! Parts that the operating points of one reduction share. Most points differ in friction alone, which adds to the n x n matrix Q(lambda) one of
//! rank m at most, m the number of channels; structures are made once for all points of equal coefficients.

use linsys::{AffineSystem, Channel, ChannelGain, OperatingPoint, SecondOrder, Term};
use nalgebra::DMatrix;
use num_complex::Complex;

use super::dense::{add_product, product};
use super::split;
use crate::ReductionError;

/// Systems without friction at operating points, one for all points of equal coefficients.
pub(super) struct Structures {
    /// Systems that differ, in the order of the first point of each.
    distinct: Vec<SecondOrder>,
    /// Index in `distinct` of the system of each point.
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

    /// Number of the structure of a point, from 0 among those that differ, and the structure.
    pub fn of(&self, point: usize) -> (usize, &SecondOrder) {
        (self.of_points[point], &self.distinct[self.of_points[point]])
    }
}

/// Friction of the m channels in Q(lambda), n x n: `sum_i b_i (mu_i r_i^T + lambda s_i(lambda) b_i^T)`, with the gains mu_i, 1, and s_i, Ns/m
/// ([`ChannelGain::complex_slope`]), which are not held here.
#[derive(Debug, Clone)]
pub(super) struct Friction {
    /// The b_i as columns, n x m.
    force: DMatrix<f64>,
    /// The b_i^T as rows, m of them, above the r_i^T, 2 m x n.
    sides: DMatrix<f64>,
}

impl Friction {
    pub fn new(system: &AffineSystem) -> Self {
        Self::of(system.force_matrix(), &system.reading_matrix())
    }

    /// With the b_i as columns of `force`, n x m, and the r_i^T as rows of `reading`, m x n.
    pub fn of(force: DMatrix<f64>, reading: &DMatrix<f64>) -> Self {
        let (order, count) = force.shape();
        let mut sides = DMatrix::zeros(2 * count, order);
        sides.rows_mut(0, count).copy_from(&force.transpose());
        sides.rows_mut(count, count).copy_from(reading);
        Self { force, sides }
    }

    /// Factors of the b_i in what friction adds to `Q(lambda_j) x_j`, `mu_i r_i^T x_j + lambda_j s_i(lambda_j) b_i^T x_j` for each channel i and
    /// each vector j, m x vectors; the vectors x_j in `shapes` and the result are [`split`]. `None` where all gains are zero.
    pub fn pulls(
        &self,
        gains: &[ChannelGain],
        lambdas: &[Complex<f64>],
        shapes: &DMatrix<f64>,
    ) -> Option<DMatrix<f64>> {
        if gains.iter().all(|gain| *gain == ChannelGain::default()) {
            return None;
        }
        let sides = product(&self.sides, shapes);
        let mut pulls = split::zeros(self.force.ncols(), lambdas.len());
        for (at, &lambda) in lambdas.iter().enumerate() {
            let motion = split::vector(&sides, at);
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

    /// Adds to column j of `out` what friction adds to `Q(lambda_j) x_j`, `sum_i b_i` times its factor by [`Friction::pulls`]; all are [`split`],
    /// n x vectors.
    pub fn add(&self, gains: &[ChannelGain], lambdas: &[Complex<f64>], shapes: &DMatrix<f64>, out: &mut DMatrix<f64>) {
        if let Some(pulls) = self.pulls(gains, lambdas, shapes) {
            add_product(out, 1.0, &self.force, &pulls);
        }
    }

    /// Adds to column j of `out` what friction adds to `Q(lambda_j)^T y_j`, `sum_i (mu_i r_i + lambda_j s_i(lambda_j) b_i) b_i^T y_j`; all are [`split`],
    /// n x vectors.
    pub fn add_transposed(
        &self,
        gains: &[ChannelGain],
        lambdas: &[Complex<f64>],
        shapes: &DMatrix<f64>,
        out: &mut DMatrix<f64>,
    ) {
        let count = self.force.ncols();
        let pushes = product(&self.force.transpose(), shapes);
        let mut factors = split::zeros(2 * count, lambdas.len());
        for (at, &lambda) in lambdas.iter().enumerate() {
            let push = split::vector(&pushes, at);
            let along = (0..count).map(|channel| push[channel] * (lambda * gains[channel].complex_slope(lambda)));
            let reading = (0..count).map(|channel| push[channel] * gains[channel].mu);
            split::set(&mut factors, at, along.chain(reading));
        }
        add_product(out, 1.0, &self.sides.transpose(), &factors);
    }
}

/// Projection `V^T Q(lambda) V` of a system on a basis V, n x k, put together for one operating point after another.
pub(super) struct Smaller {
    /// Basis V, n x k, of orthonormal columns.
    basis: DMatrix<f64>,
    /// Channels on the basis: `V^T b_i` and `r_i^T V`.
    channels: Vec<Channel>,
    /// Projected structures, of one term each and with the channels, by the number in [`Structures::of`]; `None` until a point of it is asked for.
    structures: Vec<Option<AffineSystem>>,
}

impl Smaller {
    /// The projection of `system` on a basis V of orthonormal columns, n x k. Only the channels are taken from `system`; structures come with
    /// [`Smaller::at`].
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

    /// The projected system of order k at the gains of the channels, for a structure of order n and its number by [`Structures::of`].
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
