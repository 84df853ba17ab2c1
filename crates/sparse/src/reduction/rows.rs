//! Small complex matrices by rows, real and imaginary parts apart, on vector registers.
//!
//! Rows have room for whole registers of the widest kind. What is beyond the columns is zero and stays so.

use nalgebra::DMatrix;
use num_complex::Complex;
use pulp::{Arch, Simd, WithSimd};

use super::real::{Real, cast};

/// A complex matrix by rows.
#[derive(Debug, Clone, Default)]
pub(super) struct Rows<T = f64> {
    stride: usize,
    re: Vec<T>,
    im: Vec<T>,
}

impl<T: Real> Rows<T> {
    pub fn zeros(rows: usize, columns: usize) -> Self {
        let stride = columns.next_multiple_of(T::WIDEST);
        Self { stride, re: vec![T::default(); rows * stride], im: vec![T::default(); rows * stride] }
    }

    pub fn from_fn(rows: usize, columns: usize, of: impl Fn(usize, usize) -> Complex<T>) -> Self {
        let mut out = Self::zeros(rows, columns);
        for row in 0..rows {
            (0..columns).for_each(|column| out.set(row, column, of(row, column)));
        }
        out
    }

    /// The entries of a matrix.
    pub fn of(matrix: &DMatrix<Complex<T>>) -> Self {
        Self::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)])
    }

    #[inline(always)]
    pub fn at(&self, row: usize, column: usize) -> Complex<T> {
        let place = row * self.stride + column;
        Complex::new(self.re[place], self.im[place])
    }

    #[inline(always)]
    pub fn set(&mut self, row: usize, column: usize, value: Complex<T>) {
        let place = row * self.stride + column;
        (self.re[place], self.im[place]) = (value.re, value.im);
    }

    /// All rows in registers.
    #[inline(always)]
    pub fn registers<S: Simd>(&self, _: S) -> [&[T::Register<S>]; 2] {
        [T::registers::<S>(&self.re), T::registers::<S>(&self.im)]
    }

    #[inline(always)]
    pub fn registers_mut<S: Simd>(&mut self, _: S) -> [&mut [T::Register<S>]; 2] {
        [T::registers_mut::<S>(&mut self.re), T::registers_mut::<S>(&mut self.im)]
    }

    pub fn row(&self, row: usize) -> [&[T]; 2] {
        let place = row * self.stride..(row + 1) * self.stride;
        [&self.re[place.clone()], &self.im[place]]
    }

    pub fn row_mut(&mut self, row: usize) -> [&mut [T]; 2] {
        let place = row * self.stride..(row + 1) * self.stride;
        [&mut self.re[place.clone()], &mut self.im[place]]
    }

    /// Takes the rows of another matrix as its first ones, and clears all others.
    pub fn take_rows(&mut self, of: &Self) {
        for (part, of) in [(&mut self.re, &of.re), (&mut self.im, &of.im)] {
            part[..of.len()].copy_from_slice(of);
            part[of.len()..].fill(T::default());
        }
    }

    pub fn rows(&self) -> usize {
        self.re.len().checked_div(self.stride).unwrap_or_default()
    }

    pub fn clear(&mut self) {
        self.re.fill(T::default());
        self.im.fill(T::default());
    }

    pub fn negate(&mut self) {
        self.re.iter_mut().chain(&mut self.im).for_each(|value| *value = -*value);
    }

    /// Exchanges an entry of two rows.
    #[inline(always)]
    pub fn swap(&mut self, [a, b]: [usize; 2], column: usize) {
        for part in [&mut self.re, &mut self.im] {
            part.swap(a * self.stride + column, b * self.stride + column);
        }
    }

    #[inline(always)]
    pub fn swap_rows(&mut self, a: usize, b: usize) {
        for part in [&mut self.re, &mut self.im] {
            (0..self.stride).for_each(|column| part.swap(a * self.stride + column, b * self.stride + column));
        }
    }

    /// The sum of multiples of matrices of this shape.
    #[inline(always)]
    pub fn set_sum<'a, S: Simd>(
        &mut self,
        simd: S,
        factors: &[Complex<T>],
        of: impl Iterator<Item = &'a Self> + Clone,
    ) {
        let out = T::registers_mut::<S>(&mut self.re).iter_mut().zip(T::registers_mut::<S>(&mut self.im));
        for (place, (re, im)) in out.enumerate() {
            let mut sum = [T::filled(simd, T::default()); 2];
            for (factor, part) in factors.iter().zip(of.clone()) {
                let x = [T::registers::<S>(&part.re)[place], T::registers::<S>(&part.im)[place]];
                sum = multiple_added(simd, *factor, x, sum);
            }
            [*re, *im] = sum;
        }
    }

    /// Takes the sum of two matrices of this shape.
    pub fn set_total(&mut self, a: &Self, b: &Self) {
        for (out, a, b) in [(&mut self.re, &a.re, &b.re), (&mut self.im, &a.im, &b.im)] {
            out.iter_mut().zip(a).zip(b).for_each(|((out, a), b)| *out = *a + *b);
        }
    }

    /// This matrix times a vector, the first row of another one.
    #[inline(always)]
    pub fn times<S: Simd>(&self, simd: S, vector: &Self, out: &mut Vec<Complex<T>>) {
        out.clear();
        if self.stride == 0 {
            return;
        }
        let [x_re, x_im] = vector.row(0).map(T::registers::<S>);
        for (re, im) in self.re.chunks_exact(self.stride).zip(self.im.chunks_exact(self.stride)) {
            let (re, im) = (T::registers::<S>(re), T::registers::<S>(im));
            let mut sum = [T::filled(simd, T::default()); 2];
            for ((re, im), (x_re, x_im)) in re.iter().zip(im).zip(x_re.iter().zip(x_im)) {
                sum[0] = T::take_product(simd, *im, *x_im, T::add_product(simd, *re, *x_re, sum[0]));
                sum[1] = T::add_product(simd, *im, *x_re, T::add_product(simd, *re, *x_im, sum[1]));
            }
            out.push(Complex::new(T::sum(simd, sum[0]), T::sum(simd, sum[1])));
        }
    }

    /// Takes the entries of a vector as the first row.
    pub fn set_row(&mut self, of: &[Complex<T>]) {
        of.iter().enumerate().for_each(|(column, &value)| self.set(0, column, value));
    }

    /// Two sums of multiples of the same matrices.
    #[inline(always)]
    pub fn set_sums<'a, S: Simd>(
        outs: [&mut Self; 2],
        simd: S,
        factors: [&[Complex<T>]; 2],
        of: impl Iterator<Item = &'a Self> + Clone,
    ) {
        let places = outs[0].re.len() / T::width::<S>();
        let mut outs = outs.map(|out| (T::registers_mut::<S>(&mut out.re), T::registers_mut::<S>(&mut out.im)));
        for place in 0..places {
            let mut sums = [[T::filled(simd, T::default()); 2]; 2];
            for ((first, second), part) in factors[0].iter().zip(factors[1]).zip(of.clone()) {
                let x = [T::registers::<S>(&part.re)[place], T::registers::<S>(&part.im)[place]];
                sums[0] = multiple_added(simd, *first, x, sums[0]);
                sums[1] = multiple_added(simd, *second, x, sums[1]);
            }
            for ((re, im), sum) in outs.iter_mut().zip(sums) {
                [re[place], im[place]] = sum;
            }
        }
    }

    /// Adds multiples of the rows of another matrix to a row.
    #[inline(always)]
    pub fn add_rows<S: Simd>(&mut self, simd: S, to: usize, factors: &[Complex<T>], rows: &Self) {
        self.add_rows_from(simd, to, rows, factors.len(), |row| factors[row]);
    }

    /// Adds multiples of the first rows of another matrix to a row.
    #[inline(always)]
    pub fn add_rows_from<S: Simd>(
        &mut self,
        simd: S,
        to: usize,
        rows: &Self,
        count: usize,
        factor: impl Fn(usize) -> Complex<T>,
    ) {
        let from = [rows.re.as_slice(), &rows.im];
        accumulate(simd, self.row_mut(to), from, rows.stride, count, factor);
    }

    /// Adds multiples of the rows above to a row.
    #[inline(always)]
    pub fn add_rows_above<S: Simd>(&mut self, simd: S, to: usize, factor: impl Fn(usize) -> Complex<T>) {
        let stride = self.stride;
        let (from_re, re) = self.re.split_at_mut(to * stride);
        let (from_im, im) = self.im.split_at_mut(to * stride);
        accumulate(simd, [&mut re[..stride], &mut im[..stride]], [from_re, from_im], stride, to, factor);
    }

    /// Adds multiples of the rows below, up to row `end`, to a row.
    #[inline(always)]
    pub fn add_rows_below<S: Simd>(&mut self, simd: S, to: usize, end: usize, factor: impl Fn(usize) -> Complex<T>) {
        let (stride, first) = (self.stride, to + 1);
        let (re, from_re) = self.re.split_at_mut(first * stride);
        let (im, from_im) = self.im.split_at_mut(first * stride);
        let row = [&mut re[to * stride..], &mut im[to * stride..]];
        accumulate(simd, row, [from_re, from_im], stride, end - first, |row| factor(first + row));
    }

    /// Adds `factor` times a row of another matrix to a row.
    #[inline(always)]
    pub fn add_row<S: Simd>(&mut self, simd: S, to: usize, factor: Complex<T>, other: &Self, row: usize) {
        add_multiple(simd, factor, other.row(row), self.row_mut(to));
    }

    /// The rows below row c, up to row `end`, minus multiples of it that make column c zero, from the next column on; `inverse` is that of its
    /// entry there, and each row's multiple is told.
    #[inline(always)]
    pub fn eliminate<S: Simd>(
        &mut self,
        simd: S,
        c: usize,
        inverse: Complex<T>,
        end: usize,
        mut tell: impl FnMut(usize, Complex<T>),
    ) {
        let (stride, first) = (self.stride, (c + 1) / T::width::<S>());
        let (above_re, below_re) = self.re.split_at_mut((c + 1) * stride);
        let (above_im, below_im) = self.im.split_at_mut((c + 1) * stride);
        let above_re = &T::registers::<S>(&above_re[c * stride..])[first..];
        let above_im = &T::registers::<S>(&above_im[c * stride..])[first..];
        let below = below_re.chunks_exact_mut(stride).zip(below_im.chunks_exact_mut(stride));
        for (row, (re, im)) in (c + 1..end).zip(below) {
            let factor = Complex::new(re[c], im[c]) * inverse;
            tell(row, factor);
            let (by_re, by_im) = (T::filled(simd, factor.re), T::filled(simd, factor.im));
            let (re, im) = (&mut T::registers_mut::<S>(re)[first..], &mut T::registers_mut::<S>(im)[first..]);
            for ((x_re, x_im), (y_re, y_im)) in above_re.iter().zip(above_im).zip(re.iter_mut().zip(im)) {
                *y_re = T::add_product(simd, by_im, *x_im, T::take_product(simd, by_re, *x_re, *y_re));
                *y_im = T::take_product(simd, by_im, *x_re, T::take_product(simd, by_re, *x_im, *y_im));
            }
        }
    }

    #[inline(always)]
    pub fn scale_row(&mut self, row: usize, factor: Complex<T>) {
        let [re, im] = self.row_mut(row);
        for (re, im) in re.iter_mut().zip(im) {
            let value = Complex::new(*re, *im) * factor;
            (*re, *im) = (value.re, value.im);
        }
    }
}

