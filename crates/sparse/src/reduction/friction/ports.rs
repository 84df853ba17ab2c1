//! A structure seen through the ports where friction acts, its modes in and near the band apart from all others.
//!
//! ```text
//! Q_0(lambda)^-1 = Y (lambda - Lambda)^-1 V^H + F(lambda)
//! ```
//!
//! with the p eigenvalues Lambda of the structure that have Im > 0 and are in or near the band, and all others in F, which is smooth there:
//! what friction needs of it is read off polynomials through a few points of the band.

use std::f64::consts::PI;

use linsys::{AffineSystem, SecondOrder};
use nalgebra::DMatrix;
use num_complex::Complex;

use super::rows::Rows;
use crate::SparseError;
use crate::reduction::state_modes::StateModes;

/// Between these multiples of the highest frequency of the band the near modes end, at the largest gap; chosen: what is beyond is smooth in
/// the band.
const NEAR: [f64; 2] = [1.1, 1.5];
/// Points of the band for guesses of eigenvalues; chosen: on cases/disc-pad guesses are then good to 1 rad/s.
pub(super) const COARSE: usize = 8;
/// Points for what is followed from one friction to another; chosen: on cases/disc-pad eigenvalues then err by some 1e-6, and paths ask for
/// 1e-5.
const PATH: usize = 12;
/// Points for their last digits: the fewest of these that are enough.
const FINE: [usize; 3] = [16, 24, 36];
/// Largest relative error of the fine polynomials, half way between two points; chosen, below the residuals that are asked for.
const LARGEST_ERROR: f64 = 1e-9;
/// Where derivatives at a point are taken, relative to it.
const BESIDE: f64 = 1e-7;

/// The structure through its ports.
#[derive(Debug, Clone)]
pub(super) struct Ports {
    /// Lambda, rad/s.
    pub lambdas: Vec<Complex<f64>>,
    /// Y, k x p.
    pub right: DMatrix<Complex<f64>>,
    /// `V^H B`, p x m.
    pub force: DMatrix<Complex<f64>>,
    /// `R Y` and `B^T Y`, m x p.
    pub sides: [DMatrix<Complex<f64>>; 2],
    /// `R F B` and `B^T F B` at the points of the band for guesses.
    pub coarse: Table<f32>,
    /// The same for paths.
    pub path: Table,
    /// The same for the last digits.
    pub fine: Table,
    /// What a unit of the gains mu and `lambda s(lambda)` of each port moves the near modes by at most, rad/s.
    pub moved: [Vec<f64>; 2],
    /// i omega in the middle of the band.
    pub middle: Complex<f64>,
    /// The other eigenvalues.
    pub others: Vec<Complex<f64>>,
    /// `(V^H B)^T` of the others, by ports.
    pub others_force: Rows,
    /// Y of the others, by modes.
    pub others_right: Rows,
}

/// Two m x m matrices at Chebyshev points of a part of the imaginary axis, between which polynomials run (Berrut and Trefethen, SIAM
/// Review 46, 2004).
#[derive(Debug, Clone)]
pub(super) struct Table<T = f64> {
    pub points: Vec<Complex<f64>>,
    pub weights: Vec<f64>,
    pub values: Vec<[Rows<T>; 2]>,
}

impl Table {
    fn single(self) -> Table<f32> {
        let Self { points, weights, values } = self;
        Table { points, weights, values: values.iter().map(|parts| parts.each_ref().map(Rows::single)).collect() }
    }

    fn new([low, high]: [f64; 2], count: usize, at: impl Fn(Complex<f64>) -> [Rows; 2]) -> Self {
        let angles: Vec<f64> = (0..count).map(|n| PI * (n as f64 + 0.5) / count as f64).collect();
        let point = |angle: &f64| Complex::new(0.0, 0.5 * (low + high) + 0.5 * (high - low) * angle.cos());
        let points: Vec<_> = angles.iter().map(point).collect();
        let weight = |(n, angle): (usize, &f64)| if n % 2 == 0 { angle.sin() } else { -angle.sin() };
        let weights = angles.iter().enumerate().map(weight).collect();
        let values = points.iter().map(|&point| at(point)).collect();
        Self { points, weights, values }
    }
}

impl<T> Table<T> {
    /// The barycentric weights of the values at a number near the band.
    pub fn weights_at(&self, lambda: Complex<f64>, out: &mut Vec<Complex<f64>>) {
        out.clear();
        if let Some(here) = self.points.iter().position(|point| *point == lambda) {
            out.extend((0..self.points.len()).map(|n| Complex::from(if n == here { 1.0 } else { 0.0 })));
            return;
        }
        out.extend(self.points.iter().zip(&self.weights).map(|(point, weight)| *weight / (lambda - point)));
        let sum = out.iter().sum::<Complex<f64>>().inv();
        out.iter_mut().for_each(|weight| *weight *= sum);
    }

