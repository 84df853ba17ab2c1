//! Sliding states whose systems are all stable, by proof: their samples need no spectrum.

use cea::{Channels, Workspace, h_infinity_norm_bound};
use friction::Tangent;
use linsys::SecondOrder;
use montecarlo::stream;
use nalgebra::DMatrix;
use num_complex::Complex;
use osc_model::{ContactPoint, FrictionChannels, Linearise, PreparedLattice, Sliding};
use rayon::prelude::*;

use super::{Plan, Sample, Scene};
use crate::Error;

/// Draws that show where the states of a lattice lie.
const PILOTS: u64 = 32;
/// How far below the median coefficient of friction an ellipse is tried, in spreads of the coefficient. Lower ones are
/// certified where the median is unstable.
const BELOW: [f64; 3] = [0.0, 0.75, 1.5];

/// What is certified of one lattice: ellipses in the plane of coefficient mu and slope `N0 h` of friction.
///
/// No state all of whose contacts lie in one of them has an eigenvalue with `Re lambda >= 0`, whatever the law, and whether
/// the contacts are alike or not. See [`h_infinity_norm_bound`] for the proof; docs/error-bounds.md puts it together.
#[derive(Debug, Clone, Default)]
pub struct Certificate {
    ellipses: Vec<Ellipse>,
    sizes: Sizes,
}

/// What bounds the eigenvalues of a lattice: 2-norms with the mass taken out symmetrically.
#[derive(Debug, Clone, Copy, Default)]
struct Sizes {
    /// Of C without friction, 1/s.
    damping: f64,
    /// Of K without friction, 1/s^2.
    stiffness: f64,
    /// Of what a slope of 1 Ns/m in every contact adds to C.
    slope: f64,
    /// Of what a coefficient of 1 in every contact adds to K, at most.
    coupling: f64,
}

#[derive(Debug, Clone, Copy)]
struct Ellipse {
    centre: Friction,
    half_axes: Friction,
}

/// Friction in one contact, as the equations see it, or a difference of two.
#[derive(Debug, Clone, Copy)]
struct Friction {
    /// Coefficient.
    mu: f64,
    /// N0 h, Ns/m.
    slope: f64,
}

/// The certificate of each lattice of a plan.
///
/// # Errors
/// Those of the model and of the scaling.
pub(super) fn certificates(plan: &Plan) -> Result<Vec<Certificate>, Error> {
    let pilots: Vec<Sample> =
        (0..PILOTS).filter_map(|index| Sample::draw(&plan.case, &mut stream(plan.case.seed, index)).ok()).collect();
    let of_lattice = |(at, (_, lattice)): (usize, &(usize, PreparedLattice))| {
        let scenes = plan.scenes.iter().filter(|scene| scene.lattice == at);
        let states = scenes.flat_map(|scene: &Scene| pilots.iter().filter_map(|pilot| plan.sliding(scene, pilot).ok()));
        Certificate::new(lattice, &states.collect::<Vec<_>>())
    };
    plan.lattices.par_iter().enumerate().map(of_lattice).collect()
}

impl Certificate {
    /// Certifies what it can of a lattice around the median of `states`.
    ///
    /// # Errors
    /// Those of the model and of the scaling.
    pub fn new(lattice: &PreparedLattice, states: &[Sliding]) -> Result<Self, Error> {
        let contacts = || states.iter().flat_map(|state| &state.contacts);
        let mus = quartiles(contacts().map(|point| point.tangent.mu).collect());
        let slopes = quartiles(contacts().map(middle_slope).collect());
        let (Some(channels), Some(mus), Some(slopes)) = (lattice.friction_channels(), mus, slopes) else {
            return Ok(Self::default());
        };
        let spread = Friction { mu: mus[2] - mus[0], slope: slopes[2] - slopes[0] };
        let sizes = Sizes::new(lattice.structural(), &channels);
        let weighted = Channels {
            position: stacked(spread.mu * &channels.coupling, 0.0 * &channels.coupling),
            velocity: stacked(0.0 * &channels.coupling, spread.slope * channels.force.transpose()),
            force: channels.force,
        };
        let mut ellipses = Vec::new();
        for below in BELOW {
            let centre = Friction { mu: (mus[1] - below * spread.mu).max(0.0), slope: slopes[1] };
            // Of the centre only the product of load and slope counts.
            let tangent = Tangent { mu: centre.mu, slope: centre.slope, internal: None };
            let point = ContactPoint { tangent, lateral_mu: 0.0, normal_load: 1.0, stiffness_factor: 1.0 };
            let contacts = vec![point; lattice.arrangement().in_contact().len()];
            let system = lattice.linearised(&Sliding { speed: 1.0, contacts })?;
            if let Ok(gain) = h_infinity_norm_bound(&system, &weighted, &mut Workspace::default())? {
                let half_axes = Friction { mu: spread.mu / gain, slope: spread.slope / gain };
                ellipses.push(Ellipse { centre, half_axes });
            }
        }
        Ok(Self { ellipses, sizes })
    }

    /// Whether the system in this state is proven to be stable.
    pub fn covers(&self, state: &Sliding) -> bool {
        let radius = self.sizes.radius(&state.contacts);
        self.ellipses.iter().any(|ellipse| state.contacts.iter().all(|point| ellipse.contains(point, radius)))
    }
}