impl Rows {
    /// This matrix minus another one.
    pub fn minus(&self, other: &Self) -> Self {
        let minus = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect();
        Self { stride: self.stride, re: minus(&self.re, &other.re), im: minus(&self.im, &other.im) }
    }

    /// Takes the sum of a matrix and one in single precision that has as many columns, and may have more beyond these.
    #[inline(always)]
    pub fn set_apart(&mut self, from: &Self, apart: &Rows<f32>) {
        let parts = [(&mut self.re, &from.re, &apart.re), (&mut self.im, &from.im, &apart.im)];
        for (out, from, of_apart) in parts {
            let rows = out.chunks_exact_mut(self.stride).zip(from.chunks_exact(self.stride));
            for ((out, from), apart) in rows.zip(of_apart.chunks_exact(apart.stride)) {
                out.iter_mut().zip(from).zip(apart).for_each(|((out, from), apart)| *out = from + f64::from(*apart));
            }
        }
    }

    /// All entries and the zeros beyond the columns.
    pub fn entries(&self) -> impl Iterator<Item = Complex<f64>> + '_ {
        self.re.iter().zip(&self.im).map(|(&re, &im)| Complex::new(re, im))
    }

    /// The same in single precision.
    pub fn single(&self) -> Rows<f32> {
        let columns = self.stride;
        let rows = self.re.len().checked_div(columns).unwrap_or_default();
        let mut out = Rows::zeros(rows, columns);
        for row in 0..rows {
            (0..columns).for_each(|column| out.set(row, column, cast(self.at(row, column))));
        }
        out
    }
}

