//! Sparse matrices times blocks of vectors.

use faer::Mat;
use nalgebra::DVector;
use num_complex::Complex;
use pulp::Simd;

use super::lanes::{Kernel, Row, add, columns, gathered, joined, plus_real, put, zero};
use crate::State;

type Block = Mat<Complex<f64>>;

/// Side of a matrix: it acts as it is or transposed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    /// The matrix as it is: right vectors.
    Right,
    /// The transposed matrix: conjugates of left vectors.
    Left,
}

/// Factors of M, C and K in a sum, and of each `f_i e_i^T`.
#[derive(Debug, Clone)]
pub(crate) struct Weights {
    pub(crate) mass: Complex<f64>,
    pub(crate) damping: Complex<f64>,
    pub(crate) stiffness: Complex<f64>,
    pub(crate) states: Vec<Complex<f64>>,
}

/// The entries of each row that a product reads.
#[derive(Debug, Clone)]
pub(super) struct Rows {
    pub(super) starts: Vec<usize>,
    /// Columns of the entries, fewer than 2^32: half the memory to read.
    pub(super) columns: Vec<u32>,
    /// Indices of the transposed entries in the pattern.
    pub(super) places: Vec<usize>,
}

impl Rows {
    /// The rows of those entries of a symmetric pattern that are wanted.
    pub(super) fn new(starts: &[usize], others: &[usize], is_wanted: impl Fn(usize) -> bool) -> Self {
        let mut rows = Self { starts: vec![0], columns: Vec::new(), places: Vec::new() };
        for row in starts.windows(2) {
            let places = (row[0]..row[1]).filter(|&at| is_wanted(at));
            places.for_each(|at| {
                rows.columns.push(others[at] as u32);
                rows.places.push(at);
            });
            rows.starts.push(rows.columns.len());
        }
        rows
    }
}

/// M, C, K and what drives each state, times one vector.
pub(crate) struct Parts<'a> {
    pub(super) products: [Vec<Complex<f64>>; 3],
    pub(super) driven: Vec<Complex<f64>>,
    pub(super) states: &'a [State],
    pub(super) side: Side,
}

impl Parts<'_> {
    /// Weighted sum of the products.
    pub(crate) fn sum(&self, weights: &Weights) -> DVector<Complex<f64>> {
        let Weights { mass, damping, stiffness, states } = weights;
        let [m, c, k] = &self.products;
        let rows = m.iter().zip(c).zip(k).map(|((m, c), k)| mass * m + damping * c + stiffness * k);
        let mut sum = DVector::from_iterator(m.len(), rows);
        for ((state, driven), weight) in self.states.iter().zip(&self.driven).zip(states) {
            state.sides(self.side).1.iter().for_each(|&(dof, f)| sum[dof] += weight * driven * f);
        }
        sum
    }
}

/// Real matrices on the same rows, each times a block.
pub(super) struct PartProducts<'a, const TERMS: usize> {
    pub(super) rows: &'a Rows,
    /// The values of each, in the order of the rows.
    pub(super) values: [&'a [f64]; TERMS],
    pub(super) x: &'a Block,
    pub(super) products: [&'a mut Block; TERMS],
}

impl<const TERMS: usize> Kernel for PartProducts<'_, TERMS> {
    #[inline(always)]
    fn run<S: Simd, const N: usize>(mut self, simd: S) {
        let rows = self.rows;
        for from in (0..self.x.ncols()).step_by(columns::<S, N>()) {
            let x: Vec<Row<S, N>> = gathered(simd, self.x, from);
            for (row, entries) in rows.starts.windows(2).enumerate() {
                let mut sums = [zero::<S, N>(simd); TERMS];
                for at in entries[0]..entries[1] {
                    let x = x[rows.columns[at] as usize];
                    for (sum, values) in sums.iter_mut().zip(self.values) {
                        *sum = plus_real(simd, *sum, values[at], x);
                    }
                }
                for (product, sum) in self.products.iter_mut().zip(sums) {
                    put::<S, N>(sum, product, row, from);
                }
            }
        }
    }
}

/// A complex matrix times a block.
pub(super) struct Product<'a> {
    pub(super) rows: &'a Rows,
    pub(super) values: &'a [Complex<f64>],
    pub(super) x: &'a Block,
    pub(super) product: &'a mut Block,
}

impl Kernel for Product<'_> {
    #[inline(always)]
    fn run<S: Simd, const N: usize>(self, simd: S) {
        let rows = self.rows;
        for from in (0..self.x.ncols()).step_by(columns::<S, N>()) {
            let x: Vec<Row<S, N>> = gathered(simd, self.x, from);
            for (row, entries) in rows.starts.windows(2).enumerate() {
                let entries = entries[0]..entries[1];
                let mut sum = [zero::<S, N>(simd); 2];
                for (&value, &column) in self.values[entries.clone()].iter().zip(&rows.columns[entries]) {
                    add(simd, &mut sum, value, x[column as usize]);
                }
                put::<S, N>(joined(simd, sum), self.product, row, from);
            }
        }
    }
}

/// The sum of two real matrices on the same rows, each times a block of its own.
pub(super) struct SumOfProducts<'a> {
    pub(super) rows: &'a Rows,
    pub(super) terms: [(&'a [f64], &'a Block); 2],
    pub(super) sum: &'a mut Block,
}

impl Kernel for SumOfProducts<'_> {
    #[inline(always)]
    fn run<S: Simd, const N: usize>(self, simd: S) {
        let rows = self.rows;
        for from in (0..self.sum.ncols()).step_by(columns::<S, N>()) {
            let [(a, x), (b, y)] = self.terms.map(|(values, x)| (values, gathered::<S, N>(simd, x, from)));
            for (row, entries) in rows.starts.windows(2).enumerate() {
                let entries = entries[0]..entries[1];
                let mut sums = [zero::<S, N>(simd); 2];
                let values = a[entries.clone()].iter().zip(&b[entries.clone()]);
                for ((&a, &b), &column) in values.zip(&rows.columns[entries]) {
                    sums[0] = plus_real(simd, sums[0], a, x[column as usize]);
                    sums[1] = plus_real(simd, sums[1], b, y[column as usize]);
                }
                put::<S, N>(plus_real(simd, sums[0], 1.0, sums[1]), self.sum, row, from);
            }
        }
    }
}
