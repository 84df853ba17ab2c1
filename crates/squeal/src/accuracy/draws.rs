//! The friction of a law in a speed range as sampling sees it, for all its scenes at once.
//!
//! With one draw for all contacts, friction acts on a mode through two numbers: mu and the complex slope
//! `H(i omega) = h + b_F b / (i omega + a)` of [`Tangent::complex_slope`]. Points of that plane cost no eigenproblem and
//! are the same for every arrangement of contacts.

use friction::Tangent;
use num_complex::Complex;

use super::AccuracyError;
use super::sampling::sobol_sample;
use crate::case::Draws;
use crate::study::{Plan, Sample, SceneKey};

/// Slopes at which critical coefficients are computed.
const ROWS: usize = 25;

/// Scrambled Sobol points of a law's tangents, and the rows between which critical coefficients are interpolated.
#[derive(Debug, Clone)]
pub struct FrictionPoints {
    /// Points by scrambling.
    pub(super) scramblings: Vec<Vec<Tangent>>,
    /// A sample of each row, by ascending real part of the slope.
    pub(super) rows: Vec<Sample>,
    /// Smallest and largest mu of all points.
    pub(super) range: [f64; 2],
}

impl FrictionPoints {
    /// `points` of the Sobol sequence in each of `scramblings`, for the scenes of `plan` with the law and speed range of
    /// `key`; modes near the axis have frequencies about `omega`, rad/s.
    ///
    /// # Errors
    /// [`AccuracyError::NotShared`]; a draw that the law refuses.
    pub fn new(plan: &Plan, key: SceneKey, omega: f64, points: u32, scramblings: u32) -> Result<Self, AccuracyError> {
        let case = &plan.case;
        if case.readings.draws != Draws::Shared {
            return Err(AccuracyError::NotShared);
        }
        if points == 0 || points > 1 << 16 || scramblings < 2 {
            return Err(AccuracyError::Points { points, scramblings });
        }
        let of_scrambling = |seed: u32| {
            let of_index = |i: u32| tangent(plan, key, &sobol_sample(case, key.law, i, seed));
            (0..points).map(of_index).collect::<Result<Vec<Tangent>, AccuracyError>>()
        };
        // The rows have points of their own: the guess must not depend on those that its mean is taken over.
        let own = of_scrambling(0)?;
        let scramblings = (1..=scramblings).map(of_scrambling).collect::<Result<Vec<_>, AccuracyError>>()?;
        let mus = || own.iter().map(|t| t.mu);
        let range = [mus().fold(f64::INFINITY, f64::min), mus().fold(f64::NEG_INFINITY, f64::max)];
        Ok(Self { rows: rows(plan, key, omega, &own), scramblings, range })
    }
}

/// The tangent of a sample in the scenes of `key`.
pub(super) fn tangent(plan: &Plan, key: SceneKey, sample: &Sample) -> Result<Tangent, AccuracyError> {
    let bristle_damping = plan.case.readings.bristle_damping;
    let tangent = sample.contact(0).tangent(key.law, plan.speed(key, sample), bristle_damping);
    Ok(tangent.map_err(crate::Error::from)?)
}

/// Points to stand for a slope each: half-way between equal steps of the slope and equal parts of the probability, and in
/// the middle of the imaginary parts around it.
fn rows(plan: &Plan, key: SceneKey, omega: f64, tangents: &[Tangent]) -> Vec<Sample> {
    let slope = |t: &Tangent| t.complex_slope(Complex::new(0.0, omega));
    let mut order: Vec<(Complex<f64>, usize)> = tangents.iter().enumerate().map(|(i, t)| (slope(t), i)).collect();
    order.sort_by(|a, b| a.0.re.total_cmp(&b.0.re));
    let last = order.len() - 1;
    let (low, high) = (order[0].0.re, order[last].0.re);
    let mut found: Vec<(f64, usize)> = Vec::with_capacity(ROWS);
    for k in 0..ROWS {
        let part = k as f64 / (ROWS - 1) as f64;
        let wanted = 0.5 * (low + part * (high - low) + order[(part * last as f64) as usize].0.re);
        let at = order.partition_point(|(s, _)| s.re < wanted).min(last);
        // Around a far row there are few points, and none may belong to the row after it.
        let reach = (order.len() / (16 * ROWS)).min(at / 8).min((last - at) / 8);
        let mut near = order[at - reach..=at + reach].to_vec();
        near.sort_by(|a, b| a.0.im.total_cmp(&b.0.im));
        let (s, index) = near[near.len() / 2];
        if found.last().is_none_or(|&(before, _)| s.re > before) {
            found.push((s.re, index));
        }
    }
    if found.len() == 1 {
        found.push(found[0]);
    }
    found.into_iter().map(|(_, i)| sobol_sample(&plan.case, key.law, i as u32, 0)).collect()
}
