//! Sliding states whose systems are all stable, by proof: their samples need no spectrum.

use cea::{Channels, Workspace, peak_gain};
use friction::Tangent;
use montecarlo::stream;
use nalgebra::DMatrix;
use osc_model::{ContactPoint, Linearise, PreparedLattice, Sliding};
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
/// the contacts are alike or not. See [`peak_gain`] for the proof; docs/error-bounds.md puts it together.
#[derive(Debug, Clone, Default)]
pub struct Certificate(Vec<Ellipse>);

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
        let slopes = quartiles(contacts().map(|point| 0.5 * slopes(point).iter().sum::<f64>()).collect());
        let (Some(channels), Some(mus), Some(slopes)) = (lattice.friction_channels(), mus, slopes) else {
            return Ok(Self::default());
        };
        let spread = Friction { mu: mus[2] - mus[0], slope: slopes[2] - slopes[0] };
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
            if let Some(gain) = peak_gain(&system, &weighted, &mut Workspace::default())? {
                let half_axes = Friction { mu: spread.mu / gain, slope: spread.slope / gain };
                ellipses.push(Ellipse { centre, half_axes });
            }
        }
        Ok(Self(ellipses))
    }

    /// Whether the system in this state is proven to be stable.
    pub fn covers(&self, state: &Sliding) -> bool {
        self.0.iter().any(|ellipse| state.contacts.iter().all(|point| ellipse.contains(point)))
    }
}

impl Ellipse {
    fn contains(&self, point: &ContactPoint) -> bool {
        let Self { centre, half_axes } = self;
        // A disc around a point of the real axis is farthest from another one at an end of its real diameter.
        let [a, b] = slopes(point).map(|slope| part(slope - centre.slope, half_axes.slope));
        let mu = part(point.tangent.mu - centre.mu, half_axes.mu);
        // Each side of the sum, so that a NaN is outside.
        point.stiffness_factor == 1.0 && mu * mu + a * a < 1.0 && mu * mu + b * b < 1.0
    }
}

/// `difference / half_axis`, 0 for a parameter that does not vary.
fn part(difference: f64, half_axis: f64) -> f64 {
    if difference == 0.0 { 0.0 } else { difference / half_axis }
}

/// N0 h, Ns/m, at infinity and at 0: the ends of a diameter of the disc where it lies for `Re lambda >= 0`.
fn slopes(point: &ContactPoint) -> [f64; 2] {
    point.tangent.slope_extremes().map(|slope| point.normal_load * slope)
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
