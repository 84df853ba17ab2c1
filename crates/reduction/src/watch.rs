//! The modes of an anchor that are not near, and whether one of them may come near at another point.
//!
//! None of them is followed, so one that comes into the rectangle would be lost. Its eigenvalue is predicted to first order in the
//! coefficients, which costs next to nothing.

use linsys::{AffineSystem, OperatingPoint, SecondOrder};
use nalgebra::DMatrix;
use num_complex::Complex;
use sparse::Rectangle;

use super::dense;
use super::full::outside;
use super::response::Modes;

/// Eigenvalues at an anchor, and what each is moved by.
#[derive(Debug, Clone)]
pub(super) struct Watch {
    lambdas: Vec<Complex<f64>>,
    /// Of each term, per unit of its coefficient, each eigenvalue.
    terms: Vec<Vec<Complex<f64>>>,
    /// Of each channel, per unit of mu, and per unit of its slope.
    channels: Vec<[Vec<Complex<f64>>; 2]>,
    /// i omega at which internal states are slopes.
    middle: Complex<f64>,
}

impl Watch {
    pub fn new(system: &AffineSystem, modes: &Modes, gamma: f64, middle: Complex<f64>) -> Self {
        let Modes { lambdas, y, velocity, lower } = modes;
        let wide = |a: &DMatrix<f64>| a.map(Complex::from);
        let along = |a: &DMatrix<f64>, right: &DMatrix<Complex<f64>>| -> Vec<Complex<f64>> {
            if a.iter().all(|&entry| entry == 0.0) {
                return vec![Complex::default(); lambdas.len()];
            }
            let image = dense::product(&wide(a), right);
            lower.row_iter().zip(image.column_iter()).map(|(left, image)| (left * image)[0]).collect()
        };
        let terms = system.terms().iter().map(|term| {
            let SecondOrder { m, c, k, .. } = term.matrices();
            let [m, c, k] = [along(m, velocity), along(c, velocity), along(k, y)];
            (0..lambdas.len()).map(|j| -k[j] / gamma - c[j] - lambdas[j] * m[j]).collect()
        });
        let (force, reading) = (wide(&system.force_matrix()), wide(&system.reading_matrix()));
        let (by_force, moved) = (lower * &force, [&reading * y, force.transpose() * velocity]);
        let channels = (0..force.ncols()).map(|at| {
            let by = |scale: f64, moved: &DMatrix<Complex<f64>>| {
                (0..lambdas.len()).map(|j| by_force[(j, at)] * moved[(at, j)] * -scale).collect()
            };
            [by(1.0 / gamma, &moved[0]), by(1.0, &moved[1])]
        });
        let (terms, channels) = (terms.collect(), channels.collect());
        Self { lambdas: lambdas.clone(), terms, channels, middle }
    }

    /// Whether one of the modes is predicted within `margin` of the rectangle at another point.
    pub fn comes_near(&self, [from, to]: [&OperatingPoint; 2], rectangle: &Rectangle, margin: f64) -> bool {
        let mut there = self.lambdas.clone();
        let mut add = |moved: &[Complex<f64>], factor: Complex<f64>| {
            if factor != Complex::default() {
                there.iter_mut().zip(moved).for_each(|(lambda, moved)| *lambda += moved * factor);
            }
        };
        for (moved, (from, to)) in self.terms.iter().zip(from.coefficients.iter().zip(&to.coefficients)) {
            add(moved, (to - from).into());
        }
        for ([friction, slope], (from, to)) in self.channels.iter().zip(from.channels.iter().zip(&to.channels)) {
            add(friction, (to.mu - from.mu).into());
            add(slope, to.complex_slope(self.middle) - from.complex_slope(self.middle));
        }
        there.iter().any(|&lambda| outside(rectangle, lambda) <= margin)
    }
}
