//! Small complex matrices by rows, real and imaginary parts apart, on vector registers.
//!
//! Rows have room for whole registers of the widest kind. What is beyond the columns is zero and stays so.

mod sums;

use nalgebra::DMatrix;
use num_complex::Complex;
use pulp::Simd;

pub(super) use self::sums::{Times, add_rows, combined, product};
use cea::certified::lanes::{Precision, cast};

/// A complex matrix by rows.
#[derive(Debug, Clone, Default)]
pub(super) struct Rows<T = f64> {
    stride: usize,
    re: Vec<T>,
    im: Vec<T>,
}

impl<T: Precision> Rows<T> {
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

    /// Takes the sum of two matrices of this shape.
    pub fn set_total(&mut self, a: &Self, b: &Self) {
        for (out, a, b) in [(&mut self.re, &a.re, &b.re), (&mut self.im, &a.im, &b.im)] {
            out.iter_mut().zip(a).zip(b).for_each(|((out, a), b)| *out = *a + *b);
        }
    }

    /// Takes the entries of a vector as the first row.
    pub fn set_row(&mut self, of: &[Complex<T>]) {
        of.iter().enumerate().for_each(|(column, &value)| self.set(0, column, value));
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
