//! Null vectors of many complex matrices at once, one matrix per lane.
//!
//! Householder's factorisation `Q = U R` needs no pivoting, so that all lanes run the same operations. Inverse iteration with
//! `R^H R = Q^H Q` then finds the right singular vector of the smallest singular value, which is the vector of smallest
//! backward error, and on its way `R^-H x`, which U turns into the left one. The factorisation takes 8/3 n^3 fused multiply-adds, twice those of an LU
//! factorisation.

use certified::lanes::{ComplexLanes, Ops, conj_fma, fma, narrow, neg, registers, scale, square, wide_part};
use certified::lu::{LEAST_PIVOT, Lu};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use pulp::{Arch, Simd, WithSimd, bytemuck};

/// Number of inverse iterations with `Q^H Q`; chosen: the first nearly converges.
const SINGULAR_VECTOR_ITERATIONS: usize = 3;
/// Columns that are finished together; chosen: of 2 and 4 the faster.
const TOGETHER: usize = 4;

/// A unit vector x, and `|Q x|` after the last but one and after the last iteration; of the left side a vector y and `|Q^H y|`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NullVector {
    pub vector: DVector<Complex<f64>>,
    pub residuals: [f64; 2],
}

/// The unit vector x with the least `|Q x|` for each matrix Q, all of one size, by iteration from `start`, and of two `SIDES` the unit vector y with the least
/// `|Q^H y|` as well; `None` where the entries of a matrix are too large or too small to be squared.
pub(crate) fn null_vectors<const SIDES: usize>(
    matrices: &[DMatrix<Complex<f64>>],
    start: &DVector<Complex<f64>>,
    scratch: &mut Vec<f64>,
) -> Vec<Option<[NullVector; SIDES]>> {
    let arch = Arch::new();
    let (wide, few) = matrices.split_at(wide_part(matrices.len()));
    let mut found = arch.dispatch(NullVectorsInLanes { matrices: wide, start, scratch });
    found.extend(narrow(arch, NullVectorsInLanes { matrices: few, start, scratch }));
    found
}

/// [`null_vectors`] of one matrix by its LU factors, `x := Q^-1 Q^-H x`: faster than a lane of its own, slower than one of eight.
pub(crate) fn by_factors(q: &DMatrix<Complex<f64>>, start: &DVector<Complex<f64>>) -> Option<NullVector> {
    let lu = Lu::new(q, (f64::EPSILON.powi(2) * q.camax()).max(LEAST_PIVOT));
    let (mut vector, mut residuals) = (start.clone(), [f64::INFINITY; 2]);
    for _ in 0..SINGULAR_VECTOR_ITERATIONS {
        for solve in [Lu::solve_adjoint, Lu::solve] {
            solve(&lu, &mut vector);
            let norm = vector.norm();
            vector.unscale_mut(norm);
        }
        residuals = [residuals[1], (q * &vector).norm()];
    }
    let is_one = (vector.norm_squared() - 1.0).abs() < 1e-6;
    (is_one && residuals[1].is_finite()).then_some(NullVector { vector, residuals })
}

struct NullVectorsInLanes<'a, const SIDES: usize> {
    matrices: &'a [DMatrix<Complex<f64>>],
    start: &'a DVector<Complex<f64>>,
    scratch: &'a mut Vec<f64>,
}

