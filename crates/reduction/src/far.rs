//! What the other modes of an anchor, those that are not near, do in `-Q^-1`, in single precision.
//!
//! Corrections need two or three digits, because what they are made for is computed in double precision: so these vectors,
//! nearly all of what an anchor holds and of what a correction costs, take half of the memory and of the time.

use nalgebra::DMatrix;
use num_complex::Complex;

use super::response::Modes;
use super::{dense, split};

/// Right and left vectors of unit length of one mode of each conjugate pair, and of the real ones.
#[derive(Debug, Clone)]
pub(super) struct Far {
    gamma: f64,
    lambdas: Vec<Complex<f64>>,
    /// `|y| |v| / gamma^2` of each mode, and of its conjugate; 0 where that takes no part.
    sizes: [Vec<f32>; 2],
    /// v_j^H, real parts above imaginary ones, 2 q x k.
    left: DMatrix<f32>,
    /// y_j, split, k x 2 q.
    right: DMatrix<f32>,
}

/// `|y| |v| / (gamma (lambda_j - lambda))` for some lambda: real and imaginary parts for lambda_j, then those for its conjugate, 4 q.
#[derive(Debug, Clone)]
pub(super) struct Weights {
    pub lambda: Complex<f64>,
    parts: Vec<f32>,
}

impl Far {
    /// Of modes with `Im lambda >= 0`, of which, and of whose conjugates, those that `is_near` tells take no part.
    pub fn new(modes: &Modes, gamma: f64, is_near: impl Fn(Complex<f64>) -> bool) -> Self {
        let Modes { lambdas, y: right, lower: left, .. } = modes;
        let is_there = |lambda: Complex<f64>| [!is_near(lambda), lambda.im > 0.0 && !is_near(lambda.conj())];
        let listed: Vec<usize> = (0..lambdas.len()).filter(|&j| is_there(lambdas[j]).contains(&true)).collect();
        let (q, k) = (listed.len(), left.ncols());
        let (mut left_unit, mut right_unit) = (DMatrix::zeros(2 * q, k), DMatrix::zeros(k, 2 * q));
        let mut sizes = [vec![0.0; q], vec![0.0; q]];
        for (at, &j) in listed.iter().enumerate() {
            let (row, column) = (left.row(j), right.column(j));
            let [of_left, of_right] = [row.norm(), column.norm()].map(|size| if size > 0.0 { 1.0 / size } else { 0.0 });
            for i in 0..k {
                let (l, r) = (row[i] * of_left, column[i] * of_right);
                (left_unit[(at, i)], left_unit[(q + at, i)]) = (l.re as f32, l.im as f32);
                (right_unit[(i, at)], right_unit[(i, q + at)]) = (r.re as f32, r.im as f32);
            }
            let size = row.norm() * column.norm() / (gamma * gamma);
            for (sizes, is_there) in sizes.iter_mut().zip(is_there(lambdas[j])) {
                sizes[at] = if is_there { size as f32 } else { 0.0 };
            }
        }
        let lambdas = listed.iter().map(|&j| lambdas[j]).collect();
        Self { gamma, lambdas, sizes, left: left_unit, right: right_unit }
    }

    /// The number of modes.
    pub fn count(&self) -> usize {
        self.lambdas.len()
    }

    /// What each mode is multiplied by at `lambda`.
    pub fn weights(&self, lambda: Complex<f64>) -> Weights {
        let (q, scale) = (self.lambdas.len(), 1.0 / self.gamma);
        let mut parts = vec![0.0; 4 * q];
        for (half, (sizes, sign)) in self.sizes.iter().zip([1.0, -1.0]).enumerate() {
            let (re, im) = parts[2 * half * q..2 * (half + 1) * q].split_at_mut(q);
            let modes = self.lambdas.iter().zip(sizes);
            for ((re, im), (other, &size)) in re.iter_mut().zip(im).zip(modes) {
                let x = ((other.re - lambda.re) * scale) as f32;
                let y = ((sign * other.im - lambda.im) * scale) as f32;
                // One that takes no part may be lambda itself.
                let factor = if size > 0.0 { size / (x * x + y * y) } else { 0.0 };
                (*re, *im) = (x * factor, -y * factor);
            }
        }
        Weights { lambda, parts }
    }

    /// `sum_j y_j v_j^H r / (gamma (lambda_j - lambda))` of each residual r, split, with its weights.
    pub fn apply(&self, residuals: &DMatrix<f64>, weights: &[&Weights]) -> DMatrix<f64> {
        let (q, k, vectors) = (self.lambdas.len(), residuals.nrows(), weights.len());
        let sizes: Vec<f64> = (0..vectors).map(|at| split::norm_squared(residuals, at).sqrt()).collect();
        let mut scaled = DMatrix::zeros(k, 2 * vectors);
        for (at, mut column) in scaled.column_iter_mut().enumerate() {
            let size = sizes[at % vectors];
            let factor = if size > 0.0 { 1.0 / size } else { 0.0 };
            column.zip_apply(&residuals.column(at), |to: &mut f32, value| *to = (value * factor) as f32);
        }
        let mut products = dense::product(&self.left, &scaled);
        let (re, im) = products.as_mut_slice().split_at_mut(2 * q * vectors);
        for (at, weights) in weights.iter().enumerate() {
            let here = 2 * q * at..2 * q * (at + 1);
            weigh(&mut re[here.clone()], &mut im[here], &weights.parts);
        }
        let sums = dense::product(&self.right, &products);
        DMatrix::from_fn(k, 2 * vectors, |i, j| f64::from(sums[(i, j)]) * sizes[j % vectors])
    }
}

/// Turns the products of one residual with the left vectors, real parts of `v` and then imaginary ones, into what the right vectors are
/// multiplied by.
fn weigh(re: &mut [f32], im: &mut [f32], weights: &[f32]) {
    let q = re.len() / 2;
    let ((of_re, of_im), (im_of_re, im_of_im)) = (re.split_at_mut(q), im.split_at_mut(q));
    let (upper, lower) = weights.split_at(2 * q);
    let ((upper_re, upper_im), (lower_re, lower_im)) = (upper.split_at(q), lower.split_at(q));
    for i in 0..q {
        // v^H r and that of the conjugate.
        let (a, b) =
            ((of_re[i] - im_of_im[i], im_of_re[i] + of_im[i]), (of_re[i] + im_of_im[i], im_of_re[i] - of_im[i]));
        let up = (a.0 * upper_re[i] - a.1 * upper_im[i], a.0 * upper_im[i] + a.1 * upper_re[i]);
        let low = (b.0 * lower_re[i] - b.1 * lower_im[i], b.0 * lower_im[i] + b.1 * lower_re[i]);
        (of_re[i], im_of_re[i]) = (up.0 + low.0, up.1 + low.1);
        (of_im[i], im_of_im[i]) = (low.1 - up.1, up.0 - low.0);
    }
}
