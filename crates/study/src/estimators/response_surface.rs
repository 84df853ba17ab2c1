//! The response surface of an eigenvalue over a cell of friction states: a polynomial in mu and H.
//!
//! With one gain in all contacts `Q = lambda^2 M + lambda (C + H C_1) + K + mu K_1`, where H is the complex slope at lambda: for
//! every friction law, a simple eigenvalue is an analytic function of mu and of the complex number H. The polynomial with
//! complex coefficients is fitted to values and derivatives at the corners; the residual of the fit estimates its error.

use cea::Threshold;
use linsys::ChannelGain;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use tracking::link_error;

use super::sample_points::SampledMode;

/// Largest power of mu, and total degree where a cell has four corners or fewer; with more it is one higher: values and derivatives at two ends determine a
/// cubic.
const DEGREE: usize = 3;
/// Number added to the diagonal of the normal equations, for directions in which the cell has no extent; chosen: with less, these are nearly singular; with
/// more, the polynomial misses the corners.
const RIDGE: f64 = 1e-10;
/// Largest distance from the threshold, in residuals of the polynomial, of an eigenvalue whose side is uncertain; chosen: with less, predictions that count as
/// certain are more often wrong; with more, more samples have to be solved.
const UNCERTAIN_RESIDUALS: f64 = 2.0;
/// Largest distance of a slope from the centre of a cell at which the polynomial is relied on, as a multiple of the distance of the
/// corners; chosen.
const RELIABLE_RANGE: f64 = 1.25;

/// lambda as a polynomial in mu and H, both scaled to a cell.
#[derive(Debug, Clone)]
pub(super) struct ResponseSurface {
    /// Instability threshold of a mode.
    threshold: Threshold,
    degree: usize,
    centre: (f64, Complex<f64>),
    scale: (f64, f64),
    /// Coefficients, rad/s, in the order of [`powers`].
    coefficients: Vec<Complex<f64>>,
    /// Root mean square error of the polynomial at the corners plus an estimate of the terms of higher degree, rad/s.
    pub residual: f64,
    /// Bound of |d lambda / d H| of the polynomial within [`RELIABLE_RANGE`], rad/s per Ns/m.
    steepness: f64,
}

/// Exponents of mu and H up to a total degree.
fn powers(degree: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..=DEGREE).flat_map(move |a| (0..=degree - a).map(move |b| (a, b)))
}

/// The powers of a number, and their derivatives.
fn up_to(x: Complex<f64>) -> [[Complex<f64>; DEGREE + 2]; 2] {
    let (mut powers, mut derivatives) = ([Complex::from(1.0); DEGREE + 2], [Complex::default(); DEGREE + 2]);
    for n in 1..DEGREE + 2 {
        powers[n] = powers[n - 1] * x;
        derivatives[n] = powers[n - 1] * n as f64;
    }
    [powers, derivatives]
}

