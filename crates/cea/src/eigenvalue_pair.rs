//! Pairs of eigenvalues near each other on a path, by their mean and the square of half their difference.
//!
//! Where two eigenvalues `m +- sqrt(s)` coalesce, each has a branch point; m and s are analytic there, as the coefficients of
//! the polynomial that has both as zeros (Kato, Perturbation Theory for Linear Operators, II.1.2). Both follow from the
//! characteristic polynomial on a circle about the pair: eight values determine its Taylor polynomial, of which Bairstow's
//! method (1914) splits off the quadratic factor with the two zeros.

use std::f64::consts::TAU;

use num_complex::Complex;

/// Step along the path of the differences that derivatives are computed by; chosen near the square root of machine epsilon.
const DIFFERENCE_STEP: f64 = 1e-7;
/// Number of values on the circle, and so of Taylor coefficients; chosen: a pair takes twice as many values of the function.
const CIRCLE_VALUES: usize = 8;
/// Radius of the circle, as a multiple of half the distance of the pair; chosen: the pair is inside.
const CIRCLE_RADIUS: f64 = 1.25;
/// Least radius of the circle, relative to the mean of the pair; chosen.
const LEAST_CIRCLE_RADIUS: f64 = 1e-3;
/// Least distance of the next eigenvalue from the centre, in radii, estimated by the ratio of two Taylor coefficients; chosen: with a nearer eigenvalue no
/// pair is found.
const LEAST_ISOLATION: f64 = 1.2;
/// Most steps of Bairstow's method; chosen: a pair that needs more is not found.
const MOST_BAIRSTOW_STEPS: usize = 12;
/// Largest change, in radii, of the last step of Bairstow's method; chosen.
const BAIRSTOW_CONVERGED: f64 = 1e-13;
/// Largest distance of the mean of a pair from its guess, in radii, with which no further circle is needed; chosen.
const LARGEST_OFFSET: f64 = 0.5;
/// Most circles evaluated for one pair; chosen: a guess that needs more has no pair, and its mode is followed in another way.
const MOST_CIRCLES: usize = 4;

/// Two eigenvalues `m +- sqrt(s)` by their mean m and the square s of half the gap between them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EigenvaluePair {
    /// Mean m, rad/s.
    pub mean: Complex<f64>,
    /// Square s of half the gap, rad^2/s^2.
    pub half_gap_squared: Complex<f64>,
}

impl EigenvaluePair {
    fn radius(&self) -> f64 {
        (CIRCLE_RADIUS * self.half_gap_squared.norm().sqrt()).max(LEAST_CIRCLE_RADIUS * self.mean.norm())
    }

    /// The pair after moving at `rate` for `step`.
    #[must_use]
    pub fn moved(&self, rate: &Self, step: f64) -> Self {
        Self {
            mean: self.mean + rate.mean * step,
            half_gap_squared: self.half_gap_squared + rate.half_gap_squared * step,
        }
    }
}

/// A path, a position t on it, and an eigenvalue or a guess of one, rad/s.
pub type OnPath<P> = (P, f64, Complex<f64>);

/// The pair of eigenvalues next to each guess in `at`, which is on a path at a position t, and the derivative of the pair by t; `None` where there are no two
/// such eigenvalues, or a third is as near.
///
/// `characteristic` gives values of a function of lambda and t that is analytic next to the guesses and has the eigenvalues as zeros, up to
/// a factor that is one for each path. A pair costs sixteen of them, and sixteen more for each further circle where the guess is far off.
pub fn eigenvalue_pairs<P: Copy>(
    at: &[(P, f64, EigenvaluePair)],
    mut characteristic: impl FnMut(&[OnPath<P>]) -> Vec<Complex<f64>>,
) -> Vec<Option<[EigenvaluePair; 2]>> {
    let mut guesses: Vec<EigenvaluePair> = at.iter().map(|(.., guess)| *guess).collect();
    let mut found = vec![None; at.len()];
    let mut open: Vec<usize> = (0..at.len()).collect();
    for _ in 0..MOST_CIRCLES {
        let circles: Vec<_> = open.iter().map(|&i| (at[i].0, at[i].1, guesses[i])).collect();
        let mut circles = on_circles(&circles, &mut characteristic).into_iter();
        open.retain(|&i| {
            let Some([here, ahead]) = circles.next().flatten() else { return false };
            let before = std::mem::replace(&mut guesses[i], here);
            let radius = before.radius();
            if (here.mean - before.mean).norm() > LARGEST_OFFSET * radius
                || here.half_gap_squared.norm() > radius * radius
            {
                return true;
            }
            let rate = EigenvaluePair {
                mean: ahead.mean - here.mean,
                half_gap_squared: ahead.half_gap_squared - here.half_gap_squared,
            };
            let rate = EigenvaluePair {
                mean: rate.mean / DIFFERENCE_STEP,
                half_gap_squared: rate.half_gap_squared / DIFFERENCE_STEP,
            };
            found[i] = Some([here, rate]);
            false
        });
        if open.is_empty() {
            break;
        }
    }
    found
}

