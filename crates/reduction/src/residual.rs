//! The residual of a reduced mode in the full system, at a cost that does not know the full system's size.
//!
//! ```text
//! Q(lambda) V y = sum_k theta_k (lambda^2 M_k V + lambda C_k V + K_k V) y
//!               + sum_i b_i (mu_i r_i^T V y + lambda s_i(lambda) b_i^T V y)
//! ```
//!
//! All that stands on the left of coefficients is known when the basis V is: the columns of every `A_k V` and the b_i. In an
//! orthonormal basis of what they span the residual is a short vector with the same norm. The first columns of that basis are
//! V itself, where the residual is that of the reduced system; the others come from a pivoted QR decomposition of the parts
//! orthogonal to V. Nothing is squared but the last short vector: the usual expansion of `|Q V y|^2` in inner products of the
//! terms loses half of the digits.

use linsys::{AffineSystem, OperatingPoint, SecondOrder, Term};
use nalgebra::{DMatrix, DVector};
use nalgebra_sparse::CscMatrix;
use num_complex::Complex;
use sparse::product::times;
use sparse::{SparseAffineSystem, SparseSecondOrder, SparseTerm};

use super::norms::{Norms, NormsAt};
use super::outer::{OuterRows, Random};
use super::shared::Friction;
use super::{dense, split};
use crate::ReductionError;

/// Random combinations of rows that a residual is estimated with, and how many times as many rows there are at least.
const SKETCH_ROWS: usize = 128;
const LEAST_SKETCHED: usize = 2;
/// Factor that makes an estimate a bound. The squared norm of a sketch of 128 rows is that of the vector times a mean of 128
/// squared normal numbers at least: below a quarter of it with a probability of less than 3e-18 (Chernoff's bound).
const SKETCH_FACTOR: f64 = 2.0;

/// The parts of the stacked terms that are orthogonal to the basis.
#[derive(Debug, Clone)]
pub(super) struct ResidualForm {
    rows: OuterRows,
    /// Factor of norms by these rows: 1, or more where they are random combinations themselves.
    factor: f64,
    /// Random combinations of the rows, where they are fewer by far.
    sketch: Option<OuterRows>,
    /// With `V^T b_i` and `V^T r_i` of each channel, and their norms.
    friction: Friction,
    sizes: Vec<[f64; 2]>,
    /// 2-norms at most of what was left out of each term's matrices and of each b_i.
    dropped: (Vec<[f64; 3]>, Vec<f64>),
    pub norms: Norms,
}

/// Random combinations of the rows of a system on a basis V: residuals on V, or on any smaller basis within it, without all directions of the stacked terms.
#[derive(Debug, Clone)]
pub struct Combinations {
    /// `S^T A V` of M, C and K of each term, with random columns S, n x 128; without rows where a matrix is zero.
    terms: Vec<[DMatrix<f64>; 3]>,
    /// `S^T V`.
    basis: DMatrix<f64>,
    /// `S^T b_i` as columns.
    force: DMatrix<f64>,
    norms: Norms,
}

impl Combinations {
    /// Those of a system on the orthonormal columns of a basis, n x k.
    #[must_use]
    pub fn new(system: &SparseAffineSystem, basis: &DMatrix<f64>) -> Self {
        let (n, k, mut random) = (system.order(), basis.ncols(), Random(0));
        let scale = 1.0 / (SKETCH_ROWS as f64).sqrt();
        let combinations = DMatrix::from_fn(SKETCH_ROWS, n, |_, _| random.normal() * scale);
        let of = |matrix: &CscMatrix<f64>| match matrix.nnz() {
            0 => DMatrix::zeros(0, k),
            _ => dense::product(&combinations, &times(matrix, basis)),
        };
        let of_term = |SparseTerm { matrices: SparseSecondOrder { m, c, k, .. }, .. }: &SparseTerm| [m, c, k].map(of);
        let terms = system.terms().iter().map(of_term).collect();
        let channels = system.channels();
        let force = |row: usize, at: usize| {
            channels[at].force.iter().map(|&(dof, value)| value * combinations[(row, dof)]).sum::<f64>()
        };
        let force = DMatrix::from_fn(SKETCH_ROWS, channels.len(), force);
        Self { terms, basis: dense::product(&combinations, basis), force, norms: Norms::new(system) }
    }
}

/// The residual form at one operating point.
#[derive(Debug, Clone)]
pub(super) struct ResidualAt<'a> {
    form: &'a ResidualForm,
    point: &'a OperatingPoint,
    pub norms: NormsAt,
    /// Norms at most of what was left out of M, C, K.
    dropped: [f64; 3],
}

