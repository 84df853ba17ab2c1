//! Products with a few complex columns at once, one in each lane of a register: a coefficient is read once for all of them.
//!
//! No closures around arithmetic: those are compiled for the least of all processors where they are not inlined.

use faer::Mat;
use num_complex::Complex;
use pulp::{Arch, Simd, WithSimd, bytemuck};

/// Rows that are multiplied with all columns of a basis before the next ones: they stay in the nearest cache.
const CHUNK: usize = 256;
/// Columns of a basis, or rows of a factor, that are taken together.
pub(super) const GROUP: usize = 4;

type Block = Mat<Complex<f64>>;

/// The real and the imaginary parts of one row.
pub(super) type Row<S> = [<S as Simd>::f64s; 2];

/// Runs a kernel on four lanes where the machine has AVX-512, since blocks have four columns; elsewhere on the usual registers.
pub(super) fn narrow<K: WithSimd>(kernel: K) -> K::Output {
    let arch = Arch::new();
    #[cfg(target_arch = "x86_64")]
    if let (Arch::V4(_), Some(avx2)) = (arch, pulp::x86::V3::try_new()) {
        return Simd::vectorize(avx2, kernel);
    }
    arch.dispatch(kernel)
}

#[inline(always)]
pub(super) fn zero<S: Simd>(simd: S) -> Row<S> {
    [simd.splat_f64s(0.0); 2]
}

/// `i x`.
#[inline(always)]
pub(super) fn turned<S: Simd>(simd: S, [re, im]: Row<S>) -> Row<S> {
    [simd.neg_f64s(im), re]
}

#[inline(always)]
pub(super) fn negative<S: Simd>(simd: S, [re, im]: Row<S>) -> Row<S> {
    [simd.neg_f64s(re), simd.neg_f64s(im)]
}

#[inline(always)]
pub(super) fn minus<S: Simd>(simd: S, a: Row<S>, b: Row<S>) -> Row<S> {
    [simd.sub_f64s(a[0], b[0]), simd.sub_f64s(a[1], b[1])]
}

/// `sum + Re a x + Im a y`: a times x for `y = i x`, and the conjugate of a times x for `y = -i x`.
#[inline(always)]
pub(super) fn plus<S: Simd>(simd: S, sum: Row<S>, a: Complex<f64>, x: Row<S>, y: Row<S>) -> Row<S> {
    let (re, im) = (simd.splat_f64s(a.re), simd.splat_f64s(a.im));
    [
        simd.mul_add_f64s(im, y[0], simd.mul_add_f64s(re, x[0], sum[0])),
        simd.mul_add_f64s(im, y[1], simd.mul_add_f64s(re, x[1], sum[1])),
    ]
}

/// The products of a sum with the real and with the imaginary parts of the coefficients, which a processor adds up side by side.
pub(super) type Halves<S> = [Row<S>; 2];

#[inline(always)]
pub(super) fn add<S: Simd>(simd: S, sum: &mut Halves<S>, a: Complex<f64>, x: Row<S>) {
    let (re, im) = (simd.splat_f64s(a.re), simd.splat_f64s(a.im));
    sum[0] = [simd.mul_add_f64s(re, x[0], sum[0][0]), simd.mul_add_f64s(re, x[1], sum[0][1])];
    sum[1] = [simd.mul_add_f64s(im, x[0], sum[1][0]), simd.mul_add_f64s(im, x[1], sum[1][1])];
}

#[inline(always)]
pub(super) fn joined<S: Simd>(simd: S, [re, im]: Halves<S>) -> Row<S> {
    [simd.sub_f64s(re[0], im[1]), simd.add_f64s(re[1], im[0])]
}

/// `a x`.
#[inline(always)]
pub(super) fn times<S: Simd>(simd: S, a: Complex<f64>, x: Row<S>) -> Row<S> {
    plus(simd, zero(simd), a, x, turned(simd, x))
}

/// Some columns of a block, as many as there are lanes or fewer, side by side; row i is row `order(i)` of the block.
#[inline(always)]
pub(super) fn gathered<S: Simd>(simd: S, block: &Block, from: usize, order: impl Fn(usize) -> usize) -> Vec<Row<S>> {
    let mut rows = vec![zero(simd); block.nrows()];
    let numbers: &mut [f64] = bytemuck::cast_slice_mut(&mut rows);
    for (lane, j) in (from..block.ncols().min(from + S::F64_LANES)).enumerate() {
        let column = block.col_as_slice(j);
        for (i, row) in numbers.chunks_exact_mut(2 * S::F64_LANES).enumerate() {
            let value = column[order(i)];
            (row[lane], row[S::F64_LANES + lane]) = (value.re, value.im);
        }
    }
    rows
}

