//! The argument principle: how many eigenvalues are in a circle, by the phase of det Q along it.
//!
//! `det Q(z) prod (z + a_i)` is a polynomial whose zeros are the eigenvalues. Divided by `prod (z - lambda_k)` over what is known, it
//! turns about zero as often as there are eigenvalues inside that are not known. What is known outside, however roughly, only makes the
//! phase smoother, so that few points are enough; and so does `exp(-p(z))` of any polynomial p, which has no zeros. The polynomial of degree 3
//! whose real part is nearest to `log |det Q ...|` along the circle stands for the thousands of eigenvalues far away: with damping
//! proportional to stiffness half of all are crowded in one place.
//!
//! Along a circle an eigenvalue inside that is not known turns the phase by half of the angle at least, everywhere, and p takes of that
//! only what varies slowly. Next to the circle whole turns of several may be overlooked between two points, but not the rest; along the
//! sides of a slender rectangle they could all be.

use std::f64::consts::TAU;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::{Mat, Spec};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::blocks::PAR;
use super::disc::Problem;
use super::factor::{Factor, sign};
use super::pencil::Pencil;
use super::types::{Circle, Count, Known};
use crate::SparseError;
use crate::unpatterned::unpatterned;

/// Number of points of a circle to begin with; chosen. Their distances differ by a factor of up to two, so that no number of eigenvalues at the
/// centre turns the phase by whole turns between all of them.
const FIRST_POINTS: usize = 10;
/// Number of points of a circle to begin with, where a count from fewer contradicts what is known; chosen: for a whole turn between two neighbours of so many,
/// eigenvalues have to be nearer to the circle than a search leaves any unknown.
const MORE_POINTS: usize = 50;
/// Degree of the polynomial that stands for the logarithm of all far away; chosen: so few that nothing next to the circle is in it.
const DEGREE: usize = 3;
/// Largest change of the phase between two neighbours, rad, between which no further point is taken; chosen: with less, a circle takes more points, each a
/// factorisation; with more, a change by nearly a whole turn is more easily taken for a small one.
const LARGEST_CHANGE: f64 = 0.8;
/// Most points of one circle; chosen: each is a factorisation. With fewer a circle near eigenvalues is given up, with more one along which rounding turns the
/// phase is looked at for long.
const MOST_POINTS: usize = 200;
/// Circles that are tried about one centre; chosen: two that differ in the same way, or all in one direction, are believed. With fewer rounding next to one
/// leaves the count open, with more a count that rounding spoils takes longer.
const CIRCLES: usize = 4;
/// Least distance of a circle that is clear of an eigenvalue, in error bounds of the eigenvalue; beyond that [`CLEAR`]. Chosen: the phase turns fast next to an
/// eigenvalue, so that a nearer circle takes more points; and with more there may be no circle that is clear.
const BOUNDS: f64 = 1e3;
/// Least distance of a circle that is clear of an eigenvalue, beyond [`BOUNDS`], as a fraction of its radius; chosen likewise.
const CLEAR: f64 = 1e-6;
/// Most degrees of freedom of a determinant by a dense matrix, where the sparse one has too small pivots; chosen: some tenths of a second.
const DENSE: usize = 1000;

/// Circles about one centre, of which the first that is clear of eigenvalues is counted along; rad/s.
pub(super) struct Around<'a> {
    pub(super) centre: Complex<f64>,
    pub(super) radii: &'a [f64],
    /// The eigenvalues that are known: all known ones inside, and any number outside.
    pub(super) known: &'a [Known],
    /// True if all copies of each are known: where not, more of them are no contradiction.
    pub(super) is_all: bool,
}

/// Eigenvalues, counted along circles.
pub(super) struct Counting<'a> {
    problem: &'a Problem,
    /// The unit of time of the problem, rad/s.
    gamma: f64,
    /// True if the matrices are small enough to be full.
    is_dense: bool,
    circles: Vec<Circle>,
    points: usize,
    is_clear: bool,
}

impl<'a> Counting<'a> {
    pub(super) fn new(problem: &'a Problem, gamma: f64, is_dense: bool) -> Self {
        Self { problem, gamma, is_dense, circles: Vec::new(), points: 0, is_clear: true }
    }

    /// Counts along one of the circles.
    ///
    /// # Errors
    /// [`SparseError::CountsDiffer`] where det Q has more or fewer zeros inside than are known.
    pub(super) fn add(&mut self, around: &Around<'_>) -> Result<(), SparseError> {
        self.is_clear &= self.agrees(around)?;
        Ok(())
    }

