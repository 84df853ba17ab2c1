//! LuGre friction: bristles deflect, so that the coefficient follows the speed with a delay.

use crate::error::{non_negative, positive};
use crate::series::{CurveSeries, product_term};
use crate::{
    FrictionError, FrictionLaw, FrictionSeries, InternalTangent, Steady, Stribeck, StribeckParameters, Tangent,
};

/// Dependence of the bristle damping sigma1 on speed. `sigma1 = 0` means no bristle damping.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BristleDamping {
    /// sigma1 at every speed.
    Constant,
    /// `sigma1 e^{-(v / v_s)^2}`, which vanishes in fast sliding.
    Decaying,
}

/// Parameters of [`LuGre`]; the sigmas are per unit normal force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LuGreParameters {
    /// Static coefficient, the limit at speed 0; >= `mu_k`.
    pub mu_s: f64,
    /// Kinetic coefficient, the limit of g at high speed; > 0.
    pub mu_k: f64,
    /// Stribeck speed v_s, m/s; > 0.
    pub v_s: f64,
    /// Bristle stiffness sigma0, 1/m; > 0.
    pub sigma0: f64,
    /// Bristle damping sigma1, s/m; >= 0.
    pub sigma1: f64,
    /// Viscous coefficient sigma2, s/m; >= 0.
    pub sigma2: f64,
    /// Dependence of sigma1 on speed.
    pub bristle_damping: BristleDamping,
}

/// The LuGre law (Canudas de Wit et al., IEEE Trans. Autom. Control 40, 1995), per unit normal force:
///
/// ```text
/// z' = v - sigma0 |v| z / g(v),    mu = sigma0 z + sigma1 z' + sigma2 v,
/// g(v) = mu_k + (mu_s - mu_k) e^{-(v / v_s)^2}
/// ```
///
/// In steady sliding `z = g / sigma0`, so that `mu = g + sigma2 v`. Linearised about this state, `dz' = -a dz + b dv` with
/// `a = sigma0 v / g`, `b = v g' / g`, and `dmu = (sigma0 - sigma1 a) dz + (sigma1 b + sigma2) dv`. Eliminating dz gives
/// `h(lambda) = sigma2 + (sigma0 + sigma1 lambda) b / (lambda + a)`, see [`Tangent::complex_slope`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LuGre {
    curve: Stribeck,
    sigma0: f64,
    sigma1: f64,
    bristle_damping: BristleDamping,
}

impl LuGre {
    /// The law with these parameters.
    ///
    /// # Errors
    /// A parameter out of the range that its field states.
    pub fn new(parameters: LuGreParameters) -> Result<Self, FrictionError> {
        let LuGreParameters { mu_s, mu_k, v_s, sigma0, sigma1, sigma2, bristle_damping } = parameters;
        let curve = Stribeck::new(StribeckParameters { mu_s, mu_k, v_s, sigma2 })?;
        positive("sigma0", sigma0)?;
        non_negative("sigma1", sigma1)?;
        Ok(Self { curve, sigma0, sigma1, bristle_damping })
    }

    /// sigma1 at a speed. The derivative of sigma1 does not enter the tangent, because its factor z' is 0 in steady sliding.
    fn sigma1_at(&self, speed: f64) -> f64 {
        match self.bristle_damping {
            BristleDamping::Constant => self.sigma1,
            BristleDamping::Decaying => self.sigma1 * self.curve.decay(speed),
        }
    }

    /// Bristle z in steady sliding at a speed, `g / sigma0`, m.
    #[must_use]
    pub fn steady_bristle(&self, speed: f64) -> f64 {
        self.curve.g(speed) / self.sigma0
    }

