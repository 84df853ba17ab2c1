//! Where all the zeros of a polynomial are, from its values at guesses of them.
//!
//! A monic polynomial of degree N with distinct guesses z_i of its zeros is
//!
//! ```text
//! p(z) = prod_i (z - z_i) (1 + sum_i w_i / (z - z_i)),    w_i = p(z_i) / prod_{j != i} (z_i - z_j)
//! ```
//!
//! (Lagrange; w_i is the correction of Weierstrass 1891). It vanishes nowhere where `sum |w_i| / |z - z_i| < 1`. With radii
//! r_i such that `sum |w_i| / r_i < 1` all zeros are in the discs of radius r_i about the z_i, and a disc that meets no other
//! holds one: the zeros move continuously from the guesses as all w_i grow from 0 (Smith, J. ACM 17, 1970, for equal
//! `r_i / |w_i|`).

use num_complex::Complex;

use super::Gain;

/// Part of 1 that the sum of all `|w_i| / r_i` may take.
pub(super) const MOST: f64 = 0.9;
/// Rounding errors of w, relative to z, with a reserve; next to another eigenvalue they are larger by `NEXT_TO` over the
/// relative distance.
const ROUNDING: f64 = 1e-11;
const NEXT_TO: f64 = 1e-3;
/// What w is taken to be at most, as a multiple of what it is found to be: next to a pole of the structure that is strongly
/// coupled, the large parts of a determinant cancel, and values were seen to err by 0.004 of themselves.
const RESERVE: f64 = 1.25;

/// How far beyond what is asked modes near the axis are found, as a factor.
const BEYOND: f64 = 1.5;

/// |z| of a number whose square is in range.
fn size(z: Complex<f64>) -> f64 {
    z.norm_sqr().sqrt()
}

/// Guesses of all eigenvalues: those of modes with Im > 0, their conjugates, and those of internal states.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cast {
    pub sigmas: Vec<Complex<f64>>,
    pub bristles: Option<Bristles>,
}

/// Guesses of the eigenvalues of internal states, evenly on a circle about a real number.
///
/// These eigenvalues lie together, far to the left; only what they may do to others counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bristles {
    pub middle: f64,
    pub radius: f64,
}

impl Bristles {
    /// Those with Im >= 0 of `count`, each with how many it stands for. They are the zeros of
    /// `(z - middle)^count + radius^count`.
    pub fn guesses(self, count: usize) -> impl Iterator<Item = (Complex<f64>, f64)> {
        (0..count.div_ceil(2)).map(move |i| {
            let is_real = 2 * i + 1 == count;
            let angle = std::f64::consts::PI * (2 * i + 1) as f64 / count as f64;
            let turn = if is_real { Complex::from(-1.0) } else { Complex::from_polar(1.0, angle) };
            (self.middle + self.radius * turn, if is_real { 1.0 } else { 2.0 })
        })
    }
}

impl Cast {
    /// `prod (z - z_j)` over all modes and their conjugates but mode `k` itself.
    pub fn others(&self, k: usize, z: Complex<f64>) -> Complex<f64> {
        let mut product = Complex::from(1.0);
        for (j, other) in self.sigmas.iter().enumerate() {
            let conjugate = z - other.conj();
            product *= if j == k { conjugate } else { (z - other) * conjugate };
        }
        product
    }

    /// `(z + decay)^m / prod (z - z_b)` over the m internal states.
    pub fn bristle_factor(&self, z: Complex<f64>, gain: &Gain, m: usize) -> Complex<f64> {
        let Some(Bristles { middle, radius }) = self.bristles.filter(|_| m > 0) else { return Complex::from(1.0) };
        let power = m as i32;
        let [pole, distance] = [(z + gain.decay) / radius, (z - middle) / radius];
        pole.powi(power) / (distance.powi(power) + 1.0)
    }

    /// The correction of a guess for an internal state from the value there.
    pub fn bristle_correction(&self, z: Complex<f64>, value: Complex<f64>, gain: &Gain, m: usize) -> Complex<f64> {
        let Some(Bristles { middle, radius }) = self.bristles else { return Complex::default() };
        // The derivative of (z - middle)^m + radius^m at its zeros.
        let [pole, distance] = [(z + gain.decay) / radius, (z - middle) / radius];
        let power = m as i32;
        value / self.others(usize::MAX, z) * pole.powi(power) / (m as f64 * distance.powi(power - 1)) * radius
    }
}

