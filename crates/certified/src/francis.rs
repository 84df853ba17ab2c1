//! Francis' double-shift QR iteration, eigenvalues only, in double or double-double precision.
//!
//! The algorithm of LAPACK's `dlahqr`: deflation by the criterion of Ahues and Tisseur (LAPACK Working Note 122, 1997),
//! exceptional shifts after ten and twenty steps without deflation. nalgebra's iteration has neither, and stalls on lattices
//! whose symmetry makes eigenvalues multiple.
//!
//! How a bulge is chased depends on how the matrix is stored: here column by column in double, which is the fastest for
//! some tens of rows, in `chase` by vector registers.

use nalgebra::DMatrix;
use nalgebra::linalg::Hessenberg;
use num_complex::Complex;
use pulp::{Arch, Simd, WithSimd};

use crate::real::Real;

/// Steps without deflation before an exceptional shift: LAPACK's `kexsh`.
const STEPS_TO_EXCEPTIONAL_SHIFT: usize = 10;

/// A subdiagonal entry at most this large, relative to its neighbours on the diagonal, counts as zero whatever the entry above
/// the diagonal. Next to equal diagonal entries the iteration does not make it any smaller. Its product with an entry above the
/// diagonal of up to 1e28 is below the square of rounding and changes no eigenvalue.
const NEGLIGIBLE_SUBDIAGONAL: f64 = 1e-60;

/// Real and imaginary part.
type Number<T> = (T, T);

/// A square matrix in upper Hessenberg form, and how a bulge is chased through it.
pub(crate) trait Chase<T: Real> {
    fn size(&self) -> usize;
    fn at(&self, i: usize, j: usize) -> T;
    /// Sets the subdiagonal entry of row k to zero.
    fn split(&mut self, k: usize);
    /// Chases the bulge, whose first column is a multiple of `bulge`, from `start` to `last` within the active block from `first`.
    fn chase(&mut self, place: Place, bulge: [T; 3]);
}

/// Place of a step: the active block's first row, the one in which the bulge starts, and the block's last.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub(crate) first: usize,
    pub(crate) start: usize,
    pub(crate) last: usize,
}

/// Eigenvalues of a square matrix, all of them, or `None` if one does not converge within `cap` steps or an entry is not finite.
#[must_use]
pub fn eigenvalues(matrix: DMatrix<f64>, cap: usize) -> Option<Vec<Complex<f64>>> {
    let h = if matrix.nrows() > 2 { Hessenberg::new(matrix).unpack_h() } else { matrix };
    of_hessenberg(h, cap)
}

/// Eigenvalues of a matrix that is upper Hessenberg, all of them, or `None` if one does not converge within `cap` steps or an entry is not finite.
pub(crate) fn of_hessenberg<T: Real>(mut h: impl Chase<T>, cap: usize) -> Option<Vec<Complex<f64>>> {
    let n = h.size();
    if (0..n).any(|j| (0..n).any(|i| !h.at(i, j).value().is_finite())) {
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
            h.chase(Place { first, start, last }, bulge);
        };
        if first == last {
            found[last] = Complex::from(h.at(last, last).value());
        } else {
            let pair = of_2x2(h.at(first, first), h.at(first, last), h.at(last, first), h.at(last, last));
            (found[first], found[last]) = (rounded(pair.0), rounded(pair.1));
        }
        end = first;
    }
    Some(found)
}

fn rounded<T: Real>((re, im): Number<T>) -> Complex<f64> {
    Complex::new(re.value(), im.value())
}

/// Start of the active block that ends at `last`; the subdiagonal entry before it is set to zero.
fn deflate<T: Real>(h: &mut impl Chase<T>, last: usize, tiny: f64) -> usize {
    let mut k = last;
    while k > 0 {
        let at = |i, j| h.at(i, j);
        let size = |i, j| h.at(i, j).value().abs();
        let below = size(k, k - 1);
        let mut neighbours = size(k - 1, k - 1) + size(k, k);
        if neighbours == 0.0 {
            neighbours += if k >= 2 { size(k - 1, k - 2) } else { 0.0 };
            neighbours += if k < last { size(k + 1, k) } else { 0.0 };
        }
        let small = below <= tiny
            || below <= NEGLIGIBLE_SUBDIAGONAL * neighbours
            || below <= T::EPSILON * neighbours && {
                let (d, above) = (size(k, k), size(k - 1, k));
                let difference = (at(k - 1, k - 1) - at(k, k)).value().abs();
                let (ab, ba) = (below.max(above), below.min(above));
                let (aa, bb) = (d.max(difference), d.min(difference));
                let s = aa + ab;
                ba * (ab / s) <= tiny.max(T::EPSILON * (bb * (aa / s)))
            };
        if small {
            h.split(k);
            break;
        }
        k -= 1;
    }
    k
}

/// The two shifts: eigenvalues of the trailing 2 x 2 block, or exceptional ones.
fn shifts<T: Real>(h: &impl Chase<T>, first: usize, last: usize, steps: usize) -> [Number<T>; 2] {
    let size = |i, j| h.at(i, j).value().abs();
    let exceptional = |corner: T, s: f64| {
        let diagonal = T::from(0.75 * s) + corner;
        of_2x2(diagonal, T::from(-0.4375 * s), T::from(s), diagonal).into()
    };
    if steps.is_multiple_of(2 * STEPS_TO_EXCEPTIONAL_SHIFT) {
        exceptional(h.at(last, last), size(last, last - 1) + size(last - 1, last - 2))
    } else if steps.is_multiple_of(STEPS_TO_EXCEPTIONAL_SHIFT) {
        exceptional(h.at(first, first), size(first + 1, first) + size(first + 2, first + 1))
    } else {
        let corner = h.at(last, last);
        let (a, b) = of_2x2(h.at(last - 1, last - 1), h.at(last - 1, last), h.at(last, last - 1), corner);
        if a.1.value() != 0.0 {
            return [a, b];
        }
        let distance = |x: Number<T>| (x.0 - corner).value().abs();
        let nearer = if distance(a) <= distance(b) { a } else { b };
        [nearer, nearer]
    }
}