/// Limits of what a residual form may leave out.
pub(super) struct Truncation<'a> {
    /// Operating points whose coefficients weigh the terms.
    pub points: &'a [OperatingPoint],
    /// The largest |lambda| that is wanted.
    pub largest: f64,
    /// The residual up to which directions may be left out.
    pub floor: f64,
}

/// `A V` of a matrix of one term as columns of the stack.
struct Block {
    term: usize,
    /// 0 for M, 1 for C, 2 for K.
    power: usize,
    /// Factor of the columns in the stack.
    weight: f64,
    /// Columns in the stack.
    columns: DMatrix<f64>,
    start: usize,
    width: usize,
    /// Of a matrix with few rows that are not zero, such as the springs of a patch of contact, the columns are unit vectors of these
    /// rows, and `A V` is their product with this.
    factor: Option<DMatrix<f64>>,
}

impl Block {
    fn new(term: usize, power: usize, weight: f64, image: DMatrix<f64>) -> Self {
        let sizes: Vec<(usize, f64)> =
            image.row_iter().map(|row| row.norm()).enumerate().filter(|row| row.1 > 0.0).collect();
        let (columns, factor) = if sizes.len() < image.ncols() {
            let mut units = DMatrix::zeros(image.nrows(), sizes.len());
            let mut factor = DMatrix::zeros(sizes.len(), image.ncols());
            for (at, &(row, size)) in sizes.iter().enumerate() {
                units[(row, at)] = size;
                factor.set_row(at, &(image.row(row) / size));
            }
            (units, Some(factor))
        } else {
            (image, None)
        };
        Self { term, power, weight, columns, start: 0, width: 0, factor }
    }

    /// Image of `A V`, from that of the columns.
    fn through(&self, columns: DMatrix<f64>) -> DMatrix<f64> {
        match &self.factor {
            Some(factor) => columns * factor,
            None => columns,
        }
    }
}

