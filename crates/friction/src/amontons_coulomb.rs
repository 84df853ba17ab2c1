//! Amontons-Coulomb friction: a constant coefficient.

use crate::error::non_negative;
use crate::{FrictionError, FrictionLaw, Steady, Tangent};

/// Friction with the same `mu` at every speed: the tangent has slope 0, and friction acts through the normal force alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AmontonsCoulomb {
    mu: f64,
}

impl AmontonsCoulomb {
    /// The law with coefficient `mu >= 0`.
    ///
    /// # Errors
    /// A coefficient that is negative or not finite.
    pub fn new(mu: f64) -> Result<Self, FrictionError> {
        non_negative("mu", mu)?;
        Ok(Self { mu })
    }
}

impl FrictionLaw for AmontonsCoulomb {
    fn steady(&self, speed: f64) -> Result<Steady, FrictionError> {
        Steady::new(speed, self.mu)
    }

    fn tangent(&self, at: &Steady) -> Tangent {
        Tangent { mu: at.mu(), slope: 0.0, internal: None }
    }

    fn is_constant(&self) -> bool {
        true
    }
}
