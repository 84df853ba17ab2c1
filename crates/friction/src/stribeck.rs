//! The Stribeck curve as a friction law: LuGre without bristles.

use crate::error::{non_negative, positive, static_not_below_kinetic};
use crate::series::{CurveSeries, Exponent};
use crate::{FrictionError, FrictionLaw, FrictionSeries, Steady, Tangent};

/// Parameters of [`Stribeck`], the static part of the parameters of [`LuGre`](crate::LuGre).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StribeckParameters {
    /// Static coefficient, the limit at speed 0; >= `mu_k`.
    pub mu_s: f64,
    /// Kinetic coefficient, the limit of g at high speed; > 0.
    pub mu_k: f64,
    /// Stribeck speed v_s, m/s; > 0.
    pub v_s: f64,
    /// Viscous coefficient sigma2 per unit normal force, s/m; >= 0.
    pub sigma2: f64,
}

/// `mu(v) = g(v) + sigma2 v`, `g(v) = mu_k + (mu_s - mu_k) e^{-(v / v_s)^2}`, without delay.
///
/// The Stribeck law has the same steady coefficient as [`LuGre`](crate::LuGre), so that a difference between the results of the two
/// is due to the bristles and not to the curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stribeck {
    parameters: StribeckParameters,
}

impl Stribeck {
    /// The law with these parameters.
    ///
    /// # Errors
    /// A parameter out of the range that its field states.
    pub fn new(parameters: StribeckParameters) -> Result<Self, FrictionError> {
        positive("mu_k", parameters.mu_k)?;
        positive("mu_s", parameters.mu_s)?;
        static_not_below_kinetic(parameters.mu_s, parameters.mu_k)?;
        positive("v_s", parameters.v_s)?;
        non_negative("sigma2", parameters.sigma2)?;
        Ok(Self { parameters })
    }

    /// Decay factor `e^{-(v / v_s)^2}`.
    pub(crate) fn decay(&self, speed: f64) -> f64 {
        (-(speed / self.parameters.v_s).powi(2)).exp()
    }

    /// Slope of the decay factor over the speed, s/m.
    pub(crate) fn decay_slope(&self, speed: f64) -> f64 {
        -2.0 * speed / self.parameters.v_s.powi(2) * self.decay(speed)
    }

    /// Coefficient g(v).
    pub(crate) fn g(&self, speed: f64) -> f64 {
        let p = &self.parameters;
        p.mu_k + (p.mu_s - p.mu_k) * self.decay(speed)
    }

    /// Slope g'(v), s/m.
    pub(crate) fn g_slope(&self, speed: f64) -> f64 {
        let p = &self.parameters;
        -2.0 * (p.mu_s - p.mu_k) * (speed / p.v_s) * self.decay(speed) / p.v_s
    }

    pub(crate) fn sigma2(&self) -> f64 {
        self.parameters.sigma2
    }

    /// Terms of `g(v) + viscous v`.
    pub(crate) fn terms(&self, viscous: f64) -> CurveSeries {
        let StribeckParameters { mu_s, mu_k, v_s, .. } = self.parameters;
        CurveSeries::new([mu_k, mu_s - mu_k, viscous], Exponent::Square(v_s))
    }
}

impl FrictionLaw for Stribeck {
    fn steady(&self, speed: f64) -> Result<Steady, FrictionError> {
        Steady::new(speed, self.g(speed) + self.sigma2() * speed)
    }

    fn tangent(&self, at: &Steady) -> Tangent {
        Tangent { mu: at.mu(), slope: self.g_slope(at.speed()) + self.sigma2(), internal: None }
    }

    fn series(&self) -> Option<Box<dyn FrictionSeries>> {
        Some(Box::new(self.terms(self.sigma2())))
    }
}
