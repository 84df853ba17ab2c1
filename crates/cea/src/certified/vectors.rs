//! One factorisation of the scaled Q(sigma) near an eigenvalue, and the null vectors it gives from both sides.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use pulp::{Arch, Simd, WithSimd};

use super::scaled::Scaled;
use crate::lanes::Ops;

/// Rounds with one factorisation; the second nearly always changes nothing.
const NULL_PAIR_ROUNDS: usize = 2;

/// Columns eliminated before those to their right are: few enough that a panel of 500 rows stays in the cache. Chosen.
const PANEL: usize = 16;

/// Least pivot whose square does not underflow, as complex division needs.
pub(crate) const LEAST_PIVOT: f64 = 1e-150;

pub(crate) type Vector = DVector<Complex<f64>>;

/// `P A = L U` by partial pivoting, with solves from both sides.
#[derive(Debug)]
pub(crate) struct Lu {
    /// Real and imaginary parts apart: the inner loop vectorises.
    re: DMatrix<f64>,
    im: DMatrix<f64>,
    /// Row swapped with row k at step k.
    swaps: Vec<usize>,
}

impl Lu {
    /// A pivot below `least` is replaced by it: a perturbation of that size makes A regular.
    ///
    /// [`PANEL`] columns at a time are eliminated, and then what they change in the columns to their right.
    pub(crate) fn new(a: &DMatrix<Complex<f64>>, least: f64) -> Self {
        Self::of_parts([a.map(|z| z.re), a.map(|z| z.im)], least)
    }

    /// [`new`](Self::new) of a matrix whose real and imaginary parts stand apart.
    pub(crate) fn of_parts([mut re, mut im]: [DMatrix<f64>; 2], least: f64) -> Self {
        let n = re.nrows();
        let mut swaps = Vec::with_capacity(n);
        let arch = Arch::new();
        for start in (0..n).step_by(PANEL) {
            let end = n.min(start + PANEL);
            for k in start..end {
                swaps.push(eliminate(&mut re, &mut im, k, end, least));
            }
            let (panel_re, right_re) = re.as_mut_slice().split_at_mut(end * n);
            let (panel_im, right_im) = im.as_mut_slice().split_at_mut(end * n);
            let panel = [&panel_re[start * n..], &panel_im[start * n..]];
            arch.dispatch(UpdateRight { n, start, end, panel, right: [right_re, right_im] });
        }
        Self { re, im, swaps }
    }

    fn at(&self, i: usize, j: usize) -> Complex<f64> {
        Complex::new(self.re[(i, j)], self.im[(i, j)])
    }

    /// x := A^-1 x.
    pub(crate) fn solve(&self, x: &mut Vector) {
        let n = x.len();
        for (k, &pivot) in self.swaps.iter().enumerate() {
            x.swap_rows(k, pivot);
        }
        for k in 0..n {
            self.subtract_column(k, k + 1..n, x[k], x);
        }
        for k in (0..n).rev() {
            x[k] /= self.at(k, k);
            self.subtract_column(k, 0..k, x[k], x);
        }
    }

    /// x -= column k times `head`, in some rows.
    fn subtract_column(&self, k: usize, rows: Range<usize>, head: Complex<f64>, x: &mut Vector) {
        let (re, im) = (self.re.column(k), self.im.column(k));
        let factors = re.as_slice()[rows.clone()].iter().zip(&im.as_slice()[rows.clone()]);
        for (z, (&re, &im)) in x.as_mut_slice()[rows].iter_mut().zip(factors) {
            *z -= Complex::new(re, im) * head;
        }
    }

    /// The sum of conjugate entries of column k times x, in some rows.
    fn column_dot(&self, k: usize, rows: Range<usize>, x: &Vector) -> Complex<f64> {
        let (re, im) = (self.re.column(k), self.im.column(k));
        let factors = re.as_slice()[rows.clone()].iter().zip(&im.as_slice()[rows.clone()]);
        x.as_slice()[rows].iter().zip(factors).map(|(z, (&re, &im))| Complex::new(re, -im) * z).sum()
    }

    /// x := A^-H x.
    pub(crate) fn solve_adjoint(&self, x: &mut Vector) {
        let n = x.len();
        for k in 0..n {
            let sum = self.column_dot(k, 0..k, x);
            x[k] = (x[k] - sum) / self.at(k, k).conj();
        }
        for k in (0..n).rev() {
            let sum = self.column_dot(k, k + 1..n, x);
            x[k] -= sum;
        }
        for (k, &pivot) in self.swaps.iter().enumerate().rev() {
            x.swap_rows(k, pivot);
        }
    }
}

