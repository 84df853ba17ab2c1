//! The part of residuals outside of the basis, in all directions or in a few random combinations of them.

use linsys::ChannelGain;
use nalgebra::DMatrix;
use num_complex::Complex;

use super::shared::Friction;
use super::{dense, split};

/// `W^T Q(lambda) V` by its terms, or `S W^T Q(lambda) V`.
#[derive(Debug, Clone)]
pub(super) struct OuterRows {
    pub count: usize,
    /// `W^T A_k V` of each term's M, C and K; no rows where the matrix is zero.
    pub terms: Vec<[DMatrix<f64>; 3]>,
    /// `W^T b_i` of each channel, as columns.
    pub force: DMatrix<f64>,
}

impl OuterRows {
    /// `count` combinations of the rows with independent normal numbers of variance `1 / count`: the mean of the squared norm of what
    /// they make of a vector is that of the vector. The numbers are the same every time.
    pub fn sketched(&self, count: usize) -> Self {
        let mut random = Random(0);
        let sketch = DMatrix::from_fn(count, self.count, |_, _| random.normal() / (count as f64).sqrt());
        let of = |part: &DMatrix<f64>| if part.nrows() == 0 { part.clone() } else { dense::product(&sketch, part) };
        Self {
            count,
            terms: self.terms.iter().map(|parts| parts.each_ref().map(of)).collect(),
            force: dense::product(&sketch, &self.force),
        }
    }

    /// `W^T Q(lambda_j) V y_j` of the terms with some coefficients, and with the friction of all channels over the basis.
    pub fn of(
        &self,
        (friction, gains): (&Friction, &[ChannelGain]),
        coefficients: &[f64],
        lambdas: &[Complex<f64>],
        y: &DMatrix<f64>,
    ) -> DMatrix<f64> {
        let [inertia, damping, stiffness] = [0, 1, 2].map(|power| self.product(power, coefficients, y));
        let mut outer = split::combined([&inertia, &damping], stiffness, lambdas);
        if let Some(pulls) = friction.pulls(gains, lambdas, y) {
            dense::add_product(&mut outer, 1.0, &self.force, &pulls);
        }
        outer
    }

    /// Part of the products of the vectors that comes from M, C or K. Their matrices are summed first: there are more vectors than terms.
    fn product(&self, power: usize, coefficients: &[f64], y: &DMatrix<f64>) -> DMatrix<f64> {
        let parts = self.terms.iter().map(|term| &term[power]).zip(coefficients);
        let mut parts = parts.filter(|(part, theta)| part.nrows() > 0 && **theta != 0.0);
        let mut product = DMatrix::zeros(self.count, y.ncols());
        let Some((first, &theta)) = parts.next() else { return product };
        let mut rest = parts.peekable();
        if rest.peek().is_none() {
            dense::add_product(&mut product, theta, first, y);
            return product;
        }
        let mut sum = first * theta;
        rest.for_each(|(part, &theta)| sum.zip_apply(part, |sum, value| *sum += theta * value));
        dense::add_product(&mut product, 1.0, &sum, y);
        product
    }
}

/// Normal numbers by the method of Box and Muller from the generator SplitMix64.
pub(super) struct Random(pub u64);

impl Random {
    /// Uniform in (0, 1).
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (((z ^ (z >> 31)) >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    pub fn normal(&mut self) -> f64 {
        let (radius, angle) = (self.uniform(), self.uniform());
        (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sketch_of_128_rows_keeps_norms_to_a_part() {
        let rows = OuterRows {
            count: 400,
            terms: vec![
                [(); 3].map(|()| DMatrix::from_fn(400, 90, |i, j| ((i * i + 7 * i * j + 3 * j) % 23) as f64 - 11.0)),
            ],
            force: DMatrix::zeros(400, 0),
        };
        let sketch = rows.sketched(128);
        for (whole, short) in rows.terms[0][0].column_iter().zip(sketch.terms[0][0].column_iter()) {
            let ratio = short.norm() / whole.norm();
            assert!((0.75..1.25).contains(&ratio), "{ratio}");
        }
    }
}
