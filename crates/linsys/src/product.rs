//! Products of a real matrix with complex vectors, and with the sizes of their entries; nalgebra needs a complex copy of the matrix.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use pulp::{Arch, Simd, WithSimd};

/// `A x` of a real n x m matrix and a complex vector of length m; length n. Entries beyond the shorter of m and the length of
/// x are not read.
///
/// Columns without an entry off the diagonal cost one product each, as in a diagonal mass matrix.
#[must_use]
pub fn real_times_complex(a: &DMatrix<f64>, x: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
    if a.is_empty() {
        return DVector::zeros(a.nrows());
    }
    Arch::new().dispatch(Product { a, x })
}

/// Form `|y|^T |A| |x|` of the sizes of all entries of a real n x m matrix and of complex vectors, y of length n and x of length m. Roundings of the entries of
/// A change `y^H A x` by a rounding of the form at most. The form does not change where rows and columns are scaled and x and y are the vectors of the scaled
/// problem.
#[must_use]
pub fn form_of_sizes(a: &DMatrix<f64>, y: &DVector<Complex<f64>>, x: &DVector<Complex<f64>>) -> f64 {
    let y = y.map(|entry| entry.norm());
    let column = |(j, x): (usize, &Complex<f64>)| {
        x.norm() * a.column(j).iter().zip(&y).map(|(entry, y)| entry.abs() * y).sum::<f64>()
    };
    x.iter().enumerate().map(column).sum()
}

/// The product on the widest registers that there are: its sums are the same bits on all.
struct Product<'a> {
    a: &'a DMatrix<f64>,
    x: &'a DVector<Complex<f64>>,
}

impl WithSimd for Product<'_> {
    type Output = DVector<Complex<f64>>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> DVector<Complex<f64>> {
        let Self { a, x } = self;
        let rows = a.nrows();
        let (re, im): (Vec<f64>, Vec<f64>) = x.iter().take(a.ncols()).map(|value| (value.re, value.im)).unzip();
        // The vectors of real eigenvalues have one part, to the same bits.
        let parts = if im.iter().all(|&value| value == 0.0) { vec![re] } else { vec![re, im] };
        let mut sums = vec![vec![0.0; rows]; 2];
        for (group, columns) in a.as_slice().chunks(AT_ONCE * rows).enumerate() {
            let first = group * AT_ONCE;
            let is_diagonal =
                columns.chunks_exact(rows).enumerate().all(|(at, column)| is_diagonal(column, first + at));
            for (sums, part) in sums.iter_mut().zip(&parts) {
                let factors = &part[part.len().min(first)..part.len().min(first + AT_ONCE)];
                if is_diagonal {
                    for (at, (sum, factor)) in (first..).zip(sums.iter_mut().skip(first).zip(factors)) {
                        *sum += factor * columns[(at - first) * rows + at];
                    }
                } else {
                    add_columns(sums, columns, factors);
                }
            }
        }
        DVector::from_fn(rows, |i, _| Complex::new(sums[0][i], sums[1][i]))
    }
}

/// Columns that are added in one pass over the sums; chosen: with fewer the sums are read more often, with more the columns do not stay in registers.
const AT_ONCE: usize = 4;

/// Adds each column times its factor.
#[inline(always)]
fn add_columns(sums: &mut [f64], columns: &[f64], factors: &[f64]) {
    let rows = sums.len();
    let &[a, b, c, d] = factors else {
        for (&factor, column) in factors.iter().zip(columns.chunks_exact(rows)) {
            sums.iter_mut().zip(column).for_each(|(sum, &entry)| *sum += factor * entry);
        }
        return;
    };
    let (one, rest) = columns.split_at(rows);
    let (two, rest) = rest.split_at(rows);
    let (three, four) = rest.split_at(rows);
    for ((((sum, one), two), three), four) in sums.iter_mut().zip(one).zip(two).zip(three).zip(four) {
        *sum = *sum + a * one + b * two + c * three + d * four;
    }
}

/// True if a column has no entry but perhaps this one.
#[inline(always)]
fn is_diagonal(column: &[f64], at: usize) -> bool {
    let (above, below) = column.split_at(at.min(column.len()));
    is_zero(above) && is_zero(below.get(1..).unwrap_or_default())
}

/// True if all numbers are zero of either sign: a few without a branch, so that the compiler can use vector operations; the shift
/// removes the sign bit.
#[inline(always)]
fn is_zero(numbers: &[f64]) -> bool {
    numbers.chunks(32).all(|few| few.iter().fold(0, |bits, x| bits | (x.to_bits() << 1)) == 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn diagonal_full_and_rectangular_matrices_give_the_complex_product() {
        let x = DVector::from_fn(4, |i, _| Complex::new(0.3 * i as f64 - 0.4, 1.0 / (i + 1) as f64));
        let real = x.map(|value| Complex::from(value.re));
        let full = |rows: usize| DMatrix::from_fn(rows, 4, |i, j| (1 + i * i + 3 * j) as f64 / 7.0 - 0.9);
        let diagonal = DMatrix::from_diagonal(&DVector::from_vec(vec![2.0, 0.0, -0.5, 1e-9]));
        for a in [full(4), full(2), full(6), diagonal, DMatrix::zeros(0, 4)] {
            assert_eq!(real_times_complex(&a, &x), a.map(Complex::from) * &x);
            assert_eq!(real_times_complex(&a, &real), a.map(Complex::from) * &real);
        }
    }

    #[test]
    fn a_form_of_sizes_is_that_of_the_entries_and_no_scaling_changes_it() {
        let a = DMatrix::from_fn(3, 2, |i, j| (i as f64 - 1.0) * 2.0 + j as f64 - 0.5);
        let y = DVector::from_fn(3, |i, _| Complex::new(i as f64 - 0.5, 1.0));
        let x = DVector::from_fn(2, |i, _| Complex::new(0.3, i as f64 - 2.0));
        let sizes = |v: &DVector<Complex<f64>>| v.map(|entry| entry.norm());
        let expected = (sizes(&y).transpose() * a.abs() * sizes(&x))[0];
        assert!((form_of_sizes(&a, &y, &x) - expected).abs() < 1e-14 * expected);
        let rows = DVector::from_vec(vec![1e9, 1.0, 1e-7]);
        let scaled = DMatrix::from_diagonal(&rows) * &a;
        let y = y.component_div(&rows.map(Complex::from));
        assert!((form_of_sizes(&scaled, &y, &x) - expected).abs() < 1e-14 * expected);
    }

    #[test]
    fn columns_beyond_the_last_four_and_diagonal_ones_among_others_are_added() {
        let n = 11;
        // Eight diagonal columns, then full ones.
        let a = DMatrix::from_fn(n, n, |i, j| if j < 8 && i != j { 0.0 } else { (1 + i + 2 * j) as f64 / 8.0 });
        let x = DVector::from_fn(n, |i, _| Complex::new(0.5 * i as f64 - 2.0, 3.0 - i as f64));
        for a in [a.clone(), a.transpose(), a.columns(0, 9).into_owned(), a.rows(0, 6).into_owned()] {
            let expected = a.map(Complex::from) * x.rows(0, a.ncols());
            assert_eq!(real_times_complex(&a, &x), expected);
        }
    }
}
