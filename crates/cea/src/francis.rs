//! Francis' double-shift QR iteration, eigenvalues only.
//!
//! The algorithm of LAPACK's `dlahqr`: deflation by the criterion of Ahues and Tisseur (LAPACK Working Note 122, 1997),
//! exceptional shifts after ten and twenty steps without deflation. nalgebra's iteration has neither, and stalls on lattices
//! whose symmetry makes eigenvalues multiple.

use nalgebra::DMatrix;
use nalgebra::linalg::Hessenberg;
use num_complex::Complex;

/// Steps without deflation before an exceptional shift: LAPACK's `kexsh`.
const STEPS_TO_EXCEPTIONAL_SHIFT: usize = 10;

/// A subdiagonal entry at most this large, relative to its neighbours on the diagonal, counts as zero whatever the entry above
/// the diagonal. Next to equal diagonal entries the iteration does not make it any smaller. Its product with an entry above the
/// diagonal of up to 1e28 is below the square of rounding and changes no eigenvalue.
const NEGLIGIBLE_SUBDIAGONAL: f64 = 1e-60;

/// All eigenvalues of a square matrix, or `None` if one does not converge within `cap` steps or an entry is not finite.
pub(crate) fn eigenvalues(matrix: DMatrix<f64>, cap: usize) -> Option<Vec<Complex<f64>>> {
    let n = matrix.nrows();
    let mut h = if n > 2 { Hessenberg::new(matrix).unpack_h() } else { matrix };
    if h.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let tiny = f64::MIN_POSITIVE * (n as f64 / f64::EPSILON);
    let mut found = vec![Complex::from(0.0); n];
    let mut end = n;
    while end > 0 {
        let last = end - 1;
        let mut steps = 0;
        let first = loop {
            let first = deflate(&mut h, last, tiny);
            if first + 1 >= last {
                break first;
            }
            if steps == cap {
                return None;
            }
            steps += 1;
            let shifts = shifts(&h, first, last, steps);
            let (start, bulge) = bulge_start(&h, first, last, shifts);
            sweep(&mut h, (first, start, last), bulge);
        };
        if first == last {
            found[last] = Complex::from(h[(last, last)]);
        } else {
            let pair = of_2x2(h[(first, first)], h[(first, last)], h[(last, first)], h[(last, last)]);
            (found[first], found[last]) = pair;
        }
        end = first;
    }
    Some(found)
}

/// Start of the active block that ends at `last`; the subdiagonal entry before it is set to zero.
fn deflate(h: &mut DMatrix<f64>, last: usize, tiny: f64) -> usize {
    let mut k = last;
    while k > 0 {
        let below = h[(k, k - 1)].abs();
        let (a, d, above) = (h[(k - 1, k - 1)], h[(k, k)], h[(k - 1, k)].abs());
        let mut size = a.abs() + d.abs();
        if size == 0.0 {
            size += if k >= 2 { h[(k - 1, k - 2)].abs() } else { 0.0 };
            size += if k < last { h[(k + 1, k)].abs() } else { 0.0 };
        }
        let small = below <= tiny
            || below <= NEGLIGIBLE_SUBDIAGONAL * size
            || below <= f64::EPSILON * size && {
                let (ab, ba) = (below.max(above), below.min(above));
                let (aa, bb) = (d.abs().max((a - d).abs()), d.abs().min((a - d).abs()));
                let s = aa + ab;
                ba * (ab / s) <= tiny.max(f64::EPSILON * (bb * (aa / s)))
            };
        if small {
            h[(k, k - 1)] = 0.0;
            break;
        }
        k -= 1;
    }
    k
}

/// The two shifts: eigenvalues of the trailing 2 x 2 block, or exceptional ones.
fn shifts(h: &DMatrix<f64>, first: usize, last: usize, steps: usize) -> (Complex<f64>, Complex<f64>) {
    let exceptional = |corner: f64, s: f64| of_2x2(0.75 * s + corner, -0.4375 * s, s, 0.75 * s + corner);
    if steps.is_multiple_of(2 * STEPS_TO_EXCEPTIONAL_SHIFT) {
        exceptional(h[(last, last)], h[(last, last - 1)].abs() + h[(last - 1, last - 2)].abs())
    } else if steps.is_multiple_of(STEPS_TO_EXCEPTIONAL_SHIFT) {
        exceptional(h[(first, first)], h[(first + 1, first)].abs() + h[(first + 2, first + 1)].abs())
    } else {
        let corner = h[(last, last)];
        let (a, b) = of_2x2(h[(last - 1, last - 1)], h[(last - 1, last)], h[(last, last - 1)], corner);
        if a.im != 0.0 {
            return (a, b);
        }
        let nearer = if (a.re - corner).abs() <= (b.re - corner).abs() { a } else { b };
        (nearer, nearer)
    }
}

