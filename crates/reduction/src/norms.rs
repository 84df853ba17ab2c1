//! The norms of M, C and K at an operating point, without assembling them.

use std::collections::BTreeMap;

use linsys::{ChannelGain, OperatingPoint};
use nalgebra::{DMatrix, DVector};
use nalgebra_sparse::CscMatrix;
use num_complex::Complex;
use sparse::SparseAffineSystem;
use sparse::product::columns;

/// Frobenius norms of `sum_k theta_k A_k` as the root of `theta^T G theta`, with the inner products G of the terms.
///
/// Backward errors are relative to `|lambda|^2 |M| + |lambda| |C| + |K|` and the norms of internal states, as those of
/// [`cea::backward_error`].
#[derive(Debug, Clone)]
pub(super) struct Norms {
    gram: [DMatrix<f64>; 3],
    /// |b_i|^2 of each channel.
    force: Vec<f64>,
}

/// The norms at one operating point.
#[derive(Debug, Clone)]
pub(super) struct NormsAt {
    /// |M|, |C|, |K|.
    pub matrices: [f64; 3],
    /// Decay, and the norm of the matrix that the state's gain multiplies, of each lag.
    lags: Vec<(f64, f64)>,
}

impl Norms {
    pub fn new(system: &SparseAffineSystem) -> Self {
        let n = system.order();
        let vector = |side: &[(usize, f64)]| {
            let mut sum = BTreeMap::new();
            side.iter().for_each(|&(row, value)| *sum.entry(row).or_insert(0.0) += value);
            sum.into_iter().collect::<Vec<(usize, f64)>>()
        };
        let force: Vec<_> = system.channels().iter().map(|channel| vector(&channel.force)).collect();
        let reading: Vec<_> = system.channels().iter().map(|channel| vector(&channel.reading)).collect();
        let [forces, readings] = [products(&force, n), products(&reading, n)];
        let terms = || system.terms().iter().map(|term| &term.matrices);
        // Channels stand behind the terms: b b^T in C, b r^T in K.
        let [c, k]: [Vec<_>; 2] = [terms().map(|term| &term.c).collect(), terms().map(|term| &term.k).collect()];
        let gram = [
            gram(&terms().map(|term| &term.m).collect::<Vec<_>>()),
            with_channels(&c, [&force, &force], forces.component_mul(&forces)),
            with_channels(&k, [&force, &reading], forces.component_mul(&readings)),
        ];
        Self { gram, force: forces.diagonal().iter().copied().collect() }
    }

    /// The norms at a point that belongs to the system.
    pub fn at(&self, point: &OperatingPoint) -> NormsAt {
        let norm = |gram: &DMatrix<f64>, channels: &dyn Fn(&ChannelGain) -> f64| {
            let theta = point.coefficients.iter().copied().chain(point.channels.iter().map(channels));
            let theta = DVector::from_iterator(gram.nrows(), theta.take(gram.nrows()));
            theta.dot(&(gram * &theta)).max(0.0).sqrt()
        };
        let [m, c, k] = &self.gram;
        let matrices = [norm(m, &|_| 0.0), norm(c, &|gain| gain.slope), norm(k, &|gain| gain.mu)];
        let gains = point.channels.iter().zip(&self.force);
        let lags =
            gains.filter_map(|(gain, force)| gain.lag.map(|lag| (lag.decay, (lag.force * lag.drive).abs() * force)));
        NormsAt { matrices, lags: lags.collect() }
    }
}

impl NormsAt {
    /// `|lambda|^2 |M| + |lambda| |C| + |K|` and the internal states.
    pub fn size(&self, lambda: Complex<f64>) -> f64 {
        let [m, c, k] = self.matrices;
        let l = lambda.norm();
        let gain = |decay: f64| (lambda / (lambda + decay)).norm().min(1.0 / f64::EPSILON);
        l * l * m + l * c + k + self.lags.iter().map(|&(decay, norm)| gain(decay) * norm).sum::<f64>()
    }
}

/// Inner products of `vectors`, which are given by their entries.
fn products(vectors: &[Vec<(usize, f64)>], length: usize) -> DMatrix<f64> {
    let mut products = DMatrix::zeros(vectors.len(), vectors.len());
    let mut whole = vec![0.0; length];
    for (i, own) in vectors.iter().enumerate() {
        own.iter().for_each(|&(row, value)| whole[row] = value);
        for (j, other) in vectors.iter().enumerate() {
            products[(i, j)] = other.iter().map(|&(row, value)| value * whole[row]).sum();
        }
        own.iter().for_each(|&(row, _)| whole[row] = 0.0);
    }
    products
}

/// The Gram matrix of `matrices` and, behind them, the outer products `left_i right_i^T` of channels, whose own Gram matrix is given.
fn with_channels(
    matrices: &[&CscMatrix<f64>],
    [left, right]: [&[Vec<(usize, f64)>]; 2],
    own: DMatrix<f64>,
) -> DMatrix<f64> {
    let (count, channels) = (matrices.len(), left.len());
    let mut out = DMatrix::zeros(count + channels, count + channels);
    out.view_mut((0, 0), (count, count)).copy_from(&gram(matrices));
    out.view_mut((count, count), (channels, channels)).copy_from(&own);
    for (term, matrix) in matrices.iter().enumerate() {
        for (channel, (left, right)) in left.iter().zip(right).enumerate() {
            let value = right.iter().map(|&(column, b)| {
                let entries = matrix.col(column);
                let at =
                    |row: usize| entries.row_indices().binary_search(&row).map_or(0.0, |place| entries.values()[place]);
                b * left.iter().map(|&(row, a)| a * at(row)).sum::<f64>()
            });
            let value: f64 = value.sum();
            (out[(term, count + channel)], out[(count + channel, term)]) = (value, value);
        }
    }
    out
}

fn gram(matrices: &[&CscMatrix<f64>]) -> DMatrix<f64> {
    let mut gram = DMatrix::zeros(matrices.len(), matrices.len());
    for (i, a) in matrices.iter().enumerate() {
        for (j, b) in matrices.iter().enumerate().take(i + 1) {
            let value = inner(a, b);
            (gram[(i, j)], gram[(j, i)]) = (value, value);
        }
    }
    gram
}

/// `sum A_ij B_ij`.
fn inner(a: &CscMatrix<f64>, b: &CscMatrix<f64>) -> f64 {
    let mut sum = 0.0;
    for ((rows, values), (others, other_values)) in columns(a).zip(columns(b)) {
        let mut at = 0;
        for (&row, value) in rows.iter().zip(values) {
            while others.get(at).is_some_and(|&other| other < row) {
                at += 1;
            }
            if others.get(at) == Some(&row) {
                sum += value * other_values[at];
            }
        }
    }
    sum
}
