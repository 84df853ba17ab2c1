//! The characteristic polynomial of a structure with feedback at many points, one point per lane.
//!
//! `det Q(sigma) = prod_k (sigma - p_k)(sigma - conj p_k) det(I + p G(sigma) + sigma v(sigma) H(sigma))` up to the constant
//! det M: the m x m sums G and H over the modes of the structure, then the determinant of one m x m matrix. The sums cost
//! 3 m^2 n fused multiply-adds for each of the two parts of a complex number.

use certified::lanes::{ComplexLanes, Ops, fma, narrow, neg, registers, scale, square, times, wide_part};
use nalgebra::DMatrix;
use num_complex::Complex;
use pulp::{Arch, Simd, WithSimd, bytemuck};

use super::resolvent::Resolvent;
use crate::Workspace;

#[cfg(test)]
mod tests;

/// Number of entries of G or H that are summed together, so that each mode is loaded once for all of them.
const SIDE_BY_SIDE: usize = 4;
/// Least squared distance of a point from an eigenvalue of the structure, in the resolvent's unit squared: a nearer point is
/// evaluated as if at this distance, 5e-12. Chosen: at smaller distances values may be rounding errors, and the change is half of
/// the enclosure's reserve for rounding.
const AT_POLE: f64 = 2.5e-23;

/// A point of the complex plane and the feedback there, in the units of a resolvent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Point {
    pub sigma: Complex<f64>,
    /// p, the proportional gain.
    pub mu: f64,
    /// v(sigma).
    pub slope: Complex<f64>,
}

/// The characteristic polynomial at each point, divided by `(sigma + decay)^m` where the feedback has internal states.
pub(crate) fn characteristic(
    resolvent: &Resolvent,
    points: &[Point],
    work: &mut Workspace,
    out: &mut Vec<Complex<f64>>,
) {
    out.clear();
    run(resolvent, points, work, &mut ResponseOutput::Values(out));
}

/// `I + p G + sigma v H` at each point.
pub(crate) fn secular_matrices(
    resolvent: &Resolvent,
    points: &[Point],
    work: &mut Workspace,
) -> Vec<DMatrix<Complex<f64>>> {
    let mut matrices = Vec::with_capacity(points.len());
    run(resolvent, points, work, &mut ResponseOutput::Matrices(&mut matrices));
    matrices
}

fn run(resolvent: &Resolvent, points: &[Point], work: &mut Workspace, results: &mut ResponseOutput<'_>) {
    let (arch, scratch) = (Arch::new(), &mut work.scratch);
    work.counters.secular_values += points.len() as u64;
    let (wide, few) = points.split_at(wide_part(points.len()));
    if !wide.is_empty() {
        arch.dispatch(ResponsesInLanes { resolvent, points: wide, scratch, results });
    }
    if !few.is_empty() {
        narrow(arch, ResponsesInLanes { resolvent, points: few, scratch, results });
    }
}

enum ResponseOutput<'a> {
    Values(&'a mut Vec<Complex<f64>>),
    Matrices(&'a mut Vec<DMatrix<Complex<f64>>>),
}

struct ResponsesInLanes<'a, 'b> {
    resolvent: &'a Resolvent,
    points: &'a [Point],
    scratch: &'a mut Vec<f64>,
    results: &'a mut ResponseOutput<'b>,
}

impl WithSimd for ResponsesInLanes<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (o, lanes) = (Ops::new(simd), S::F64_LANES);
        let Resolvent { poles, ports, reading, mobility, .. } = self.resolvent;
        let (n, m) = (poles.len(), *ports);
        let registers = registers::<S>(self.scratch, 4 * n + 4 * m * m);
        let (modes, rest) = registers.split_at_mut(4 * n);
        let (modes, _) = modes.as_chunks_mut::<4>();
        let (matrix, sums) = rest.as_chunks_mut::<2>().0.split_at_mut(m * m);
        for points in self.points.chunks(lanes) {
            let [re, im, mu, slope_re, slope_im] = gather::<S>(o, points);
            let sigma = [re, im];
            let product = fill(o, sigma, poles, modes);
            add_up(o, modes, reading, matrix);
            for entry in &mut *matrix {
                *entry = scale(o, *entry, mu);
            }
            if points.iter().any(|point| point.slope != Complex::default()) {
                let half = &mut sums[..m * (m + 1) / 2];
                add_up(o, modes, mobility, half);
                let slope = times(o, [slope_re, slope_im], sigma);
                let mut upper = half.iter();
                for i in 0..m {
                    for (j, &sum) in (i..m).zip(upper.by_ref()) {
                        matrix[i * m + j] = fma(o, slope, sum, matrix[i * m + j]);
                        if i != j {
                            matrix[j * m + i] = fma(o, slope, sum, matrix[j * m + i]);
                        }
                    }
                }
            }
            for diagonal in matrix.iter_mut().step_by(m + 1) {
                diagonal[0] = o.add(diagonal[0], o.splat(1.0));
            }
            match &mut *self.results {
                ResponseOutput::Values(values) => {
                    let value = times(o, determinant(o, matrix, m), product);
                    let numbers: &[f64] = bytemuck::cast_slice(&value);
                    for lane in 0..points.len() {
                        values.push(Complex::new(numbers[lane], numbers[lanes + lane]));
                    }
                }
                ResponseOutput::Matrices(matrices) => {
                    let numbers: &[f64] = bytemuck::cast_slice(matrix);
                    for lane in 0..points.len() {
                        let at = |i: usize, j: usize| 2 * (i * m + j) * lanes + lane;
                        matrices.push(DMatrix::from_fn(m, m, |i, j| {
                            Complex::new(numbers[at(i, j)], numbers[at(i, j) + lanes])
                        }));
                    }
                }
            }
        }
    }
}

