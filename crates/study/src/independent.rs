//! A brake whose draws are independent numbers: its distributions, and the operating point at given values, are all that has to be said.

use std::sync::Arc;

use linsys::{OperatingPoint, SecondOrder};
use montecarlo::{Distribution, StreamRng};
use osc_model::Brake;

use crate::identity::Identity;
use crate::{
    Contradiction, DrawnInputs, Error, Input, NamedParameter, Parametrised, Plan, Scene, SingleParameter,
    UncertainBrake,
};

/// A parameter that is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// Name of the parameter, by which sweeps and tables know it.
    pub name: String,
    /// Unit of the parameter, for people.
    pub unit: String,
    /// Distribution of the parameter; a constant one is swept and not drawn.
    pub distribution: Distribution,
}

impl Drawn {
    /// A parameter with its unit and distribution.
    pub fn new(name: impl Into<String>, unit: impl Into<String>, distribution: Distribution) -> Self {
        Self { name: name.into(), unit: unit.into(), distribution }
    }
}

/// A brake of independent parameters: a function of a scene and one value of each of them gives the operating point, and draws, medians,
/// inputs, quantiles, named parameters and identity follow from the distributions.
///
/// The most important parameters come first: scrambled Sobol' points spread best over the first ones.
///
/// # Examples
///
/// A mass on a belt, of whose dashpot little is known:
///
/// ```
/// use linsys::{AffineSystem, Channel, ChannelGain, OperatingPoint, SecondOrder, Term};
/// use montecarlo::Distribution;
/// use nalgebra::DMatrix;
/// use osc_model::Brake;
/// use study::{Drawn, IndependentBrake, UncertainBrake};
///
/// let of = |value| DMatrix::from_element(1, 1, value);
/// let spring = Term::new("mass and spring", "springs", SecondOrder::new(of(1.0), of(0.0), of(1e4))?)?;
/// let dashpot = Term::new("dashpot", "dashpots", SecondOrder::new(of(0.0), of(1.0), of(0.0))?)?;
/// let belt = Channel::new("belt", "friction", vec![(0, 1.0)], Vec::new());
/// let brake = Brake::new(AffineSystem::new(vec![spring, dashpot], vec![belt])?);
/// let drawn = vec![Drawn::new("c", "Ns/m", Distribution::Uniform { from: 6.0, to: 30.0 })];
/// let brake = IndependentBrake::new("mass on a belt", brake, drawn, |_, values| {
///     let friction = ChannelGain { slope: -12.0, ..ChannelGain::default() };
///     Ok(OperatingPoint { coefficients: vec![1.0, values[0]], channels: vec![friction] })
/// })?;
/// assert_eq!(brake.median(), [18.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct IndependentBrake<F> {
    plan: Plan,
    drawn: Vec<Drawn>,
    at: F,
}

impl<F: Fn(&Scene, &[f64]) -> Result<OperatingPoint, Error> + Sync> IndependentBrake<F> {
    /// A brake with one scene, 1,000 samples and seed 1, which [`IndependentBrake::with_samples`] changes. Its modes are named at the
    /// medians.
    ///
    /// # Errors
    /// As [`IndependentBrake::with_plan`].
    pub fn new(name: &str, brake: Brake, drawn: Vec<Drawn>, at: F) -> Result<Self, Error> {
        let medians: Vec<f64> = drawn.iter().map(|parameter| parameter.distribution.median()).collect();
        let failed = |source: Error| Error::Median { study: name.into(), source: Box::new(source) };
        let naming_point = at(&Scene::default(), &medians).map_err(failed)?;
        Self::with_plan(Plan::single(name, brake, naming_point, 1_000, 1), drawn, at)
    }

    /// A brake with a plan of its own: several sets of constraints, a band, a threshold. Its configurations are named at the operating point
    /// of the medians, as [`Plan::is_named_at_medians`] says, which a study checks.
    ///
    /// # Errors
    /// [`Contradiction::Distribution`] for parameters that are no distribution, [`Contradiction::NameTwice`] for two of one name.
    pub fn with_plan(mut plan: Plan, drawn: Vec<Drawn>, at: F) -> Result<Self, Error> {
        for (place, Drawn { name, distribution, .. }) in drawn.iter().enumerate() {
            if let Err(fault) = distribution.check() {
                return Err(Contradiction::Distribution { parameter: name.clone(), fault }.into());
            }
            if drawn[..place].iter().any(|earlier| earlier.name == *name) {
                return Err(Contradiction::NameTwice { what: "parameter", name: name.clone() }.into());
            }
        }
        plan.identity = Identity::read(&plan.name, &plan.identity)
            .part("parameters", |to| {
                to.list(&drawn, |to, parameter| {
                    to.text(&parameter.name);
                    to.distribution(&parameter.distribution);
                });
            })
            .into_line();
        Ok(Self { plan, drawn, at })
    }

    /// The brake under several friction laws by name and title, in whose order [`SceneKey::law`](crate::SceneKey::law) counts them.
    ///
    /// # Errors
    /// As [`Plan::with_laws`].
    pub fn with_laws(mut self, laws: &[(&str, &str)]) -> Result<Self, Error> {
        self.plan = self.plan.with_laws(laws)?;
        self.named_anew()
    }

