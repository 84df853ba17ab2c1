//! Operating points: the numbers that select one system of an affine family.

use num_complex::Complex;

use crate::LinsysError;

/// Coefficients of the terms and gains of the channels of an [`AffineSystem`](super::AffineSystem).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OperatingPoint {
    /// theta_k, one for each term.
    pub coefficients: Vec<f64>,
    /// The gains, one for each channel.
    pub channels: Vec<ChannelGain>,
}

/// Gain of friction in one channel: `mu r^T + lambda s(lambda) b^T`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ChannelGain {
    /// mu, the coefficient of friction: tangential over normal force.
    pub mu: f64,
    /// `N0 h`, the normal load times the slope of the coefficient over the sliding velocity, Ns/m.
    pub slope: f64,
    /// An internal first-order state, such as the bristle of a LuGre contact.
    pub lag: Option<Lag>,
}

/// `z' = -decay z + drive v` under the sliding velocity v, adding the force `force z` to friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lag {
    /// Decay rate, 1/s.
    pub decay: f64,
    /// Rate of the state per unit of sliding velocity.
    pub drive: f64,
    /// Friction force per unit of the state: the normal load times the contribution to the coefficient, N.
    pub force: f64,
}

impl OperatingPoint {
    /// Checks that this point belongs to a system whose terms and channels have these names.
    ///
    /// # Errors
    /// Not one finite coefficient for each term and one finite gain for each channel.
    pub fn check<'a>(
        &self,
        terms: impl ExactSizeIterator<Item = &'a str>,
        channels: impl ExactSizeIterator<Item = &'a str>,
    ) -> Result<(), LinsysError> {
        check_coefficients(&self.coefficients, terms)?;
        let (found, expected) = (self.channels.len(), channels.len());
        if found != expected {
            return Err(LinsysError::Count { what: "channel gains", found, expected });
        }
        match channels.zip(&self.channels).find(|(_, gain)| !gain.is_finite()) {
            Some((channel, _)) => Err(LinsysError::ChannelGain { channel: channel.into() }),
            None => Ok(()),
        }
    }
}

pub(super) fn check_coefficients<'a>(
    coefficients: &[f64],
    terms: impl ExactSizeIterator<Item = &'a str>,
) -> Result<(), LinsysError> {
    let (found, expected) = (coefficients.len(), terms.len());
    if found != expected {
        return Err(LinsysError::Count { what: "term coefficients", found, expected });
    }
    match terms.zip(coefficients).find(|(_, value)| !value.is_finite()) {
        Some((term, &value)) => Err(LinsysError::Coefficient { term: term.into(), value }),
        None => Ok(()),
    }
}

impl ChannelGain {
    /// Friction of a constant coefficient: mu alone.
    pub fn proportional(mu: f64) -> Self {
        Self { mu, ..Self::default() }
    }

    /// `s(lambda) = N0 h(lambda) = slope + force drive / (lambda + decay)`, Ns/m, with the state eliminated.
    pub fn complex_slope(&self, lambda: Complex<f64>) -> Complex<f64> {
        match self.lag {
            None => Complex::from(self.slope),
            Some(lag) => self.slope + lag.force * lag.drive / (lambda + lag.decay),
        }
    }

    /// s at infinity and at 0, Ns/m: the ends of a diameter of the disc in which `s(lambda)` lies for every
    /// `Re lambda >= 0`, because `1 / (lambda + decay)` maps that half plane to the disc with the diameter from 0 to
    /// `1 / decay`. Not finite for a state that does not decay.
    pub fn slope_extremes(&self) -> [f64; 2] {
        let lag = self.lag.map_or(0.0, |lag| lag.force * lag.drive / lag.decay);
        [self.slope, self.slope + lag]
    }

    pub(super) fn is_finite(&self) -> bool {
        let lag = self.lag.map_or([0.0; 3], |lag| [lag.decay, lag.drive, lag.force]);
        self.mu.is_finite() && self.slope.is_finite() && lag.iter().all(|value| value.is_finite())
    }
}