/// A matrix times a vector.
pub(super) fn product<T: Real>(matrix: &Rows<T>, vector: &[Complex<T>]) -> Vec<Complex<T>> {
    let (mut row, mut out) = (Rows::zeros(1, vector.len()), Vec::with_capacity(matrix.rows()));
    row.set_row(vector);
    Arch::new().dispatch(Times { matrix, vector: &row, out: &mut out });
    out
}

/// A matrix times a vector, the first row of another one.
pub(super) struct Times<'a, T> {
    pub matrix: &'a Rows<T>,
    pub vector: &'a Rows<T>,
    pub out: &'a mut Vec<Complex<T>>,
}

impl<T: Real> WithSimd for Times<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.matrix.times(simd, self.vector, self.out);
    }
}

/// Adds multiples of the rows of a matrix to a row of another one.
pub(super) fn add_rows<T: Real>(to: usize, factors: &[Complex<T>], rows: &Rows<T>, out: &mut Rows<T>) {
    Arch::new().dispatch(AddRows { to, factors, rows, out });
}

/// The sum of multiples of the first rows of a matrix.
pub(super) fn combined<T: Real>(factors: &[Complex<T>], rows: &Rows<T>) -> Vec<Complex<T>> {
    let mut sum =
        Rows { stride: rows.stride, re: vec![T::default(); rows.stride], im: vec![T::default(); rows.stride] };
    add_rows(0, factors, rows, &mut sum);
    (0..rows.rows()).map(|column| sum.at(0, column)).collect()
}