impl Sizes {
    fn new(structure: &SecondOrder, channels: &FrictionChannels) -> Self {
        let mass = structure.m.clone().symmetric_eigen();
        let scale = DMatrix::from_diagonal(&mass.eigenvalues.map(|m| 1.0 / m.sqrt()));
        let root = &mass.eigenvectors * scale * mass.eigenvectors.transpose();
        let norm = |matrix: DMatrix<f64>| matrix.singular_values().max();
        let (force, coupling) = (norm(&root * &channels.force), norm(&channels.coupling * &root));
        Self {
            damping: norm(&root * &structure.c * &root),
            stiffness: norm(&root * &structure.k * &root),
            slope: force * force,
            coupling: force * coupling,
        }
    }

    /// No eigenvalue with `Re lambda >= 0` is farther from 0: `|lambda|^2 <= c |lambda| + k` with bounds c and k of damping
    /// and stiffness. Rad/s.
    fn radius(&self, contacts: &[ContactPoint]) -> f64 {
        let slopes = contacts.iter().flat_map(|p| p.tangent.slope_extremes().map(|slope| p.normal_load * slope.abs()));
        let c = self.damping + self.slope * slopes.fold(0.0, f64::max);
        let k = self.stiffness + self.coupling * contacts.iter().map(|p| p.tangent.mu).fold(0.0, f64::max);
        // The last factor is for rounding.
        (0.5 * c + (0.25 * c * c + k).sqrt()) * (1.0 + 1e-9)
    }
}

impl Ellipse {
    /// Whether friction in a contact stays in the ellipse for every lambda with `Re lambda >= 0`, `|lambda| <= radius`.
    fn contains(&self, point: &ContactPoint, radius: f64) -> bool {
        let Self { centre, half_axes } = self;
        let mu = part(point.tangent.mu - centre.mu, half_axes.mu);
        // The slope is farthest from one on the real axis at a corner of the half disc, or at its farthest point.
        let corners = [Complex::default(), Complex::new(radius, 0.0), Complex::new(0.0, radius)];
        let is_inside = |lambda| {
            let slope = point.normal_load * point.tangent.complex_slope(lambda) - centre.slope;
            let slope = part(slope.norm(), half_axes.slope);
            mu * mu + slope * slope < 1.0
        };
        point.stiffness_factor == 1.0 && corners.into_iter().all(is_inside)
    }
}

/// `difference / half_axis`, 0 for a parameter that does not vary.
fn part(difference: f64, half_axis: f64) -> f64 {
    if difference == 0.0 { 0.0 } else { difference / half_axis }
}

/// The middle of the slopes `N0 h` at 0 and at infinity, Ns/m.
fn middle_slope(point: &ContactPoint) -> f64 {
    0.5 * point.normal_load * point.tangent.slope_extremes().iter().sum::<f64>()
}

fn stacked(above: DMatrix<f64>, below: DMatrix<f64>) -> DMatrix<f64> {
    let rows = above.nrows();
    let mut both = above.resize_vertically(rows + below.nrows(), 0.0);
    both.rows_mut(rows, below.nrows()).copy_from(&below);
    both
}

/// First quartile, median and third quartile; `None` of nothing or of what is not finite.
fn quartiles(mut values: Vec<f64>) -> Option<[f64; 3]> {
    values.sort_unstable_by(f64::total_cmp);
    let all_finite = values.iter().all(|value| value.is_finite());
    let last = values.len().checked_sub(1).filter(|_| all_finite)?;
    Some([last / 4, last / 2, 3 * last / 4].map(|at| values[at]))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use cea::{EigenSolver, QrSolver};

    use super::*;
    use crate::case::Case;

    #[test]
    fn no_growing_eigenvalue_lies_beyond_the_radius() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/two-by-two.toml");
        let plan = Plan::new(Case::read(&path).unwrap()).unwrap();
        let (mut growing, mut nearest) = (0, f64::INFINITY);
        for index in 0..20 {
            let sample = Sample::draw(&plan.case, &mut stream(3, index)).unwrap();
            for scene in &plan.scenes {
                let lattice = plan.lattice(scene);
                let sizes = Sizes::new(lattice.structural(), &lattice.friction_channels().unwrap());
                let state = plan.sliding(scene, &sample).unwrap();
                let radius = sizes.radius(&state.contacts);
                let system = lattice.linearised(&state).unwrap();
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
        let tangent = Tangent {
            mu: 0.5,
            slope: -3.0,
            internal: Some(friction::InternalTangent { decay: 2e4, drive: -0.2, force: -1e5 }),
        };
        let (radius, stiff) =
            (1.5e4, ContactPoint { tangent, lateral_mu: 0.0, normal_load: 2.0, stiffness_factor: 1.0 });
        for centre in [-10.0, -5.0, -4.0, -1.0, 3.0] {
            let most = |half_axis: f64| {
                let half_axes = Friction { mu: 1.0, slope: half_axis };
                Ellipse { centre: Friction { mu: 0.5, slope: centre }, half_axes }.contains(&stiff, radius)
            };
            let inside = (0..=60).flat_map(|i| (0..=60).map(move |j| (i, j))).map(|(i, j)| {
                let angle = std::f64::consts::PI * (f64::from(j) / 60.0 - 0.5);
                Complex::from_polar(radius * f64::from(i) / 60.0, angle)
            });
            let farthest = inside.map(|l| (2.0 * tangent.complex_slope(l) - centre).norm()).fold(0.0, f64::max);
            assert!(most(farthest * (1.0 + 1e-9)) && !most(farthest * (1.0 - 1e-9)), "{centre}");
        }
    }
}