impl<const SIDES: usize> WithSimd for NullVectorsInLanes<'_, SIDES> {
    type Output = Vec<Option<[NullVector; SIDES]>>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let (o, n) = (Ops::new(simd), self.start.len());
        let registers = registers::<S>(self.scratch, 2 * (n * n + 3 * n) + n);
        let (sizes, pairs) = registers.split_at_mut(n);
        let (pairs, _) = pairs.as_chunks_mut::<2>();
        let (r, rest) = pairs.split_at_mut(n * n);
        let (x, rest) = rest.split_at_mut(n);
        let (y, heads) = rest.split_at_mut(n);
        let mut found = Vec::with_capacity(self.matrices.len());
        for matrices in self.matrices.chunks(S::F64_LANES) {
            fill::<S>(r, matrices);
            factorise(o, r, heads, sizes, n);
            for (x, start) in x.iter_mut().zip(self.start) {
                *x = [o.splat(start.re), o.splat(start.im)];
            }
            let floor = floor(o, r, n);
            let mut residuals = [[o.splat(f64::INFINITY); 2]; 2];
            for _ in 0..SINGULAR_VECTOR_ITERATIONS {
                solve_adjoint(o, r, x, floor);
                if SIDES == 2 {
                    y.copy_from_slice(x);
                    to_unit(o, y);
                    residuals[1] = [residuals[1][1], residual_of_adjoint(o, r, y)];
                }
                solve(o, r, x, floor);
                to_unit(o, x);
                residuals[0] = [residuals[0][1], residual(o, r, x)];
            }
            if SIDES == 2 {
                for k in (0..n).rev() {
                    reflect(o, [&mut y[k..]], (heads[k], &r[k * n..][k + 1..n]), sizes[k]);
                }
            }
            let sides: [_; SIDES] = std::array::from_fn(|side| ([&*x, &*y][side], &residuals[side]));
            for lane in 0..matrices.len() {
                let both = sides.map(|(vector, residuals)| null_vector::<S>(vector, residuals, lane));
                let both: Option<Vec<NullVector>> = both.into_iter().collect();
                found.push(both.and_then(|both| both.try_into().ok()));
            }
        }
        found
    }
}

/// Null vector that a lane has found; `None` where that is no vector.
fn null_vector<S: Simd>(vector: &[[S::f64s; 2]], residuals: &[S::f64s; 2], lane: usize) -> Option<NullVector> {
    let lanes = S::F64_LANES;
    let (entries, residuals): (&[f64], &[f64]) = (bytemuck::cast_slice(vector), bytemuck::cast_slice(residuals));
    let entry = |i: usize| entries[i * lanes + lane];
    let vector = DVector::from_fn(vector.len(), |i, _| Complex::new(entry(2 * i), entry(2 * i + 1)));
    let residuals = [residuals[lane], residuals[lanes + lane]];
    let is_one = (vector.norm_squared() - 1.0).abs() < 1e-6;
    (is_one && residuals[1].is_finite()).then_some(NullVector { vector, residuals })
}

/// Writes one matrix into each lane, column by column; the spare lanes hold the first matrix.
#[inline(always)]
fn fill<S: Simd>(r: &mut [[S::f64s; 2]], matrices: &[DMatrix<Complex<f64>>]) {
    let lanes = S::F64_LANES;
    let numbers: &mut [f64] = bytemuck::cast_slice_mut(r);
    for lane in 0..lanes {
        let matrix = matrices.get(lane).unwrap_or(&matrices[0]);
        for (entry, value) in numbers.chunks_exact_mut(2 * lanes).zip(matrix) {
            (entry[lane], entry[lanes + lane]) = (value.re, value.im);
        }
    }
}

/// Overwrites the upper triangle with R, by a reflection `H = I - g v v^H` for each column: the first entries of v in `heads`, the others below the
/// diagonal, and the g in `sizes`. Columns are finished a few at a time, so that all others are read and not written: the matrices of all lanes together fit
/// into no cache.
#[inline(always)]
fn factorise<S: Simd>(o: Ops<S>, r: &mut [[S::f64s; 2]], heads: &mut [[S::f64s; 2]], sizes: &mut [S::f64s], n: usize) {
    let mut first = 0;
    while first < n {
        let (known, rest) = r.split_at_mut(first * n);
        let mut columns = rest.chunks_exact_mut(n);
        match columns.len() {
            TOGETHER.. => finish(
                o,
                known,
                std::array::from_fn::<_, TOGETHER, _>(|_| columns.next().unwrap_or_default()),
                heads,
                sizes,
            ),
            _ => finish(o, known, std::array::from_fn::<_, 1, _>(|_| columns.next().unwrap_or_default()), heads, sizes),
        }
        first += if n - first >= TOGETHER { TOGETHER } else { 1 };
    }
}