/// The numbers of one point in each lane; the spare lanes hold the first point.
#[inline(always)]
fn gather<S: Simd>(o: Ops<S>, points: &[Point]) -> [S::f64s; 5] {
    let mut registers = [o.splat(0.0); 5];
    let numbers: &mut [f64] = bytemuck::cast_slice_mut(&mut registers);
    for lane in 0..S::F64_LANES {
        let Point { sigma, mu, slope } = points.get(lane).unwrap_or(&points[0]);
        let of_point = [sigma.re, sigma.im, *mu, slope.re, slope.im];
        for (register, number) in of_point.into_iter().enumerate() {
            numbers[register * S::F64_LANES + lane] = number;
        }
    }
    registers
}

/// For each mode `d = 1 / ((sigma - p)(sigma - conj p))` and `sigma d`; returns the product of all 1 / d.
#[inline(always)]
fn fill<S: Simd>(
    o: Ops<S>,
    sigma: ComplexLanes<S>,
    poles: &[Complex<f64>],
    modes: &mut [[S::f64s; 4]],
) -> ComplexLanes<S> {
    let (one, floor) = (o.splat(1.0), o.splat(AT_POLE));
    let mut product = [one, o.splat(0.0)];
    for (pole, mode) in poles.iter().zip(modes) {
        let re = o.sub(sigma[0], o.splat(pole.re));
        let near = [re, o.sub(sigma[1], o.splat(pole.im))];
        let is_there = o.lt(square(o, near, o.splat(0.0)), floor);
        let near = [o.select(is_there, o.splat(AT_POLE.sqrt()), near[0]), near[1]];
        let both = times(o, near, [re, o.add(sigma[1], o.splat(pole.im))]);
        product = times(o, product, both);
        let part = o.div(one, square(o, both, o.splat(0.0)));
        let d = [o.mul(both[0], part), o.neg(o.mul(both[1], part))];
        let e = times(o, sigma, d);
        *mode = [d[0], d[1], e[0], e[1]];
    }
    product
}

/// For each entry the sum of `U sigma d + V d` over the modes.
#[inline(always)]
fn add_up<S: Simd>(o: Ops<S>, modes: &[[S::f64s; 4]], parts: &[[f64; 2]], sums: &mut [[S::f64s; 2]]) {
    let (n, side_by_side) = (modes.len(), sums.len() - sums.len() % SIDE_BY_SIDE);
    let (sums, rest) = sums.split_at_mut(side_by_side);
    for (sums, parts) in sums.chunks_exact_mut(SIDE_BY_SIDE).zip(parts.chunks_exact(SIDE_BY_SIDE * n.max(1))) {
        add_up_some::<S, SIDE_BY_SIDE>(o, modes, parts, sums);
    }
    for (sums, parts) in rest.chunks_exact_mut(1).zip(parts[side_by_side * n..].chunks_exact(n.max(1))) {
        add_up_some::<S, 1>(o, modes, parts, sums);
    }
}

#[inline(always)]
fn add_up_some<S: Simd, const N: usize>(
    o: Ops<S>,
    modes: &[[S::f64s; 4]],
    parts: &[[f64; 2]],
    sums: &mut [[S::f64s; 2]],
) {
    let mut of = [[o.splat(0.0); 2]; N];
    let n = modes.len();
    for (k, &[d_re, d_im, e_re, e_im]) in modes.iter().enumerate() {
        for i in 0..N {
            let [u, v] = parts[i * n + k];
            let (u, v) = (o.splat(u), o.splat(v));
            of[i][0] = o.fma(u, e_re, o.fma(v, d_re, of[i][0]));
            of[i][1] = o.fma(u, e_im, o.fma(v, d_im, of[i][1]));
        }
    }
    sums.copy_from_slice(&of);
}

/// The determinant by elimination with partial pivoting, each lane with its own pivots; the matrix is overwritten. Apart from
/// [`certified::lu`]: one small matrix in each lane.
#[inline(always)]
fn determinant<S: Simd>(o: Ops<S>, matrix: &mut [[S::f64s; 2]], m: usize) -> ComplexLanes<S> {
    let mut product = [o.splat(1.0), o.splat(0.0)];
    for c in 0..m {
        for i in c + 1..m {
            let (below, pivot) = (matrix[i * m + c], matrix[c * m + c]);
            let is_larger = o.lt(o.add(o.abs(pivot[0]), o.abs(pivot[1])), o.add(o.abs(below[0]), o.abs(below[1])));
            for j in c..m {
                let (upper, lower) = (matrix[c * m + j], matrix[i * m + j]);
                for part in 0..2 {
                    matrix[c * m + j][part] = o.select(is_larger, lower[part], upper[part]);
                    // Of two exchanged rows one changes its sign, which keeps the determinant.
                    matrix[i * m + j][part] = o.select(is_larger, o.neg(upper[part]), lower[part]);
                }
            }
        }
        let pivot = matrix[c * m + c];
        product = times(o, product, pivot);
        let part = o.div(o.splat(1.0), square(o, pivot, o.splat(0.0)));
        let inverse = [o.mul(pivot[0], part), o.neg(o.mul(pivot[1], part))];
        let (above, rest) = matrix.split_at_mut((c + 1) * m);
        let row = &above[c * m..];
        for other in rest.chunks_exact_mut(m) {
            let factor = neg(o, times(o, other[c], inverse));
            for j in c + 1..m {
                other[j] = fma(o, factor, row[j], other[j]);
            }
        }
    }
    product
}
