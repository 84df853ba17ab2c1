//! What is smooth in a band of frequencies, as rational functions through a few of its points.
//!
//! ```text
//! F(lambda) = sum_n w_n F_n / (lambda - lambda_n)  /  sum_n w_n / (lambda - lambda_n)
//! ```
//!
//! is `F_n` at `lambda_n` whatever the weights are. The points and weights are those of the AAA algorithm (Nakatsukasa, Sete and Trefethen,
//! SIAM J. Sci. Comput. 40, 2018): one point after another where a function is missed most, and weights that make
//! `sum_n w_n (F - F_n) / (lambda - lambda_n)` least at all others. F is a sum of poles beyond the band, which the weights follow: a
//! polynomial through Chebyshev points takes twice as many for nine digits. The function that is missed least need not be F itself: what
//! is made of F at the points may be what is read off between them.

use std::f64::consts::PI;

use nalgebra::DMatrix;
use num_complex::Complex;

use crate::ReductionError;
use crate::dense;
use crate::outer::Random;
use crate::rows::Rows;

/// Points at which F is known while a table is made; chosen, two to each of the widest table: of the band, of a line to its right where
/// growing modes are, and of lines on both sides where modes are counted.
const OF_BAND: usize = 48;
const OF_GROWING: usize = 12;
const OF_SIDES: usize = 8;
/// That line, as a part of the highest frequency: to its right nothing is known of tables.
pub(super) const GROWING: f64 = 0.02;
/// Those on both sides too; chosen.
pub(super) const ASIDE: f64 = 0.06;
/// Most points of a table; chosen, the tables of cases/disc-pad have 12.
const MOST_POINTS: usize = 24;
/// Random combinations of the entries of each matrix that stand for all of them; chosen.
const DIRECTIONS: usize = 6;
/// Where derivatives at a point are taken, relative to it.
const BESIDE: f64 = 1e-7;

/// Two matrices at points of a part of the imaginary axis, and weights.
#[derive(Debug, Clone)]
pub(super) struct Table<T = f64> {
    pub points: Vec<Complex<f64>>,
    pub weights: Vec<Complex<f64>>,
    pub values: Vec<[Rows<T>; 2]>,
}

impl Table {
    /// The same in single precision.
    pub fn single(self) -> Table<f32> {
        let Self { points, weights, values } = self;
        Table { points, weights, values: values.iter().map(|parts| parts.each_ref().map(Rows::single)).collect() }
    }

    /// The matrices at the first point, and what those at all points differ by from these.
    pub fn differences(&self) -> Differences {
        let first = self.values[0].clone();
        let apart = |parts: &[Rows; 2]| [0, 1].map(|part| parts[part].minus(&first[part]));
        let Self { points, weights, values } = self;
        let values = values.iter().map(apart).collect();
        let table = Self { points: points.clone(), weights: weights.clone(), values }.single();
        Differences { single_first: first.each_ref().map(Rows::single), first, table }
    }
}

/// A table of what the matrices differ by from those at its first point: where F changes little over the band, single precision holds that as
/// well as double precision holds F.
#[derive(Debug, Clone)]
pub(super) struct Differences {
    pub first: [Rows; 2],
    /// The same in single precision.
    pub single_first: [Rows<f32>; 2],
    pub table: Table<f32>,
}

/// F at the points where it is known.
pub(super) struct Samples {
    points: Vec<Complex<f64>>,
    values: Vec<[Rows; 2]>,
}

/// Where a table holds what it is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Region {
    /// The band, and to its right.
    Growing,
    /// The lines around it too.
    Around,
}

/// Matrices at a point, from the point and F there.
pub(super) type Seen<'a> = &'a dyn Fn(Complex<f64>, &[Rows; 2]) -> Vec<Rows>;

impl Samples {
    /// F in a band of frequencies, rad/s, and on both sides of it as far as a part of the highest.
    pub fn new([low, high]: [f64; 2], aside: f64, at: impl Fn(Complex<f64>) -> [Rows; 2]) -> Self {
        let along = |n: usize, count: usize| {
            0.5 * (low + high) - 0.5 * (high - low) * (PI * n as f64 / (count - 1) as f64).cos()
        };
        let line = |re: f64, count: usize| (0..count).map(move |n| Complex::new(re * high, along(n, count)));
        let points = line(0.0, OF_BAND).chain(line(GROWING, OF_GROWING));
        let points: Vec<_> = points.chain(line(-aside, OF_SIDES)).chain(line(aside, OF_SIDES)).collect();
        Self { values: points.iter().map(|&point| at(point)).collect(), points }
    }