    /// True if det Q has as many zeros as are known inside one of the circles; false where rounding turns the phase along all of them.
    ///
    /// # Errors
    /// [`SparseError::CountsDiffer`] where there are more or fewer.
    pub(super) fn agrees(&mut self, around: &Around<'_>) -> Result<bool, SparseError> {
        let mut differing: Vec<(f64, i64)> = Vec::new();
        for tried in 0..CIRCLES {
            let radius = around.clear_radius(tried);
            let Some(mut excess) = self.excess(around, radius, FIRST_POINTS) else { continue };
            // A row of eigenvalues along one side may turn the phase by a whole turn between two of a few points.
            if excess != 0 {
                let Some(again) = self.excess(around, radius, MORE_POINTS) else { continue };
                excess = again;
            }
            let (centre, inside) = (around.centre, |known: &&Known| (known.lambda - around.centre).norm() < radius);
            let eigenvalues = around.known.iter().filter(inside).count();
            // det Q has no poles: phases that say so turned by rounding.
            if eigenvalues as i64 + excess < 0 {
                continue;
            }
            if excess == 0 {
                self.circles.push(Circle { centre, radius, eigenvalues });
                return Ok(true);
            }
            // Rounding that turns the phase next to one circle does not at two in the same way, nor at all of them in one direction.
            let is_same = differing.last().is_some_and(|&(other, last)| other != radius && last == excess);
            differing.push((radius, excess));
            let are_all =
                differing.len() == CIRCLES && differing.iter().all(|(_, other)| other.signum() == excess.signum());
            if (is_same || are_all) && (around.is_all || excess < 0) {
                let counted = (eigenvalues as i64 + excess) as usize;
                return Err(SparseError::CountsDiffer { listed: eigenvalues, counted, centre, radius });
            }
        }
        Ok(false)
    }

    /// The count along all circles.
    pub(super) fn done(self) -> Count {
        match self {
            Self { is_clear: true, circles, points, .. } => Count::Argument { circles, points },
            _ => Count::Unclear,
        }
    }

    /// Number of eigenvalues inside less the number of known eigenvalues inside, from `first` points to begin with; `None` where the phase jumps.
    fn excess(&mut self, around: &Around<'_>, radius: f64, first: usize) -> Option<i64> {
        let at = |angle: f64| around.centre + Complex::from_polar(radius, angle);
        let irregular = |i: usize| (i as f64 + unpatterned(i as f64) / 3.0) * TAU / first as f64;
        let mut wanted: Vec<f64> = (0..first).map(irregular).collect();
        let mut samples: Vec<(f64, Complex<f64>)> = Vec::new();
        loop {
            if samples.len() + wanted.len() > MOST_POINTS {
                return None;
            }
            for angle in wanted {
                samples.push((angle, self.logarithm(at(angle), around.known)?));
            }
            samples.sort_by(|a, b| a.0.total_cmp(&b.0));
            let phases = without_smooth(&samples)?;
            let next = |i: usize| if i + 1 < phases.len() { i + 1 } else { 0 };
            let changes: Vec<f64> = (0..phases.len()).map(|i| wrapped(phases[next(i)] - phases[i])).collect();
            let between = |(i, change): (usize, &f64)| {
                let to = samples[next(i)].0 + if next(i) == 0 { TAU } else { 0.0 };
                (change.abs() > LARGEST_CHANGE).then_some(0.5 * (samples[i].0 + to))
            };
            wanted = changes.iter().enumerate().filter_map(between).collect();
            if wanted.is_empty() {
                return Some((changes.iter().sum::<f64>() / TAU).round() as i64);
            }
        }
    }

    /// The logarithm of det Q at z divided by the known factors, but for whole turns; `None` where Q is singular or its determinant is not to be had.
    fn logarithm(&mut self, z: Complex<f64>, known: &[Known]) -> Option<Complex<f64>> {
        self.points += 1;
        let (sigma, pencil) = (z / self.gamma, &self.problem.pencil);
        let states: Complex<f64> = pencil.states().iter().map(|state| (sigma + state.decay).ln()).sum();
        let known: Complex<f64> = known.iter().map(|k| (z - k.lambda).ln()).sum();
        let own = if self.is_dense { dense_logarithm(pencil, sigma) } else { sparse_logarithm(self.problem, sigma) };
        Some(own? + states - known).filter(|logarithm| logarithm.is_finite())
    }
}

