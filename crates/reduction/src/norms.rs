//! The norms of M, C and K at an operating point, without assembling them.

use linsys::{ChannelGain, OperatingPoint};
use nalgebra::{DMatrix, DVector};
use nalgebra_sparse::{CooMatrix, CscMatrix};
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
        let outer = |left: &[(usize, f64)], right: &[(usize, f64)]| {
            let mut product = CooMatrix::new(n, n);
            for &(row, a) in left {
                right.iter().for_each(|&(column, b)| product.push(row, column, a * b));
            }
            CscMatrix::from(&product)
        };
        // Channels stand behind the terms: b b^T in C, b r^T in K.
        let slopes: Vec<_> = system.channels().iter().map(|channel| outer(&channel.force, &channel.force)).collect();
        let frictions: Vec<_> =
            system.channels().iter().map(|channel| outer(&channel.force, &channel.reading)).collect();
        let terms = system.terms();
        let gram = [
            gram(&terms.iter().map(|term| &term.matrices.m).collect::<Vec<_>>()),
            gram(&terms.iter().map(|term| &term.matrices.c).chain(&slopes).collect::<Vec<_>>()),
            gram(&terms.iter().map(|term| &term.matrices.k).chain(&frictions).collect::<Vec<_>>()),
        ];
        Self { gram, force: slopes.iter().map(|slope| inner(slope, slope).sqrt()).collect() }
    }

    /// The norms of a system whose terms are summed into one with these coefficients.
    pub fn summed(&self, coefficients: &[f64]) -> Self {
        let gram = self.gram.each_ref().map(|gram| {
            let channels = gram.nrows() - coefficients.len().min(gram.nrows());
            let onto = DMatrix::from_fn(gram.nrows(), 1 + channels, |row, column| match coefficients.get(row) {
                Some(&theta) if column == 0 => theta,
                None if row - coefficients.len() + 1 == column => 1.0,
                _ => 0.0,
            });
            onto.transpose() * gram * onto
        });
        Self { gram, force: self.force.clone() }
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