struct AddRows<'a, T> {
    to: usize,
    factors: &'a [Complex<T>],
    rows: &'a Rows<T>,
    out: &'a mut Rows<T>,
}

impl<T: Real> WithSimd for AddRows<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.out.add_rows(simd, self.to, self.factors, self.rows);
    }
}

/// Adds multiples of the first rows of a matrix to a row: sums stay in registers, two of them side by side.
#[inline(always)]
fn accumulate<T: Real, S: Simd>(
    simd: S,
    [re, im]: [&mut [T]; 2],
    [from_re, from_im]: [&[T]; 2],
    stride: usize,
    rows: usize,
    factor: impl Fn(usize) -> Complex<T>,
) {
    let stride = stride / T::width::<S>();
    let (from_re, from_im) = (T::registers::<S>(from_re), T::registers::<S>(from_im));
    let (re, last_re) = T::registers_mut::<S>(re).as_chunks_mut::<2>();
    let (im, last_im) = T::registers_mut::<S>(im).as_chunks_mut::<2>();
    for (pair, (re, im)) in re.iter_mut().zip(&mut *im).enumerate() {
        let mut sums = [[re[0], im[0]], [re[1], im[1]]];
        for row in 0..rows {
            let (factor, place) = (factor(row), row * stride + 2 * pair);
            sums[0] = multiple_added(simd, factor, [from_re[place], from_im[place]], sums[0]);
            sums[1] = multiple_added(simd, factor, [from_re[place + 1], from_im[place + 1]], sums[1]);
        }
        (*re, *im) = ([sums[0][0], sums[1][0]], [sums[0][1], sums[1][1]]);
    }
    if let ([re], [im]) = (last_re, last_im) {
        let mut sum = [*re, *im];
        for row in 0..rows {
            let place = row * stride + stride - 1;
            sum = multiple_added(simd, factor(row), [from_re[place], from_im[place]], sum);
        }
        [*re, *im] = sum;
    }
}