/// The imaginary parts of logarithms along a circle, less the imaginary parts of the polynomial whose real parts are nearest to the real parts of the
/// logarithms.
fn without_smooth(samples: &[(f64, Complex<f64>)]) -> Option<Vec<f64>> {
    let mean = samples.iter().map(|(_, value)| value.re).sum::<f64>() / samples.len() as f64;
    let column = |angle: f64, j: usize| match (j.div_ceil(2), j % 2) {
        (0, _) => Complex::from(1.0),
        (k, 1) => Complex::from_polar(1.0, k as f64 * angle),
        (k, _) => Complex::from_polar(1.0, k as f64 * angle) * Complex::i(),
    };
    let a = DMatrix::from_fn(samples.len(), 2 * DEGREE + 1, |i, j| column(samples[i].0, j).re);
    let b = DVector::from_fn(samples.len(), |i, _| samples[i].1.re - mean);
    let coefficients = a.svd(true, true).solve(&b, f64::EPSILON).ok()?;
    let smooth = |angle: f64| coefficients.iter().enumerate().map(|(j, c)| c * column(angle, j).im).sum::<f64>();
    Some(samples.iter().map(|&(angle, value)| value.im - smooth(angle)).collect())
}

impl Around<'_> {
    /// Number `skipped`, from 0, of the radii that are clear of the known eigenvalues ([`BOUNDS`], [`CLEAR`]); where not so many are clear, the radius
    /// whose circle is farthest from them.
    fn clear_radius(&self, skipped: usize) -> f64 {
        let clearance = |radius: f64| {
            let own = |k: &Known| ((k.lambda - self.centre).norm() - radius).abs() - BOUNDS * k.bound;
            self.known.iter().map(own).fold(f64::INFINITY, f64::min)
        };
        let clear = self.radii.iter().copied().filter(|&radius| clearance(radius) > CLEAR * radius);
        let best = || self.radii.iter().copied().max_by(|a, b| clearance(*a).total_cmp(&clearance(*b)));
        clear.clone().nth(skipped).or_else(best).unwrap_or(0.0)
    }
}

/// The angle itself but for whole turns, from -pi to pi.
fn wrapped(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

/// The logarithm of det Q(sigma), by its sparse factors; `None` where Q is singular, or needs pivots that these do not have.
fn sparse_logarithm(problem: &Problem, sigma: Complex<f64>) -> Option<Complex<f64>> {
    let factor = Factor::new(&problem.symbolic, &problem.pencil, sigma).ok()?;
    factor.determinant().or_else(|| {
        drop(factor);
        (problem.pencil.order() <= DENSE).then(|| dense_logarithm(&problem.pencil, sigma))?
    })
}

/// The logarithm of det Q(sigma), by LU of the full matrix; `None` where a pivot is zero.
fn dense_logarithm(pencil: &Pencil, sigma: Complex<f64>) -> Option<Complex<f64>> {
    let n = pencil.order();
    let values = pencil.values(&pencil.weights(sigma));
    let (starts, rows) = pencil.pattern();
    let mut q = Mat::<Complex<f64>>::zeros(n, n);
    for column in 0..n {
        (starts[column]..starts[column + 1]).for_each(|at| q[(rows[at], column)] = values[at]);
    }
    let (mut pivots, mut inverse) = (vec![0_usize; n], vec![0; n]);
    let mut buffer = MemBuffer::new(lu_in_place_scratch::<usize, Complex<f64>>(n, n, PAR, Spec::default()));
    lu_in_place(q.as_mut(), &mut pivots, &mut inverse, PAR, MemStack::new(&mut buffer), Spec::default());
    let logarithm = sign(&pivots) + (0..n).map(|i| q[(i, i)].ln()).sum::<Complex<f64>>();
    logarithm.is_finite().then_some(logarithm)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use nalgebra::DMatrix;
    use nalgebra_sparse::CscMatrix;

    use super::*;
    use crate::SparseSecondOrder;

    /// A chain without any symmetry, and rows that all couple.
    fn chain(n: usize) -> SparseSecondOrder {
        let value = |i: usize, j: usize| unpatterned((1 + i * n + j) as f64) - 0.5;
        let k = DMatrix::from_fn(n, n, |i, j| if i.abs_diff(j) < 4 || i.max(j) < 9 { value(i, j) } else { 0.0 });
        let c = DMatrix::from_fn(n, n, |i, j| if i == j { 0.1 } else { 0.0 });
        let [m, c, k] = [DMatrix::identity(n, n), c, k].map(|a| CscMatrix::from(&a));
        SparseSecondOrder::new(m, c, k).unwrap()
    }

    #[test]
    fn the_determinant_of_sparse_factors_is_that_of_the_full_matrix() {
        let problem = Problem::new(&chain(60)).unwrap();
        for sigma in [Complex::new(0.1, 0.3), Complex::new(-0.7, 1.1), Complex::new(0.4, -0.9)] {
            let [sparse, dense] = [sparse_logarithm(&problem, sigma), dense_logarithm(&problem.pencil, sigma)];
            let difference = sparse.unwrap() - dense.unwrap();
            assert!(difference.re.abs() < 1e-9 && wrapped(difference.im).abs() < 1e-9, "{sigma}: {difference}");
        }
    }
}
