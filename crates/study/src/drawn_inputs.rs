//! The capability of a brake whose numbers are drawn one by one: what they are called, and samples by quantiles.

use montecarlo::Distribution;

use crate::Scene;

/// A number that is drawn for a scene.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Input {
    /// Its name, as the case file has it; with the number of its contact where each has a draw of its own.
    pub name: String,
    /// Its unit, for people.
    pub unit: String,
    /// The coordinate of [`DrawnInputs::quantile_sample`] that it is a function of.
    pub coordinate: u32,
    /// Whether it depends on another input.
    pub is_correlated: bool,
}

/// Samples as functions of numbers that are drawn: for influence, for samples that are kept, and for estimators that need fewer samples
/// than plain draws.
pub trait DrawnInputs<S>: Sync {
    /// What is drawn and matters in a scene. Constants are not listed.
    fn inputs(&self, scene: &Scene) -> Vec<Input>;

    /// The value that each of the [`DrawnInputs::inputs`] has in a sample.
    fn input_values(&self, scene: &Scene, sample: &S) -> Vec<f64>;

    /// The sample at a point of the unit cube, by the quantile functions of the parameters: `uniform(d)` in (0, 1) is its
    /// coordinate d, the most important parameters first.
    fn quantile_sample(&self, scene: &Scene, uniform: &dyn Fn(u32) -> f64) -> S;

    /// The one parameter that the operating points of a scene are a function of; `None` where there are more, or none.
    fn single_parameter(&self, scene: &Scene) -> Option<SingleParameter<'_, S>>;
}

/// The one parameter that the operating points of a scene are a function of.
pub struct SingleParameter<'a, S> {
    /// What it is drawn from.
    pub distribution: &'a Distribution,
    at: Box<dyn Fn(f64) -> S + 'a>,
}

impl<'a, S> SingleParameter<'a, S> {
    /// A parameter with its distribution, and the sample in which it has a value and all others their medians.
    pub fn new(distribution: &'a Distribution, at: impl Fn(f64) -> S + 'a) -> Self {
        Self { distribution, at: Box::new(at) }
    }

    /// The sample in which the parameter has a value.
    pub fn sample(&self, value: f64) -> S {
        (self.at)(value)
    }
}