/// `y += factor x`.
#[inline(always)]
fn add_multiple<T: Real, S: Simd>(simd: S, factor: Complex<T>, x: [&[T]; 2], y: [&mut [T]; 2]) {
    let [x_re, x_im] = [T::registers::<S>(x[0]), T::registers::<S>(x[1])];
    let [y_re, y_im] = y;
    let (y_re, y_im) = (T::registers_mut::<S>(y_re), T::registers_mut::<S>(y_im));
    let (re, im) = (T::filled(simd, factor.re), T::filled(simd, factor.im));
    for ((x_re, x_im), (y_re, y_im)) in x_re.iter().zip(x_im).zip(y_re.iter_mut().zip(y_im)) {
        *y_re = T::take_product(simd, im, *x_im, T::add_product(simd, re, *x_re, *y_re));
        *y_im = T::add_product(simd, im, *x_re, T::add_product(simd, re, *x_im, *y_im));
    }
}

/// `factor x + y`.
#[inline(always)]
fn multiple_added<T: Real, S: Simd>(
    simd: S,
    factor: Complex<T>,
    x: [T::Register<S>; 2],
    y: [T::Register<S>; 2],
) -> [T::Register<S>; 2] {
    let (re, im) = (T::filled(simd, factor.re), T::filled(simd, factor.im));
    [
        T::take_product(simd, im, x[1], T::add_product(simd, re, x[0], y[0])),
        T::add_product(simd, im, x[0], T::add_product(simd, re, x[1], y[1])),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_those_of_the_entries() {
        let of = |seed: usize, rows: usize, columns: usize| {
            Rows::from_fn(rows, columns, |i, j| Complex::new((seed * i + j) as f64, (i + seed * j) as f64 - 3.0))
        };
        for columns in [3, 8, 17, 26] {
            let (a, b, mut out) = (of(2, 4, columns), of(3, 4, columns), of(5, 1, columns));
            let before = out.clone();
            let factors =
                [Complex::new(1.0, 2.0), Complex::new(-0.5, 0.0), Complex::new(0.0, 3.0), Complex::new(2.0, -1.0)];
            add_rows(0, &factors, &a, &mut out);
            let mut sum = Rows::zeros(4, columns);
            Arch::new().dispatch(SetSum(&mut sum, &factors[..2], &[&a, &b]));
            for j in 0..columns {
                let expected: Complex<f64> = (0..4).map(|i| factors[i] * a.at(i, j)).sum();
                assert!((out.at(0, j) - before.at(0, j) - expected).norm() < 1e-12 * expected.norm());
                let expected = factors[0] * a.at(2, j) + factors[1] * b.at(2, j);
                assert!((sum.at(2, j) - expected).norm() < 1e-12 * expected.norm());
            }
            let row: Vec<Complex<f64>> = (0..columns).map(|j| out.at(0, j)).collect();
            for (i, product) in product(&a, &row).into_iter().enumerate() {
                let expected: Complex<f64> = (0..columns).map(|j| a.at(i, j) * out.at(0, j)).sum();
                assert!((product - expected).norm() < 1e-12 * expected.norm());
            }
            let total: Complex<f64> =
                (0..4).flat_map(|i| (0..columns).map(move |j| (i, j))).map(|(i, j)| a.at(i, j)).sum();
            assert!((a.entries().sum::<Complex<f64>>() - total).norm() < 1e-12 * total.norm());
        }
    }

    struct SetSum<'a>(&'a mut Rows, &'a [Complex<f64>], &'a [&'a Rows]);

    impl WithSimd for SetSum<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            self.0.set_sum(simd, self.1, self.2.iter().copied());
        }
    }
}