/// The row in which the bulge can start (at two consecutive small subdiagonal entries, or `first`), and the bulge's first
/// column.
fn bulge_start<T: Real>(h: &impl Chase<T>, first: usize, last: usize, shifts: [Number<T>; 2]) -> (usize, [T; 3]) {
    let [a, b] = shifts;
    let mut m = last - 2;
    loop {
        if m > first && !may_start(h, m, shifts) {
            m -= 1;
            continue;
        }
        let (diagonal, next, below) = (h.at(m, m), h.at(m + 1, m + 1), h.at(m + 1, m));
        let s = T::from((diagonal - b.0).value().abs() + b.1.value().abs() + below.value().abs());
        let below = below / s;
        let v = [
            below * h.at(m, m + 1) + (diagonal - a.0) * ((diagonal - b.0) / s) - a.1 * (b.1 / s),
            below * (diagonal + next - a.0 - b.0),
            below * h.at(m + 2, m + 1),
        ];
        let s = T::from(v.iter().map(|x| x.value().abs()).sum());
        let v = v.map(|x| x / s);
        if m == first {
            return (m, v);
        }
        let size = |i, j| h.at(i, j).value().abs();
        let around = size(m - 1, m - 1) + size(m, m) + size(m + 1, m + 1);
        let [v0, v1, v2] = v.map(|x| x.value().abs());
        if size(m, m - 1) * (v1 + v2) <= T::EPSILON * v0 * around {
            return (m, v);
        }
        m -= 1;
    }
}

/// True if a bulge might start at m, by its last entry alone and what its first one cannot exceed: in doubles, since hardly
/// any row passes.
fn may_start<T: Real>(h: &impl Chase<T>, m: usize, shifts: [Number<T>; 2]) -> bool {
    let size = |i, j| h.at(i, j).value().abs();
    let (below, around) = (size(m + 1, m), size(m, m) + size(m + 1, m + 1) + size(m - 1, m - 1));
    let [a, b] = shifts.map(|(re, im)| around + re.value().abs() + im.value().abs());
    let largest = below * size(m, m + 1) + a * b;
    size(m, m - 1) * below * size(m + 2, m + 1) <= 2.0 * T::EPSILON * largest * around
}

/// Eigenvalues of `[a b; c d]`: exact conjugates, or two real ones without cancellation.
fn of_2x2<T: Real>(a: T, b: T, c: T, d: T) -> (Number<T>, Number<T>) {
    let zero = T::default();
    let p = T::from(0.5) * (a - d);
    let scale = p.value().abs().max(b.value().abs()).max(c.value().abs());
    if scale == 0.0 {
        return ((a, zero), (d, zero));
    }
    let scale = T::from(scale);
    let discriminant = (p / scale) * p + (b / scale) * c;
    if discriminant.value() < 0.0 {
        let root = (-discriminant).root() * scale.root();
        return ((d + p, root), (d + p, -root));
    }
    let root = discriminant.root() * scale.root();
    let z = if p.value().is_sign_negative() { p - root } else { p + root };
    let other = if z.value() == 0.0 { d } else { d - (b / z) * c };
    ((d + z, zero), (other, zero))
}

impl Chase<f64> for DMatrix<f64> {
    fn size(&self) -> usize {
        self.nrows()
    }

    fn at(&self, i: usize, j: usize) -> f64 {
        self[(i, j)]
    }

    fn split(&mut self, k: usize) {
        self[(k, k - 1)] = 0.0;
    }

    fn chase(&mut self, place: Place, bulge: [f64; 3]) {
        Arch::new().dispatch(ChaseByColumns { h: self, place, bulge });
    }
}

/// Chase column by column, in wide vector registers where there are any; the bits are the same everywhere.
struct ChaseByColumns<'a> {
    h: &'a mut DMatrix<f64>,
    place: Place,
    bulge: [f64; 3],
}

impl WithSimd for ChaseByColumns<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { h, place: Place { first, start, last }, bulge: mut v } = self;
        let order = h.nrows();
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
            let entries = h.as_mut_slice();
            for column in entries.chunks_exact_mut(order).take(last + 1).skip(k) {
                match &mut column[k..k + size] {
                    [a, b, c] => reflect([a, b, c], tau, w),
                    [a, b] => reflect([a, b], tau, w),
                    _ => {}
                }
            }
            let rows = first..=(k + 3).min(last);
            let mut columns = entries[k * order..].chunks_exact_mut(order).map(|column| &mut column[rows.clone()]);
            let [Some(a), Some(b)] = [columns.next(), columns.next()] else { return };
            match columns.next().filter(|_| size == 3) {
                Some(c) => a.iter_mut().zip(b).zip(c).for_each(|((a, b), c)| reflect([a, b, c], tau, w)),
                None => a.iter_mut().zip(b).for_each(|(a, b)| reflect([a, b], tau, w)),
            }
        }
    }
}

/// `x - tau (w^T x) w` in the place of x.
#[inline(always)]
fn reflect<const N: usize>(x: [&mut f64; N], tau: f64, w: [f64; 3]) {
    let sum = tau * w.iter().zip(&x).map(|(w, x)| w * **x).sum::<f64>();
    x.into_iter().zip(w).for_each(|(x, w)| *x -= sum * w);
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
