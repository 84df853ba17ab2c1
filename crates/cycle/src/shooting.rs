//! Periodic motions by shooting, and their Floquet multipliers from the variational equation.

use nalgebra::{DMatrix, DVector, Schur};
use num_complex::Complex;
use serde::{Deserialize, Serialize};

use crate::factor::Factor;
use crate::path::Path;
use crate::size::amplitude;
use crate::{ContactSystem, Error};

/// Corrections after which a shooting has failed; chosen.
const MOST_CORRECTIONS: usize = 24;

/// Part of the residual so far up to which the next one says that the derivative used is good enough for one more; chosen.
const USEFUL: f64 = 0.1;

/// Part of the least residual so far up to which a correction counts as one, and the number of corrections one after the other that do not, after which a shooting has failed;
/// chosen.
const CORRECTED: f64 = 0.5;
const MOST_IN_VAIN: usize = 3;

/// Multipliers up to this far beyond the unit circle count as on it; chosen, far above the error of a monodromy matrix.
const ON_THE_CIRCLE: f64 = 1e-5;

/// A periodic motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cycle {
    /// State of motion at its begin.
    pub start: Vec<f64>,
    /// Period, s.
    pub period: f64,
    /// Difference of the states at begin and end, relative to the motion's scales and size.
    pub residual: f64,
    /// Floquet multipliers, by magnitude, largest first, without the one of a shift in time.
    pub multipliers: Vec<Complex<f64>>,
}

impl Cycle {
    /// Frequency, Hz.
    #[must_use]
    pub fn frequency_hz(&self) -> f64 {
        1.0 / self.period
    }

    /// The largest multiplier's magnitude: what a small deviation becomes in a period.
    #[must_use]
    pub fn largest_multiplier(&self) -> f64 {
        self.multipliers.first().map_or(0.0, |multiplier| multiplier.norm())
    }

    /// True if neighbouring motions do not leave it: no multiplier is larger than 1 + 1e-5. A cycle whose neighbours neither come nor go counts
    /// as stable.
    #[must_use]
    pub fn is_stable(&self) -> bool {
        self.largest_multiplier() <= 1.0 + ON_THE_CIRCLE
    }
}

/// Derivative of the state after a period by the state at the begin, both in scales.
fn monodromy(
    system: &ContactSystem,
    start: &[f64],
    period: f64,
    scales: &[f64],
    tolerance: f64,
) -> Result<DMatrix<f64>, Error> {
    let mut matrix = DMatrix::from_diagonal(&DVector::from_column_slice(scales));
    let mut motion = Path::new(system, start.to_vec(), scales, tolerance, 0.1 * period, &[])?;
    while motion.time < period {
        motion.step(period)?;
        motion.carry(&mut matrix)?;
    }
    matrix.row_iter_mut().zip(scales).for_each(|(mut row, scale)| row /= *scale);
    Ok(matrix)
}

/// The periodic motion near a state and a period, by Newton's method on `x(T; x_0) = x_0` with `x_0` moved across the motion, and its
/// multipliers.
///
/// # Errors
/// [`Error::NoConvergence`]; a motion that cannot be followed.
pub fn shoot(
    system: &ContactSystem,
    start: Vec<f64>,
    period: f64,
    scales: &[f64],
    tolerance: f64,
) -> Result<Cycle, Error> {
    let d = system.dimension();
    let (mut x, mut period, mut best) = (start, period, f64::INFINITY);
    let mut rate = vec![0.0; d];
    let wanted = (1e3 * tolerance).min(1e-6);
    let (mut kept, mut in_vain) = (None, 0);
    for _ in 0..MOST_CORRECTIONS {
        let mut motion = Path::new(system, x.clone(), scales, tolerance, 0.1 * period, &[])?;
        while motion.time < period {
            motion.step(period)?;
        }
        let end = motion.x;
        let size = amplitude(&x, scales).max(f64::MIN_POSITIVE);
        let difference = DVector::from_fn(d, |i, _| (end[i] - x[i]) / scales[i]);
        let residual = difference.amax() / size;
        // The derivative of a start before will do as long as it brings the motion nearer quickly.
        let is_slow = residual > USEFUL * best;
        if residual < 10.0 * tolerance || (residual < wanted && is_slow) {
            let multipliers = multipliers(monodromy(system, &x, period, scales, tolerance)?)?;
            return Ok(Cycle { start: x, period, residual, multipliers });
        }
        if is_slow {
            kept = None;
        }
        in_vain = if residual > CORRECTED * best { in_vain + 1 } else { 0 };
        if in_vain == MOST_IN_VAIN {
            break;
        }
        best = best.min(residual);
        let bordered = match kept.take() {
            Some(bordered) => bordered,
            None => {
                let mut bordered = DMatrix::zeros(d + 1, d + 1);
                let matrix = monodromy(system, &x, period, scales, tolerance)?;
                bordered.view_mut((0, 0), (d, d)).copy_from(&(matrix - DMatrix::identity(d, d)));
                system.rate(&end, &mut rate);
                (0..d).for_each(|i| bordered[(i, d)] = rate[i] * period / scales[i]);
                system.rate(&x, &mut rate);
                (0..d).for_each(|i| bordered[(d, i)] = rate[i] * period / scales[i]);
                Factor::new(bordered)
            }
        };
        let right = DVector::from_fn(d + 1, |i, _| if i < d { -difference[i] } else { 0.0 });
        let Some(step) = bordered.as_ref().and_then(|bordered| bordered.solve(&right)) else { break };
        // Far from a solution a full step leaves the motion.
        let factor = (0.5 * size / step.rows(0, d).amax()).min(0.2 / step[d].abs()).min(1.0);
        x.iter_mut().zip(scales).zip(&step).for_each(|((x, scale), step)| *x += factor * scale * step);
        period *= 1.0 + factor * step[d];
        kept = Some(bordered);
    }
    Err(Error::NoConvergence { method: "shooting", residual: best })
}