impl ResponseSurface {
    /// The polynomial fitted to values and derivatives at the corners of a cell, each given with its mu; `None` where these are
    /// not finite.
    pub fn new(corners: &[(f64, &SampledMode)], threshold: Threshold) -> Option<Self> {
        let degree = if corners.len() > 4 { DEGREE + 1 } else { DEGREE };
        let count = corners.len() as f64;
        let mu = corners.iter().map(|c| c.0).sum::<f64>() / count;
        let slope = corners.iter().map(|c| c.1.slope).sum::<Complex<f64>>() / count;
        let reach = |from: f64, to: f64| from.max(to).max(f64::MIN_POSITIVE);
        let scale = (
            corners.iter().map(|c| (c.0 - mu).abs()).fold(0.0, reach),
            corners.iter().map(|c| (c.1.slope - slope).norm()).fold(0.0, reach),
        );
        let terms = powers(degree).count();
        let mut matrix = DMatrix::<Complex<f64>>::zeros(3 * corners.len(), terms);
        let mut wanted = DVector::<Complex<f64>>::zeros(3 * corners.len());
        for (k, (at, mode)) in corners.iter().enumerate() {
            let [m, by_m] = up_to(Complex::from((at - mu) / scale.0));
            let [h, by_h] = up_to((mode.slope - slope) / scale.1);
            for (j, (a, b)) in powers(degree).enumerate() {
                matrix[(3 * k, j)] = m[a] * h[b];
                matrix[(3 * k + 1, j)] = by_m[a] * h[b];
                matrix[(3 * k + 2, j)] = m[a] * by_h[b];
            }
            wanted[3 * k] = mode.lambda;
            wanted[3 * k + 1] = mode.by_mu * scale.0;
            wanted[3 * k + 2] = mode.by_slope * scale.1;
        }
        let normal = matrix.ad_mul(&matrix) + DMatrix::identity(terms, terms) * Complex::from(RIDGE);
        let coefficients = normal.cholesky()?.solve(&matrix.ad_mul(&wanted));
        let left = (&matrix * &coefficients - wanted).norm_squared();
        let spare = (3 * corners.len()).saturating_sub(terms).max(1) as f64;
        // A cubic polynomial fits values and derivatives at two ends exactly, so that its residual does not show the next term
        // in mu, nor in a real H. This term is estimated from the last two, as in a geometric series.
        let term = |power: (usize, usize)| {
            powers(degree).position(|other| other == power).map_or(0.0, |at| size(coefficients[at]))
        };
        let next = |last: f64, before: f64| if last < before { last * last / before } else { last };
        let mut unseen = next(term((DEGREE, 0)), term((DEGREE - 1, 0)));
        if degree == DEGREE {
            unseen += next(term((0, DEGREE)), term((0, DEGREE - 1)));
        }
        let steepest = |((a, b), c): ((usize, usize), &Complex<f64>)| {
            b as f64 * size(*c) * RELIABLE_RANGE.powi((a + b).saturating_sub(1) as i32)
        };
        Some(Self {
            threshold,
            steepness: powers(degree).zip(coefficients.iter()).map(steepest).sum::<f64>() / scale.1,
            degree,
            centre: (mu, slope),
            scale,
            coefficients: coefficients.iter().copied().collect(),
            residual: (left / spare).sqrt() + unseen,
        })
    }

    /// Eigenvalue lambda, rad/s, under a gain, and true if the slope at lambda is outside [`RELIABLE_RANGE`]: the slope depends on more
    /// than the coordinates of the gain.
    fn eigenvalue(&self, gain: &ChannelGain) -> (Complex<f64>, bool) {
        let mut slope = gain.complex_slope(self.coefficients[0]);
        let mut lambda = self.at(gain.mu, slope);
        if gain.lag.is_some() {
            // The slope depends on the eigenvalue; far from the threshold the first approximation is enough.
            let other = gain.complex_slope(lambda);
            if self.threshold.margin(lambda).abs() <= self.uncertainty() + self.steepness * (other - slope).l1_norm() {
                (slope, lambda) = (other, self.at(gain.mu, other));
            }
        }
        (lambda, (slope - self.centre.1).norm_sqr() > (RELIABLE_RANGE * self.scale.1).powi(2))
    }

    /// Margin of the eigenvalue beyond the threshold under a gain, rad/s, and true if the slope at it is outside [`RELIABLE_RANGE`].
    pub fn margin(&self, gain: &ChannelGain) -> (f64, bool) {
        let (lambda, is_outside) = self.eigenvalue(gain);
        (self.threshold.margin(lambda), is_outside)
    }

    /// Largest distance from the threshold with which the side of the eigenvalue is uncertain, rad/s.
    pub fn uncertainty(&self) -> f64 {
        UNCERTAIN_RESIDUALS * self.residual
    }

    fn at(&self, mu: f64, slope: Complex<f64>) -> Complex<f64> {
        let m = (mu - self.centre.0) / self.scale.0;
        let h = (slope - self.centre.1) / self.scale.1;
        // Horner's scheme in H within Horner's scheme in mu.
        let mut last = self.coefficients.len();
        let mut sum = Complex::default();
        for a in (0..=DEGREE).rev() {
            let first = last - (self.degree - a + 1);
            let inner =
                self.coefficients[first..last].iter().rev().fold(Complex::default(), |s: Complex<f64>, c| s * h + c);
            sum = sum * m + inner;
            last = first;
        }
        sum
    }
}

/// |z| of a number whose square is in range.
fn size(z: Complex<f64>) -> f64 {
    z.norm_sqr().sqrt()
}

