//! Operating points whose systems are all stable, by a small-gain certificate: their samples need no spectrum.

use cea::{AxisMargins, Channels, NormBound, Workspace, h_infinity_norm_bound};
use linsys::{AffineSystem, ChannelGain, OperatingPoint, SecondOrder};
use montecarlo::{Progress, stream};
use nalgebra::DMatrix;
use num_complex::Complex;
use rayon::prelude::*;

use super::{Configuration, Scene, UncertainBrake};
use crate::Error;

/// Number of draws whose quartiles say where ellipses are placed and how wide they are tried. Chosen; a proof does not depend on it, only
/// how many samples it covers.
const DRAWS_TO_PLACE_ELLIPSES: u64 = 32;
/// Distances of the centres of the ellipses below the median coefficient of friction, in interquartile ranges of the
/// coefficient. Chosen: where the system is unstable at the median, lower centres can still be certified.
const SPREADS_BELOW_MEDIAN: [f64; 3] = [0.0, 0.75, 1.5];

/// Certificate of one configuration: ellipses in the plane of coefficient mu and slope `N0 h`, Ns/m, of friction, inside of which
/// every system is stable.
///
/// No operating point all of whose channels lie in one of them has an eigenvalue with `Re lambda >= 0`, whatever the law,
/// and whether the channels are alike or not. See [`h_infinity_norm_bound`] for the proof; docs/error-bounds.md puts it together.
#[derive(Debug, Clone, Default)]
pub struct Certificate {
    /// The coefficient of each term; the certificate holds for this structure alone.
    coefficients: Vec<f64>,
    ellipses: Vec<Ellipse>,
    norms: NormBounds,
    margins: AxisMargins,
}

/// Bounds of the matrices of a configuration, from which a bound of its eigenvalues follows: 2-norms of `M^-1/2 A M^-1/2`.
#[derive(Debug, Clone, Copy, Default)]
struct NormBounds {
    /// Norm for C without friction, 1/s.
    damping: f64,
    /// Norm for K without friction, 1/s^2.
    stiffness: f64,
    /// Norm for the change of C by a slope of 1 Ns/m in every channel.
    slope: f64,
    /// Bound of the norm for the change of K by a coefficient of 1 in every channel.
    coupling: f64,
}

#[derive(Debug, Clone, Copy)]
struct Ellipse {
    centre: Friction,
    half_axes: Friction,
}

/// Friction in one channel, or the difference of two such frictions.
#[derive(Debug, Clone, Copy)]
struct Friction {
    /// Coefficient of friction mu.
    mu: f64,
    /// Slope `N0 h`, Ns/m.
    slope: f64,
}

/// The certificate of each configuration of a brake.
///
/// # Errors
/// Those of the model and of the scaling.
pub(super) fn certificates<B: UncertainBrake>(brake: &B, progress: &dyn Progress) -> Result<Vec<Certificate>, Error> {
    let plan = brake.plan();
    let samples: Vec<B::Sample> =
        (0..DRAWS_TO_PLACE_ELLIPSES).filter_map(|index| brake.draw(&mut stream(plan.seed, index)).ok()).collect();
    let of_configuration = |(at, configuration): (usize, &Configuration)| {
        progress.go_on()?;
        let scenes = plan.scenes.iter().filter(|scene| scene.configuration == at);
        let points = scenes
            .flat_map(|scene: &Scene| samples.iter().filter_map(|sample| brake.operating_point(scene, sample).ok()));
        Certificate::new(&configuration.brake.system, &points.collect::<Vec<_>>())
    };
    plan.configurations.par_iter().enumerate().map(of_configuration).collect()
}

impl Certificate {
    /// Places ellipses by the quartiles of `points` and certifies as many as it can; none where the points differ in the
    /// coefficients of terms.
    ///
    /// # Errors
    /// Those of the model and of the scaling.
    pub fn new(system: &AffineSystem, points: &[OperatingPoint]) -> Result<Self, Error> {
        let Some(coefficients) = common_coefficients(points) else { return Ok(Self::default()) };
        let gains = || points.iter().flat_map(|at| &at.channels);
        let mus = quartiles(gains().map(|gain| gain.mu).collect());
        let slopes = quartiles(gains().map(middle_slope).collect());
        let (Some(mus), Some(slopes)) = (mus, slopes) else { return Ok(Self::default()) };
        let spread = Friction { mu: mus[2] - mus[0], slope: slopes[2] - slopes[0] };
        let (force, reading) = (system.force_matrix(), system.reading_matrix());
        let structure = system.structure(&coefficients)?;
        let Some(norms) = NormBounds::new(&structure, &force, &reading) else { return Ok(Self::default()) };
        let weighted = Channels {
            position: stacked(spread.mu * &reading, 0.0 * &reading),
            velocity: stacked(0.0 * &reading, spread.slope * force.transpose()),
            force,
        };
        let (mut ellipses, mut margins) = (Vec::new(), AxisMargins::default());
        for below in SPREADS_BELOW_MEDIAN {
            let centre = Friction { mu: (mus[1] - below * spread.mu).max(0.0), slope: slopes[1] };
            let gain = ChannelGain { mu: centre.mu, slope: centre.slope, lag: None };
            let channels = vec![gain; system.channels().len()];
            let centred = system.assemble(&OperatingPoint { coefficients: coefficients.clone(), channels })?;
            let found = h_infinity_norm_bound(&centred, &weighted, &mut Workspace::default())?;
            if let Ok(NormBound { bound, margins: of_bound }) = found {
                let half_axes = Friction { mu: spread.mu / bound, slope: spread.slope / bound };
                ellipses.push(Ellipse { centre, half_axes });
                margins = margins.and(of_bound);
            }
        }
        Ok(Self { coefficients, ellipses, norms, margins })
    }

