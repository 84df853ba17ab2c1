//! Factorisation of the scaled Q(sigma) near an eigenvalue, and the null vectors it gives from both sides.

use nalgebra::DVector;
use num_complex::Complex;

use super::scaled::Scaled;
use crate::lu::{LEAST_PIVOT, Lu, Vector};

/// Rounds with one factorisation; the second nearly always changes nothing.
const NULL_PAIR_ROUNDS: usize = 2;

/// The scaled Q at one sigma, factored.
#[derive(Debug)]
pub(crate) struct Factor<'a> {
    pub(super) problem: &'a Scaled,
    pub(super) sigma: Complex<f64>,
    lu: Lu,
}

impl<'a> Factor<'a> {
    pub(crate) fn new(problem: &'a Scaled, sigma: Complex<f64>) -> Self {
        Self::with_least_pivot(problem, sigma, f64::EPSILON * f64::EPSILON)
    }

    /// The factors for several null vectors: no pivot is below a rounding error, or the first vector drowns the others.
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

    /// Number of pivots that are no larger than `limit`.
    pub(crate) fn pivots_up_to(&self, limit: f64) -> usize {
        self.lu.pivots_up_to(limit)
    }

    /// True if Q(sigma) leaves no more than `limit` of each of `count` orthonormal vectors.
    pub(crate) fn hides(&self, count: usize, limit: f64) -> bool {
        let mut x: Vec<_> = (0..count).map(|v| self.start(v)).collect();
        x.iter_mut().for_each(|v| self.lu.solve(v));
        orthonormalise(&mut x).is_some() && x.iter().all(|x| self.residual(x).norm() <= limit)
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

    /// The adjoint of [`deflated_solve`](Self::deflated_solve).
    pub(crate) fn deflated_solve_adjoint(&self, x: &Vector, y: &Vector, mut g: Vector) -> Vector {
        g.axpy(-x.dotc(&g), x, Complex::from(1.0));
        self.lu.solve_adjoint(&mut g);
        g.axpy(-y.dotc(&g), y, Complex::from(1.0));
        g
    }

    /// Starting vector without a symmetry to be orthogonal to the wanted one by; real for a real sigma, as all that follows.
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
const NORM_ESTIMATES: [(usize, f64); 3] = [(1, 1e3), (4, 16.0), (16, 2.0)];
/// Factor on what a random vector shows of a norm: the product exceeds the norm with a chance of 1e-10 at most, as the square of what a vector shows
/// exceeds r times the square of the norm with a chance of exp(-r) at most.
pub(super) const SURELY_SHOWN: f64 = 0.2;

/// Conclusion from the Frobenius norms of linear maps of n-vectors: `conclude` gets them from above, as well as the cheapest
/// estimate that suffices tells. What is not concluded from norms is not concluded from larger ones either: no more vectors are tried where those
/// tried leave nothing to conclude from the last estimate.
pub(crate) fn by_norms<const N: usize, R>(
    n: usize,
    maps: [&dyn Fn(Vector) -> Vector; N],
    conclude: impl Fn([f64; N]) -> Option<R>,
) -> Option<R> {
    let (mut squares, mut made) = ([0.0; N], 0);
    for (probes, safety) in NORM_ESTIMATES {
        if n <= probes {
            return conclude(maps.map(|map| shown_norm(n, probes, map)));
        }
        while made < probes {
            for (sum, map) in squares.iter_mut().zip(maps) {
                *sum += map(phases(n, made)).norm_squared();
            }
            made += 1;
            if made.is_power_of_two() {
                conclude(squares.map(|sum| least_conclusion(n, made, sum)))?;
            }
        }
        if let Some(found) = conclude(squares.map(|sum| safety * (sum / probes as f64).sqrt())) {
            return Some(found);
        }
    }
    None
}

/// Lower bound of the norm that [`by_norms`] concludes from at the end, whatever vectors are still to come: the whole norm, which is at least the norm of a
/// vector's image over the norm of the vector, or what the last line of [`NORM_ESTIMATES`] makes of the sum of squares.
fn least_conclusion(n: usize, made: usize, squares: f64) -> f64 {
    let (probes, safety) = NORM_ESTIMATES[NORM_ESTIMATES.len() - 1];
    if n <= probes { (squares / (made * n) as f64).sqrt() } else { safety * (squares / probes as f64).sqrt() }
}

/// Frobenius norm of a linear map as `probes` vectors of phases without a pattern show it, or all of it from the unit vectors
/// where these are no more.
pub(super) fn shown_norm(n: usize, probes: usize, map: &dyn Fn(Vector) -> Vector) -> f64 {
    let squares =
        |count: usize, vector: &dyn Fn(usize) -> Vector| (0..count).map(|k| map(vector(k)).norm_squared()).sum::<f64>();
    if n <= probes {
        return squares(n, &|k| Vector::from_fn(n, |i, _| Complex::from(f64::from(u8::from(i == k))))).sqrt();
    }
    (squares(probes, &|k| phases(n, k)) / probes as f64).sqrt()
}

/// The golden angle times a polynomial of degree two, another one for each vector.
fn phases(n: usize, k: usize) -> Vector {
    Vector::from_fn(n, |i, _| Complex::cis(2.399_963_229_728_653 * ((i + 1) * (i + 3 + 5 * k) + k * k) as f64))
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
    use nalgebra::{DMatrix, dmatrix};

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