/// Makes the known reflections in the next W columns, and finds those of these columns.
#[inline(always)]
fn finish<S: Simd, const W: usize>(
    o: Ops<S>,
    known: &[[S::f64s; 2]],
    mut columns: [&mut [[S::f64s; 2]]; W],
    heads: &mut [[S::f64s; 2]],
    sizes: &mut [S::f64s],
) {
    let n = columns[0].len();
    let first = known.len() / n;
    for (k, v) in known.chunks_exact(n).enumerate() {
        reflect(o, columns.each_mut().map(|column| &mut column[k..]), (heads[k], &v[k + 1..]), sizes[k]);
    }
    for c in 0..W {
        let k = first + c;
        let (done, others) = columns.split_at_mut(c + 1);
        let column = &mut done[c][k..];
        (heads[k], sizes[k]) = reflection(o, column);
        for other in others {
            reflect(o, [&mut other[k..]], (heads[k], &column[1..]), sizes[k]);
        }
    }
}

/// The reflection that leaves of a column its first entry alone, which is replaced: the first entry of v, and g. The others are those of the column.
#[inline(always)]
fn reflection<S: Simd>(o: Ops<S>, column: &mut [[S::f64s; 2]]) -> (ComplexLanes<S>, S::f64s) {
    let (zero, one) = (o.splat(0.0), o.splat(1.0));
    let mut below = zero;
    for &x in &column[1..] {
        below = square(o, x, below);
    }
    let alpha = column[0];
    let size = o.sqrt(square(o, alpha, zero));
    let norm = o.sqrt(square(o, alpha, below));
    // beta = -norm times the phase of alpha, v_0 = alpha - beta, g = 2 / v^H v.
    let has_phase = o.lt(zero, size);
    let inverse = o.select(has_phase, o.div(one, size), zero);
    let phase = [o.select(has_phase, o.mul(alpha[0], inverse), one), o.mul(alpha[1], inverse)];
    let beta = scale(o, phase, o.neg(norm));
    column[0] = beta;
    let g = o.mul(norm, o.add(norm, size));
    let g = o.select(o.lt(zero, g), o.div(one, g), zero);
    ([o.sub(alpha[0], beta[0]), o.sub(alpha[1], beta[1])], g)
}

/// `a - g v (v^H a)` for W columns; v by its first entry and the others.
#[inline(always)]
fn reflect<S: Simd, const W: usize>(
    o: Ops<S>,
    columns: [&mut [[S::f64s; 2]]; W],
    (head, tail): (ComplexLanes<S>, &[[S::f64s; 2]]),
    g: S::f64s,
) {
    let rows = tail.len();
    let zero = o.splat(0.0);
    let mut sums = [[zero; 2]; W];
    let columns = columns.map(|column| &mut column[..=rows]);
    for c in 0..W {
        sums[c] = conj_fma(o, head, columns[c][0], sums[c]);
    }
    for i in 0..rows {
        for c in 0..W {
            sums[c] = conj_fma(o, tail[i], columns[c][1 + i], sums[c]);
        }
    }
    for sum in &mut sums {
        *sum = scale(o, *sum, o.neg(g));
    }
    for c in 0..W {
        columns[c][0] = fma(o, head, sums[c], columns[c][0]);
    }
    for i in 0..rows {
        for c in 0..W {
            columns[c][1 + i] = fma(o, tail[i], sums[c], columns[c][1 + i]);
        }
    }
}

/// Least size of a diagonal entry of R in a division: epsilon times the largest entry.
#[inline(always)]
fn floor<S: Simd>(o: Ops<S>, r: &[[S::f64s; 2]], n: usize) -> S::f64s {
    let mut largest = o.splat(0.0);
    for k in 0..n {
        largest = o.max(largest, square(o, r[k * n + k], o.splat(0.0)));
    }
    o.mul(o.sqrt(largest), o.splat(f64::EPSILON))
}

/// `d / |d|^2`, for the division by a diagonal entry or its conjugate; an entry that vanishes counts as `floor`.
#[inline(always)]
fn inverse<S: Simd>(o: Ops<S>, d: ComplexLanes<S>, floor: S::f64s) -> ComplexLanes<S> {
    let zero = o.splat(0.0);
    let size = square(o, d, zero);
    let vanishes = o.lt(size, o.mul(floor, floor));
    let d = [o.select(vanishes, floor, d[0]), o.select(vanishes, zero, d[1])];
    scale(o, d, o.div(o.splat(1.0), square(o, d, zero)))
}

