//! The trait of a friction law, and its results: the steady state and the tangent there.

use num_complex::Complex;

use crate::error::{non_negative, positive};
use crate::{FrictionError, FrictionSeries};

/// A friction law in sliding at a positive relative speed.
pub trait FrictionLaw {
    /// Steady sliding at `speed`, m/s.
    ///
    /// # Errors
    /// A speed that is not finite and positive: the linearisation is about sliding, not about sticking.
    fn steady(&self, speed: f64) -> Result<Steady, FrictionError>;

    /// The linearisation about a steady state of this law.
    fn tangent(&self, at: &Steady) -> Tangent;

    /// True of a law whose coefficient is the same at every speed.
    fn is_constant(&self) -> bool {
        false
    }

    /// Terms of the friction along a motion that is a power series of time; `None` of a law that has none, which costs a motion after the onset time alone.
    fn series(&self) -> Option<Box<dyn FrictionSeries>> {
        None
    }

    /// [`FrictionLaw::steady`] and [`FrictionLaw::tangent`] in one call.
    ///
    /// # Errors
    /// As [`FrictionLaw::steady`].
    fn tangent_at(&self, speed: f64) -> Result<Tangent, FrictionError> {
        Ok(self.tangent(&self.steady(speed)?))
    }
}

/// Steady sliding: a positive speed and the friction coefficient there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steady {
    speed: f64,
    mu: f64,
}

impl Steady {
    /// The state that a law returns from [`FrictionLaw::steady`].
    ///
    /// # Errors
    /// A speed that is not finite and positive, a coefficient that is not finite or is negative.
    pub fn new(speed: f64, mu: f64) -> Result<Self, FrictionError> {
        positive("speed", speed)?;
        non_negative("mu", mu)?;
        Ok(Self { speed, mu })
    }

    /// Relative speed v of the surfaces, m/s.
    #[must_use]
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Friction coefficient: tangential over normal force.
    #[must_use]
    pub fn mu(&self) -> f64 {
        self.mu
    }
}

/// The friction force `mu N` linearised about steady sliding, per unit normal force N0.
///
/// With the perturbations dv of the relative velocity, dN of the normal force and dz of the internal state, if any,
/// `dF = N0 (slope dv + force dz) + mu dN`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tangent {
    /// Friction coefficient of the steady state.
    pub mu: f64,
    /// Instantaneous slope of the coefficient over the relative velocity, s/m.
    pub slope: f64,
    /// The internal state of the law, if it has one.
    pub internal: Option<InternalTangent>,
}

/// An internal first-order state `dz' = -decay dz + drive dv` that contributes `N0 force dz` to the friction force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InternalTangent {
    /// Decay rate a, 1/s.
    pub decay: f64,
    /// b, the rate of the state per unit of velocity; without unit where z is a length.
    pub drive: f64,
    /// Coefficient of friction per unit of the state, 1/m where z is a length; `sigma0 - sigma1 a` for LuGre.
    pub force: f64,
}

impl Tangent {
    /// The complex slope `h(lambda) = slope + force drive / (lambda + decay)`, s/m, with the internal state eliminated.
    ///
    /// `dF = N0 h(lambda) dv + mu dN` for motion `e^{lambda t}`. A law without an internal state has the constant
    /// `slope`. `h(0)` is the slope of the steady coefficient over speed. At `lambda = -decay` there is a pole.
    #[must_use]
    pub fn complex_slope(&self, lambda: Complex<f64>) -> Complex<f64> {
        match self.internal {
            None => Complex::from(self.slope),
            Some(state) => self.slope + state.force * state.drive / (lambda + state.decay),
        }
    }
}
