//! Friction of a contact that slides slower than its stick speed, as a series of time.

use crate::contact::along;
use crate::series::MOST_TERMS;
use crate::{ContactFriction, SlidingContact};

/// Numbers of powers of the velocity by which a coefficient of friction is tried to be told; chosen: 5 of a smoothed constant one.
const POWERS: [usize; 3] = [5, 8, 11];

/// Part of the coefficient at the stick speed that its polynomial may miss; chosen, far below the error of a piece.
const MISSED: f64 = 1e-13;

/// A coefficient of friction without a state, below the stick speed on one side of rest: a polynomial of w / eps.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SlowFriction {
    eps: f64,
    /// Coefficients of Newton's form, and the values of w / eps at which its factors are 0.
    coefficients: Vec<f64>,
    knots: Vec<f64>,
}

impl SlowFriction {
    /// The coefficient of a contact on the side of positive velocities, or of negative ones; `None` where it has a state, or is no such polynomial.
    pub fn new(friction: &dyn ContactFriction, speed: f64, is_forward: bool) -> Option<Self> {
        if friction.steady_state(speed).is_some() {
            return None;
        }
        let (eps, sign) = (friction.stick_speed(), if is_forward { 1.0 } else { -1.0 });
        let mu = |part: f64| friction.at(eps * part, 0.0).mu;
        let most = mu(sign).abs();
        POWERS.into_iter().find_map(|powers| {
            let angle = |knot: usize| std::f64::consts::PI * (2 * knot + 1) as f64 / (2 * powers + 2) as f64;
            let knots: Vec<f64> = (0..=powers).map(|knot| sign * (0.5 - 0.5 * angle(knot).cos())).collect();
            let mut coefficients: Vec<f64> = knots.iter().map(|knot| mu(*knot)).collect();
            for order in 1..=powers {
                for at in (order..=powers).rev() {
                    let width = knots[at] - knots[at - order];
                    coefficients[at] = (coefficients[at] - coefficients[at - 1]) / width;
                }
            }
            let found = Self { eps, coefficients, knots };
            let misses = |part: f64| (found.at(sign * part) - mu(sign * part)).abs();
            // Between the knots, at the ends too.
            let is_held = (0..=4 * powers).all(|at| misses(at as f64 / (4 * powers) as f64) <= MISSED * most);
            is_held.then_some(found)
        })
    }

    /// The coefficient at a part of the stick speed.
    fn at(&self, part: f64) -> f64 {
        self.coefficients.iter().zip(&self.knots).rev().fold(0.0, |sum, (c, knot)| sum * (part - knot) + c)
    }
}

/// Friction of a contact in a piece of motion: the series of its coefficient and its force.
#[derive(Debug, Clone)]
pub(crate) struct Slow<'a> {
    contact: &'a SlidingContact,
    friction: &'a SlowFriction,
    /// Slopes of the force by the gap and by the velocity at the begin of the piece.
    slopes: [f64; 2],
    /// Terms of the normal force, N, and of w / eps.
    normal: [f64; MOST_TERMS],
    part: [f64; MOST_TERMS],
    /// Terms of the polynomial and of what its form has within, from the innermost on.
    within: Vec<[f64; MOST_TERMS]>,
}

impl<'a> Slow<'a> {
    /// A contact at the begin of a piece, with its friction and the slopes of that by the gap and by the velocity.
    pub fn new(contact: &'a SlidingContact, friction: &'a SlowFriction, slopes: [f64; 2]) -> Self {
        let within = vec![[0.0; MOST_TERMS]; friction.knots.len()];
        Self { contact, friction, slopes, normal: [0.0; MOST_TERMS], part: [0.0; MOST_TERMS], within }
    }