    /// Margins of the eigenvalues from the axis in the matrices that the ellipses rest on.
    pub fn margins(&self) -> AxisMargins {
        self.margins
    }

    /// True if the system at this operating point is certified to be stable.
    pub fn covers(&self, at: &OperatingPoint) -> bool {
        self.covers_all([at])
    }

    /// True if the systems at all operating points on the straight line between two are certified to be stable: both ends, of channels with the
    /// same lag, lie in one ellipse, which is convex, and no point between has an eigenvalue with `Re lambda >= 0` farther out than the ends may.
    pub fn covers_line(&self, ends: [&OperatingPoint; 2]) -> bool {
        let [lags, other_lags] = ends.map(|end| end.channels.iter().map(|gain| gain.lag));
        lags.eq(other_lags) && self.covers_all(ends)
    }

    /// True if one ellipse contains all channels at all of `points`, up to the largest eigenvalue that any of them allows.
    fn covers_all<const N: usize>(&self, points: [&OperatingPoint; N]) -> bool {
        if self.ellipses.is_empty() || points.iter().any(|at| at.coefficients != self.coefficients) {
            return false;
        }
        let radius = points.iter().map(|at| self.norms.radius(&at.channels)).fold(0.0, f64::max);
        let gains = || points.iter().flat_map(|at| &at.channels);
        self.ellipses.iter().any(|ellipse| gains().all(|gain| ellipse.contains(gain, radius)))
    }
}

/// The coefficients of `points`, if they are the same at all of them.
fn common_coefficients(points: &[OperatingPoint]) -> Option<Vec<f64>> {
    let (first, others) = points.split_first()?;
    others.iter().all(|other| other.coefficients == first.coefficients).then(|| first.coefficients.clone())
}

impl NormBounds {
    /// The bounds of the matrices; `None` for a mass matrix that is not positive definite.
    fn new(structure: &SecondOrder, force: &DMatrix<f64>, reading: &DMatrix<f64>) -> Option<Self> {
        let mass = structure.m.clone().symmetric_eigen();
        if mass.eigenvalues.min() <= 0.0 {
            return None;
        }
        let scale = DMatrix::from_diagonal(&mass.eigenvalues.map(|m| 1.0 / m.sqrt()));
        let root = &mass.eigenvectors * scale * mass.eigenvectors.transpose();
        let norm = |matrix: DMatrix<f64>| matrix.singular_values().max();
        let (force, coupling) = (norm(&root * force), norm(reading * &root));
        Some(Self {
            damping: norm(&root * &structure.c * &root),
            stiffness: norm(&root * &structure.k * &root),
            slope: force * force,
            coupling: force * coupling,
        })
    }

    /// Largest |lambda| that an eigenvalue with `Re lambda >= 0` can have, rad/s: it satisfies `|lambda|^2 <= c |lambda| + k`
    /// with bounds c and k of damping and stiffness.
    fn radius(&self, gains: &[ChannelGain]) -> f64 {
        let slopes = gains.iter().flat_map(|gain| gain.slope_extremes().map(f64::abs));
        let c = self.damping + self.slope * slopes.fold(0.0, f64::max);
        let k = self.stiffness + self.coupling * gains.iter().map(|gain| gain.mu.abs()).fold(0.0, f64::max);
        // The last factor is an allowance for rounding, chosen far above the rounding of these few operations.
        (0.5 * c + (0.25 * c * c + k).sqrt()) * (1.0 + 1e-9)
    }
}