/// Floquet multipliers of a monodromy matrix, without the one nearest 1.
fn multipliers(matrix: DMatrix<f64>) -> Result<Vec<Complex<f64>>, Error> {
    let failed = Error::NoConvergence { method: "the spectrum of the monodromy matrix", residual: f64::NAN };
    let schur = Schur::try_new(matrix, f64::EPSILON, 100_000).ok_or(failed)?;
    let mut all: Vec<Complex<f64>> = schur.complex_eigenvalues().iter().copied().collect();
    all.sort_by(|a, b| (a - 1.0).norm().total_cmp(&(b - 1.0).norm()));
    all.remove(0);
    all.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
    Ok(all)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use std::sync::Arc;

    use friction::{AmontonsCoulomb, BristleDamping, LuGre, LuGreParameters};
    use friction::{VelocityDependent, VelocityDependentParameters};
    use linsys::SecondOrder;
    use nalgebra::dmatrix;

    use super::*;
    use crate::motion::state_after;
    use crate::{Bristled, ContactFriction, Part, SlidingContact, Smoothed};

    /// Two masses, one on a belt whose contact may open.
    fn system(friction: Arc<dyn ContactFriction>) -> ContactSystem {
        let (m, c) = (dmatrix![1.0, 0.0; 0.0, 1.5], dmatrix![0.05, 0.01; 0.01, 0.1]);
        let matrices = SecondOrder::new(m, c, dmatrix![2.0, 1.0; 1.0, 3.0]).unwrap();
        let belt = SlidingContact {
            name: "belt".into(),
            family: "friction".into(),
            sliding: vec![(0, 1.0)],
            normal: vec![(1, 1.0), (0, -0.2)],
            stiffness: 0.8,
            load: 1.0,
            speed: 1.0,
            friction,
        };
        ContactSystem::new(vec![Part { family: "structure".into(), matrices }], vec![belt]).unwrap()
    }

    #[test]
    fn a_bristle_whose_sliding_turns_has_the_slopes_of_the_side_that_it_turns_to() {
        let parameters = LuGreParameters {
            mu_s: 0.6,
            mu_k: 0.4,
            v_s: 0.5,
            sigma0: 1e4,
            sigma1: 20.0,
            sigma2: 0.0,
            bristle_damping: BristleDamping::Constant,
        };
        let law = LuGre::new(parameters).unwrap();
        let system = system(Arc::new(Bristled { law, stick_speed: 0.01 }));
        let (scales, mut turns) = (system.scales(1.0), 0);
        let mut motion = Path::new(&system, vec![0.3, -1.7, 1.4, 0.6, 0.0], &scales, 1e-10, 0.1, &[]).unwrap();
        let mut x = motion.x.clone();
        while motion.time < 50.0 {
            let begin = motion.x.clone();
            motion.step(50.0).unwrap();
            let turned = 1.0 - begin[2];
            if turned.abs() > 1e-12 {
                continue;
            }
            turns += 1;
            motion.at_part(0.5, &mut x);
            let side = (1.0 - x[2]).signum();
            let expected = law.moving(side * 1e-300, law.steady_bristle(1.0) + begin[4]).rate_by_velocity;
            assert!((motion.forces[0].rate_by_velocity - expected).abs() < 1e-9 * expected.abs(), "{turned}");
        }
        assert!(turns >= 5, "{turns}");
    }

    #[test]
    fn deviations_are_limits_of_differences_where_contacts_open_slide_and_stick() {
        let parameters = VelocityDependentParameters { mu_s: 0.6, mu_k: 0.3, alpha: 2.0 };
        let bristles = LuGreParameters {
            mu_s: 0.6,
            mu_k: 0.3,
            v_s: 0.5,
            sigma0: 20.0,
            sigma1: 1.0,
            sigma2: 0.02,
            bristle_damping: BristleDamping::Decaying,
        };
        let laws: [Arc<dyn ContactFriction>; 3] = [
            Arc::new(Smoothed { law: AmontonsCoulomb::new(0.5).unwrap(), stick_speed: 0.1 }),
            Arc::new(Smoothed { law: VelocityDependent::new(parameters).unwrap(), stick_speed: 0.1 }),
            Arc::new(Bristled { law: LuGre::new(bristles).unwrap(), stick_speed: 0.1 }),
        ];
        for law in laws {
            let system = system(law);
            let (d, scales, time) = (system.dimension(), system.scales(1.0), 7.0);
            let mut start = vec![0.3, -1.7, 1.4, 0.6, 0.0];
            start.truncate(d);
            let after = |by: f64, of: usize| {
                let moved = start.iter().enumerate().map(|(at, x)| if at == of { x + by * scales[of] } else { *x });
                state_after(&system, moved.collect(), time, 1.0, 1e-12).unwrap()
            };
            let found = monodromy(&system, &start, time, &scales, 1e-12).unwrap();
            for of in 0..d {
                let (ahead, behind) = (after(1e-5, of), after(-1e-5, of));
                for at in 0..d {
                    let difference = (ahead[at] - behind[at]) / (2e-5 * scales[at]);
                    assert!((difference - found[(at, of)]).abs() < 1e-6, "{at} {of}: {difference} {}", found[(at, of)]);
                }
            }
        }
    }
}
