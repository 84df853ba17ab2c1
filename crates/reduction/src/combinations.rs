//! Random combinations of the rows of a large system, from which residuals are known at a cost that does not know its size.

use linsys::ChannelGain;
use nalgebra::DMatrix;
use nalgebra_sparse::CscMatrix;
use num_complex::Complex;
use sparse::product::times;
use sparse::{SparseAffineSystem, SparseSecondOrder, SparseTerm};

use super::norms::Norms;
use super::shared::Friction;
use super::{dense, split};

/// Number of random combinations of rows that residuals are estimated from; chosen: with fewer a bound is farther from what it bounds, or [`FACTOR`]
/// larger, with more each residual takes longer.
pub(super) const COMBINATIONS: usize = 128;
/// Factor that makes an estimate a bound. The squared norm of 128 combinations is at least the squared norm of the vector times a mean of 128
/// squared normal numbers: below a quarter of the squared norm with a probability of less than 3e-18 (Chernoff's bound).
pub(super) const FACTOR: f64 = 2.0;

/// Random combinations of the rows of a system on a basis V: residuals on V, or on any smaller basis within it, without all directions of the stacked terms.
#[derive(Debug, Clone)]
pub struct Combinations {
    /// `S^T A V` of M, C and K of each term, with random columns S, n x 128; without rows where a matrix is zero.
    pub(super) terms: Vec<[DMatrix<f64>; 3]>,
    /// `S^T V`.
    pub(super) basis: DMatrix<f64>,
    /// `S^T b_i` as columns.
    pub(super) force: DMatrix<f64>,
    pub(super) norms: Norms,
}

impl Combinations {
    /// Combinations of a system on the orthonormal columns of a basis, n x k. The factors are independent normal numbers of variance 1 / 128, so that the mean
    /// of the squared norm of what they make of a vector is the squared norm of the vector. The numbers are the same every time.
    #[must_use]
    pub fn new(system: &SparseAffineSystem, basis: &DMatrix<f64>) -> Self {
        let (n, k, mut random) = (system.order(), basis.ncols(), Random(0));
        let scale = 1.0 / (COMBINATIONS as f64).sqrt();
        let combinations = DMatrix::from_fn(COMBINATIONS, n, |_, _| random.normal() * scale);
        let of = |matrix: &CscMatrix<f64>| match matrix.nnz() {
            0 => DMatrix::zeros(0, k),
            _ => dense::product(&combinations, &times(matrix, basis)),
        };
        let of_term = |SparseTerm { matrices: SparseSecondOrder { m, c, k, .. }, .. }: &SparseTerm| [m, c, k].map(of);
        let terms = system.terms().iter().map(of_term).collect();
        let channels = system.channels();
        let combined = |row: usize, at: usize| {
            channels[at].force.iter().map(|&(dof, value)| value * combinations[(row, dof)]).sum::<f64>()
        };
        let force = DMatrix::from_fn(COMBINATIONS, channels.len(), combined);
        Self { terms, basis: dense::product(&combinations, basis), force, norms: Norms::new(system) }
    }
}

/// `S^T W Q(lambda) V` by its terms, with the projection W on what is orthogonal to V.
#[derive(Debug, Clone)]
pub(super) struct OuterRows {
    /// Combinations of M, C and K of each term; no rows where the matrix is zero.
    pub terms: Vec<[DMatrix<f64>; 3]>,
    /// `S^T W b_i` of each channel, as columns.
    pub force: DMatrix<f64>,
}

impl OuterRows {
    /// `S^T W Q(lambda_j) V y_j` of the terms with `coefficients` and of `friction`, that of all channels over the basis, with `gains`. `losses` are the
    /// coefficients times loss factors, `None` without any. The y_j and the result are [`split`].
    pub fn of(
        &self,
        (friction, gains): (&Friction, &[ChannelGain]),
        (coefficients, losses): (&[f64], Option<&[f64]>),
        lambdas: &[Complex<f64>],
        y: &DMatrix<f64>,
    ) -> DMatrix<f64> {
        let [inertia, damping, mut stiffness] = [0, 1, 2].map(|power| self.product(power, coefficients, y));
        losses.iter().for_each(|losses| split::add_times_i(&mut stiffness, &self.product(2, losses, y)));
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
        let mut product = DMatrix::zeros(COMBINATIONS, y.ncols());
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
struct Random(u64);

impl Random {
    /// Uniform in (0, 1).
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (((z ^ (z >> 31)) >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let (radius, angle) = (self.uniform(), self.uniform());
        (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra_sparse::CooMatrix;

    use super::*;

    #[test]
    fn combinations_of_128_rows_keep_norms_to_a_part() {
        let matrix = DMatrix::from_fn(400, 400, |i, j| ((i * i + 7 * i * j + 3 * j) % 23) as f64 - 11.0);
        let zero = || CscMatrix::zeros(400, 400);
        let matrices = SparseSecondOrder::new(CscMatrix::from(&CooMatrix::from(&matrix)), zero(), zero()).unwrap();
        let term = SparseTerm { name: "structure".into(), family: "structure".into(), matrices, loss: 0.0 };
        let system = SparseAffineSystem::new(vec![term], Vec::new()).unwrap();
        let combinations = Combinations::new(&system, &DMatrix::identity(400, 90));
        for (whole, short) in matrix.column_iter().zip(combinations.terms[0][0].column_iter()) {
            let ratio = short.norm() / whole.norm();
            assert!((0.75..1.25).contains(&ratio), "{ratio}");
        }
    }
}