    /// Tables of F for each of some errors, which descend, relative to the matrices that are seen, each by itself; `None` where most points
    /// are not enough.
    ///
    /// # Errors
    /// Values that are no numbers.
    pub fn tables<const N: usize>(
        &self,
        region: Region,
        errors: [f64; N],
        seen: Seen<'_>,
    ) -> Result<Option<[Table; N]>, ReductionError> {
        let known = Known::new(self, region, seen);
        let (mut support, mut tables) = (vec![0, OF_BAND - 1], Vec::with_capacity(N));
        while support.len() <= MOST_POINTS {
            let weights = known.weights(&support)?;
            let misses = known.misses(&support, &weights);
            let largest = misses.iter().copied().fold(0.0, f64::max);
            while tables.len() < N && largest <= errors[tables.len()] {
                tables.push(self.table(&support, &weights));
            }
            if tables.len() == N {
                break;
            }
            let next = (0..OF_BAND).max_by(|&a, &b| misses[a].total_cmp(&misses[b]));
            support.extend(next);
        }
        Ok(tables.try_into().ok())
    }

    /// The table of a support, with its points in descending order.
    fn table(&self, support: &[usize], weights: &[Complex<f64>]) -> Table {
        let mut pairs: Vec<_> = support.iter().copied().zip(weights.iter().copied()).collect();
        pairs.sort_by_key(|(n, _)| std::cmp::Reverse(*n));
        let (support, weights): (Vec<_>, Vec<_>) = pairs.into_iter().unzip();
        Table {
            points: support.iter().map(|&n| self.points[n]).collect(),
            weights,
            values: support.iter().map(|&n| self.values[n].clone()).collect(),
        }
    }
}

/// The matrices that a table is to hold.
struct Known<'a> {
    points: &'a [Complex<f64>],
    /// Combinations of their entries, by points: those of each matrix after one another, of the order of 1.
    seen: DMatrix<Complex<f64>>,
}

impl<'a> Known<'a> {
    fn new(samples: &'a Samples, region: Region, seen: Seen<'_>) -> Self {
        let count = match region {
            Region::Growing => OF_BAND + OF_GROWING,
            Region::Around => samples.points.len(),
        };
        let points = &samples.points[..count];
        let matrices: Vec<Vec<Rows>> = points.iter().zip(&samples.values).map(|(&at, f)| seen(at, f)).collect();
        let parts = matrices.first().map_or(0, Vec::len);
        let mut seen = DMatrix::zeros(count, parts * DIRECTIONS);
        let mut random = Random(0);
        for part in 0..parts {
            let mut of_part = seen.columns_mut(part * DIRECTIONS, DIRECTIONS);
            for mut direction in of_part.column_iter_mut() {
                let factors: Vec<f64> = matrices[0][part].entries().map(|_| random.normal()).collect();
                for (seen, matrices) in direction.iter_mut().zip(&matrices) {
                    *seen = matrices[part].entries().zip(&factors).map(|(entry, factor)| entry * factor).sum();
                }
            }
            let size = of_part.norm() / (count as f64).sqrt();
            if size > 0.0 {
                of_part.unscale_mut(size);
            }
        }
        Self { points, seen }
    }

    /// The points that are in no support.
    fn others<'b>(&'b self, support: &'b [usize]) -> impl Iterator<Item = usize> + 'b {
        (0..self.points.len()).filter(|point| !support.contains(point))
    }

    /// The weights of some points.
    fn weights(&self, support: &[usize]) -> Result<Vec<Complex<f64>>, ReductionError> {
        let others: Vec<usize> = self.others(support).collect();
        let directions = self.seen.ncols();
        let left = DMatrix::from_fn(others.len() * directions, support.len(), |row, column| {
            let ([here, there], direction) = ([others[row / directions], support[column]], row % directions);
            (self.seen[(here, direction)] - self.seen[(there, direction)]) / (self.points[here] - self.points[there])
        });
        dense::smallest_right_singular(&left)
    }

    /// What a table misses of a matrix at most, as a part of it, at each point.
    fn misses(&self, support: &[usize], weights: &[Complex<f64>]) -> Vec<f64> {
        let mut misses = vec![0.0; self.points.len()];
        for point in self.others(support) {
            let factors =
                support.iter().zip(weights).map(|(&n, weight)| weight / (self.points[point] - self.points[n]));
            let factors: Vec<Complex<f64>> = factors.collect();
            let whole = factors.iter().sum::<Complex<f64>>().inv();
            let apart = |direction: usize| {
                let sum: Complex<f64> =
                    support.iter().zip(&factors).map(|(&n, factor)| self.seen[(n, direction)] * factor).sum();
                (sum * whole - self.seen[(point, direction)]).norm_sqr()
            };
            for first in (0..self.seen.ncols()).step_by(DIRECTIONS) {
                let part = first..first + DIRECTIONS;
                let size: f64 = part.clone().map(|direction| self.seen[(point, direction)].norm_sqr()).sum();
                let apart: f64 = part.map(apart).sum();
                misses[point] = f64::max(misses[point], (apart / size.max(f64::MIN_POSITIVE)).sqrt());
            }
        }
        misses
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
