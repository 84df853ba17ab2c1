//! Draws of the uncertain parameters, and the tangent of a friction law with the drawn parameters.

use std::sync::Arc;

use cycle::{Bristled, ContactFriction, Smoothed};
use friction::{
    AmontonsCoulomb, BristleDamping, FrictionError, FrictionLaw, LuGre, LuGreParameters, Stribeck, StribeckParameters,
    Tangent, VelocityDependent, VelocityDependentParameters,
};
use montecarlo::{Distribution, MonteCarloError, StreamRng};
use rand_distr::{Distribution as _, StandardUniform};

use crate::case::{Correlation, Draws, FrictionDistributions, LatticeCase, Law};

/// Friction parameters of one contact for all laws, so that scenes of different laws have the same draw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionDraw {
    /// Coefficient of Amontons-Coulomb.
    pub mu: f64,
    /// Coefficient across the sliding for all laws except Amontons-Coulomb.
    pub lateral_mu: f64,
    /// Static coefficient as drawn.
    pub drawn_mu_s: f64,
    /// Static coefficient, raised to `mu_k` where the drawn value is below.
    pub mu_s: f64,
    /// Kinetic coefficient.
    pub mu_k: f64,
    /// Decay over speed, s/m.
    pub alpha: f64,
    /// Stribeck speed, m/s.
    pub v_s: f64,
    /// Bristle stiffness, 1/m.
    pub sigma0: f64,
    /// Bristle damping, s/m.
    pub sigma1: f64,
    /// Viscous coefficient, s/m.
    pub sigma2: f64,
}

impl FrictionDraw {
    /// A draw from values in the order of [`FrictionDistributions::of_draw`].
    pub(crate) fn from_values(values: [f64; FrictionDistributions::DRAWN.len()]) -> Self {
        let [mu, lateral_mu, drawn_mu_s, mu_k, alpha, v_s, sigma0, sigma1, sigma2] = values;
        let mu_s = drawn_mu_s.max(mu_k);
        Self { mu, lateral_mu, drawn_mu_s, mu_s, mu_k, alpha, v_s, sigma0, sigma1, sigma2 }
    }

    /// The values as drawn, in the order of [`FrictionDistributions::of_draw`].
    pub(crate) fn values(&self) -> [f64; FrictionDistributions::DRAWN.len()] {
        let Self { mu, lateral_mu, drawn_mu_s, mu_s: _, mu_k, alpha, v_s, sigma0, sigma1, sigma2 } = *self;
        [mu, lateral_mu, drawn_mu_s, mu_k, alpha, v_s, sigma0, sigma1, sigma2]
    }

    fn draw(from: &FrictionDistributions, rng: &mut StreamRng) -> Result<Self, MonteCarloError> {
        let mut values = [0.0; FrictionDistributions::DRAWN.len()];
        for (value, distribution) in values.iter_mut().zip(from.of_draw()) {
            *value = distribution.draw(rng)?;
        }
        Ok(Self::from_values(values))
    }

    fn median(from: &FrictionDistributions) -> Self {
        Self::from_values(from.of_draw().map(|distribution| distribution.median()))
    }

    /// The tangent of `law` at `speed`, m/s. `bristle_damping` is reading R9; `None` sets sigma1 to 0.
    ///
    /// # Errors
    /// Those of the law.
    pub fn tangent(
        &self,
        law: Law,
        speed: f64,
        bristle_damping: Option<BristleDamping>,
    ) -> Result<Tangent, FrictionError> {
        let Self { mu, mu_s, mu_k, alpha, v_s, sigma2, .. } = *self;
        match law {
            Law::AmontonsCoulomb => AmontonsCoulomb::new(mu)?.tangent_at(speed),
            Law::VelocityDependent => {
                VelocityDependent::new(VelocityDependentParameters { mu_s, mu_k, alpha })?.tangent_at(speed)
            }
            Law::Stribeck => Stribeck::new(StribeckParameters { mu_s, mu_k, v_s, sigma2 })?.tangent_at(speed),
            Law::LuGre => self.lugre(bristle_damping)?.tangent_at(speed),
        }
    }

    /// Friction under `law` in any motion, which sticks below a speed, m/s. `bristle_damping` is reading R9; `None` sets sigma1 to 0.
    ///
    /// # Errors
    /// Those of the law.
    pub(crate) fn in_motion(
        &self,
        law: Law,
        stick_speed: f64,
        bristle_damping: Option<BristleDamping>,
    ) -> Result<Arc<dyn ContactFriction>, FrictionError> {
        let Self { mu, mu_s, mu_k, alpha, v_s, sigma2, .. } = *self;
        Ok(match law {
            Law::AmontonsCoulomb => Arc::new(Smoothed { law: AmontonsCoulomb::new(mu)?, stick_speed }),
            Law::VelocityDependent => {
                let law = VelocityDependent::new(VelocityDependentParameters { mu_s, mu_k, alpha })?;
                Arc::new(Smoothed { law, stick_speed })
            }
            Law::Stribeck => {
                let law = Stribeck::new(StribeckParameters { mu_s, mu_k, v_s, sigma2 })?;
                Arc::new(Smoothed { law, stick_speed })
            }
            Law::LuGre => Arc::new(Bristled { law: self.lugre(bristle_damping)?, stick_speed }),
        })
    }

