//! Quasi-random points of the friction of a scene, computed without an eigenproblem.
//!
//! Friction that is the same in all contacts acts on a mode of frequency omega through two numbers: mu and the complex slope `s(i omega)` of
//! [`ChannelGain::complex_slope`], which surrogates call H.

use linsys::{ChannelGain, OperatingPoint};
use montecarlo::rand::RngExt as _;
use montecarlo::stream;
use num_complex::Complex;
use rayon::prelude::*;

use super::EstimatorError;
use crate::{Scene, UncertainBrake};

/// Most points of the Sobol sequence, by the tables of the generator.
const MOST_POINTS: u32 = 1 << 16;
/// Dimensions of the Sobol sequence, by the same tables.
const MOST_DIMENSIONS: u32 = sobol_burley::NUM_DIMENSIONS;
/// Number of points at which the friction of two scenes is compared before one scene uses the points of the other; chosen: with fewer, friction that differs
/// elsewhere passes for the same; with more, the comparison takes longer.
const COMPARED_POINTS: usize = 64;

/// Scrambled Sobol points of the friction of a scene.
#[derive(Debug, Clone)]
pub struct FrictionPoints {
    /// The points of each scrambling.
    pub(super) scramblings: Vec<Vec<ChannelGain>>,
    /// Points of one more scrambling, from which a surrogate is made: it must not depend on the points of its mean.
    pub(super) training: Vec<ChannelGain>,
    /// Frequency that the modes near the axis have about, rad/s.
    pub(super) omega: f64,
}

impl FrictionPoints {
    /// `points` of the Sobol sequence in each of `scramblings`, for a scene of a brake; modes near the axis have frequencies
    /// about `omega`, rad/s.
    ///
    /// # Errors
    /// [`EstimatorError::NotShared`]; a sample that has no operating point.
    pub fn new<B: UncertainBrake>(
        brake: &B,
        scene: &Scene,
        omega: f64,
        points: u32,
        scramblings: u32,
    ) -> Result<Self, EstimatorError> {
        check_points(points, scramblings)?;
        let friction = LeadingFriction::new(brake, scene)?;
        let of_scrambling = |seed: u32| {
            let of_index = |i: u32| friction.at_sobol_point(i, seed);
            (0..points).map(of_index).collect::<Result<Vec<ChannelGain>, EstimatorError>>()
        };
        let scramblings =
            (1..=scramblings).into_par_iter().map(of_scrambling).collect::<Result<_, EstimatorError>>()?;
        Ok(Self { scramblings, training: of_scrambling(0)?, omega })
    }

    /// True if these points can be used for another scene: if its friction has the same values at the first few of the points.
    ///
    /// # Errors
    /// As [`FrictionPoints::new`].
    pub fn serves<B: UncertainBrake>(&self, brake: &B, scene: &Scene) -> Result<bool, EstimatorError> {
        let friction = LeadingFriction::new(brake, scene)?;
        for (index, gain) in self.training.iter().take(COMPARED_POINTS).enumerate() {
            if friction.at_sobol_point(index as u32, 0)? != *gain {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The coordinates of a gain: mu, Re s and Im s / Re s at [`FrictionPoints::omega`].
    pub(super) fn coordinates(&self, gain: &ChannelGain) -> [f64; 3] {
        coordinates(gain, self.omega)
    }
}

/// mu, Re s and Im s / Re s of a gain at a frequency, rad/s.
pub(super) fn coordinates(gain: &ChannelGain, omega: f64) -> [f64; 3] {
    let slope = gain.complex_slope(Complex::new(0.0, omega));
    [gain.mu, slope.re, if slope.re == 0.0 { 0.0 } else { slope.im / slope.re }]
}

/// The friction of a scene in the leading channels, which have the same gain as the first one at median parameters: all channels,
/// or those along the sliding where friction across it has separate channels.
pub(super) struct LeadingFriction<'a, B: UncertainBrake> {
    brake: &'a B,
    scene: &'a Scene,
    /// The operating point at median parameters.
    median: OperatingPoint,
    /// Number of leading channels.
    alike: usize,
}

impl<'a, B: UncertainBrake> LeadingFriction<'a, B> {
    /// # Errors
    /// [`EstimatorError::NotShared`] for a brake without friction channels.
    pub fn new(brake: &'a B, scene: &'a Scene) -> Result<Self, EstimatorError> {
        let median = brake.operating_point(scene, &brake.median())?;
        let first = median.channels.first().ok_or(EstimatorError::NotShared)?;
        let alike = median.channels.iter().take_while(|gain| *gain == first).count();
        Ok(Self { brake, scene, alike, median })
    }

    /// The gain of a sample.
    ///
    /// # Errors
    /// [`EstimatorError::NotShared`] where the leading channels differ, or the structure differs from that at median parameters.
    pub fn of(&self, sample: &B::Sample) -> Result<ChannelGain, EstimatorError> {
        let at = self.brake.operating_point(self.scene, sample)?;
        let first = at.channels.first().ok_or(EstimatorError::NotShared)?;
        let is_shared = at.channels[..self.alike].iter().all(|gain| gain == first);
        if is_shared && at.coefficients == self.median.coefficients {
            Ok(*first)
        } else {
            Err(EstimatorError::NotShared)
        }
    }

    /// The operating point at median parameters, with a gain in the leading channels.
    pub fn point(&self, gain: &ChannelGain) -> OperatingPoint {
        let mut point = self.median.clone();
        point.channels[..self.alike].fill(*gain);
        point
    }

    fn at_sobol_point(&self, index: u32, seed: u32) -> Result<ChannelGain, EstimatorError> {
        let sample = sobol_sample(self.brake, self.scene, index, seed)?;
        self.of(&sample)
    }
}

/// An error unless the numbers of Sobol points and of scramblings are allowed.
pub(super) fn check_points(points: u32, scramblings: u32) -> Result<(), EstimatorError> {
    let is_allowed = (1..=MOST_POINTS).contains(&points) && scramblings >= 2;
    if is_allowed { Ok(()) } else { Err(EstimatorError::Points { points, scramblings }) }
}

/// The sample at a point of a scrambled Sobol sequence.
///
/// # Errors
/// [`EstimatorError::NotShared`] for a brake whose samples are not functions of a point of the unit cube.
pub(super) fn sobol_sample<B: UncertainBrake>(
    brake: &B,
    scene: &Scene,
    index: u32,
    seed: u32,
) -> Result<B::Sample, EstimatorError> {
    // A number of 24 bits in [0, 1), moved to the middle of its step, because quantiles at 0 and 1 may be infinite.
    let uniform = |dimension: u32| match dimension {
        // Beyond the dimensions of the sequence, numbers at random.
        _ if dimension >= MOST_DIMENSIONS => {
            let random: f64 = stream(u64::from(seed) << 32 | u64::from(dimension), u64::from(index)).random();
            random.max(f64::EPSILON)
        }
        _ => f64::from(sobol_burley::sample(index, dimension, seed)) + 0.5_f64.powi(25),
    };
    brake.drawn_inputs().map(|drawn| drawn.quantile_sample(scene, &uniform)).ok_or(EstimatorError::NotShared)
}
