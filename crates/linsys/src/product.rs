//! A real matrix times a complex vector; nalgebra needs a complex copy of the matrix.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

/// `A x` of a real n x m matrix and a complex vector of length m; length n. Entries beyond the shorter of m and the length of
/// x are not read.
///
/// A column with no entry off the diagonal costs one product, as in a diagonal mass matrix.
#[must_use]
pub fn real_times_complex(a: &DMatrix<f64>, x: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
    let rows = a.nrows();
    let mut product = DVector::zeros(rows);
    if rows == 0 {
        return product;
    }
    // The vectors of real eigenvalues: half of the work, to the same bits.
    if x.iter().all(|value| value.im == 0.0) {
        return real_times_real(a, x).map(Complex::from);
    }
    for (j, (column, &value)) in a.as_slice().chunks_exact(rows).zip(x).enumerate() {
        let (above, below) = column.split_at(j.min(rows));
        match below.split_first() {
            Some((&diagonal, below)) if is_zero(above) && is_zero(below) => product[j] += value * diagonal,
            _ => product.iter_mut().zip(column).for_each(|(sum, &entry)| *sum += value * entry),
        }
    }
    product
}

/// [`real_times_complex`] of a vector without imaginary parts: four columns in one pass over the sums.
fn real_times_real(a: &DMatrix<f64>, x: &DVector<Complex<f64>>) -> DVector<f64> {
    let rows = a.nrows();
    let mut product = DVector::zeros(rows);
    let factors: Vec<f64> = x.iter().take(a.ncols()).map(|value| value.re).collect();
    let mut fours = factors.chunks_exact(4);
    for (factors, columns) in fours.by_ref().zip(a.as_slice().chunks_exact(4 * rows)) {
        let (one, rest) = columns.split_at(rows);
        let (two, rest) = rest.split_at(rows);
        let (three, four) = rest.split_at(rows);
        for ((((sum, one), two), three), four) in product.iter_mut().zip(one).zip(two).zip(three).zip(four) {
            *sum = *sum + factors[0] * one + factors[1] * two + factors[2] * three + factors[3] * four;
        }
    }
    let done = factors.len() / 4 * 4;
    for (&factor, column) in fours.remainder().iter().zip(a.as_slice()[done * rows..].chunks_exact(rows)) {
        product.iter_mut().zip(column).for_each(|(sum, &entry)| *sum += factor * entry);
    }
    product
}

/// Whether all numbers are zero of either sign. There is no branch per number, so that the compiler can use vector operations;
/// the shift removes the sign bit.
fn is_zero(numbers: &[f64]) -> bool {
    numbers.iter().fold(0, |bits, x| bits | (x.to_bits() << 1)) == 0
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
}