impl ResidualForm {
    /// The form of a system over the orthonormal columns of `basis`.
    pub fn new(
        system: &SparseAffineSystem,
        basis: &DMatrix<f64>,
        truncation: &Truncation<'_>,
    ) -> Result<Self, ReductionError> {
        let (n, k, norms) = (system.order(), basis.ncols(), Norms::new(system));
        let &Truncation { points, largest, floor } = truncation;
        let greatest = |of: &dyn Fn(&OperatingPoint) -> f64| points.iter().map(|at| of(at).abs()).fold(0.0, f64::max);
        let mut blocks: Vec<Block> = Vec::new();
        for (at, term) in system.terms().iter().enumerate() {
            let theta = greatest(&|point| point.coefficients[at]);
            let matrices = [&term.matrices.m, &term.matrices.c, &term.matrices.k];
            for (power, (matrix, scale)) in matrices.into_iter().zip([largest * largest, largest, 1.0]).enumerate() {
                if matrix.nnz() > 0 {
                    let weight = if theta > 0.0 { theta * scale } else { scale };
                    blocks.push(Block::new(at, power, weight, times(matrix, basis)));
                }
            }
        }
        let of = |side: &[(usize, f64)]| {
            let mut vector = DVector::zeros(n);
            side.iter().for_each(|&(dof, value)| vector[dof] += value);
            vector
        };
        let sides: Vec<(DVector<f64>, DVector<f64>)> =
            system.channels().iter().map(|channel| (of(&channel.force), of(&channel.reading))).collect();
        let weights: Vec<f64> = sides
            .iter()
            .enumerate()
            .map(|(at, (force, reading))| {
                let lag =
                    |point: &OperatingPoint| point.channels[at].lag.map_or(0.0, |lag| (lag.force * lag.drive).abs());
                let velocity = largest * greatest(&|point| point.channels[at].slope) + greatest(&lag);
                let weight = greatest(&|point| point.channels[at].mu) * reading.norm() + velocity * force.norm();
                if weight > 0.0 { weight } else { reading.norm().max(force.norm()) }
            })
            .collect();
        let of_blocks: usize = blocks.iter().map(|block| block.columns.ncols()).sum();
        let mut stack = DMatrix::zeros(n, of_blocks + sides.len());
        let mut start = 0;
        for block in &mut blocks {
            let columns = std::mem::replace(&mut block.columns, DMatrix::zeros(0, 0));
            (block.start, block.width) = (start, columns.ncols());
            stack.columns_mut(start, block.width).copy_from(&(columns * block.weight));
            start += block.width;
        }
        for (at, ((force, _), weight)) in sides.iter().zip(&weights).enumerate() {
            stack.set_column(of_blocks + at, &(force * *weight));
        }
        // nalgebra's `tr_mul` is not blocked; this product is.
        let transposed = basis.transpose();
        for _ in 0..2 {
            let inside = &transposed * &stack;
            stack.gemm(-1.0, basis, &inside, 1.0);
        }
        let smallest = points.iter().map(|at| norms.at(at).matrices[2]).fold(f64::INFINITY, f64::min);
        let r = dense::unpivoted_r(&stack)?;
        let rank = rank(&r, floor * if smallest.is_finite() { smallest } else { 0.0 });

        let empty = || DMatrix::zeros(0, k);
        let mut terms: Vec<_> = system.terms().iter().map(|_| [empty(), empty(), empty()]).collect();
        let mut dropped = (vec![[0.0; 3]; terms.len()], vec![0.0; sides.len()]);
        for block in &blocks {
            let columns = block.through(r.columns(block.start, block.width).into_owned());
            terms[block.term][block.power] = columns.rows(0, rank) / block.weight;
            dropped.0[block.term][block.power] = columns.rows(rank, r.nrows() - rank).norm() / block.weight;
        }
        let mut force_rows = DMatrix::zeros(rank, sides.len());
        let (mut force_of, mut reading_of) = (DMatrix::zeros(k, sides.len()), DMatrix::zeros(sides.len(), k));
        let mut sizes = Vec::with_capacity(sides.len());
        for (at, ((force, reading), weight)) in sides.iter().zip(&weights).enumerate() {
            let column = r.column(of_blocks + at);
            let scale = if *weight > 0.0 { 1.0 / weight } else { 0.0 };
            force_rows.set_column(at, &(column.rows(0, rank) * scale));
            let [force, reading] = [basis.tr_mul(force), basis.tr_mul(reading)];
            sizes.push([force.norm(), reading.norm()]);
            force_of.set_column(at, &force);
            reading_of.set_row(at, &reading.transpose());
            dropped.1[at] = column.rows(rank, r.nrows() - rank).norm() * scale;
        }
        let rows = OuterRows { count: rank, terms, force: force_rows };
        let sketch = (rank >= LEAST_SKETCHED * SKETCH_ROWS).then(|| rows.sketched(SKETCH_ROWS));
        Ok(Self { rows, factor: 1.0, sketch, friction: Friction::of(force_of, &reading_of), sizes, dropped, norms })
    }

    /// The form over `V W`, on which a system is `reduced`, by random combinations.
    pub fn of_combinations(combined: &Combinations, columns: &DMatrix<f64>, reduced: &AffineSystem) -> Self {
        // S less its part in V W: what it makes of a matrix A is S^T A V W - (S^T V W) (W^T V^T A V W).
        let inside = dense::product(&combined.basis, columns);
        let outside = |of: &DMatrix<f64>, own: &DMatrix<f64>| {
            let mut rows = dense::product(of, columns);
            dense::add_product(&mut rows, -1.0, &inside, own);
            rows
        };
        let of_term = |(of, term): (&[DMatrix<f64>; 3], &Term)| {
            let SecondOrder { m, c, k, .. } = term.matrices();
            let own = [m, c, k];
            std::array::from_fn(|power| match of[power].nrows() {
                0 => DMatrix::zeros(0, columns.ncols()),
                _ => outside(&of[power], own[power]),
            })
        };
        let terms: Vec<[DMatrix<f64>; 3]> = combined.terms.iter().zip(reduced.terms()).map(of_term).collect();
        let (own, reading) = (reduced.force_matrix(), reduced.reading_matrix());
        let mut force = combined.force.clone();
        dense::add_product(&mut force, -1.0, &inside, &own);
        let sizes = (0..own.ncols()).map(|at| [own.column(at).norm(), reading.row(at).norm()]).collect();
        let dropped = (vec![[0.0; 3]; terms.len()], vec![0.0; own.ncols()]);
        let rows = OuterRows { count: SKETCH_ROWS, terms, force };
        let friction = Friction::of(own, &reading);
        Self { rows, factor: SKETCH_FACTOR, sketch: None, friction, sizes, dropped, norms: combined.norms.clone() }
    }

    /// Directions outside of the basis that residuals are computed in.
    pub fn rank(&self) -> usize {
        self.rows.count
    }

