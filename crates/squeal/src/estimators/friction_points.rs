//! The friction of a law in a speed range as sampling sees it, for all its scenes at once.
//!
//! With one draw for all contacts, friction acts on a mode through two numbers: mu and the complex slope
//! `H(i omega) = h + b_F b / (i omega + a)` of [`Tangent::complex_slope`]. Points of that plane cost no eigenproblem and
//! are the same for every arrangement of contacts.

use friction::Tangent;
use num_complex::Complex;

use super::EstimatorError;
use super::sampling::sobol_sample;
use crate::case::Draws;
use crate::study::{Plan, Sample, SceneKey};

/// Scrambled Sobol points of a law's tangents.
#[derive(Debug, Clone)]
pub struct FrictionPoints {
    /// Points by scrambling.
    pub(super) scramblings: Vec<Vec<Tangent>>,
    /// Points of one more scrambling, for making a surrogate: it must not depend on the points that its mean is taken over.
    pub(super) training: Vec<Tangent>,
    /// A frequency near the axis, rad/s.
    pub(super) omega: f64,
}

impl FrictionPoints {
    /// `points` of the Sobol sequence in each of `scramblings`, for the scenes of `plan` with the law and speed range of
    /// `key`; modes near the axis have frequencies about `omega`, rad/s.
    ///
    /// # Errors
    /// [`EstimatorError::NotShared`]; a draw that the law refuses.
    pub fn new(plan: &Plan, key: SceneKey, omega: f64, points: u32, scramblings: u32) -> Result<Self, EstimatorError> {
        let case = &plan.case;
        if case.readings.draws != Draws::Shared {
            return Err(EstimatorError::NotShared);
        }
        if points == 0 || points > 1 << 16 || scramblings < 2 {
            return Err(EstimatorError::Points { points, scramblings });
        }
        let of_scrambling = |seed: u32| {
            let of_index = |i: u32| tangent(plan, key, &sobol_sample(case, key.law, i, seed));
            (0..points).map(of_index).collect::<Result<Vec<Tangent>, EstimatorError>>()
        };
        let scrambled = (1..=scramblings).map(of_scrambling).collect::<Result<_, EstimatorError>>()?;
        Ok(Self { scramblings: scrambled, training: of_scrambling(0)?, omega })
    }

    /// The coordinates of a tangent: mu, Re H and Im H / Re H at [`FrictionPoints::omega`].
    pub(super) fn coordinates(&self, tangent: &Tangent) -> [f64; 3] {
        coordinates(tangent, self.omega)
    }
}

/// mu, Re H and Im H / Re H of a tangent at a frequency, rad/s.
pub(super) fn coordinates(tangent: &Tangent, omega: f64) -> [f64; 3] {
    let slope = tangent.complex_slope(Complex::new(0.0, omega));
    [tangent.mu, slope.re, if slope.re == 0.0 { 0.0 } else { slope.im / slope.re }]
}

/// The tangent of a sample in the scenes of `key`.
pub(super) fn tangent(plan: &Plan, key: SceneKey, sample: &Sample) -> Result<Tangent, EstimatorError> {
    let bristle_damping = plan.case.readings.bristle_damping;
    let tangent = sample.contact(0).tangent(key.law, plan.speed(key, sample), bristle_damping);
    Ok(tangent.map_err(crate::Error::from)?)
}
