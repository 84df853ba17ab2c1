//! Velocity-dependent friction: an exponential fall from the static to the kinetic coefficient.

use crate::error::{non_negative, static_not_below_kinetic};
use crate::series::{CurveSeries, Exponent};
use crate::{FrictionError, FrictionLaw, FrictionSeries, Steady, Tangent};

/// Parameters of [`VelocityDependent`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocityDependentParameters {
    /// Static coefficient, the limit at speed 0; >= `mu_k`.
    pub mu_s: f64,
    /// Kinetic coefficient, the limit at high speed; >= 0.
    pub mu_k: f64,
    /// Rate of the fall over speed, s/m; >= 0.
    pub alpha: f64,
}

/// `mu(v) = mu_k + (mu_s - mu_k) e^{-alpha v}`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocityDependent {
    parameters: VelocityDependentParameters,
}

impl VelocityDependent {
    /// The law with these parameters.
    ///
    /// # Errors
    /// A parameter out of the range that its field states.
    pub fn new(parameters: VelocityDependentParameters) -> Result<Self, FrictionError> {
        non_negative("mu_k", parameters.mu_k)?;
        non_negative("mu_s", parameters.mu_s)?;
        static_not_below_kinetic(parameters.mu_s, parameters.mu_k)?;
        non_negative("alpha", parameters.alpha)?;
        Ok(Self { parameters })
    }

    /// `(mu_s - mu_k) e^{-alpha v}`, the part of mu above the kinetic coefficient.
    fn excess(&self, speed: f64) -> f64 {
        let p = &self.parameters;
        (p.mu_s - p.mu_k) * (-p.alpha * speed).exp()
    }
}

impl FrictionLaw for VelocityDependent {
    fn steady(&self, speed: f64) -> Result<Steady, FrictionError> {
        Steady::new(speed, self.parameters.mu_k + self.excess(speed))
    }

    fn tangent(&self, at: &Steady) -> Tangent {
        Tangent { mu: at.mu(), slope: -self.parameters.alpha * self.excess(at.speed()), internal: None }
    }

    fn series(&self) -> Option<Box<dyn FrictionSeries>> {
        let VelocityDependentParameters { mu_s, mu_k, alpha } = self.parameters;
        Some(Box::new(CurveSeries::new([mu_k, mu_s - mu_k, 0.0], Exponent::Linear(alpha))))
    }
}
