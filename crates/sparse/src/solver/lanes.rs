//! A few complex columns at once, side by side in the lanes of registers: a coefficient is read once for all of them.
//!
//! No closures around arithmetic: those are compiled for the least of all processors where they are not inlined.

use faer::Mat;
use num_complex::Complex;
use pulp::bytemuck::{cast, cast_slice, cast_slice_mut};
use pulp::{Arch, Simd, WithSimd};

/// Columns of a basis, or rows of a factor, that are taken together; chosen: with fewer the other factor is read more often, with more their sums do not
/// stay in registers.
pub(super) const GROUP: usize = 4;
/// Coefficients in a line of a cache: 64 bytes.
const LINE: usize = 4;

type Block = Mat<Complex<f64>>;

/// Row of a few columns, real and imaginary parts by turns, in N registers.
pub(super) type Row<S, const N: usize> = [<S as Simd>::f64s; N];

/// Kernel: a computation with rows.
pub(super) trait Kernel {
    fn run<S: Simd, const N: usize>(self, simd: S);
}

/// Runs a kernel on rows of four columns, as many as blocks have: one register where the machine has AVX-512, two with AVX2.
pub(super) fn compute<K: Kernel>(kernel: K) {
    match Arch::new() {
        #[cfg(target_arch = "x86_64")]
        Arch::V4(simd) => Simd::vectorize(simd, InRegisters::<K, 1>(kernel)),
        arch => arch.dispatch(InRegisters::<K, 2>(kernel)),
    }
}

struct InRegisters<K, const N: usize>(K);

impl<K: Kernel, const N: usize> WithSimd for InRegisters<K, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.0.run::<S, N>(simd);
    }
}

/// Columns of a row.
#[inline(always)]
pub(super) const fn columns<S: Simd, const N: usize>() -> usize {
    N * S::F64_LANES / 2
}

#[inline(always)]
pub(super) fn zero<S: Simd, const N: usize>(simd: S) -> Row<S, N> {
    [simd.splat_f64s(0.0); N]
}

/// `i x`.
#[inline(always)]
pub(super) fn turned<S: Simd, const N: usize>(simd: S, mut x: Row<S, N>) -> Row<S, N> {
    if S::F64_LANES == 1 {
        for [re, im] in x.as_chunks_mut().0 {
            (*re, *im) = (simd.neg_f64s(*im), *re);
        }
    } else {
        for x in &mut x {
            *x = cast(simd.swap_re_im_c64s(simd.conj_c64s(cast(*x))));
        }
    }
    x
}

#[inline(always)]
pub(super) fn negative<S: Simd, const N: usize>(simd: S, mut x: Row<S, N>) -> Row<S, N> {
    for x in &mut x {
        *x = simd.neg_f64s(*x);
    }
    x
}

#[inline(always)]
pub(super) fn minus<S: Simd, const N: usize>(simd: S, mut a: Row<S, N>, b: Row<S, N>) -> Row<S, N> {
    for (a, b) in a.iter_mut().zip(b) {
        *a = simd.sub_f64s(*a, b);
    }
    a
}

/// `sum + a x` of a real number a.
#[inline(always)]
pub(super) fn plus_real<S: Simd, const N: usize>(simd: S, mut sum: Row<S, N>, a: f64, x: Row<S, N>) -> Row<S, N> {
    let a = simd.splat_f64s(a);
    for (sum, x) in sum.iter_mut().zip(x) {
        *sum = simd.mul_add_f64s(a, x, *sum);
    }
    sum
}

/// `sum + Re a x + Im a y`: a times x for `y = i x`.
#[inline(always)]
pub(super) fn plus<S: Simd, const N: usize>(
    simd: S,
    sum: Row<S, N>,
    a: Complex<f64>,
    x: Row<S, N>,
    y: Row<S, N>,
) -> Row<S, N> {
    plus_real(simd, plus_real(simd, sum, a.re, x), a.im, y)
}

/// The products of a sum with the real and with the imaginary parts of the coefficients, which a processor adds up side by side.
pub(super) type Halves<S, const N: usize> = [Row<S, N>; 2];

#[inline(always)]
pub(super) fn add<S: Simd, const N: usize>(simd: S, sum: &mut Halves<S, N>, a: Complex<f64>, x: Row<S, N>) {
    *sum = [plus_real(simd, sum[0], a.re, x), plus_real(simd, sum[1], a.im, x)];
}

/// The sum of `a x`.
#[inline(always)]
pub(super) fn joined<S: Simd, const N: usize>(simd: S, [re, im]: Halves<S, N>) -> Row<S, N> {
    plus_real(simd, re, 1.0, turned(simd, im))
}

/// The sum of the products of x with the conjugates of the coefficients.
#[inline(always)]
pub(super) fn joined_conjugate<S: Simd, const N: usize>(simd: S, [re, im]: Halves<S, N>) -> Row<S, N> {
    minus(simd, re, turned(simd, im))
}

/// `a x`.
#[inline(always)]
pub(super) fn times<S: Simd, const N: usize>(simd: S, a: Complex<f64>, x: Row<S, N>) -> Row<S, N> {
    plus(simd, zero(simd), a, x, turned(simd, x))
}

/// Brings coefficients into the nearest cache by reading one of each line: these reads wait for each other no more than for anything
/// else, and arithmetic that comes later does not wait for them.
#[inline(always)]
pub(super) fn bring<'a>(values: impl Iterator<Item = &'a Complex<f64>>) {
    std::hint::black_box(values.step_by(LINE).fold(0, |bits, value| bits ^ value.re.to_bits()));
}

/// Rows of the columns of a block from `from` on, as many as a row holds or are left.
#[inline(always)]
pub(super) fn gathered<S: Simd, const N: usize>(simd: S, block: &Block, from: usize) -> Vec<Row<S, N>> {
    let mut rows = vec![zero::<S, N>(simd); block.nrows()];
    let numbers: &mut [Complex<f64>] = cast_slice_mut(rows.as_flattened_mut());
    let width = columns::<S, N>();
    for (lane, j) in (from..block.ncols().min(from + width)).enumerate() {
        let column = block.col_as_slice(j);
        for (row, value) in numbers.chunks_exact_mut(width).zip(column) {
            row[lane] = *value;
        }
    }
    rows
}

/// Puts rows back into the columns of a block, the reverse of [`gathered`].
#[inline(always)]
pub(super) fn scatter<S: Simd, const N: usize>(rows: &[Row<S, N>], block: &mut Block, from: usize) {
    let numbers: &[Complex<f64>] = cast_slice(rows.as_flattened());
    let width = columns::<S, N>();
    for (lane, j) in (from..block.ncols().min(from + width)).enumerate() {
        let column = block.col_as_slice_mut(j);
        for (row, value) in numbers.chunks_exact(width).zip(column) {
            *value = row[lane];
        }
    }
}

/// Puts a row back into row i of a block, in its columns from `from` on.
#[inline(always)]
pub(super) fn put<S: Simd, const N: usize>(row: Row<S, N>, block: &mut Block, i: usize, from: usize) {
    let numbers: &[Complex<f64>] = cast_slice(&row);
    for (&value, j) in numbers.iter().zip(from..block.ncols()) {
        block[(i, j)] = value;
    }
}