/// Column k eliminated, in the columns before `end`; the row that was swapped with row k.
fn eliminate(re: &mut DMatrix<f64>, im: &mut DMatrix<f64>, k: usize, end: usize, least: f64) -> usize {
    let n = re.nrows();
    let size = |i: usize| re[(i, k)].abs() + im[(i, k)].abs();
    let pivot = (k..n).fold(k, |best, i| if size(i) > size(best) { i } else { best });
    re.swap_rows(k, pivot);
    im.swap_rows(k, pivot);
    let mut head = Complex::new(re[(k, k)], im[(k, k)]);
    if head.norm() < least {
        head = Complex::from(least);
        (re[(k, k)], im[(k, k)]) = (least, 0.0);
    }
    let inverse = head.inv();
    for i in k + 1..n {
        let l = Complex::new(re[(i, k)], im[(i, k)]) * inverse;
        (re[(i, k)], im[(i, k)]) = (l.re, l.im);
    }
    for j in k + 1..end {
        let (ur, ui) = (re[(k, j)], im[(k, j)]);
        for i in k + 1..n {
            let (lr, li) = (re[(i, k)], im[(i, k)]);
            re[(i, j)] -= lr * ur - li * ui;
            im[(i, j)] -= lr * ui + li * ur;
        }
    }
    pivot
}

/// The columns right of a panel of L: its triangle solved, and what is below it subtracted.
struct UpdateRight<'a> {
    n: usize,
    /// The panel's first column, and the first one after it.
    start: usize,
    end: usize,
    panel: [&'a [f64]; 2],
    right: [&'a mut [f64]; 2],
}

impl WithSimd for UpdateRight<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { n, start, end, panel, right: [re, im] } = self;
        let o = Ops(simd);
        let (mut fours_re, mut fours_im) = (re.chunks_exact_mut(4 * n), im.chunks_exact_mut(4 * n));
        for (re, im) in fours_re.by_ref().zip(fours_im.by_ref()) {
            update::<4, S>(o, (n, start, end), panel, [re, im]);
        }
        let rest = fours_re.into_remainder().chunks_exact_mut(n).zip(fours_im.into_remainder().chunks_exact_mut(n));
        for (re, im) in rest {
            update::<1, S>(o, (n, start, end), panel, [re, im]);
        }
    }
}

/// [`UpdateRight`] for `COLUMNS` columns: enough of them hide how long one sum takes.
#[inline(always)]
fn update<const COLUMNS: usize, S: Simd>(
    o: Ops<S>,
    (n, start, end): (usize, usize, usize),
    [panel_re, panel_im]: [&[f64]; 2],
    [re, im]: [&mut [f64]; 2],
) {
    // Most of the matrices of finite elements is zero.
    let is_zero = |part: &[f64]| part.chunks_exact(n).all(|x| x[start..end].iter().all(|&x| x == 0.0));
    if is_zero(re) && is_zero(im) {
        return;
    }
    let mut upper = [[[0.0; 2]; COLUMNS]; PANEL];
    for (column, (re, im)) in re.chunks_exact_mut(n).zip(im.chunks_exact_mut(n)).enumerate() {
        for p in start..end {
            let (ur, ui) = (re[p], im[p]);
            upper[p - start][column] = [ur, ui];
            let left = (p - start) * n;
            for i in p + 1..end {
                let (lr, li) = (panel_re[left + i], panel_im[left + i]);
                re[i] -= lr * ur - li * ui;
                im[i] -= lr * ui + li * ur;
            }
        }
    }
    let mut at = end;
    while at < n {
        let next = n.min(at + S::F64_LANES);
        let mut sums = [[o.splat(0.0); 2]; COLUMNS];
        for (p, upper) in upper[..end - start].iter().enumerate() {
            let (lr, li) = (o.load(&panel_re[p * n + at..p * n + next]), o.load(&panel_im[p * n + at..p * n + next]));
            for (sum, u) in sums.iter_mut().zip(upper) {
                let (ur, ui) = (o.splat(u[0]), o.splat(u[1]));
                sum[0] = o.fnma(li, ui, o.fma(lr, ur, sum[0]));
                sum[1] = o.fma(li, ur, o.fma(lr, ui, sum[1]));
            }
        }
        for (column, sum) in sums.iter().enumerate() {
            let rows = column * n + at..column * n + next;
            for (part, &sum) in [&mut *re, &mut *im].into_iter().zip(sum) {
                let x = o.load(&part[rows.clone()]);
                o.store(&mut part[rows.clone()], o.sub(x, sum));
            }
        }
        at = next;
    }
}