/// The row in which the bulge can start (at two consecutive small subdiagonal entries, or `first`), and the bulge's first
/// column.
fn bulge_start(h: &DMatrix<f64>, first: usize, last: usize, (a, b): (Complex<f64>, Complex<f64>)) -> (usize, [f64; 3]) {
    let mut m = last - 2;
    loop {
        let s = (h[(m, m)] - b.re).abs() + b.im.abs() + h[(m + 1, m)].abs();
        let below = h[(m + 1, m)] / s;
        let mut v = [
            below * h[(m, m + 1)] + (h[(m, m)] - a.re) * ((h[(m, m)] - b.re) / s) - a.im * (b.im / s),
            below * (h[(m, m)] + h[(m + 1, m + 1)] - a.re - b.re),
            below * h[(m + 2, m + 1)],
        ];
        let s: f64 = v.iter().map(|x| x.abs()).sum();
        v = v.map(|x| x / s);
        if m == first {
            return (m, v);
        }
        let around = h[(m - 1, m - 1)].abs() + h[(m, m)].abs() + h[(m + 1, m + 1)].abs();
        if h[(m, m - 1)].abs() * (v[1].abs() + v[2].abs()) <= f64::EPSILON * v[0].abs() * around {
            return (m, v);
        }
        m -= 1;
    }
}

/// Chases the bulge from `start` to `last` within the active block from `first`.
fn sweep(h: &mut DMatrix<f64>, (first, start, last): (usize, usize, usize), mut v: [f64; 3]) {
    for k in start..last {
        let size = (last - k + 1).min(3);
        if k > start {
            for (i, x) in v.iter_mut().enumerate() {
                *x = if i < size { h[(k + i, k - 1)] } else { 0.0 };
            }
        } else if size < 3 {
            v[2] = 0.0;
        }
        let (beta, tau, w) = householder(v);
        if k > start {
            h[(k, k - 1)] = beta;
            for i in 1..size {
                h[(k + i, k - 1)] = 0.0;
            }
        } else if start > first {
            h[(k, k - 1)] *= 1.0 - tau;
        }
        for j in k..=last {
            let sum = tau * (0..size).map(|i| w[i] * h[(k + i, j)]).sum::<f64>();
            for i in 0..size {
                h[(k + i, j)] -= sum * w[i];
            }
        }
        for j in first..=(k + 3).min(last) {
            let sum = tau * (0..size).map(|i| w[i] * h[(j, k + i)]).sum::<f64>();
            for i in 0..size {
                h[(j, k + i)] -= sum * w[i];
            }
        }
    }
}

/// `(I - tau w w^T) v = (beta, 0, 0)` with `w[0] = 1`.
fn householder(v: [f64; 3]) -> (f64, f64, [f64; 3]) {
    let tail = v[1].hypot(v[2]);
    if tail == 0.0 {
        return (v[0], 0.0, [1.0, 0.0, 0.0]);
    }
    let beta = -v[0].hypot(tail).copysign(v[0]);
    let scale = 1.0 / (v[0] - beta);
    (beta, (beta - v[0]) / beta, [1.0, v[1] * scale, v[2] * scale])
}