/// The index of one mode at every corner of a cell; corner `ks[c]` is on the upper side in direction d where bit d is set. `None`
/// where a corner has no modes. The mode is followed along each edge to the mode with the least [`link_error`].
pub(super) fn link(modes: &[(f64, &[SampledMode])], ks: &[usize], start: usize, index: usize) -> Option<Vec<usize>> {
    let mut path = vec![index; ks.len()];
    // From the start along one direction after the other.
    let mut known = vec![start];
    for d in 0..3 {
        for c in known.clone() {
            let Some(other) = ks.iter().position(|&k| k == ks[c] ^ (1 << d)) else { continue };
            let from = &modes[c].1[path[c]];
            let step = modes[other].0 - modes[c].0;
            let error = |to: &SampledMode| {
                let changes = [from, to].map(|mode| mode.by_mu * step + mode.by_slope * (to.slope - from.slope));
                link_error([from.lambda, to.lambda], changes)
            };
            let candidates = modes[other].1.iter().map(error).enumerate();
            path[other] = candidates.min_by(|a, b| a.1.total_cmp(&b.1))?.0;
            known.push(other);
        }
    }
    Some(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use linsys::Lag;

    /// A mode whose eigenvalue is `100 i + 3 + offset + 2 m - m H + H^2 + i m^2 H`.
    fn mode(mu: f64, slope: Complex<f64>, offset: f64) -> SampledMode {
        let i = Complex::i();
        SampledMode {
            lambda: 100.0 * i + 3.0 + offset + 2.0 * mu - mu * slope + slope * slope + i * mu * mu * slope,
            slope,
            by_mu: 2.0 - slope + 2.0 * i * mu * slope,
            by_slope: -mu + 2.0 * slope + i * mu * mu,
            names: Vec::new(),
        }
    }

    const SLOPES: [[f64; 2]; 4] = [[-0.3, -0.1], [0.0, 0.1], [-0.4, -0.5], [0.1, -0.4]];

    /// The corners in the order of their bits: mu, then the two parts of H.
    fn corners(slopes: &[[f64; 2]], offset: f64) -> Vec<(f64, SampledMode)> {
        let both = |&[re, im]: &[f64; 2]| [0.3, 0.7].map(|mu| (mu, mode(mu, Complex::new(re, im), offset)));
        slopes.iter().flat_map(both).collect()
    }

    #[test]
    fn a_polynomial_is_found_again() {
        let lag = Lag { decay: 150.0, drive: -0.5, force: 60.0 };
        for (slopes, lag) in [(&SLOPES[..2], None), (&SLOPES[..], Some(lag))] {
            // Far from the axis, and on the axis, where the surface has to be accurate.
            for (offset, error) in [(0.0, 1e-3), (-4.139, 1e-6)] {
                let corners = corners(slopes, offset);
                let corners: Vec<(f64, &SampledMode)> = corners.iter().map(|(mu, mode)| (*mu, mode)).collect();
                let surface = ResponseSurface::new(&corners, Threshold::AXIS).unwrap();
                let gain = ChannelGain { mu: 0.45, slope: -0.2, lag };
                let lambda = surface.eigenvalue(&gain).0;
                let expected = mode(0.45, gain.complex_slope(lambda), offset).lambda;
                assert!((lambda - expected).norm() < error, "{lambda} {expected} {}", surface.residual);
            }
        }
    }

    #[test]
    fn branches_that_cross_are_told_apart_by_their_derivatives() {
        let (a, b) = (corners(&SLOPES, 0.0), corners(&SLOPES, 0.0));
        // The other branch is the mirror image in mu about 0.5: the two branches cross in the middle.
        let mirrored = |k: usize| {
            let mode = &b[k ^ 1].1;
            SampledMode { by_mu: -mode.by_mu, ..mode.clone() }
        };
        let both: Vec<Vec<SampledMode>> = (0..8)
            .map(|k| {
                let mut pair = vec![a[k].1.clone(), mirrored(k)];
                pair.sort_by(|x, y| x.lambda.re.total_cmp(&y.lambda.re));
                pair
            })
            .collect();
        let modes: Vec<(f64, &[SampledMode])> = (0..8).map(|k| (a[k].0, &both[k][..])).collect();
        let ks: Vec<usize> = (0..8).collect();
        let start = both[0].iter().position(|mode| mode.lambda == a[0].1.lambda).unwrap();
        let path = link(&modes, &ks, 0, start).unwrap();
        for (k, &index) in path.iter().enumerate() {
            assert_eq!(both[k][index].lambda, a[k].1.lambda);
        }
    }
}
