//! A contact that may open, slide and stick.

use std::sync::Arc;

use crate::{ContactFriction, Error};

/// Difference, relative, below which two ways to say a friction say the same; chosen: of a law that is written twice, rounding stays far below it.
const SAME: f64 = 1e-6;

/// A contact of one normal direction and one direction of sliding.
///
/// With u the displacement from steady sliding, z the state of a bristle and mu0 the coefficient in steady sliding, its normal force is
/// `N = max(0, N0 + k c^T u)` and its sliding velocity `w = v - b^T u'`. It adds the forces `-c (N - N0)`, of which the part `-c k c^T u` is that of the
/// spring in the structure's K, and `b (mu(w, z) N - mu0 N0)`, both zero in steady sliding. A contact that is open in steady sliding has a negative N0, `-k`
/// times its gap, and no spring in K: until its spring is pressed it has no force, and `-c N` and `b mu(w, z) N` act then.
#[derive(Debug, Clone)]
pub struct SlidingContact {
    /// Name of the contact.
    pub name: String,
    /// The family to which the work of its friction belongs.
    pub family: String,
    /// b, the direction in which friction drags the structure: degrees of freedom, from 0, with coefficients.
    pub sliding: Vec<(usize, f64)>,
    /// c, the approach of the contact: degrees of freedom, from 0, with coefficients; empty where the normal force does not change.
    pub normal: Vec<(usize, f64)>,
    /// k, the stiffness of the contact spring, N/m, which is in the structure's K as `k c c^T`, unless the contact is open in steady sliding; 0
    /// will do where `normal` is empty.
    pub stiffness: f64,
    /// N0, the normal force in steady sliding, N; of a contact that is open there `-k` times its gap. Not 0.
    pub load: f64,
    /// v, the speed of steady sliding, m/s; > 0.
    pub speed: f64,
    /// Friction law.
    pub friction: Arc<dyn ContactFriction>,
}

impl SlidingContact {
    /// Refuses what is no contact on `order` degrees of freedom.
    pub(crate) fn check(&self, order: usize) -> Result<(), Error> {
        let refused = |field, value, allowed| Error::Contact { contact: self.name.clone(), field, value, allowed };
        for (field, value) in [("speed", self.speed), ("stick speed", self.friction.stick_speed())] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(refused(field, value, "finite and > 0"));
            }
        }
        if !(self.load.is_finite() && (self.load > 0.0 || (self.load < 0.0 && !self.normal.is_empty()))) {
            return Err(refused(
                "load",
                self.load,
                "finite and > 0, or < 0 of a contact that is open in steady sliding",
            ));
        }
        let is_spring = self.stiffness.is_finite() && (self.stiffness > 0.0 || self.normal.is_empty());
        if !is_spring {
            let allowed = "finite, and > 0 of a contact that has a normal direction";
            return Err(refused("stiffness", self.stiffness, allowed));
        }
        if self.friction.stick_speed() >= self.speed {
            return Err(refused("stick speed", self.friction.stick_speed(), "below the speed of steady sliding"));
        }
        if let Some((field, value)) = self.contradiction() {
            return Err(refused(field, value, "that of the coefficient where it slides, and of its derivatives"));
        }
        let mut entries = self.sliding.iter().chain(&self.normal);
        match entries.find(|(dof, value)| *dof >= order || !value.is_finite()) {
            Some(&(dof, _)) => {
                Err(refused("degree of freedom", dof as f64, "one of the structure, with a finite coefficient"))
            }
            None => Ok(()),
        }
    }

    /// What its friction says of the coefficient in steady sliding and, backwards, in its mirror image, otherwise than by its coefficient: as a constant, or
    /// by the first two terms of its series.
    fn contradiction(&self) -> Option<(&'static str, f64)> {
        let steady = self.friction.steady_state(self.speed);
        for sign in [1.0, -1.0] {
            let (velocity, state) = (sign * self.speed, sign * steady.unwrap_or(0.0));
            let sliding = self.friction.sliding(self.speed, sign > 0.0);
            let at = sliding.unwrap_or_else(|| self.friction.at(velocity, state));
            if self.friction.is_constant() && at.mu_by_velocity != 0.0 {
                return Some(("slope of constant friction", at.mu_by_velocity));
            }
            let Some(mut series) = self.friction.series() else { continue };
            // In steady sliding the rate of a bristle is the difference of two speeds.
            let scale = [at.mu.abs(), self.speed];
            for [faster, stretched] in [[self.speed, 0.0], [0.0, state]] {
                series.begin(sign > 0.0);
                let mu = at.mu_by_velocity * faster + at.mu_by_state * stretched;
                let rate = at.rate_by_velocity * faster + at.rate_by_state * stretched;
                for (found, expected) in
                    [(series.next(velocity, state), [at.mu, at.rate]), (series.next(faster, stretched), [mu, rate])]
                {
                    for (i, field) in
                        ["coefficient by its series", "rate of the state by its series"].into_iter().enumerate()
                    {
                        let is_same = (found[i] - expected[i]).abs() <= SAME * (scale[i] + expected[i].abs());
                        if !is_same {
                            return Some((field, found[i]));
                        }
                    }
                }
            }
        }
        None
    }

    /// True of a contact that presses in steady sliding.
    pub(crate) fn is_closed(&self) -> bool {
        self.load > 0.0
    }

    /// Normal force in steady sliding, N: N0, or 0 of a contact that is open there.
    pub(crate) fn steady_load(&self) -> f64 {
        self.load.max(0.0)
    }

    /// k c^T u, the change of the normal force of a closed contact, N.
    pub(crate) fn change_of_load(&self, u: &[f64]) -> f64 {
        self.stiffness * along(&self.normal, u)
    }

    /// w, the sliding velocity, m/s.
    pub(crate) fn slip(&self, velocity: &[f64]) -> f64 {
        self.speed - along(&self.sliding, velocity)
    }

    /// Bristle state in steady sliding, and the coefficient there.
    pub(crate) fn steady(&self) -> (f64, f64) {
        let state = self.friction.steady_state(self.speed).unwrap_or(0.0);
        (state, self.friction.at(self.speed, state).mu)
    }
}

/// A sparse vector times a dense one.
pub(crate) fn along(sparse: &[(usize, f64)], dense: &[f64]) -> f64 {
    sparse.iter().map(|&(dof, value)| value * dense[dof]).sum()
}

/// Way in which the friction of a contact acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sliding {
    /// By a law without a jump, at any velocity.
    Smooth,
    /// By its law, at positive velocities.
    Forwards,
    /// By its law, at negative velocities.
    Backwards,
    /// By what keeps it from sliding.
    Stuck,
}

impl Sliding {
    /// The side of a velocity; 0, where the caller asks whether it sticks, belongs to either.
    pub fn of(velocity: f64) -> Self {
        if velocity > 0.0 { Self::Forwards } else { Self::Backwards }
    }
}