/// Replaces x by `R^-H x`.
#[inline(always)]
fn solve_adjoint<S: Simd>(o: Ops<S>, r: &[[S::f64s; 2]], x: &mut [[S::f64s; 2]], floor: S::f64s) {
    let n = x.len();
    let nothing = [o.splat(0.0); 2];
    for k in 0..n {
        let column = &r[k * n..][..=k];
        let mut sum = nothing;
        for (&a, &x) in column[..k].iter().zip(&*x) {
            sum = conj_fma(o, a, x, sum);
        }
        let left = [o.sub(x[k][0], sum[0]), o.sub(x[k][1], sum[1])];
        x[k] = fma(o, left, inverse(o, column[k], floor), nothing);
    }
}

/// Replaces x by `R^-1 x`.
#[inline(always)]
fn solve<S: Simd>(o: Ops<S>, r: &[[S::f64s; 2]], x: &mut [[S::f64s; 2]], floor: S::f64s) {
    let n = x.len();
    for k in (0..n).rev() {
        let column = &r[k * n..][..=k];
        let found = conj_fma(o, inverse(o, column[k], floor), x[k], [o.splat(0.0); 2]);
        x[k] = found;
        let minus = neg(o, found);
        for (&a, x) in column[..k].iter().zip(&mut *x) {
            *x = fma(o, a, minus, *x);
        }
    }
}

/// Scales x to unit length.
#[inline(always)]
fn to_unit<S: Simd>(o: Ops<S>, x: &mut [[S::f64s; 2]]) {
    let mut norm = o.splat(0.0);
    for &x in &*x {
        norm = square(o, x, norm);
    }
    let inverse = o.div(o.splat(1.0), o.sqrt(norm));
    for x in x {
        *x = scale(o, *x, inverse);
    }
}

/// `|R x|`.
#[inline(always)]
fn residual<S: Simd>(o: Ops<S>, r: &[[S::f64s; 2]], x: &[[S::f64s; 2]]) -> S::f64s {
    let n = x.len();
    let zero = o.splat(0.0);
    let mut norm = zero;
    for i in 0..n {
        let mut sum = [zero; 2];
        for j in i..n {
            sum = fma(o, r[j * n + i], x[j], sum);
        }
        norm = square(o, sum, norm);
    }
    o.sqrt(norm)
}