/// Back into the columns of a block, the reverse of [`gathered`].
#[inline(always)]
pub(super) fn scatter<S: Simd>(rows: &[Row<S>], block: &mut Block, from: usize, order: impl Fn(usize) -> usize) {
    let numbers: &[f64] = bytemuck::cast_slice(rows);
    for (lane, j) in (from..block.ncols().min(from + S::F64_LANES)).enumerate() {
        let column = block.col_as_slice_mut(j);
        for (i, row) in numbers.chunks_exact(2 * S::F64_LANES).enumerate() {
            column[order(i)] = Complex::new(row[lane], row[S::F64_LANES + lane]);
        }
    }
}

/// `V^H X` with the first columns of V, and as many of its rows as X has.
pub(super) fn adjoint_times(v: &Block, columns: usize, x: &Block) -> Block {
    let mut product = Mat::zeros(columns, x.ncols());
    let columns: Vec<_> = (0..columns).map(|j| &v.col_as_slice(j)[..x.nrows()]).collect();
    narrow(Dots { columns: &columns, x, product: &mut product });
    product
}

/// `X + V C` with as many columns of V as C has rows, and as many of its rows as X has.
pub(super) fn add_times(x: &mut Block, v: &Block, c: &Block) {
    let columns: Vec<_> = (0..c.nrows()).map(|j| &v.col_as_slice(j)[..x.nrows()]).collect();
    narrow(Sums { columns: &columns, c, x });
}

struct Dots<'a> {
    columns: &'a [&'a [Complex<f64>]],
    x: &'a Block,
    product: &'a mut Block,
}

impl WithSimd for Dots<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let starts = (0..self.x.ncols()).step_by(S::F64_LANES);
        let groups: Vec<_> = starts.clone().map(|from| gathered(simd, self.x, from, |i| i)).collect();
        let mut dots = vec![vec![zero(simd); self.columns.len()]; groups.len()];
        for from in (0..self.x.nrows()).step_by(CHUNK) {
            let chunk = from..self.x.nrows().min(from + CHUNK);
            for (at, columns) in self.columns.chunks(GROUP).enumerate() {
                for (x, dots) in groups.iter().zip(&mut dots) {
                    let (x, dots) = (&x[chunk.clone()], &mut dots[at * GROUP..]);
                    if let [a, b, c, d] = columns {
                        let columns = [a, b, c, d].map(|column| &column[chunk.clone()]);
                        let mut sums = [dots[0], dots[1], dots[2], dots[3]];
                        for (i, &x) in x.iter().enumerate() {
                            let y = negative(simd, turned(simd, x));
                            for (sum, column) in sums.iter_mut().zip(columns) {
                                *sum = plus(simd, *sum, column[i], x, y);
                            }
                        }
                        dots[..GROUP].copy_from_slice(&sums);
                    } else {
                        for (column, dot) in columns.iter().zip(dots) {
                            for (&value, &x) in column[chunk.clone()].iter().zip(x) {
                                *dot = plus(simd, *dot, value, x, negative(simd, turned(simd, x)));
                            }
                        }
                    }
                }
            }
        }
        starts.zip(&dots).for_each(|(from, dots)| scatter::<S>(dots, self.product, from, |i| i));
    }
}

struct Sums<'a> {
    columns: &'a [&'a [Complex<f64>]],
    c: &'a Block,
    x: &'a mut Block,
}

impl WithSimd for Sums<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let starts = (0..self.x.ncols()).step_by(S::F64_LANES);
        let mut groups: Vec<_> = starts.clone().map(|from| gathered(simd, self.x, from, |i| i)).collect();
        let factors: Vec<_> = starts.clone().map(|from| gathered(simd, self.c, from, |i| i)).collect();
        for from in (0..self.x.nrows()).step_by(CHUNK) {
            let chunk = from..self.x.nrows().min(from + CHUNK);
            for (at, columns) in self.columns.chunks(GROUP).enumerate() {
                for (x, factors) in groups.iter_mut().zip(&factors) {
                    let (x, factors) = (&mut x[chunk.clone()], &factors[at * GROUP..]);
                    if let [a, b, c, d] = columns {
                        let columns = [a, b, c, d].map(|column| &column[chunk.clone()]);
                        let factors = [factors[0], factors[1], factors[2], factors[3]];
                        let mut others = factors;
                        for other in &mut others {
                            *other = turned(simd, *other);
                        }
                        for (i, x) in x.iter_mut().enumerate() {
                            let mut sum = *x;
                            for ((column, &factor), &other) in columns.iter().zip(&factors).zip(&others) {
                                sum = plus(simd, sum, column[i], factor, other);
                            }
                            *x = sum;
                        }
                    } else {
                        for (column, &factor) in columns.iter().zip(factors) {
                            let other = turned(simd, factor);
                            for (&value, x) in column[chunk.clone()].iter().zip(&mut *x) {
                                *x = plus(simd, *x, value, factor, other);
                            }
                        }
                    }
                }
            }
        }
        starts.zip(&groups).for_each(|(from, rows)| scatter::<S>(rows, self.x, from, |i| i));
    }
}