/// Which of some guesses hold what is asked, and which do not yet.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Enclosure {
    /// Radii that hold all eigenvalues if `total < 1`.
    pub radii: Vec<f64>,
    /// At least `2 |w_i| / r_i` of each guess, its conjugate included.
    pub shares: Vec<f64>,
    /// The sum of all shares, and those of internal states.
    pub total: f64,
    /// The shares of internal states.
    of_bristles: f64,
}

impl Enclosure {
    /// The radii, as small as the bound allows if all shrink alike.
    pub fn smallest(&self) -> impl Iterator<Item = f64> + '_ {
        let part = (self.total - self.of_bristles) / (MOST - self.of_bristles);
        self.radii.iter().map(move |radius| radius * part)
    }
}

/// What a search is to find.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Wanted {
    /// The modes that grow, and which others have lower frequencies.
    Growing,
    /// The modes that grow or decay more slowly than this part of |sigma|.
    Near(f64),
}

impl Wanted {
    pub fn is_found(self, sigma: Complex<f64>) -> bool {
        match self {
            Self::Growing => sigma.re > 0.0,
            // Also some that decay a little faster: nothing need be known of those just beyond the line.
            Self::Near(part) => sigma.re > -BEYOND * part * size(sigma),
        }
    }
}

/// The largest radii that keep the modes wanted apart from all others, and what they leave of 1. The others keep left of
/// the axis and off the frequencies `apart_from`. `bristles` are guesses of internal states with their corrections; they
/// keep off all modes.
pub(super) fn enclosure(
    wanted: Wanted,
    sigmas: &[Complex<f64>],
    corrections: &[Complex<f64>],
    bristles: &[(Complex<f64>, f64)],
    apart_from: &[f64],
) -> Enclosure {
    let found: Vec<usize> = (0..sigmas.len()).filter(|&i| wanted.is_found(sigmas[i])).collect();
    let apart = |i: usize, j: usize| match wanted {
        _ if i == j => f64::INFINITY,
        Wanted::Growing => (sigmas[i].im - sigmas[j].im).abs(),
        Wanted::Near(_) => size(sigmas[i] - sigmas[j]),
    };
    let radius = |i: usize| {
        let z = sigmas[i];
        let (side, apart) = if wanted.is_found(z) {
            let side = if wanted == Wanted::Growing { z.re } else { f64::INFINITY };
            (side, 0.5 * (0..sigmas.len()).map(|j| apart(i, j)).fold(f64::INFINITY, f64::min))
        } else {
            let here = 0.5 * found.iter().map(|&j| apart(i, j)).fold(f64::INFINITY, f64::min);
            let side = match wanted {
                Wanted::Growing => -z.re,
                // Within a radius |z| grows by the radius at most.
                Wanted::Near(part) => (-z.re - part * size(z)) / (1.0 + part),
            };
            (side, apart_from.iter().map(|im| (z.im - im).abs()).fold(here, f64::min))
        };
        side.min(z.im).min(apart).max(0.0)
    };
    let radii: Vec<f64> = (0..sigmas.len()).map(radius).collect();
    let share = |((i, w), r): ((usize, &Complex<f64>), &f64)| {
        let z = sigmas[i];
        let others = sigmas.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, other)| (z - other).norm_sqr());
        let nearest = (others.fold(f64::INFINITY, f64::min) / z.norm_sqr()).sqrt();
        2.0 * (RESERVE * size(*w) + ROUNDING * size(z) * (1.0 + NEXT_TO / nearest)) / r
    };
    let shares: Vec<f64> = corrections.iter().enumerate().zip(&radii).map(share).collect();
    let bristle = |&(z, size): &(Complex<f64>, f64)| {
        let free = sigmas.iter().zip(&radii).map(|(sigma, r)| self::size(sigma - z) - r).fold(-z.re, f64::min);
        size / free.max(0.0)
    };
    let (of_modes, of_bristles) = (shares.iter().sum::<f64>(), bristles.iter().map(bristle).sum::<f64>());
    Enclosure { radii, shares, total: of_modes + of_bristles, of_bristles }
}
