//! Friction of a contact in any motion: sliding either way, and sticking.

use std::fmt::Debug;

use friction::{BristleMotion, FrictionLaw, FrictionSeries, LuGre};

/// Friction in any relative motion; a [`FrictionLaw`] is its linearisation about steady sliding.
pub trait ContactFriction: Debug + Send + Sync {
    /// The coefficient at a sliding velocity w of either sign, m/s, and a bristle state z, with its derivatives. The direction of steady sliding is that of
    /// positive w ([`SlidingContact`](crate::SlidingContact)), and the coefficient has the sign of w. A friction without a state does not read z, and its
    /// rate is 0.
    fn at(&self, velocity: f64, state: f64) -> BristleMotion;

    /// State z in steady sliding at a speed, m/s; `None`, at every speed, for friction without a state.
    fn steady_state(&self, speed: f64) -> Option<f64>;

    /// Speed below which a contact is said to stick, m/s; of [`Smoothed`] friction the width of the smoothing too, on which its force depends.
    fn stick_speed(&self) -> f64;

    /// True where the coefficient of [`ContactFriction::sliding`] is the same at every speed, so that a contact is linear until it opens, sticks or turns.
    fn is_constant(&self) -> bool {
        false
    }

    /// The coefficient where it slides forwards, or backwards, at a speed, m/s, of friction that jumps where the sliding turns: [`ContactFriction::at`] smooths it. `None` of friction
    /// that does not jump.
    fn sliding(&self, _speed: f64, _is_forwards: bool) -> Option<BristleMotion> {
        None
    }

    /// Terms of friction along a motion that is a power series of time and does not turn: those of [`ContactFriction::sliding`], or else of
    /// [`ContactFriction::at`]. Without them, `None`, the same motion takes several times as long.
    fn series(&self) -> Option<Box<dyn FrictionSeries>> {
        None
    }
}

/// A law of the speed alone, smoothed where the sliding turns: `mu(w) = mu(|w|) s(w / eps)`. A law with an internal state is not for this: its state would
/// be lost.
///
/// `s(x) = (15 x - 10 x^3 + 3 x^5) / 8` within 1 and the sign of x beyond, twice differentiable. So friction above eps is that of the law to
/// the last bit, and its tangent in steady sliding that of the complex eigenvalue analysis, which `w / sqrt(w^2 + eps^2)` would bend.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smoothed<L> {
    /// The law.
    pub law: L,
    /// eps, the speed below which the contact sticks, m/s; > 0.
    pub stick_speed: f64,
}

impl<L: FrictionLaw + Debug + Send + Sync> ContactFriction for Smoothed<L> {
    fn at(&self, velocity: f64, _: f64) -> BristleMotion {
        let x = velocity / self.stick_speed;
        let beyond = self.beyond(velocity.abs(), velocity.is_sign_positive());
        if x.abs() >= 1.0 {
            return beyond;
        }
        let (mu, slope) = (beyond.mu.abs(), beyond.mu_by_velocity);
        let square = x * x;
        let sign = x * (15.0 - square * (10.0 - 3.0 * square)) / 8.0;
        let sign_slope = 15.0 * (1.0 - square) * (1.0 - square) / (8.0 * self.stick_speed);
        BristleMotion {
            mu: mu * sign,
            mu_by_velocity: slope * velocity.signum() * sign + mu * sign_slope,
            ..BristleMotion::default()
        }
    }

    fn steady_state(&self, _: f64) -> Option<f64> {
        None
    }

    fn stick_speed(&self) -> f64 {
        self.stick_speed
    }

    fn is_constant(&self) -> bool {
        self.law.is_constant()
    }

    fn sliding(&self, speed: f64, is_forwards: bool) -> Option<BristleMotion> {
        Some(self.beyond(speed, is_forwards))
    }

    fn series(&self) -> Option<Box<dyn FrictionSeries>> {
        self.law.series()
    }
}

impl<L: FrictionLaw> Smoothed<L> {
    /// The law itself, without smoothing.
    fn beyond(&self, speed: f64, is_forwards: bool) -> BristleMotion {
        // Where a law has no coefficient, integration fails, as nothing goes on from what is not a number.
        let tangent = self.law.tangent_at(speed.max(f64::MIN_POSITIVE));
        let (mu, slope) = tangent.map_or((f64::NAN, f64::NAN), |tangent| (tangent.mu, tangent.slope));
        let sign = if is_forwards { 1.0 } else { -1.0 };
        BristleMotion { mu: sign * mu, mu_by_velocity: slope, ..BristleMotion::default() }
    }
}

/// LuGre friction with its own bristle, which sticks without smoothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bristled {
    /// The law.
    pub law: LuGre,
    /// Speed below which the contact is said to stick, m/s; > 0.
    pub stick_speed: f64,
}

impl ContactFriction for Bristled {
    fn at(&self, velocity: f64, state: f64) -> BristleMotion {
        self.law.moving(velocity, state)
    }

    fn steady_state(&self, speed: f64) -> Option<f64> {
        Some(self.law.steady_bristle(speed))
    }

    fn stick_speed(&self) -> f64 {
        self.stick_speed
    }

    fn series(&self) -> Option<Box<dyn FrictionSeries>> {
        self.law.series()
    }
}
