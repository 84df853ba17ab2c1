//! Sums of multiples of rows, vectors and matrices in vector registers.

use cea::certified::lanes::{Ops, Precision, fma, fnma, splat};
use num_complex::Complex;
use pulp::{Arch, Simd, WithSimd};

use super::Rows;

impl<T: Precision> Rows<T> {
    /// The sum of multiples of matrices of this shape.
    #[inline(always)]
    pub fn set_sum<'a, S: Simd>(
        &mut self,
        simd: S,
        factors: &[Complex<T>],
        of: impl Iterator<Item = &'a Self> + Clone,
    ) {
        let o = Ops::of(simd);
        let out = T::registers_mut::<S>(&mut self.re).iter_mut().zip(T::registers_mut::<S>(&mut self.im));
        for (place, (re, im)) in out.enumerate() {
            let mut sum = [o.splat(T::default()); 2];
            for (factor, part) in factors.iter().zip(of.clone()) {
                let x = [T::registers::<S>(&part.re)[place], T::registers::<S>(&part.im)[place]];
                sum = fma(o, splat(o, *factor), x, sum);
            }
            [*re, *im] = sum;
        }
    }

    /// This matrix times a vector, the first row of another one.
    #[inline(always)]
    pub fn times<S: Simd>(&self, simd: S, vector: &Self, out: &mut Vec<Complex<T>>) {
        out.clear();
        if self.stride == 0 {
            return;
        }
        let o = Ops::of(simd);
        let [x_re, x_im] = vector.row(0).map(T::registers::<S>);
        for (re, im) in self.re.chunks_exact(self.stride).zip(self.im.chunks_exact(self.stride)) {
            let (re, im) = (T::registers::<S>(re), T::registers::<S>(im));
            let mut sum = [o.splat(T::default()); 2];
            for ((re, im), (x_re, x_im)) in re.iter().zip(im).zip(x_re.iter().zip(x_im)) {
                sum = fma(o, [*re, *im], [*x_re, *x_im], sum);
            }
            out.push(Complex::new(o.sum(sum[0]), o.sum(sum[1])));
        }
    }

    /// Two sums of multiples of the same matrices.
    #[inline(always)]
    pub fn set_sums<'a, S: Simd>(
        outs: [&mut Self; 2],
        simd: S,
        factors: [&[Complex<T>]; 2],
        of: impl Iterator<Item = &'a Self> + Clone,
    ) {
        let (o, places) = (Ops::of(simd), outs[0].re.len() / T::width::<S>());
        let mut outs = outs.map(|out| (T::registers_mut::<S>(&mut out.re), T::registers_mut::<S>(&mut out.im)));
        for place in 0..places {
            let mut sums = [[o.splat(T::default()); 2]; 2];
            for ((first, second), part) in factors[0].iter().zip(factors[1]).zip(of.clone()) {
                let x = [T::registers::<S>(&part.re)[place], T::registers::<S>(&part.im)[place]];
                sums[0] = fma(o, splat(o, *first), x, sums[0]);
                sums[1] = fma(o, splat(o, *second), x, sums[1]);
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
        let (o, stride, first) = (Ops::of(simd), self.stride, (c + 1) / T::width::<S>());
        let (above_re, below_re) = self.re.split_at_mut((c + 1) * stride);
        let (above_im, below_im) = self.im.split_at_mut((c + 1) * stride);
        let above_re = &T::registers::<S>(&above_re[c * stride..])[first..];
        let above_im = &T::registers::<S>(&above_im[c * stride..])[first..];
        let below = below_re.chunks_exact_mut(stride).zip(below_im.chunks_exact_mut(stride));
        for (row, (re, im)) in (c + 1..end).zip(below) {
            let factor = Complex::new(re[c], im[c]) * inverse;
            tell(row, factor);
            let by = splat(o, factor);
            let (re, im) = (&mut T::registers_mut::<S>(re)[first..], &mut T::registers_mut::<S>(im)[first..]);
            for ((x_re, x_im), (y_re, y_im)) in above_re.iter().zip(above_im).zip(re.iter_mut().zip(im)) {
                [*y_re, *y_im] = fnma(o, by, [*x_re, *x_im], [*y_re, *y_im]);
            }
        }
    }
}

/// A matrix times a vector.
pub(crate) fn product<T: Precision>(matrix: &Rows<T>, vector: &[Complex<T>]) -> Vec<Complex<T>> {
    let (mut row, mut out) = (Rows::zeros(1, vector.len()), Vec::with_capacity(matrix.rows()));
    row.set_row(vector);
    Arch::new().dispatch(Times { matrix, vector: &row, out: &mut out });
    out
}

/// A matrix times a vector, the first row of another one.
pub(crate) struct Times<'a, T> {
    pub matrix: &'a Rows<T>,
    pub vector: &'a Rows<T>,
    pub out: &'a mut Vec<Complex<T>>,
}