/// The scaled Q at one sigma, factored.
#[derive(Debug)]
pub(crate) struct Factor<'a> {
    problem: &'a Scaled,
    sigma: Complex<f64>,
    lu: Lu,
}

impl<'a> Factor<'a> {
    pub(crate) fn new(problem: &'a Scaled, sigma: Complex<f64>) -> Self {
        Self::with_least_pivot(problem, sigma, f64::EPSILON * f64::EPSILON)
    }

    /// For several null vectors: no pivot is below a rounding error, or the first vector drowns the others.
    pub(crate) fn for_several(problem: &'a Scaled, sigma: Complex<f64>) -> Self {
        Self::with_least_pivot(problem, sigma, f64::EPSILON)
    }

    fn with_least_pivot(problem: &'a Scaled, sigma: Complex<f64>, relative: f64) -> Self {
        let least = relative * problem.norms.size(sigma.norm());
        let lu = Lu::of_parts(problem.polynomial_parts(sigma), least.max(LEAST_PIVOT));
        Self { problem, sigma, lu }
    }

    /// Orthonormal x and y, `count` of each, for the smallest singular values of Q(sigma): `Q x` and `Q^H y` are as
    /// small as they can be. None where they overflow.
    ///
    /// The iteration alternates between the sides, as it would for the eigenvectors of Q^H Q. Inverse iteration with Q
    /// alone leaves the vector again that it found in its first step where the eigenvalue is defective.
    pub(crate) fn null_pairs(&self, count: usize) -> Option<(Vec<Vector>, Vec<Vector>)> {
        let mut y: Vec<_> = (0..count).map(|v| self.start(v)).collect();
        let mut x = Vec::new();
        for _ in 0..NULL_PAIR_ROUNDS {
            x = y;
            x.iter_mut().for_each(|v| self.lu.solve(v));
            orthonormalise(&mut x)?;
            y = x.clone();
            y.iter_mut().for_each(|v| self.lu.solve_adjoint(v));
            orthonormalise(&mut y)?;
        }
        Some((x, y))
    }

    /// An estimate of the smallest singular value of Q(sigma).
    pub(crate) fn smallest(&self) -> f64 {
        self.null_pairs(1).map_or(f64::INFINITY, |(x, _)| self.residual(&x[0]).norm())
    }

    /// The inverse of Q(sigma) between the complements of y and x, its left and right null vectors, applied to g.
    pub(crate) fn deflated_solve(&self, x: &Vector, y: &Vector, mut g: Vector) -> Vector {
        g.axpy(-y.dotc(&g), y, Complex::from(1.0));
        self.lu.solve(&mut g);
        g.axpy(-x.dotc(&g), x, Complex::from(1.0));
        g
    }

    /// Without a symmetry to be orthogonal to the wanted vector by; real for a real sigma, as all that follows.
    fn start(&self, v: usize) -> Vector {
        DVector::from_fn(self.problem.order(), |i, _| {
            let angle = 2.399_963_229_728_653 * ((i + 1) * (i + 2) + 7 * v * (i + 1)) as f64;
            let z = Complex::from_polar(1.0 + 0.1 * (i % 3) as f64, angle);
            if self.sigma.im == 0.0 { Complex::from(z.re) } else { z }
        })
    }

    /// `Q(sigma) x`.
    pub(crate) fn residual(&self, x: &Vector) -> Vector {
        self.problem.times(self.sigma, x)
    }
}

/// Vectors for the norm of a linear map, and how many times it may exceed what they show. If their phases were random it would
/// be more with a chance of at most 4e-6, and that only if a single vector has it all. Few vectors are cheap, many tell more:
/// the next line is for where the one before leaves a doubt.
pub(crate) const NORM_ESTIMATES: [(usize, f64); 3] = [(1, 1e3), (4, 16.0), (16, 2.0)];

