//! What the other modes of an anchor do to its near modes when coefficients change: right and left near vectors to first order, and with these the
//! matrix between near modes to second order.
//!
//! With near modes N and others F, `A Z = Z Lambda` at the anchor and a change D of `A - lambda B`, vectors are `Z_N + Z_F P` with
//! `P_fj = (W_F^H D Z_N)_fj / (lambda_j - lambda_f)`, and the matrix between near modes gains `W_N^H D Z_F P`. A start to this order
//! saves most of the corrections.

use linsys::SecondOrder;
use nalgebra::DMatrix;
use num_complex::Complex;

use super::{dense, split};

/// Vectors of modes, right `[y; velocity]` as columns and the lower parts of left vectors as rows.
pub(super) struct Modes {
    pub lambdas: Vec<Complex<f64>>,
    pub y: DMatrix<Complex<f64>>,
    pub velocity: DMatrix<Complex<f64>>,
    pub lower: DMatrix<Complex<f64>>,
}

/// The responses to unit changes, in single precision: they are small beside what they are added to.
#[derive(Debug, Clone)]
pub(super) struct Responses {
    /// Of each change, what it adds to the shapes of the near modes, split, k x 2 p.
    shapes: Vec<DMatrix<f32>>,
    /// Of each change, what it adds to the left vectors, real parts above imaginary ones, 2 p x k.
    left: Vec<DMatrix<f32>>,
    /// Of each pair of changes (0, 0), (1, 0), (1, 1), (2, 0) and so on, what it adds to the matrix between near modes, p x p.
    pairs: Vec<DMatrix<Complex<f32>>>,
}

impl Responses {
    /// Those to changes of M, C and K.
    pub fn new(changes: &[SecondOrder], near: &Modes, other: &Modes, gamma: f64) -> Self {
        let wide = |a: &DMatrix<f64>| a.map(Complex::from);
        let changes: Vec<_> = changes.iter().map(|SecondOrder { m, c, k, .. }| [m, c, k].map(wide)).collect();
        // The lower part of D z / -gamma for vectors that belong to the near eigenvalues.
        let acting = |[m, c, k]: &[DMatrix<Complex<f64>>; 3], y: &_, velocity: &DMatrix<_>| {
            let mut fast = velocity.clone();
            for (mut column, lambda) in fast.column_iter_mut().zip(&near.lambdas) {
                column *= *lambda;
            }
            dense::product(k, y) / Complex::from(gamma) + dense::product(c, velocity) + dense::product(m, &fast)
        };
        let moved: Vec<[DMatrix<Complex<f64>>; 2]> = changes
            .iter()
            .map(|change| {
                let mut parts = dense::product(&other.lower, &acting(change, &near.y, &near.velocity));
                for (mut column, lambda) in parts.column_iter_mut().zip(&near.lambdas) {
                    column.iter_mut().zip(&other.lambdas).for_each(|(part, other)| *part /= other - lambda);
                }
                [&other.y, &other.velocity].map(|vectors| dense::product(vectors, &parts))
            })
            .collect();
        let between =
            |s: usize, t: usize| dense::product(&near.lower, &acting(&changes[s], &moved[t][0], &moved[t][1]));
        let mut pairs = Vec::new();
        for s in 0..changes.len() {
            for t in 0..=s {
                let pair = if s == t { between(s, s) } else { between(s, t) + between(t, s) };
                pairs.push(pair.map(|value| Complex::new(-value.re as f32, -value.im as f32)));
            }
        }
        // Of left vectors the same from the other side: `(W_N^H D Z_F)_if / (lambda_i - lambda_f) W_F^H`.
        let left = changes.iter().map(|[m, c, k]| {
            let mut fast = dense::product(&near.lower, m);
            for (mut row, lambda) in fast.row_iter_mut().zip(&near.lambdas) {
                row *= *lambda;
            }
            let slow = dense::product(&near.lower, c) + fast;
            let mut parts = dense::product(&dense::product(&near.lower, k), &other.y) / Complex::from(gamma)
                + dense::product(&slow, &other.velocity);
            for (mut row, lambda) in parts.row_iter_mut().zip(&near.lambdas) {
                row.iter_mut().zip(&other.lambdas).for_each(|(part, other)| *part /= other - lambda);
            }
            split::stacked(&dense::product(&parts, &other.lower)).map(|value| value as f32)
        });
        let left = left.collect();
        Self {
            left,
            shapes: moved.iter().map(|[y, _]| split::from_columns(y).map(|value| value as f32)).collect(),
            pairs,
        }
    }

    /// What a change adds to the shapes of the near modes, split, k x 2 p.
    pub fn shapes(&self, along: &[f64]) -> Option<DMatrix<f32>> {
        sum(self.shapes.iter().zip(along.iter().map(|&along| along as f32)), |value, factor| value * factor)
    }

    /// What a change adds to the left vectors, real parts above imaginary ones, 2 p x k.
    pub fn left(&self, along: &[f64]) -> Option<DMatrix<f32>> {
        sum(self.left.iter().zip(along.iter().map(|&along| along as f32)), |value, factor| value * factor)
    }

    /// What a change adds to the matrix between near modes, p x p.
    pub fn between(&self, along: &[f64]) -> Option<DMatrix<Complex<f32>>> {
        let factors = (0..along.len()).flat_map(|s| (0..=s).map(move |t| (along[s] * along[t]) as f32));
        sum(self.pairs.iter().zip(factors), |value, factor| value * factor)
    }
}

/// The sum of matrices times factors; `None` where there is none.
fn sum<'a, T: nalgebra::Scalar + Copy + std::ops::AddAssign>(
    mut parts: impl Iterator<Item = (&'a DMatrix<T>, f32)>,
    times: impl Fn(T, f32) -> T,
) -> Option<DMatrix<T>> {
    let (first, factor) = parts.next()?;
    let mut sum = first.map(|value| times(value, factor));
    for (part, factor) in parts {
        sum.zip_apply(part, |sum, value| *sum += times(value, factor));
    }
    Some(sum)
}