    /// The coefficient and the rate of the bristle at a sliding velocity w of either sign, m/s, and a bristle z, m, with their derivatives.
    #[must_use]
    pub fn moving(&self, velocity: f64, z: f64) -> BristleMotion {
        let (speed, sign) = (velocity.abs(), velocity.signum());
        let (g, sigma1, sigma0) = (self.curve.g(speed), self.sigma1_at(speed), self.sigma0);
        let rate = velocity - sigma0 * speed * z / g;
        let rate_by_velocity = 1.0 - sigma0 * z * sign * (1.0 - speed * self.curve.g_slope(speed) / g) / g;
        let rate_by_state = -sigma0 * speed / g;
        let sigma1_slope = match self.bristle_damping {
            BristleDamping::Constant => 0.0,
            BristleDamping::Decaying => sign * self.sigma1 * self.curve.decay_slope(speed),
        };
        BristleMotion {
            mu: sigma0 * z + sigma1 * rate + self.curve.sigma2() * velocity,
            mu_by_velocity: sigma1_slope * rate + sigma1 * rate_by_velocity + self.curve.sigma2(),
            mu_by_state: sigma0 + sigma1 * rate_by_state,
            rate,
            rate_by_velocity,
            rate_by_state,
        }
    }
}

/// Friction in any motion: the coefficient at a sliding velocity w of either sign and a state z, the rate of the state, and the derivatives
/// of both. Of a law without a state all that is of the state is 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BristleMotion {
    /// mu, with the sign of the friction: positive along w.
    pub mu: f64,
    /// Derivative of mu by w, s/m.
    pub mu_by_velocity: f64,
    /// Derivative of mu by z, 1/m.
    pub mu_by_state: f64,
    /// z', m/s.
    pub rate: f64,
    /// Derivative of z' by w.
    pub rate_by_velocity: f64,
    /// Derivative of z' by z, 1/s.
    pub rate_by_state: f64,
}

impl FrictionLaw for LuGre {
    fn steady(&self, speed: f64) -> Result<Steady, FrictionError> {
        self.curve.steady(speed)
    }

    fn tangent(&self, at: &Steady) -> Tangent {
        let speed = at.speed();
        let g = self.curve.g(speed);
        let sigma1 = self.sigma1_at(speed);
        let decay = self.sigma0 * speed / g;
        let drive = speed * self.curve.g_slope(speed) / g;
        Tangent {
            mu: at.mu(),
            slope: sigma1 * drive + self.curve.sigma2(),
            internal: Some(InternalTangent { decay, drive, force: self.sigma0 - sigma1 * decay }),
        }
    }

    fn series(&self) -> Option<Box<dyn FrictionSeries>> {
        Some(Box::new(LuGreSeries::new(*self)))
    }
}

/// Terms of LuGre friction.
#[derive(Debug, Clone)]
struct LuGreSeries {
    law: LuGre,
    curve: CurveSeries,
    /// Terms of g.
    g: Vec<f64>,
    /// Terms of z.
    z: Vec<f64>,
    /// Terms of `v z / g`.
    ratio: Vec<f64>,
    /// Terms of z'.
    rate: Vec<f64>,
}

impl LuGreSeries {
    fn new(law: LuGre) -> Self {
        let none = Vec::new;
        Self { law, curve: law.curve.terms(0.0), g: none(), z: none(), ratio: none(), rate: none() }
    }
}

impl FrictionSeries for LuGreSeries {
    fn begin(&mut self, is_forwards: bool) {
        self.curve.begin(is_forwards);
        [&mut self.g, &mut self.z, &mut self.ratio, &mut self.rate].into_iter().for_each(Vec::clear);
    }

    fn next(&mut self, velocity: f64, state: f64) -> [f64; 2] {
        let k = self.z.len();
        let g = self.curve.falling(velocity);
        self.g.push(g);
        self.z.push(state);
        // The ratio y of v z to g: g y = v z.
        let known = product_term(&self.g[1..], &self.ratio);
        self.ratio.push((product_term(&self.curve.speed, &self.z) - known) / self.g[0]);
        let LuGre { sigma0, sigma1, bristle_damping, .. } = self.law;
        let rate = velocity - sigma0 * self.ratio[k];
        self.rate.push(rate);
        let damped = match bristle_damping {
            BristleDamping::Constant => rate,
            BristleDamping::Decaying => product_term(&self.curve.exponential, &self.rate),
        };
        [sigma0 * state + sigma1 * damped + self.law.curve.sigma2() * velocity, rate]
    }
}