/// `|R^H x|`.
#[inline(always)]
fn residual_of_adjoint<S: Simd>(o: Ops<S>, r: &[[S::f64s; 2]], x: &[[S::f64s; 2]]) -> S::f64s {
    let n = x.len();
    let zero = o.splat(0.0);
    let mut norm = zero;
    for k in 0..n {
        let mut sum = [zero; 2];
        for (&a, &x) in r[k * n..][..=k].iter().zip(x) {
            sum = conj_fma(o, a, x, sum);
        }
        norm = square(o, sum, norm);
    }
    o.sqrt(norm)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dvector;
    use pulp::Scalar;

    /// Pseudo-random entries in the unit square.
    fn noise(rows: usize, columns: usize, seed: u64) -> DMatrix<Complex<f64>> {
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1u32 << 30) - 1.0
        };
        DMatrix::from_fn(rows, columns, |_, _| Complex::new(next(), next()))
    }

    fn start(n: usize) -> DVector<Complex<f64>> {
        DVector::from_fn(n, |i, _| Complex::from_polar(1.0, (i * i) as f64))
    }

    fn found(matrices: &[DMatrix<Complex<f64>>]) -> Vec<Option<NullVector>> {
        let found = null_vectors::<1>(matrices, &start(matrices[0].nrows()), &mut Vec::new());
        found.into_iter().map(|found| found.map(|[right]| right)).collect()
    }

    /// `A (I - x x^H)` annihilates x, and no other vector.
    fn singular(n: usize, seed: u64) -> (DMatrix<Complex<f64>>, DVector<Complex<f64>>) {
        let x = noise(n, 1, seed + 1000).column(0).normalize();
        (noise(n, n, seed) * (DMatrix::identity(n, n) - &x * x.adjoint()), x)
    }

    #[test]
    fn the_vector_that_a_singular_matrix_annihilates_is_found_in_every_lane() {
        for n in [2, 3, 10, 31] {
            let (matrices, vectors): (Vec<_>, Vec<_>) = (0..11).map(|seed| singular(n, seed)).unzip();
            for ((matrix, x), found) in matrices.iter().zip(vectors).zip(found(&matrices)) {
                let (found, factored) = (found.unwrap(), by_factors(matrix, &start(n)).unwrap());
                assert!((1.0 - factored.vector.dotc(&x).norm()).abs() < 1e-12, "n = {n}");
                assert!(factored.residuals[1] < 1e-13 * matrix.norm(), "n = {n}");
                assert!((1.0 - found.vector.dotc(&x).norm()).abs() < 1e-12, "n = {n}");
                assert!((matrix * &found.vector).norm() < 1e-13 * matrix.norm(), "n = {n}");
                assert!(found.residuals[1] < 1e-13 * matrix.norm(), "n = {n}");
            }
        }
    }

    #[test]
    fn both_sides_come_from_one_factorisation() {
        // As many columns as are finished together, fewer, and some more.
        for n in [2, 4, 7, 10, 31] {
            let matrices: Vec<_> = (0..11).map(|seed| singular(n, seed).0).collect();
            let both = null_vectors::<2>(&matrices, &start(n), &mut Vec::new());
            for ((matrix, both), alone) in matrices.iter().zip(both).zip(found(&matrices)) {
                let [right, left] = both.unwrap();
                assert_eq!(Some(right), alone);
                let expected = null_vectors::<1>(&[matrix.adjoint()], &start(n), &mut Vec::new()).remove(0).unwrap();
                assert!((1.0 - left.vector.dotc(&expected[0].vector).norm()).abs() < 1e-12, "n = {n}");
                assert!((matrix.ad_mul(&left.vector)).norm() < 1e-13 * matrix.norm(), "n = {n}");
                assert!(left.residuals[1] < 1e-13 * matrix.norm(), "n = {n}");
            }
        }
    }

    #[test]
    fn without_a_null_vector_it_is_the_one_of_the_smallest_singular_value() {
        let matrix = DMatrix::from_diagonal(&dvector![3.0, 0.01, 2.0].map(Complex::from));
        for found in [found(std::slice::from_ref(&matrix)).remove(0), by_factors(&matrix, &start(3))] {
            let NullVector { vector, residuals } = found.unwrap();
            assert!((vector[1].norm() - 1.0).abs() < 1e-8 && (residuals[1] - 0.01).abs() < 1e-8);
        }
    }

    #[test]
    fn exact_zeros_on_the_diagonal_of_r_are_no_obstacle() {
        let mut nothing = DMatrix::zeros(4, 4);
        assert!(found(&[nothing.clone()])[0].is_none());
        nothing[(0, 0)] = Complex::from(1.0);
        nothing[(1, 2)] = Complex::from(5.0);
        let found = found(&[nothing.clone()]).remove(0).unwrap();
        assert!((nothing * found.vector).norm() < 1e-12);
    }

    #[test]
    fn a_vector_depends_neither_on_its_lane_nor_on_its_neighbours() {
        let mut matrices: Vec<_> = (0..9).map(|seed| singular(7, seed).0).collect();
        let alone: Vec<_> = matrices.iter().map(|matrix| found(std::slice::from_ref(matrix)).remove(0)).collect();
        assert_eq!(found(&matrices), alone);
        matrices[3][(2, 2)] = Complex::from(f64::NAN);
        for (k, (found, alone)) in found(&matrices).into_iter().zip(alone).enumerate() {
            assert_eq!(found, if k == 3 { None } else { alone }, "matrix {k}");
        }
    }

    #[test]
    fn a_machine_without_vector_units_finds_the_same_up_to_rounding() {
        let matrices: Vec<_> = (0..3).map(|seed| singular(12, seed).0).collect();
        let kernel = NullVectorsInLanes::<1> { matrices: &matrices, start: &start(12), scratch: &mut Vec::new() };
        for (portable, best) in Simd::vectorize(Scalar, kernel).into_iter().zip(found(&matrices)) {
            assert!((portable.unwrap()[0].vector.dotc(&best.unwrap().vector).norm() - 1.0).abs() < 1e-12);
        }
    }
}
