//! Gauss's elimination of small complex matrices by rows.
//!
//! Apart from [`cea::certified::lu`], which has columns in double precision: here rows are in registers of either precision, many right
//! sides at once, pivots with the signs of a determinant, and no memory is taken for the next of thousands of samples.

use num_complex::Complex;
use pulp::Simd;

use super::rows::Rows;
use cea::certified::lanes::Precision;

/// Gauss's elimination of a square matrix with row pivots, which leaves the upper factor in its place.
#[derive(Debug, Default)]
pub(super) struct Elimination<T = f64> {
    order: usize,
    /// The lower factor without its diagonal, by rows.
    lower: Vec<Complex<T>>,
    /// The row that each was exchanged with.
    exchanged: Vec<usize>,
    /// With the signs of the exchanges: their product is the determinant.
    pub pivots: Vec<Complex<T>>,
}

impl<T: Precision> Elimination<T> {
    #[inline(always)]
    pub fn factor<S: Simd>(&mut self, simd: S, a: &mut Rows<T>, order: usize) {
        self.order = order;
        self.lower.clear();
        self.lower.resize(order * order, Complex::default());
        self.exchanged.clear();
        self.pivots.clear();
        for c in 0..order {
            let size = |row: usize| a.at(row, c).l1_norm();
            let (mut largest, mut most) = (c, size(c));
            for row in c + 1..order {
                if size(row) > most {
                    (largest, most) = (row, size(row));
                }
            }
            self.exchanged.push(largest);
            if largest != c {
                a.swap_rows(c, largest);
                (0..c).for_each(|column| self.lower.swap(c * order + column, largest * order + column));
            }
            let pivot = a.at(c, c);
            self.pivots.push(if largest == c { pivot } else { -pivot });
            let lower = &mut self.lower;
            a.eliminate(simd, c, pivot.inv(), order, |row, factor| lower[row * order + c] = factor);
        }
    }

    /// Right sides through the factors of a matrix: they become the solution.
    #[inline(always)]
    pub fn solve_rows<S: Simd>(&self, simd: S, a: &Rows<T>, sides: &mut Rows<T>) {
        for (c, &largest) in self.exchanged.iter().enumerate().filter(|(c, largest)| c != *largest) {
            sides.swap_rows(c, largest);
        }
        for row in 1..self.order {
            sides.add_rows_above(simd, row, |c| -self.lower[row * self.order + c]);
        }
        for row in (0..self.order).rev() {
            sides.add_rows_below(simd, row, self.order, |c| -a.at(row, c));
            sides.scale_row(row, a.at(row, row).inv());
        }
    }

    /// One right side through the factors of a matrix.
    pub fn solve(&self, a: &Rows<T>, side: &mut [Complex<T>]) {
        for (c, &largest) in self.exchanged.iter().enumerate() {
            side.swap(c, largest);
        }
        for row in 0..side.len() {
            let sum: Complex<T> = (0..row).map(|c| self.lower[row * self.order + c] * side[c]).sum();
            side[row] -= sum;
        }
        for row in (0..side.len()).rev() {
            let sum: Complex<T> = (row + 1..side.len()).map(|c| a.at(row, c) * side[c]).sum();
            side[row] = (side[row] - sum) / a.at(row, row);
        }
    }

    /// One right side through the factors of the conjugate transpose of a matrix.
    pub fn solve_adjoint(&self, a: &Rows<T>, side: &mut [Complex<T>]) {
        for column in 0..side.len() {
            let sum: Complex<T> = (0..column).map(|row| a.at(row, column).conj() * side[row]).sum();
            side[column] = (side[column] - sum) / a.at(column, column).conj();
        }
        for column in (0..side.len()).rev() {
            let below = column + 1..side.len();
            let sum: Complex<T> = below.map(|row| self.lower[row * self.order + column].conj() * side[row]).sum();
            side[column] -= sum;
        }
        for (c, &largest) in self.exchanged.iter().enumerate().rev() {
            side.swap(c, largest);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use pulp::{Arch, WithSimd};

    struct Factor<'a>(&'a mut Rows, &'a mut Rows, &'a mut Elimination, usize);

    impl WithSimd for Factor<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            self.2.factor(simd, self.0, self.3);
            self.2.solve_rows(simd, self.0, self.1);
        }
    }

    #[test]
    fn factors_solve_systems_and_their_adjoints() {
        for n in [1, 3, 8, 13, 19] {
            let number = |i: usize, j: usize| ((7 * i + 5 * j * j + i * j + 3) % 23) as f64 - 11.0;
            let a = DMatrix::from_fn(n, n, |i, j| Complex::new(number(i, j), number(j + 2, i)));
            let b = DMatrix::from_fn(n, 5, |i, j| Complex::new(number(j, i), number(i, j + 1)));
            let rows = |a: &DMatrix<Complex<f64>>| Rows::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)]);
            let (mut square, mut sides, mut elimination) = (rows(&a), rows(&b), Elimination::default());
            Arch::new().dispatch(Factor(&mut square, &mut sides, &mut elimination, n));
            let x = DMatrix::from_fn(n, 5, |i, j| sides.at(i, j));
            assert!((&a * x - &b).norm() < 1e-11 * b.norm() * a.norm(), "{n}");
            let determinant: Complex<f64> = elimination.pivots.iter().product();
            assert!((determinant - a.determinant()).norm() < 1e-10 * determinant.norm());
            let (mut x, mut y): (Vec<_>, Vec<_>) = b.column(1).iter().map(|&b| (b, b)).unzip();
            elimination.solve(&square, &mut x);
            elimination.solve_adjoint(&square, &mut y);
            let [x, y] = [x, y].map(DVector::from_vec);
            assert!((&a * x - b.column(1)).norm() < 1e-11 * b.norm() * a.norm());
            assert!((a.adjoint() * y - b.column(1)).norm() < 1e-11 * b.norm() * a.norm());
        }
    }
}
