//! Eigenvalues of a quasi-triangular matrix.

use num_complex::Complex;

/// The eigenvalues of the 1 x 1 and 2 x 2 blocks on the diagonal of an `n x n` matrix, complex ones in exact
/// conjugate pairs. A block ends where the entry below its diagonal is zero.
pub(super) fn eigenvalues(n: usize, at: impl Fn(usize, usize) -> f64) -> Vec<Complex<f64>> {
    let mut found = Vec::with_capacity(n);
    let mut k = 0;
    while k < n {
        if k + 1 == n || at(k + 1, k) == 0.0 {
            found.push(Complex::from(at(k, k) + 0.0));
            k += 1;
        } else {
            found.extend(pair(at(k, k), at(k, k + 1), at(k + 1, k), at(k + 1, k + 1)));
            k += 2;
        }
    }
    found
}

/// Eigenvalues of `[a b; c d]` without cancellation: a real pair from its larger root and the determinant.
fn pair(a: f64, b: f64, c: f64, d: f64) -> [Complex<f64>; 2] {
    let half = 0.5 * (a - d);
    let product = b * c;
    let square = half * half + product;
    if square < 0.0 {
        let root = Complex::new(d + half, (-square).sqrt());
        return [root, root.conj()];
    }
    let larger = half + square.sqrt().copysign(half);
    let smaller = if larger == 0.0 { 0.0 } else { -product / larger };
    [Complex::from(d + larger), Complex::from(d + smaller)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_have_the_right_sum_and_product() {
        for (a, b, c, d) in [(1.0, 2.0, 3.0, 4.0), (0.0, -4.0, 1.0, 0.0), (2.0, 0.0, 5.0, 2.0), (1.0, 1e-9, 1e-9, 1.0)]
        {
            let [p, q] = pair(a, b, c, d);
            assert!((p + q - (a + d)).norm() < 1e-15 * 8.0, "{p} {q}");
            assert!((p * q - (a * d - b * c)).norm() < 1e-15 * 8.0, "{p} {q}");
        }
    }
}