impl<T: Precision> WithSimd for Times<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.matrix.times(simd, self.vector, self.out);
    }
}

/// Adds multiples of the rows of a matrix to a row of another one.
pub(crate) fn add_rows<T: Precision>(to: usize, factors: &[Complex<T>], rows: &Rows<T>, out: &mut Rows<T>) {
    Arch::new().dispatch(AddRows { to, factors, rows, out });
}

/// The sum of multiples of the first rows of a matrix.
pub(crate) fn combined<T: Precision>(factors: &[Complex<T>], rows: &Rows<T>) -> Vec<Complex<T>> {
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

impl<T: Precision> WithSimd for AddRows<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.out.add_rows(simd, self.to, self.factors, self.rows);
    }
}

/// Adds multiples of the first rows of a matrix to a row: sums stay in registers, two of them side by side.
#[inline(always)]
fn accumulate<T: Precision, S: Simd>(
    simd: S,
    [re, im]: [&mut [T]; 2],
    [from_re, from_im]: [&[T]; 2],
    stride: usize,
    rows: usize,
    factor: impl Fn(usize) -> Complex<T>,
) {
    let (o, stride) = (Ops::of(simd), stride / T::width::<S>());
    let (from_re, from_im) = (T::registers::<S>(from_re), T::registers::<S>(from_im));
    let (re, last_re) = T::registers_mut::<S>(re).as_chunks_mut::<2>();
    let (im, last_im) = T::registers_mut::<S>(im).as_chunks_mut::<2>();
    for (pair, (re, im)) in re.iter_mut().zip(&mut *im).enumerate() {
        let mut sums = [[re[0], im[0]], [re[1], im[1]]];
        for row in 0..rows {
            let (factor, place) = (splat(o, factor(row)), row * stride + 2 * pair);
            sums[0] = fma(o, factor, [from_re[place], from_im[place]], sums[0]);
            sums[1] = fma(o, factor, [from_re[place + 1], from_im[place + 1]], sums[1]);
        }
        (*re, *im) = ([sums[0][0], sums[1][0]], [sums[0][1], sums[1][1]]);
    }
    if let ([re], [im]) = (last_re, last_im) {
        let mut sum = [*re, *im];
        for row in 0..rows {
            let place = row * stride + stride - 1;
            sum = fma(o, splat(o, factor(row)), [from_re[place], from_im[place]], sum);
        }
        [*re, *im] = sum;
    }
}

/// `y += factor x`.
#[inline(always)]
fn add_multiple<T: Precision, S: Simd>(simd: S, factor: Complex<T>, x: [&[T]; 2], y: [&mut [T]; 2]) {
    let [x_re, x_im] = [T::registers::<S>(x[0]), T::registers::<S>(x[1])];
    let [y_re, y_im] = y;
    let (y_re, y_im) = (T::registers_mut::<S>(y_re), T::registers_mut::<S>(y_im));
    let o = Ops::of(simd);
    let factor = splat(o, factor);
    for ((x_re, x_im), (y_re, y_im)) in x_re.iter().zip(x_im).zip(y_re.iter_mut().zip(y_im)) {
        [*y_re, *y_im] = fma(o, factor, [*x_re, *x_im], [*y_re, *y_im]);
    }
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
