//! Discs that contain all zeros of a polynomial, from its values at guesses of the zeros.
//!
//! The theorem is Smith's: [`smith_share`]. Each guess stands for its conjugate too.

use certified::enclosures::smith_share;
use num_complex::Complex;

use super::Gain;

/// Largest sum of all shares that counts as an enclosure; chosen: in exact arithmetic any sum below 1 does, the difference is
/// kept for rounding errors of the sum.
pub(super) const LARGEST_TOTAL_SHARE: f64 = 0.9;
/// Bound of the rounding error of the correction w of a guess z, relative to |z|, far from other eigenvalues; chosen.
const CORRECTION_ROUNDING: f64 = 1e-11;
/// Relative distance of the nearest other eigenvalue at which that bound is twice as large; chosen. It is larger by the factor
/// `1 + CLUSTER_DISTANCE / distance`.
const CLUSTER_DISTANCE: f64 = 1e-3;
/// Safety factor on |w|; chosen. Next to a strongly coupled pole of the structure, large terms of the determinant cancel, and
/// values were seen with relative errors of 0.004.
const CORRECTION_SAFETY: f64 = 1.25;
/// Modes near the axis are sought up to this multiple of the damping ratio asked for; chosen: eigenvalues just beyond that ratio need then not be enclosed
/// on one side of it.
const NEAR_AXIS_MARGIN: f64 = 1.5;

/// |z| of a number whose square is in range.
fn size(z: Complex<f64>) -> f64 {
    z.norm_sqr().sqrt()
}

/// Guesses of all eigenvalues: of the modes with Im > 0, of their conjugates, and of internal states.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Approximations {
    pub sigmas: Vec<Complex<f64>>,
    pub internal: Option<InternalCluster>,
}

/// Guesses of the eigenvalues of internal states, evenly on a circle about a real number.
///
/// The eigenvalues lie together, far left of the imaginary axis; they are not wanted and matter only for the bounds of the modes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct InternalCluster {
    pub middle: f64,
    pub radius: f64,
}

impl InternalCluster {
    /// The zeros of `(z - middle)^count + radius^count` with Im >= 0, each with the number of zeros it stands for: 1 if real, 2
    /// with its conjugate.
    pub fn guesses(self, count: usize) -> impl Iterator<Item = (Complex<f64>, f64)> {
        (0..count.div_ceil(2)).map(move |i| {
            let is_real = 2 * i + 1 == count;
            let angle = std::f64::consts::PI * (2 * i + 1) as f64 / count as f64;
            let turn = if is_real { Complex::from(-1.0) } else { Complex::from_polar(1.0, angle) };
            (self.middle + self.radius * turn, if is_real { 1.0 } else { 2.0 })
        })
    }
}

impl Approximations {
    /// `prod (z - z_j)` over all modes and their conjugates, without the factor `z - z_k`; with all factors for a k that is no mode.
    pub fn others(&self, k: usize, z: Complex<f64>) -> Complex<f64> {
        let mut product = Complex::from(1.0);
        for (j, other) in self.sigmas.iter().enumerate() {
            let conjugate = z - other.conj();
            product *= if j == k { conjugate } else { (z - other) * conjugate };
        }
        product
    }

    /// `(z + decay)^m / prod (z - z_b)` over the m internal states.
    pub fn internal_factor(&self, z: Complex<f64>, gain: &Gain, m: usize) -> Complex<f64> {
        let Some(InternalCluster { middle, radius }) = self.internal.filter(|_| m > 0) else {
            return Complex::from(1.0);
        };
        let power = m as i32;
        let [pole, distance] = [(z + gain.decay) / radius, (z - middle) / radius];
        pole.powi(power) / (distance.powi(power) + 1.0)
    }

    /// The correction w of the guess `z` of an internal state, from the polynomial's value there.
    pub fn internal_correction(&self, z: Complex<f64>, value: Complex<f64>, gain: &Gain, m: usize) -> Complex<f64> {
        let Some(InternalCluster { middle, radius }) = self.internal else { return Complex::default() };
        // The derivative of (z - middle)^m + radius^m at its zeros.
        let [pole, distance] = [(z + gain.decay) / radius, (z - middle) / radius];
        let power = m as i32;
        value / self.others(usize::MAX, z) * pole.powi(power) / (m as f64 * distance.powi(power - 1)) * radius
    }
}

/// Discs about the guesses of modes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Enclosure {
    /// Radii of the discs, which contain all eigenvalues if `total < 1`.
    pub radii: Vec<f64>,
    /// Upper bound of the share of each guess together with its conjugate, `2 |w_i| / r_i`.
    pub shares: Vec<f64>,
    /// The sum of all shares, including the shares of internal states.
    pub total: f64,
    /// The shares of internal states.
    of_internal: f64,
}

impl Enclosure {
    /// The radii reduced by one common factor, as far as `LARGEST_TOTAL_SHARE` allows.
    pub fn smallest(&self) -> impl Iterator<Item = f64> + '_ {
        let part = (self.total - self.of_internal) / (LARGEST_TOTAL_SHARE - self.of_internal);
        self.radii.iter().map(move |radius| radius * part)
    }
}

/// Modes that a search is to find.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Wanted {
    /// The growing modes, and which other modes have lower frequencies.
    Growing,
    /// The modes with a damping ratio below this number: `Re sigma > - number |sigma|`.
    Near(f64),
}

impl Wanted {
    pub fn is_found(self, sigma: Complex<f64>) -> bool {
        match self {
            Self::Growing => sigma.re > 0.0,
            Self::Near(part) => sigma.re > -NEAR_AXIS_MARGIN * part * size(sigma),
        }
    }
}

/// The discs with the largest radii such that the disc of a wanted mode meets no other disc, and the disc of another mode stays left of
/// the imaginary axis and contains no excluded frequency. `internal` are guesses of internal states with their corrections;
/// their discs stay left of the imaginary axis and meet no disc of a mode.
pub(super) fn enclosure(
    wanted: Wanted,
    sigmas: &[Complex<f64>],
    corrections: &[Complex<f64>],
    internal: &[(Complex<f64>, f64)],
    excluded_frequencies: &[f64],
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
                // Within the disc |z| is larger than at its centre by the radius at most.
                Wanted::Near(part) => (-z.re - part * size(z)) / (1.0 + part),
            };
            (side, excluded_frequencies.iter().map(|im| (z.im - im).abs()).fold(here, f64::min))
        };
        side.min(z.im).min(apart).max(0.0)
    };
    let radii: Vec<f64> = (0..sigmas.len()).map(radius).collect();
    let share = |((i, w), r): ((usize, &Complex<f64>), &f64)| {
        let z = sigmas[i];
        let others = sigmas.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, other)| (z - other).norm_sqr());
        let nearest = (others.fold(f64::INFINITY, f64::min) / z.norm_sqr()).sqrt();
        let rounding = CORRECTION_ROUNDING * size(z) * (1.0 + CLUSTER_DISTANCE / nearest);
        smith_share(2.0 * (CORRECTION_SAFETY * size(*w) + rounding), *r)
    };
    let shares: Vec<f64> = corrections.iter().enumerate().zip(&radii).map(share).collect();
    let internal_share = |&(z, size): &(Complex<f64>, f64)| {
        let free = sigmas.iter().zip(&radii).map(|(sigma, r)| self::size(sigma - z) - r).fold(-z.re, f64::min);
        smith_share(size, free.max(0.0))
    };
    let (of_modes, of_internal) = (shares.iter().sum::<f64>(), internal.iter().map(internal_share).sum::<f64>());
    Enclosure { radii, shares, total: of_modes + of_internal, of_internal }
}