/// The Frobenius norm of a linear map of n-vectors, from above: `safety` times what `probes` vectors of phases without a pattern
/// give, or exactly from the unit vectors where these are no more.
pub(crate) fn frobenius_norm(n: usize, (probes, safety): (usize, f64), apply: impl Fn(Vector) -> Vector) -> f64 {
    let squares = |count: usize, vector: &dyn Fn(usize) -> Vector| {
        (0..count).map(|k| apply(vector(k)).norm_squared()).sum::<f64>()
    };
    if n <= probes {
        return squares(n, &|k| Vector::from_fn(n, |i, _| Complex::from(f64::from(u8::from(i == k))))).sqrt();
    }
    // The golden angle times a polynomial of degree two, another one for each vector.
    let phases = |k: usize| {
        Vector::from_fn(n, |i, _| Complex::cis(2.399_963_229_728_653 * ((i + 1) * (i + 3 + 5 * k) + k * k) as f64))
    };
    safety * (squares(probes, &phases) / probes as f64).sqrt()
}

/// Gram and Schmidt, twice; nothing where a vector is not finite or depends on the others.
pub(crate) fn orthonormalise(block: &mut [Vector]) -> Option<()> {
    for v in 0..block.len() {
        let (done, rest) = block.split_at_mut(v);
        let x = rest.first_mut()?;
        let size = x.camax();
        if !(size > 0.0 && size.is_finite()) {
            return None;
        }
        x.unscale_mut(size);
        for _ in 0..2 {
            for other in &*done {
                let overlap = other.dotc(x);
                x.axpy(-overlap, other, Complex::from(1.0));
            }
            let norm = x.norm();
            if norm.is_nan() || norm <= 0.0 {
                return None;
            }
            x.unscale_mut(norm);
        }
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use linsys::SecondOrder;
    use nalgebra::dmatrix;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn both_solves_invert_the_matrix(entries in prop::collection::vec(-1.0..1.0f64, 60)) {
            let a = DMatrix::from_fn(5, 5, |i, j| Complex::new(entries[5 * i + j], entries[25 + 5 * i + j]));
            let b = DVector::from_fn(5, |i, _| Complex::new(entries[50 + i], entries[55 + i]));
            let lu = Lu::new(&a, 1e-300);
            prop_assume!(a.determinant().norm() > 1e-3);
            let (mut x, mut y) = (b.clone(), b.clone());
            lu.solve(&mut x);
            lu.solve_adjoint(&mut y);
            prop_assert!((&a * x - &b).norm() < 1e-10);
            prop_assert!((a.adjoint() * y - &b).norm() < 1e-10);
        }
    }

    #[test]
    fn a_matrix_of_several_panels_is_solved_from_both_sides() {
        let n = 3 * PANEL + 5;
        let wave = |i: usize, j: usize| ((5 * i + 11 * j * j + 3 * i * j) % 29) as f64 / 29.0 - 0.5;
        let a = DMatrix::from_fn(n, n, |i, j| Complex::new(wave(i, j), wave(j, i + 3)));
        let b = DVector::from_fn(n, |i, _| Complex::new(wave(i, 1), wave(2, i)));
        let lu = Lu::new(&a, 1e-300);
        let (mut x, mut y) = (b.clone(), b.clone());
        lu.solve(&mut x);
        lu.solve_adjoint(&mut y);
        assert!((&a * &x - &b).norm() < 1e-13 * a.norm() * x.norm());
        assert!((a.adjoint() * &y - &b).norm() < 1e-13 * a.norm() * y.norm());
    }

    #[test]
    fn a_double_eigenvalue_has_two_null_vectors_and_no_third() {
        let system = SecondOrder::new(
            DMatrix::identity(3, 3),
            DMatrix::zeros(3, 3),
            dmatrix![4.0, 0.0, 1.0; 0.0, 4.0, 1.0; 0.0, 0.0, 9.0],
        );
        let scaled = Scaled::new(&system.unwrap());
        let factor = Factor::new(&scaled, Complex::new(0.0, 2.0 / scaled.gamma));
        let sizes: Vec<f64> = factor.null_pairs(3).unwrap().0.iter().map(|x| factor.residual(x).norm()).collect();
        assert!(sizes[0] < 1e-15 && sizes[1] < 1e-15 && sizes[2] > 0.1, "{sizes:?}");
    }
}
