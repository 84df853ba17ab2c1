//! A finite element brake of a case, reduced, with its friction laws and distributions.

mod layout;
mod places;
mod points;
mod reduce;

pub use points::frictionless;
pub use reduce::ReducedSet;

use linsys::OperatingPoint;
use montecarlo::{Distribution, Progress, StreamRng};
use nalgebra::DVector;
use num_complex::Complex;

use super::LatticeSample;
use crate::Error;
use crate::case::{Draws, FiniteElementCase, Law};
use crate::study::{ModeResidual, Place, Plan, Scene, UncertainBrake, WholeContact};

/// The brake of a case in all its configurations, each set of constraints reduced on its own basis.
#[derive(Debug)]
pub struct FiniteElementBrake {
    /// The case.
    pub case: FiniteElementCase,
    /// The scenes of the case.
    pub plan: Plan,
    /// The reduced brake of each set of constraints.
    pub sets: Vec<ReducedSet>,
    /// The closed patches of each configuration of the plan, from 0; none without a contact.
    closed: Vec<Vec<usize>>,
}

/// One draw of all that is uncertain.
#[derive(Debug, Clone, PartialEq)]
pub struct FiniteElementSample {
    /// The parameters of coefficients.
    pub values: Vec<f64>,
    /// Friction and speed; `None` without a contact.
    pub contacts: Option<LatticeSample>,
}

impl FiniteElementBrake {
    /// Reduces the brake for each set of constraints, and lays out its scenes.
    ///
    /// # Errors
    /// What the reduction refuses; [`Error::Median`] where the medians of the parameters have no operating point.
    pub fn new(case: FiniteElementCase, progress: &dyn Progress) -> Result<Self, Error> {
        let sets = reduce::reduced_sets(&case, progress)?;
        let (plan, closed) = layout::plan(&case, &sets)?;
        Ok(Self { case, plan, sets, closed })
    }

    /// The closed patches of a scene, from 0.
    pub fn closed(&self, scene: &Scene) -> &[usize] {
        &self.closed[scene.configuration]
    }

    /// The operating point of the whole brake, reduced or not, from that of a scene.
    pub fn full_point(&self, scene: &Scene, at: &OperatingPoint) -> OperatingPoint {
        points::of_brake(&self.case, self.closed(scene), at)
    }

    fn law_and_speed(&self, scene: &Scene, sample: &FiniteElementSample) -> Option<(Law, f64)> {
        let contact = self.case.contact.as_ref()?;
        Some((contact.laws[scene.key.law], points::speed(contact, scene.key.speed, sample)))
    }
}

impl UncertainBrake for FiniteElementBrake {
    type Sample = FiniteElementSample;

    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<FiniteElementSample, Error> {
        points::draw(&self.case, rng)
    }

    fn median(&self) -> FiniteElementSample {
        points::median(&self.case)
    }

    fn operating_point(&self, scene: &Scene, sample: &FiniteElementSample) -> Result<OperatingPoint, Error> {
        points::scene_point(&self.case, self.closed(scene), self.law_and_speed(scene, sample), sample)
    }

    /// Shared Amontons-Coulomb friction depends on mu alone where nothing else is drawn.
    fn single_parameter(&self, scene: &Scene) -> Option<&Distribution> {
        let contact = self.case.contact.as_ref()?;
        let is_single = contact.laws[scene.key.law] == Law::AmontonsCoulomb
            && contact.draws == Draws::Shared
            && self.case.parameters.iter().all(|p| matches!(p.distribution, Distribution::Constant { .. }));
        is_single.then_some(&contact.friction.mu)
    }

    fn with_parameter(&self, _: &Scene, mu: f64) -> FiniteElementSample {
        let median = self.median();
        let contacts = median.contacts.map(|sample| {
            let draw = super::FrictionDraw { mu, lateral_mu: mu, ..*sample.contact(0) };
            LatticeSample::shared(draw, sample.speed_quantile)
        });
        FiniteElementSample { contacts, ..median }
    }

    fn contacts(&self, scene: &Scene) -> Vec<WholeContact> {
        places::contacts(self, scene)
    }

    fn places(&self, constraints: usize) -> Result<Option<Vec<Place>>, Error> {
        places::places(&self.case, &self.sets[constraints]).map(Some)
    }

    fn mode_residual(
        &self,
        scene: &Scene,
        at: &OperatingPoint,
        lambda: Complex<f64>,
        shape: &DVector<Complex<f64>>,
    ) -> Result<Option<ModeResidual>, Error> {
        let set = &self.sets[scene.key.constraints];
        let value = set.reduction.reduced.residual(&self.full_point(scene, at), lambda, shape)?;
        // One that is no number is above too.
        let is_within = value <= self.case.reduction.residual;
        Ok(Some(ModeResidual { value, is_above: !is_within }))
    }
}
