//! Inputs that are drawn of a lattice, as numbers and by quantiles.

use osc_model::{Lateral, Preload};
use study::{DrawnInputs, Input, ModeIdentity, Scene, SingleParameter};

use super::{LatticeBrake, LatticeSample};
use crate::case::{Draws, Law};

impl DrawnInputs<LatticeSample> for LatticeBrake {
    fn inputs(&self, scene: &Scene) -> Vec<Input> {
        self.drawn(scene).inputs(self.lattice(scene).arrangement().in_contact(), self.speed_is_drawn(scene))
    }

    fn input_values(&self, scene: &Scene, sample: &LatticeSample) -> Vec<f64> {
        let mut values = self.drawn(scene).values(self.lattice(scene).arrangement().in_contact(), sample);
        values.extend(self.speed_is_drawn(scene).then(|| self.speed(scene.key, sample)));
        values
    }

    fn quantile_sample(&self, scene: &Scene, uniform: &dyn Fn(u32) -> f64) -> LatticeSample {
        let contacts = match self.case.readings.draws {
            Draws::Shared => 1,
            Draws::Each => self.case.lattice.grid.oscillators(),
        };
        self.drawn(scene).sample(contacts, uniform)
    }

    /// Shared Amontons-Coulomb friction with given loads depends on mu alone. What is computed from that knows modes by
    /// continuation in mu.
    fn single_parameter(&self, scene: &Scene) -> Option<SingleParameter<'_, LatticeSample>> {
        let readings = &self.case.readings;
        let is_single = self.law(scene.key) == Law::AmontonsCoulomb
            && readings.draws == Draws::Shared
            && readings.identity == ModeIdentity::Continuation
            && readings.lateral != Lateral::Vector
            && !matches!(readings.preload, Preload::Equilibrium(_));
        is_single.then(|| SingleParameter::new(&self.case.friction.mu, |mu| self.with_mu(mu)))
    }
}