    /// LuGre friction with the drawn parameters.
    fn lugre(&self, bristle_damping: Option<BristleDamping>) -> Result<LuGre, FrictionError> {
        let Self { mu_s, mu_k, v_s, sigma0, sigma1, sigma2, .. } = *self;
        LuGre::new(LuGreParameters {
            mu_s,
            mu_k,
            v_s,
            sigma0,
            sigma1: if bristle_damping.is_some() { sigma1 } else { 0.0 },
            sigma2,
            bristle_damping: bristle_damping.unwrap_or(BristleDamping::Constant),
        })
    }

    /// mu_y: Amontons-Coulomb has one coefficient for all directions, the other laws have a separate one across the sliding.
    pub fn lateral(&self, law: Law) -> f64 {
        if law == Law::AmontonsCoulomb { self.mu } else { self.lateral_mu }
    }
}

/// Sample of a lattice: all uncertain parameters of one complex eigenvalue analysis.
#[derive(Debug, Clone, PartialEq)]
pub struct LatticeSample {
    /// Draws of friction: one for all oscillators, or one for each.
    contacts: Vec<FrictionDraw>,
    /// The probability at which the speed is the quantile of a speed range, uniform in 0..1.
    pub speed_quantile: f64,
}

impl LatticeSample {
    /// Draws a sample of `case`.
    ///
    /// # Errors
    /// Those of [`Distribution::draw`](montecarlo::Distribution::draw).
    pub fn draw(case: &LatticeCase, rng: &mut StreamRng) -> Result<Self, MonteCarloError> {
        let count = match case.readings.draws {
            Draws::Shared => 1,
            Draws::Each => case.lattice.grid.oscillators(),
        };
        Self::draw_for(&case.friction, case.correlation.as_ref(), count, rng)
    }

    /// Draws a sample with `count` draws of friction, one for all contacts or one for each, and makes them correlated.
    ///
    /// # Errors
    /// Those of [`Distribution::draw`](montecarlo::Distribution::draw).
    pub fn draw_for(
        friction: &FrictionDistributions,
        correlation: Option<&Correlation>,
        count: usize,
        rng: &mut StreamRng,
    ) -> Result<Self, MonteCarloError> {
        let speed_quantile = StandardUniform.sample(rng);
        let contacts = (0..count).map(|_| FrictionDraw::draw(friction, rng)).collect::<Result<_, _>>()?;
        Ok(Self { contacts, speed_quantile }.correlated(friction, correlation))
    }

    /// A draw for each contact, or one for all, from independent ones.
    pub(crate) fn correlated(self, friction: &FrictionDistributions, correlation: Option<&Correlation>) -> Self {
        match correlation {
            Some(correlation) => self.correlated_with(friction, (&[], Vec::new()), correlation).0,
            None => self,
        }
    }

    /// A draw for each contact, or one for all, and values of other distributions, from independent ones.
    pub(crate) fn correlated_with(
        mut self,
        friction: &FrictionDistributions,
        (others, values): (&[&Distribution], Vec<f64>),
        correlation: &Correlation,
    ) -> (Self, Vec<f64>) {
        let of_contact = friction.of_draw();
        let mut all: Vec<f64> = self.contacts.iter().flat_map(FrictionDraw::values).collect();
        let of_friction = all.len();
        all.extend(values);
        let mut distributions = of_contact.repeat(self.contacts.len());
        distributions.extend(others);
        correlation.apply(&distributions, &mut all);
        let values = all.split_off(of_friction);
        let draws = all.chunks_exact(of_contact.len()).filter_map(|draw| draw.first_chunk().copied());
        self.contacts = draws.map(FrictionDraw::from_values).collect();
        (self, values)
    }

    /// A sample with these draws, one for each contact or one for all.
    pub(super) fn of_contacts(contacts: Vec<FrictionDraw>, speed_quantile: f64) -> Self {
        Self { contacts, speed_quantile }
    }

    /// The medians of all distributions.
    pub fn median(case: &LatticeCase) -> Self {
        Self::median_of(&case.friction)
    }

    /// The medians of these distributions, alike in all contacts.
    pub fn median_of(friction: &FrictionDistributions) -> Self {
        Self { contacts: vec![FrictionDraw::median(friction)], speed_quantile: 0.5 }
    }

    /// A sample with the given draw in every contact.
    pub fn shared(draw: FrictionDraw, speed_quantile: f64) -> Self {
        Self { contacts: vec![draw], speed_quantile }
    }

    /// The draw of all oscillators; `None` where each has its own.
    pub fn shared_draw(&self) -> Option<&FrictionDraw> {
        if let [draw] = &self.contacts[..] { Some(draw) } else { None }
    }

    /// The draw of an oscillator, by index from 0.
    pub fn contact(&self, oscillator: usize) -> &FrictionDraw {
        &self.contacts[oscillator % self.contacts.len()]
    }
}