/// Eigenvalues of `[a b; c d]`: exact conjugates, or two real ones without cancellation.
fn of_2x2(a: f64, b: f64, c: f64, d: f64) -> (Complex<f64>, Complex<f64>) {
    let p = 0.5 * (a - d);
    let scale = p.abs().max(b.abs()).max(c.abs());
    if scale == 0.0 {
        return (Complex::from(a), Complex::from(d));
    }
    let discriminant = (p / scale) * p + (b / scale) * c;
    let root = discriminant.abs().sqrt() * scale.sqrt();
    if discriminant < 0.0 {
        let upper = Complex::new(d + p, root);
        return (upper, upper.conj());
    }
    let z = p + root.copysign(p);
    let other = if z == 0.0 { d } else { d - (b / z) * c };
    (Complex::from(d + z), Complex::from(other))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;
    use proptest::prelude::*;

    fn sorted(matrix: DMatrix<f64>) -> Vec<Complex<f64>> {
        let mut values = eigenvalues(matrix, 60).unwrap();
        crate::sort(&mut values);
        values
    }

    proptest! {
        #[test]
        fn traces_of_powers_are_sums_of_powers(entries in prop::collection::vec(-1.0..1.0, 49)) {
            let a = DMatrix::from_vec(7, 7, entries);
            let values = sorted(a.clone());
            let mut power = DMatrix::identity(7, 7);
            for exponent in 1..=4 {
                power *= &a;
                let sum: Complex<f64> = values.iter().map(|l| l.powi(exponent)).sum();
                prop_assert!((sum - power.trace()).norm() < 1e-10, "{} {}", sum, power.trace());
            }
        }

        #[test]
        fn a_known_spectrum_is_found(real in prop::collection::vec(-3.0..3.0, 5), im in 0.1..4.0_f64, mix in prop::collection::vec(-0.3..0.3, 49)) {
            let mut d: DMatrix<f64> = DMatrix::zeros(7, 7);
            for i in 0..5 { d[(i, i)] = real[i]; }
            d.view_mut((5, 5), (2, 2)).copy_from(&dmatrix![0.5, im; -im, 0.5]);
            let t = DMatrix::identity(7, 7) + DMatrix::from_vec(7, 7, mix) * 0.4;
            let inverse = t.clone().try_inverse().unwrap();
            let values = sorted(&t * d * inverse);
            prop_assert!((values[6] - Complex::new(0.5, im)).norm() < 1e-9 || (values[6].im - im).abs() < 1e-9);
            let mut wanted = real.clone();
            wanted.sort_by(f64::total_cmp);
            let sum: f64 = values.iter().map(|l| l.re).sum();
            prop_assert!((sum - wanted.iter().sum::<f64>() - 1.0).abs() < 1e-10);
        }
    }

    #[test]
    fn hard_shapes_converge() {
        // The cyclic matrix needs an exceptional shift: ordinary QR steps only permute it.
        let cyclic = DMatrix::from_fn(8, 8, |i, j| if (j + 1) % 8 == i { 1.0 } else { 0.0 });
        assert!(sorted(cyclic).iter().all(|l| (l.norm() - 1.0).abs() < 1e-14));
        let jordan = DMatrix::from_fn(6, 6, |i, j| {
            if i == j {
                2.0
            } else if i + 1 == j {
                1.0
            } else {
                0.0
            }
        });
        assert!(sorted(jordan).iter().all(|l| (l - 2.0).norm() == 0.0));
        assert!(sorted(DMatrix::zeros(5, 5)).iter().all(|l| l.norm() == 0.0));
        assert_eq!(sorted(dmatrix![3.0]), [Complex::from(3.0)]);
        assert_eq!(sorted(dmatrix![0.0, 1.0; -4.0, 0.0])[1], Complex::new(0.0, 2.0));
        assert_eq!(eigenvalues(dmatrix![f64::NAN], 60), None);
    }

    #[test]
    fn many_equal_eigenvalues_converge() {
        // Six uncoupled copies of one oscillator in turned coordinates: every eigenvalue is sixfold.
        let block = DMatrix::from_fn(12, 12, |i, j| match (i < 6, j < 6) {
            (true, false) if j == i + 6 => 1.0,
            (false, true) if i == j + 6 => -1.0,
            (false, false) if i == j => -0.1,
            _ => 0.0,
        });
        let axis = nalgebra::DVector::from_fn(12, |i, _| (1.3 * (i + 1) as f64).sin()).normalize();
        let turn = DMatrix::identity(12, 12) - &axis * axis.transpose() * 2.0;
        for l in sorted(&turn * block * &turn) {
            assert!((l * l + l * 0.1 + 1.0).norm() < 1e-13);
        }
    }
}