    /// The brake in several ranges of sliding speed by name and description, in whose order
    /// [`SceneKey::speed`](crate::SceneKey::speed) counts them. Before this the range is `None`, with which the function was called when the
    /// brake was made. A speed in a range is a parameter that is drawn, such as a number from 0 to 1 that the function takes to it.
    ///
    /// # Errors
    /// As [`Plan::with_speeds`].
    pub fn with_speeds(mut self, speeds: &[(&str, &str)]) -> Result<Self, Error> {
        self.plan = self.plan.with_speeds(speeds)?;
        self.named_anew()
    }

    /// The brake with its modes named at the medians of the first scene of each configuration.
    fn named_anew(mut self) -> Result<Self, Error> {
        let median = self.median();
        for place in 0..self.plan.configurations.len() {
            let Some(scene) = self.plan.scenes.iter().find(|scene| scene.configuration == place) else { continue };
            let failed = |source| Error::Median { study: self.plan.name.clone(), source: Box::new(source) };
            let point = (self.at)(scene, &median).map_err(failed)?;
            let configuration = &mut self.plan.configurations[place];
            let origin = &mut self.plan.origins[configuration.origin];
            // An origin of another brake has a naming point of its own.
            if Arc::ptr_eq(&origin.brake, &configuration.brake) {
                origin.naming_point.clone_from(&point);
            }
            configuration.naming_point = point;
        }
        Ok(self)
    }

    /// The brake with another number of samples, >= 1, and seed.
    #[must_use]
    pub fn with_samples(mut self, samples: u64, seed: u64) -> Self {
        (self.plan.samples, self.plan.seed) = (samples, seed);
        self
    }

    /// Parameters that are not constant, with their indices.
    fn varying(&self) -> impl Iterator<Item = (usize, &Drawn)> {
        let varies =
            |(_, parameter): &(usize, &Drawn)| !matches!(parameter.distribution, Distribution::Constant { .. });
        self.drawn.iter().enumerate().filter(varies)
    }
}

impl<F: Fn(&Scene, &[f64]) -> Result<OperatingPoint, Error> + Sync> UncertainBrake for IndependentBrake<F> {
    type Sample = Vec<f64>;

    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<Vec<f64>, Error> {
        self.drawn.iter().map(|parameter| Ok(parameter.distribution.draw(rng)?)).collect()
    }

    fn median(&self) -> Vec<f64> {
        self.drawn.iter().map(|parameter| parameter.distribution.median()).collect()
    }

    fn operating_point(&self, scene: &Scene, sample: &Vec<f64>) -> Result<OperatingPoint, Error> {
        (self.at)(scene, sample)
    }

    fn drawn_inputs(&self) -> Option<&dyn DrawnInputs<Vec<f64>>> {
        Some(self)
    }

    fn parametrised(&self) -> Option<&dyn Parametrised> {
        Some(self)
    }
}

impl<F: Fn(&Scene, &[f64]) -> Result<OperatingPoint, Error> + Sync> DrawnInputs<Vec<f64>> for IndependentBrake<F> {
    fn inputs(&self, _: &Scene) -> Vec<Input> {
        let input = |(place, parameter): (usize, &Drawn)| Input {
            name: parameter.name.clone(),
            unit: parameter.unit.clone(),
            coordinate: place as u32,
            is_correlated: false,
            has_atoms: parameter.distribution.has_atoms(),
            jumps: parameter.distribution.jumps(),
        };
        self.varying().map(input).collect()
    }

    fn input_values(&self, _: &Scene, sample: &Vec<f64>) -> Vec<f64> {
        self.varying().map(|(place, _)| sample[place]).collect()
    }

    fn quantile_sample(&self, _: &Scene, uniform: &dyn Fn(u32) -> f64) -> Vec<f64> {
        self.drawn.iter().zip(0..).map(|(parameter, d)| parameter.distribution.quantile(uniform(d))).collect()
    }

    fn single_parameter(&self, _: &Scene) -> Option<SingleParameter<'_, Vec<f64>>> {
        let mut varying = self.varying();
        let (place, only) = varying.next().filter(|_| varying.next().is_none())?;
        let with = move |value: f64| {
            let mut sample = self.median();
            sample[place] = value;
            sample
        };
        Some(SingleParameter::new(&only.distribution, with))
    }
}

impl<F: Fn(&Scene, &[f64]) -> Result<OperatingPoint, Error> + Sync> Parametrised for IndependentBrake<F> {
    fn parameters(&self, _: &Scene) -> Vec<NamedParameter> {
        let named = |parameter: &Drawn| NamedParameter {
            name: parameter.name.clone(),
            unit: parameter.unit.clone(),
            median: parameter.distribution.median(),
        };
        self.drawn.iter().map(named).collect()
    }

    fn system_with(&self, scene: &Scene, values: &[(usize, f64)]) -> Result<SecondOrder, Error> {
        let mut sample = self.median();
        for &(place, value) in values {
            sample[place] = value;
        }
        self.system(scene, &sample)
    }

    fn contact_points(&self, _: &Scene) -> Vec<String> {
        Vec::new()
    }

    fn closed_points(&self, _: &Scene, _: &[(usize, f64)]) -> Result<Vec<bool>, Error> {
        Ok(Vec::new())
    }
}
