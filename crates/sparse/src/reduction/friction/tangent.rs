//! A next to a number: its value there by the fine polynomials, and how it changes by the coarse ones, so that the last digits of an
//! eigenvalue take one evaluation.

use linsys::ChannelGain;
use num_complex::Complex;

use super::coupling::{self, Coordinates, Gains, Scratch, combine, combine_part};
use super::ports::Ports;
use super::real::cast;
use super::rows::Rows;

/// Distance from the number, relative to it, up to which A is a straight line; chosen: guesses lie within it, and what is then missing of an
/// eigenvalue of cases/disc-pad is below 1e-9 of it.
const STRAIGHT: f64 = 3e-6;

/// `T^-1 (D_mu R Y + D_s B^T Y)` and A at the coarse points.
pub(super) type Coarse = Vec<[Rows<f32>; 2]>;

/// The gains of one sample in some coordinates.
#[derive(Clone, Copy)]
pub(super) struct Sample<'a> {
    pub ports: &'a Ports,
    pub own: &'a Coordinates,
    pub gains: &'a [ChannelGain],
}

/// A and `T^-1 (D_mu R Y + D_s B^T Y)` as straight lines through a number.
pub(super) struct Tangent {
    at: Option<Complex<f64>>,
    /// Each by its value and its derivative over lambda.
    solved: [Rows; 2],
    a: [Rows; 2],
    weights: Vec<Complex<f64>>,
    /// The derivatives in single precision.
    single: [Rows<f32>; 2],
}

impl Tangent {
    pub fn new(ports: &Ports) -> Self {
        let (p, m) = (ports.near(), ports.count());
        let two = |rows: usize| [Rows::zeros(rows, p), Rows::zeros(rows, p)];
        let single = [Rows::zeros(m, p), Rows::zeros(p, p)];
        Self { at: None, solved: two(m), a: two(p), weights: Vec::new(), single }
    }

    /// Forgets the sample.
    pub fn clear(&mut self) {
        self.at = None;
    }

    /// A at a number, from the line through this one or one near it.
    pub fn value(
        &mut self,
        Sample { ports, own, gains }: Sample<'_>,
        coarse: &Coarse,
        lambda: Complex<f64>,
        scratch: &mut Scratch,
        out: &mut Rows,
    ) {
        let from = self.at.filter(|at| (lambda - at).norm() <= STRAIGHT * lambda.norm()).unwrap_or_else(|| {
            coupling::at(&own.double, &ports.fine, lambda, Gains::of(gains), scratch, &mut self.a[0]);
            std::mem::swap(&mut scratch.solved, &mut self.solved[0]);
            ports.coarse.slope_weights_at(lambda, &mut self.weights);
            let weights: Vec<Complex<f32>> = self.weights.iter().map(|&weight| cast(weight)).collect();
            for (part, slope) in self.single.iter_mut().enumerate() {
                combine_part(&weights, coarse, part, slope);
            }
            self.solved[1].set_wide(&self.single[0], ports.near());
            self.a[1].set_wide(&self.single[1], ports.near());
            lambda
        });
        self.at = Some(from);
        combine(&[Complex::new(1.0, 0.0), lambda - from], &[&self.a[0], &self.a[1]], out);
    }

    /// How fast an eigenvalue of A changes with lambda, from its left and its right vector: `y^H (dA / d lambda) x / y^H x`.
    pub fn rate(&self, [y, x]: [&[Complex<f64>]; 2]) -> Complex<f64> {
        let along: Complex<f64> = y.iter().zip(x).map(|(y, x)| y.conj() * x).sum();
        y.iter().enumerate().map(|(row, y)| y.conj() * self.a[1].row_times(row, x)).sum::<Complex<f64>>() / along
    }

    /// `T^-1 (D_mu R Y + D_s B^T Y)` at a number from the same line.
    pub fn solved(&self, lambda: Complex<f64>, out: &mut Rows) {
        let step = lambda - self.at.unwrap_or(lambda);
        combine(&[Complex::new(1.0, 0.0), step], &[&self.solved[0], &self.solved[1]], out);
    }
}