    /// The form at a point that belongs to the system.
    pub fn at<'a>(&'a self, point: &'a OperatingPoint) -> ResidualAt<'a> {
        let mut dropped = [0.0; 3];
        for (left_out, theta) in self.dropped.0.iter().zip(&point.coefficients) {
            dropped.iter_mut().zip(left_out).for_each(|(sum, left_out)| *sum += theta.abs() * left_out);
        }
        for (([force, reading], left_out), gain) in self.sizes.iter().zip(&self.dropped.1).zip(&point.channels) {
            let lag = gain.lag.map_or(0.0, |lag| lag.force * lag.drive);
            dropped[2] += gain.mu.abs() * left_out * reading + lag.abs() * left_out * force;
            dropped[1] += gain.slope.abs() * left_out * force;
        }
        ResidualAt { form: self, point, norms: self.norms.at(point), dropped }
    }
}

/// Pairs (lambda_j, V y_j) at a point.
pub(super) struct Pairs<'a> {
    pub at: &'a ResidualAt<'a>,
    pub lambdas: &'a [Complex<f64>],
    /// The split columns y_j.
    pub y: &'a DMatrix<f64>,
    /// The norms of the residuals of the reduced system.
    pub inner: &'a [f64],
}

impl Pairs<'_> {
    /// The residual of each pair: an upper bound, above the residual by no more than what the truncation left out. Where the sketch
    /// shows that a residual is below `enough`, the bound of the sketch takes its place.
    pub fn residuals(&self, enough: f64) -> Vec<f64> {
        let form = self.at.form;
        let all: Vec<usize> = (0..self.lambdas.len()).collect();
        let Some(sketch) = &form.sketch else { return self.by(&form.rows, form.factor, &all) };
        let mut out = self.by(sketch, SKETCH_FACTOR, &all);
        let open: Vec<usize> = all.into_iter().filter(|&at| out[at].is_nan() || out[at] > enough).collect();
        if !open.is_empty() {
            let exact = self.by(&form.rows, 1.0, &open);
            open.iter().zip(exact).for_each(|(&at, residual)| out[at] = residual);
        }
        out
    }

    /// The residuals of some of the pairs, by all rows or by a sketch whose norms are multiplied by a factor.
    fn by(&self, rows: &OuterRows, factor: f64, wanted: &[usize]) -> Vec<f64> {
        let (lambdas, y): (Vec<_>, _) =
            (wanted.iter().map(|&at| self.lambdas[at]).collect(), split::selected(self.y, wanted));
        let ResidualAt { form, point, norms, dropped: [m, c, k] } = self.at;
        let outer = rows.of((&form.friction, &point.channels), &point.coefficients, &lambdas, &y);
        let residual = |(place, &lambda): (usize, &Complex<f64>)| {
            let (size, l) = (split::norm_squared(&y, place).sqrt(), lambda.norm());
            let left_out = (l * l * m + l * c + k) * size;
            let outside = factor * split::norm_squared(&outer, place).sqrt() + left_out;
            self.inner[wanted[place]].hypot(outside) / (norms.size(lambda) * size)
        };
        lambdas.iter().enumerate().map(residual).collect()
    }
}

/// `Q(lambda_j) y_j` of the reduced system, internal states eliminated.
pub(super) fn reduced_residual(system: &SecondOrder, lambdas: &[Complex<f64>], y: &DMatrix<f64>) -> DMatrix<f64> {
    let mut out = split::quadratic([&system.m, &system.c, &system.k], lambdas, y);
    if system.states() > 0 {
        let drive = &system.internal.drive * y;
        let mut gains = split::zeros(system.states(), lambdas.len());
        for (at, &lambda) in lambdas.iter().enumerate() {
            let values = split::vector(&drive, at);
            let gain = |(value, decay): (&Complex<f64>, &f64)| value * lambda / (lambda + decay);
            split::set(&mut gains, at, values.iter().zip(&system.internal.decay).map(gain));
        }
        out.gemm(-1.0, &system.internal.force, &gains, 1.0);
    }
    out
}

/// The rows of R to keep so that the Frobenius norm of the others is at most `floor`.
fn rank(r: &DMatrix<f64>, floor: f64) -> usize {
    let mut left_out = 0.0;
    let mut rank = r.nrows();
    while rank > 0 {
        left_out += r.row(rank - 1).norm_squared();
        if left_out > floor * floor {
            break;
        }
        rank -= 1;
    }
    rank
}