    /// Term k of the force, N, beyond its tangent at the begin of the piece, by terms k of displacements and velocities. The terms before must have been asked for; that
    /// of k = 0 is no remainder.
    pub fn remainder(&mut self, k: usize, u: &[f64], velocity: &[f64]) -> f64 {
        let (approach, slip) = (self.contact.approach(u), -along(&self.contact.sliding, velocity));
        let [load, speed] = if k == 0 { [self.contact.load, self.contact.speed] } else { [0.0; 2] };
        self.normal[k] = load + approach;
        self.part[k] = (speed + slip) / self.friction.eps;
        let product = |one: &[f64], other: &[f64]| (0..=k).map(|at| one[at] * other[k - at]).sum::<f64>();
        let last = self.friction.knots.len() - 1;
        for (at, knot) in (0..=last).zip(self.friction.knots.iter().rev()) {
            let constant = if k == 0 { self.friction.coefficients[last - at] } else { 0.0 };
            let before = at.checked_sub(1).map(|before| &self.within[before]);
            let inner = before.map_or(0.0, |before| product(before, &self.part) - knot * before[k]);
            self.within[at][k] = inner + constant;
        }
        product(&self.within[last], &self.normal) - self.slopes[0] * approach - self.slopes[1] * slip
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use std::sync::Arc;

    use friction::{AmontonsCoulomb, FrictionLaw, VelocityDependent, VelocityDependentParameters};

    use super::*;
    use crate::Smoothed;

    fn smoothed<L: FrictionLaw + std::fmt::Debug + Send + Sync + 'static>(law: L) -> Arc<dyn ContactFriction> {
        Arc::new(Smoothed { law, stick_speed: 0.05 })
    }

    #[test]
    fn a_force_is_its_tangent_and_the_terms_beyond_it() {
        let parameters = VelocityDependentParameters { mu_s: 0.6, mu_k: 0.3, alpha: 2.0 };
        let laws =
            [smoothed(AmontonsCoulomb::new(0.5).unwrap()), smoothed(VelocityDependent::new(parameters).unwrap())];
        for (law, is_forward) in laws.into_iter().flat_map(|law| [(law.clone(), true), (law, false)]) {
            let contact = SlidingContact {
                name: "belt".into(),
                family: "friction".into(),
                sliding: vec![(0, 1.0)],
                normal: vec![(0, 1.0)],
                stiffness: 2.0,
                load: 1.0,
                speed: 1.0,
                friction: law,
            };
            let friction = SlowFriction::new(&*contact.friction, 1.0, is_forward).unwrap();
            // Series of a displacement and of a velocity, whose sliding stays below the stick speed.
            let sign = if is_forward { 1.0 } else { -1.0 };
            let (u, v) = ([0.1, 0.04, -0.03], [1.0 - sign * 0.02, 0.012, 0.004]);
            let at = |of: [f64; 3], time: f64| of[0] + time * (of[1] + time * of[2]);
            let moment = |time: f64| (1.0 + 2.0 * at(u, time), contact.speed - at(v, time));
            let force = |(normal, slip): (f64, f64)| contact.friction.at(slip, 0.0).mu * normal;
            let (normal, slip) = moment(0.0);
            let begin = contact.friction.at(slip, 0.0);
            let slopes = [begin.mu, begin.mu_by_velocity * normal];
            let mut slow = Slow::new(&contact, &friction, slopes);
            let term = |of: [f64; 3], k: usize| of.get(k).copied().unwrap_or(0.0);
            let terms: Vec<f64> = (0..MOST_TERMS).map(|k| slow.remainder(k, &[term(u, k)], &[term(v, k)])).collect();
            for time in [0.3, 1.0] {
                let beyond = (1..MOST_TERMS).rev().fold(0.0, |sum, k| (sum + terms[k]) * time);
                let (later, slip_later) = moment(time);
                let tangent = slopes[0] * (later - normal) + slopes[1] * (slip_later - slip);
                let error = force((normal, slip)) + tangent + beyond - force((later, slip_later));
                assert!(error.abs() < 1e-12, "{is_forward} {time}: {error:e}");
            }
        }
    }

    #[test]
    fn friction_with_a_state_or_a_corner_is_no_polynomial() {
        #[derive(Debug)]
        struct Cornered;
        impl ContactFriction for Cornered {
            fn at(&self, velocity: f64, _: f64) -> friction::BristleMotion {
                friction::BristleMotion { mu: (velocity - 0.5).abs(), ..friction::BristleMotion::default() }
            }
            fn steady_state(&self, _: f64) -> Option<f64> {
                None
            }
            fn stick_speed(&self) -> f64 {
                1.0
            }
        }
        assert_eq!(SlowFriction::new(&Cornered, 2.0, true), None);
        assert!(SlowFriction::new(&Cornered, 2.0, false).is_some());
    }
}