/// The pair in the circle about each guess, at t and at `t + DIFFERENCE_STEP`.
fn on_circles<P: Copy>(
    at: &[(P, f64, EigenvaluePair)],
    characteristic: &mut impl FnMut(&[OnPath<P>]) -> Vec<Complex<f64>>,
) -> Vec<Option<[EigenvaluePair; 2]>> {
    let mut points = Vec::with_capacity(2 * CIRCLE_VALUES * at.len());
    for &(path, t, guess) in at {
        for t in [t, t + DIFFERENCE_STEP] {
            points.extend((0..CIRCLE_VALUES).map(|k| (path, t, guess.mean + turn(k) * guess.radius())));
        }
    }
    let values = characteristic(&points);
    let pair = |((.., guess), values): (&(P, f64, EigenvaluePair), &[Complex<f64>])| {
        let radius = guess.radius();
        let pair = |values: &[Complex<f64>]| {
            let (middle, square) = small_pair(&taylor(values))?;
            Some(EigenvaluePair { mean: guess.mean + middle * radius, half_gap_squared: square * (radius * radius) })
        };
        let (here, ahead) = values.split_at(CIRCLE_VALUES);
        Some([pair(here)?, pair(ahead)?])
    };
    at.iter().zip(values.chunks_exact(2 * CIRCLE_VALUES)).map(pair).collect()
}

/// `exp(2 pi i k / 8)`.
fn turn(k: usize) -> Complex<f64> {
    Complex::from_polar(1.0, TAU * k as f64 / CIRCLE_VALUES as f64)
}

/// The Taylor coefficients of a polynomial about the centre of a circle, with its radius as unit, from the values on the circle.
fn taylor(values: &[Complex<f64>]) -> [Complex<f64>; CIRCLE_VALUES] {
    std::array::from_fn(|order| {
        let sum: Complex<f64> =
            values.iter().enumerate().map(|(k, value)| value * turn(k * order % CIRCLE_VALUES).conj()).sum();
        sum / CIRCLE_VALUES as f64
    })
}

/// Mean and half gap squared of the two zeros of a polynomial next to 0; `None` where a third zero is near.
fn small_pair(a: &[Complex<f64>; CIRCLE_VALUES]) -> Option<(Complex<f64>, Complex<f64>)> {
    if a[2].norm() < LEAST_ISOLATION * a[3].norm() {
        return None;
    }
    // The factor x^2 - u x - v.
    let (mut u, mut v) = (-a[1] / a[2], -a[0] / a[2]);
    for _ in 0..MOST_BAIRSTOW_STEPS {
        // Division by the factor gives the quotient b and the remainder b_1, b_0; dividing b again gives its derivatives in c.
        let (mut b, mut c) = ([Complex::default(); CIRCLE_VALUES + 2], [Complex::default(); CIRCLE_VALUES + 2]);
        for k in (0..CIRCLE_VALUES).rev() {
            b[k] = a[k] + u * b[k + 1] + v * b[k + 2];
            c[k] = b[k] + u * c[k + 1] + v * c[k + 2];
        }
        let determinant = c[2] * c[2] - c[1] * c[3];
        let du = (b[0] * c[3] - b[1] * c[2]) / determinant;
        let dv = (b[1] * c[1] - b[0] * c[2]) / determinant;
        (u, v) = (u + du, v + dv);
        if !(u.is_finite() && v.is_finite()) {
            return None;
        }
        if du.norm() + dv.norm() <= BAIRSTOW_CONVERGED {
            return Some((0.5 * u, 0.25 * u * u + v));
        }
    }
    None
}
