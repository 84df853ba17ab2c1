//! Inputs of a finite element brake that are drawn.

use montecarlo::Distribution;
use study::{DrawnInputs, Input, Scene, SingleParameter, UncertainBrake as _};

use super::{FiniteElementBrake, FiniteElementSample, points, samples};
use crate::case::{Draws, Parameter};
use crate::lattice::{DrawnFriction, OF_CONTACT};
use crate::{FrictionDraw, LatticeSample};

impl FiniteElementBrake {
    /// Law of a scene, and the distributions from which its friction is drawn; `None` without a contact.
    fn drawn(&self, scene: &Scene) -> Option<DrawnFriction<'_>> {
        let contact = self.case.contact.as_ref()?;
        Some(DrawnFriction {
            law: contact.laws[scene.key.law],
            from: &contact.friction,
            correlation: self.case.correlation.as_ref(),
            draws: contact.draws,
            has_lateral_mu: false,
            has_bristle_damping: contact.bristle_damping.is_some(),
        })
    }

    /// Number of contacts that have a draw of their own.
    fn drawn_contacts(&self) -> usize {
        let contact = self.case.contact.as_ref().filter(|contact| contact.draws == Draws::Each);
        contact.map_or(1, |contact| contact.patches.len())
    }

    /// The coordinate of the first parameter of coefficients, after the coordinates of friction.
    fn first_parameter(&self) -> u32 {
        OF_CONTACT * self.drawn_contacts() as u32
    }

    /// Number of values of friction; in a correlation they come before the values of coefficients.
    fn friction_values(&self) -> usize {
        let of_contact = self.case.contact.as_ref().map_or(0, |contact| contact.friction.of_draw().len());
        of_contact * self.drawn_contacts()
    }

    fn speed_is_drawn(&self, scene: &Scene) -> bool {
        let range = self.case.contact.as_ref().zip(scene.key.speed).map(|(contact, range)| &contact.speeds[range]);
        range.is_some_and(|range| range.to > range.from)
    }

    /// Parameters of coefficients that are not constant and have a part in a scene, with their indices.
    fn varying(&self, scene: &Scene) -> impl Iterator<Item = (usize, &Parameter)> {
        let closed = self.closed(scene);
        let acts = move |at: usize| self.case.contact.as_ref().is_none_or(|of| of.spread.acts_in(at, closed));
        let varies = move |(at, parameter): &(usize, &Parameter)| {
            acts(*at) && !matches!(parameter.distribution, Distribution::Constant { .. })
        };
        self.case.parameters.iter().enumerate().filter(varies)
    }
}

impl DrawnInputs<FiniteElementSample> for FiniteElementBrake {
    fn inputs(&self, scene: &Scene) -> Vec<Input> {
        let of_contact = self.drawn(scene).map(|drawn| drawn.inputs(self.closed(scene), self.speed_is_drawn(scene)));
        let mut inputs = of_contact.unwrap_or_default();
        for input in &mut inputs {
            input.unit = self.case.header.units.of(&input.unit).to_owned();
        }
        inputs.extend(self.varying(scene).map(|(at, parameter)| Input {
            name: parameter.name.clone(),
            unit: parameter.unit.clone(),
            coordinate: self.first_parameter() + at as u32,
            is_correlated: self.case.correlation.as_ref().is_some_and(|of| of.holds(self.friction_values() + at)),
            has_atoms: parameter.distribution.has_atoms(),
            jumps: parameter.distribution.jumps(),
        }));
        inputs
    }

    fn input_values(&self, scene: &Scene, sample: &FiniteElementSample) -> Vec<f64> {
        let mut values = match (self.drawn(scene), &sample.contacts) {
            (Some(drawn), Some(contacts)) => drawn.values(self.closed(scene), contacts),
            _ => Vec::new(),
        };
        let speed = self.law_and_speed(scene, sample).filter(|_| self.speed_is_drawn(scene));
        values.extend(speed.map(|(_, speed)| speed));
        values.extend(self.varying(scene).map(|(at, _)| sample.values[at]));
        values
    }

    fn quantile_sample(&self, scene: &Scene, uniform: &dyn Fn(u32) -> f64) -> FiniteElementSample {
        let parameters = self.case.parameters.iter().zip(self.first_parameter()..);
        let sample = FiniteElementSample {
            values: parameters.map(|(p, coordinate)| p.distribution.quantile(uniform(coordinate))).collect(),
            contacts: self
                .drawn(scene)
                .map(|drawn| DrawnFriction { correlation: None, ..drawn }.sample(self.drawn_contacts(), uniform)),
        };
        samples::correlated(&self.case, sample)
    }

    /// Shared Amontons-Coulomb friction depends on mu alone where nothing else is drawn, none acts across the sliding and no point opens.
    fn single_parameter(&self, scene: &Scene) -> Option<SingleParameter<'_, FiniteElementSample>> {
        let contact = self.case.contact.as_ref()?;
        let is_single = !points::depends_on_speed(contact, contact.laws[scene.key.law])
            && contact.balance.is_none()
            && contact.draws == Draws::Shared
            && self.case.parameters.iter().all(|p| matches!(p.distribution, Distribution::Constant { .. }));
        let with = |mu: f64| {
            let median = self.median();
            let contacts = median.contacts.map(|sample| {
                let draw = FrictionDraw { mu, lateral_mu: mu, ..*sample.contact(0) };
                LatticeSample::shared(draw, sample.speed_quantile)
            });
            FiniteElementSample { contacts, ..median }
        };
        is_single.then(|| SingleParameter::new(&contact.friction.mu, with))
    }
}
