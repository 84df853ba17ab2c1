//! `Q~(sigma) x` in double-double, a register of rows at a time.

use num_complex::Complex;
use pulp::{Arch, Simd, WithSimd};

use super::dd::{Dd, DdComplex};
use super::lane::{Lane, product_error};
use super::scaled::Scaled;
use crate::lanes::Ops;
use crate::lu::Vector;

/// `Q~(sigma) x` in double-double, rounded at the end: wrong by some 2^-104 of the sum of the moduli of its terms.
pub(crate) fn residual(s: &Scaled, sigma: DdComplex, x: &[DdComplex]) -> Vector {
    let n = s.order();
    // High and low parts of the sums' real parts, then of their imaginary parts, which stay zero where everything is real.
    let mut sums = [vec![0.0; 2 * n], vec![0.0; 2 * n]];
    let is_real = |z: &DdComplex| z.im == Dd::default();
    let parts = if is_real(&sigma) && x.iter().all(is_real) { 1 } else { 2 };
    Arch::new().dispatch(AddColumns { s, sigma, x, sums: &mut sums[..parts] });
    let [re, im] = sums;
    Vector::from_fn(n, |i, _| Complex::new(re[i] + re[n + i], im[i] + im[n + i]))
}

/// Adds the columns of M, C and K times `sigma^2 x_j`, `sigma x_j` and `x_j`.
struct AddColumns<'a> {
    s: &'a Scaled,
    sigma: DdComplex,
    x: &'a [DdComplex],
    /// The real part alone, or both.
    sums: &'a mut [Vec<f64>],
}

impl WithSimd for AddColumns<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (Self { s, sigma, x, sums }, o) = (self, Ops::new(simd));
        let n = s.order();
        for (j, &constant) in x.iter().enumerate() {
            let linear = constant * sigma;
            let factors = [linear * sigma, linear, constant];
            let column = |matrix: usize| &[&s.m, &s.c, &s.k][matrix].as_slice()[j * n..(j + 1) * n];
            let columns = [column(0), column(1), column(2)];
            for (part, sums) in sums.iter_mut().enumerate() {
                let factors = factors.map(|z| if part == 0 { z.re } else { z.im });
                add_columns(o, columns, factors, sums);
            }
        }
    }
}

/// Adds three columns of doubles, each times a double-double.
#[inline(always)]
fn add_columns<S: Simd>(o: Ops<S>, columns: [&[f64]; 3], factors: [Dd; 3], sums: &mut [f64]) {
    let n = columns[0].len();
    let mut at = 0;
    while at < n {
        let rows = (at, n.min(at + S::F64_LANES));
        let mut sum = Dd::load(o, sums, n, rows);
        for (column, factor) in columns.iter().zip(factors) {
            let entries = &column[rows.0..rows.1];
            // Most of a mass matrix is zero, and of the matrices of finite elements.
            if entries.iter().all(|&x| x == 0.0) {
                continue;
            }
            let (entry, [hi, lo]) = (o.load(entries), Dd::splat(o, factor));
            let product = o.mul(hi, entry);
            let error = o.add(product_error(o, hi, entry, product), o.mul(lo, entry));
            sum = Dd::plus(o, sum, [product, error]);
        }
        Dd::store(o, sums, n, rows, sum);
        at = rows.1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use linsys::SecondOrder;
    use nalgebra::DMatrix;
    use proptest::prelude::*;

    /// Entry by entry, each product and sum in double-double.
    fn by_entries(s: &Scaled, sigma: DdComplex, x: &[DdComplex]) -> Vector {
        let times = |z: DdComplex, a: f64| DdComplex { re: z.re.times(a), im: z.im.times(a) };
        let sum_of_row = |i: usize| {
            (0..x.len()).fold(DdComplex::default(), |sum, j| {
                let linear = sigma * x[j];
                sum + times(sigma * linear, s.m[(i, j)]) + times(linear, s.c[(i, j)]) + times(x[j], s.k[(i, j)])
            })
        };
        Vector::from_fn(s.order(), |i, _| sum_of_row(i).value())
    }

    proptest! {
        #[test]
        fn what_cancels_to_the_rounding_of_doubles_has_all_its_digits(
            entries in prop::collection::vec(0.1..1.0f64, 4 * 11 * 11),
            im in prop_oneof![Just(0.0), 0.1..1.0f64],
        ) {
            let n = 11;
            let matrix = |k: usize| DMatrix::from_column_slice(n, n, &entries[k * n * n..(k + 1) * n * n]);
            let mut s = Scaled::new(&SecondOrder::new(matrix(0), matrix(1), matrix(2)).unwrap());
            // Numbers with low parts; x is real, so that K can make up for the real part of all else.
            let number = |re: f64, im: f64| DdComplex::from(Complex::new(re, im)) * DdComplex { re: Dd::from(1.0) / Dd::from(3.0), im: Dd::default() };
            let sigma = number(entries[3 * n * n], im);
            let x: Vec<_> = (0..n).map(|j| number(entries[3 * n * n + j], 0.0)).collect();
            let rest = by_entries(&s, sigma, &x);
            (0..n).for_each(|i| s.k[(i, 0)] -= rest[i].re / x[0].value().re);
            let (expected, found) = (by_entries(&s, sigma, &x), residual(&s, sigma, &x));
            for (expected, found) in expected.iter().zip(&found) {
                prop_assert!(expected.re.abs() < 1e-14);
                prop_assert!((found.re - expected.re).abs() < 1e-14 * expected.re.abs() + 1e-30);
                prop_assert!((found.im - expected.im).abs() <= 1e-15 * expected.im.abs());
            }
        }
    }
}