    /// The weights of the values for the derivative over lambda there: `b_n (s - 1 / (lambda - lambda_n))` with the weights b_n of the
    /// values themselves and `s = sum_n b_n / (lambda - lambda_n)`.
    pub fn slope_weights_at(&self, lambda: Complex<f64>, out: &mut Vec<Complex<f64>>) {
        let is_point = self.points.contains(&lambda);
        let lambda = if is_point { lambda * (1.0 + BESIDE) } else { lambda };
        self.weights_at(lambda, out);
        let inverses = self.points.iter().map(|point| (lambda - point).inv());
        let mean: Complex<f64> = out.iter().zip(inverses.clone()).map(|(weight, inverse)| weight * inverse).sum();
        out.iter_mut().zip(inverses).for_each(|(weight, inverse)| *weight *= mean - inverse);
    }
}

impl Ports {
    /// The structure of a system through some of its channels, for a band of frequencies, rad/s; `None` where the polynomials do not hold
    /// what is smooth in it.
    ///
    /// # Errors
    /// A mass matrix that is singular.
    pub fn new(
        structure: &SecondOrder,
        system: &AffineSystem,
        channels: &[usize],
        band: [f64; 2],
    ) -> Result<Option<Self>, SparseError> {
        let order = structure.order();
        let gamma = band[1];
        let StateModes { lambdas, y: right, lower, .. } = StateModes::new(structure, gamma)?;
        let wide = |a: DMatrix<f64>| a.map(Complex::from);
        let force = wide(system.force_matrix().select_columns(channels));
        let reading = wide(system.reading_matrix().select_rows(channels));
        let end = end_of_near(&lambdas, band[1]);
        let is_near = |at: &usize| lambdas[*at].im > 0.0 && lambdas[*at].im <= end;
        let (mut near, others): (Vec<usize>, Vec<usize>) = (0..2 * order).partition(is_near);
        near.sort_by(|&a, &b| cea::by_frequency(&lambdas[a], &lambdas[b]));

        let driven = lower * &force / Complex::from(gamma);
        let read = [&reading * &right, force.transpose() * &right];
        let smooth = |lambda: Complex<f64>| {
            let mut weighted = driven.select_rows(&others);
            for (mut row, &at) in weighted.row_iter_mut().zip(&others) {
                row *= (lambda - lambdas[at]).inv();
            }
            let part = |side: &DMatrix<Complex<f64>>| {
                let product = side.select_columns(&others) * &weighted;
                Rows::from_fn(product.nrows(), product.ncols(), |i, j| product[(i, j)])
            };
            [part(&read[0]), part(&read[1])]
        };
        let Some(fine) =
            FINE.into_iter().map(|count| Table::new(band, count, smooth)).find(|table| is_held(table, smooth, band))
        else {
            return Ok(None);
        };
        let [coarse, path] = [COARSE, PATH].map(|count| Table::new(band, count, smooth));
        let count = channels.len();
        let force = driven.select_rows(&near);
        let sides = read.map(|side| side.select_columns(&near));
        let moved = |side: &DMatrix<Complex<f64>>| {
            (0..count).map(|port| force.column(port).norm() * side.row(port).norm()).collect()
        };
        Ok(Some(Self {
            lambdas: near.iter().map(|&at| lambdas[at]).collect(),
            right: right.select_columns(&near),
            moved: [moved(&sides[0]), moved(&sides[1])],
            middle: Complex::new(0.0, 0.5 * (band[0] + band[1])),
            force,
            sides,
            coarse: coarse.single(),
            path,
            fine,
            others_force: Rows::from_fn(count, others.len(), |port, at| driven[(others[at], port)]),
            others_right: Rows::from_fn(others.len(), order, |at, row| right[(row, others[at])]),
            others: others.iter().map(|&at| lambdas[at]).collect(),
        }))
    }

    /// p, the number of modes in and near the band.
    pub fn near(&self) -> usize {
        self.lambdas.len()
    }

    /// m, the number of ports.
    pub fn count(&self) -> usize {
        self.force.ncols()
    }
}

/// Whether a table holds what it is made of: between its points, at an end of the band and to the right of the other.
fn is_held(table: &Table, exact: impl Fn(Complex<f64>) -> [Rows; 2], band: [f64; 2]) -> bool {
    let count = table.points.len();
    let between = (table.points[count / 2 - 1] + table.points[count / 2]) * 0.5;
    let mut weights = Vec::new();
    [between, Complex::new(0.0, band[0]), Complex::new(0.02 * band[1], band[1])].into_iter().all(|lambda| {
        table.weights_at(lambda, &mut weights);
        exact(lambda).iter().enumerate().all(|(part, exact)| {
            let values: Vec<&Rows> = table.values.iter().map(|value| &value[part]).collect();
            exact.distance(&values, &weights) <= LARGEST_ERROR
        })
    })
}

/// The frequency in the middle of the largest gap, by ratio, between the frequencies of modes at the end of a band.
fn end_of_near(lambdas: &[Complex<f64>], highest: f64) -> f64 {
    let [from, to] = NEAR.map(|part| part * highest);
    let mut inside: Vec<f64> = lambdas.iter().map(|lambda| lambda.im).filter(|im| (from..to).contains(im)).collect();
    inside.extend([from, to]);
    inside.sort_by(f64::total_cmp);
    let widest = inside.windows(2).max_by(|a, b| (a[1] / a[0]).total_cmp(&(b[1] / b[0])));
    widest.map_or(to, |gap| (gap[0] * gap[1]).sqrt())
}