impl Ellipse {
    /// True if friction in a channel stays in the ellipse for every lambda with `Re lambda >= 0`, `|lambda| <= radius`.
    fn contains(&self, gain: &ChannelGain, radius: f64) -> bool {
        let Self { centre, half_axes } = self;
        let mu = in_half_axes(gain.mu - centre.mu, half_axes.mu);
        // Over the half disc `Re lambda >= 0`, `|lambda| <= radius` the complex slope is farthest from a real number at lambda = 0,
        // at the point of the real axis or at the point of the imaginary axis.
        let corners = [Complex::default(), Complex::new(radius, 0.0), Complex::new(0.0, radius)];
        let is_inside = |lambda| {
            let slope = gain.complex_slope(lambda) - centre.slope;
            let slope = in_half_axes(slope.norm(), half_axes.slope);
            mu * mu + slope * slope < 1.0
        };
        corners.into_iter().all(is_inside)
    }
}

/// A difference in units of a half axis; 0 for a parameter that does not vary.
fn in_half_axes(difference: f64, half_axis: f64) -> f64 {
    if difference == 0.0 { 0.0 } else { difference / half_axis }
}

/// The middle of the slopes `N0 h` at 0 and at infinity, Ns/m.
fn middle_slope(gain: &ChannelGain) -> f64 {
    0.5 * gain.slope_extremes().iter().sum::<f64>()
}

/// The matrix `above` on top of the matrix `below`.
fn stacked(above: DMatrix<f64>, below: DMatrix<f64>) -> DMatrix<f64> {
    let rows = above.nrows();
    let mut both = above.resize_vertically(rows + below.nrows(), 0.0);
    both.rows_mut(rows, below.nrows()).copy_from(&below);
    both
}

/// First quartile, median and third quartile, as entries of the sorted list; `None` for an empty list and for one with a value
/// that is not finite.
fn quartiles(mut values: Vec<f64>) -> Option<[f64; 3]> {
    values.sort_unstable_by(f64::total_cmp);
    let all_finite = values.iter().all(|value| value.is_finite());
    let last = values.len().checked_sub(1).filter(|_| all_finite)?;
    Some([last / 4, last / 2, 3 * last / 4].map(|at| values[at]))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use brakes::case::LatticeCase;
    use brakes::{LatticeBrake, LatticeSample};
    use cea::{EigenSolver, QrSolver};

    use super::*;

    #[test]
    fn no_growing_eigenvalue_lies_beyond_the_radius() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/two-by-two.toml");
        let brake = LatticeBrake::new(LatticeCase::read(&path).unwrap()).unwrap();
        let (mut growing, mut nearest) = (0, f64::INFINITY);
        for index in 0..20 {
            let sample = LatticeSample::draw(&brake.case, &mut stream(3, index)).unwrap();
            for scene in &brake.plan.scenes {
                let system = &brake.plan.brake(scene).system;
                let (force, reading) = (system.force_matrix(), system.reading_matrix());
                let at = brake.lattice(scene).operating_point(&brake.sliding(scene, &sample).unwrap()).unwrap();
                let sizes = NormBounds::new(&system.structure(&at.coefficients).unwrap(), &force, &reading).unwrap();
                let radius = sizes.radius(&at.channels);
                let system = system.assemble(&at).unwrap();
                for lambda in QrSolver.eigenvalues(&system, &mut Workspace::default()).unwrap().eigenvalues {
                    if lambda.re >= 0.0 {
                        assert!(lambda.norm() < radius, "{lambda} {radius}");
                        (growing, nearest) = (growing + 1, f64::min(nearest, radius / lambda.norm()));
                    }
                }
            }
        }
        // A radius without meaning would be many times larger.
        assert!(growing > 100 && nearest < 3.0, "{growing} growing, radius at least {nearest} times as large");
    }

    #[test]
    fn a_slope_is_farthest_from_a_real_one_at_a_corner_of_the_half_disc() {
        let lag = Some(linsys::Lag { decay: 2e4, drive: -0.2, force: -2e5 });
        let (radius, gain) = (1.5e4, ChannelGain { mu: 0.5, slope: -6.0, lag });
        for centre in [-10.0, -5.0, -4.0, -1.0, 3.0] {
            let most = |half_axis: f64| {
                let half_axes = Friction { mu: 1.0, slope: half_axis };
                Ellipse { centre: Friction { mu: 0.5, slope: centre }, half_axes }.contains(&gain, radius)
            };
            let inside = (0..=60).flat_map(|i| (0..=60).map(move |j| (i, j))).map(|(i, j)| {
                let angle = std::f64::consts::PI * (f64::from(j) / 60.0 - 0.5);
                Complex::from_polar(radius * f64::from(i) / 60.0, angle)
            });
            let farthest = inside.map(|l| (gain.complex_slope(l) - centre).norm()).fold(0.0, f64::max);
            assert!(most(farthest * (1.0 + 1e-9)) && !most(farthest * (1.0 - 1e-9)), "{centre}");
        }
    }
}
