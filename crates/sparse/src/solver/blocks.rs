//! Blocks of vectors: what all that computes with them shares.

use faer::{Mat, Par};
use num_complex::Complex;

use crate::unpatterned::unpatterned;

/// Parallelism of one thread: the bits of a factorisation depend on the number of threads, and this library has none without it.
pub(crate) const PAR: Par = Par::Seq;

/// The 2-norm, summed in eight parts, which a processor adds at once.
pub(crate) fn length(x: &[Complex<f64>]) -> f64 {
    let (blocks, rest) = x.as_chunks::<8>();
    let mut sums = [0.0; 8];
    for block in blocks {
        sums.iter_mut().zip(block).for_each(|(sum, z)| *sum += z.norm_sqr());
    }
    (sums.iter().sum::<f64>() + rest.iter().map(Complex::norm_sqr).sum::<f64>()).sqrt()
}

/// `a^H b` of the rows that b has, summed in four parts.
pub(super) fn dot(a: &[Complex<f64>], b: &[Complex<f64>]) -> Complex<f64> {
    let a = &a[..b.len()];
    let ((a, rest_a), (b, rest_b)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let mut sums = [Complex::<f64>::default(); 4];
    for (a, b) in a.iter().zip(b) {
        sums.iter_mut().zip(a).zip(b).for_each(|((sum, a), b)| *sum += a.conj() * b);
    }
    let rest: Complex<f64> = rest_a.iter().zip(rest_b).map(|(a, b)| a.conj() * b).sum();
    sums.iter().sum::<Complex<f64>>() + rest
}

/// A fixed block without structure, the same on every machine: sums of two numbers of [`unpatterned`].
pub(super) fn starting_block(rows: usize, columns: usize) -> Mat<Complex<f64>> {
    another_block(rows, columns, 0)
}

/// A fixed block without structure as [`starting_block`], which has the `number` 0: another one for each `number`.
pub(super) fn another_block(rows: usize, columns: usize, number: usize) -> Mat<Complex<f64>> {
    Mat::from_fn(rows, columns, |i, j| {
        let k = (i * columns + j + 1 + 7919 * number) as f64;
        Complex::from(unpatterned(k) * 2.0 - 1.0 + unpatterned((k % 97.0) * (k % 89.0)) - 0.5)
    })
}
