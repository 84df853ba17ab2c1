//! The capability of a brake whose numbers are drawn one by one: their names and values, and samples by quantiles.

use montecarlo::Distribution;

use crate::Scene;

/// A number that is drawn for a scene.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Input {
    /// Name of the input, as the case file has it; with the number of its contact where each has a draw of its own.
    pub name: String,
    /// Unit of the input, for people.
    pub unit: String,
    /// Coordinate of [`DrawnInputs::quantile_sample`] that the input is a function of.
    pub coordinate: u32,
    /// True if the input depends on another one.
    pub is_correlated: bool,
    /// True if the input has a value with a probability of its own, above 0, and so may keep it where its coordinate changes.
    pub has_atoms: bool,
    /// True if the input is no continuous function of its coordinate, or has but one value.
    pub jumps: bool,
}

/// Samples as functions of numbers that are drawn: for influence, for samples that are kept, and for estimators that need fewer samples
/// than plain draws.
pub trait DrawnInputs<S>: Sync {
    /// Inputs that are drawn and matter in a scene. Constants are not listed.
    fn inputs(&self, scene: &Scene) -> Vec<Input>;

    /// Values of the [`DrawnInputs::inputs`] in a sample, one each.
    fn input_values(&self, scene: &Scene, sample: &S) -> Vec<f64>;

    /// The sample at a point of the unit cube, by the quantile functions of the parameters: `uniform(d)` in (0, 1) is its
    /// coordinate d, the most important parameters first.
    fn quantile_sample(&self, scene: &Scene, uniform: &dyn Fn(u32) -> f64) -> S;

    /// The one parameter that the operating points of a scene are a function of; `None` where they depend on more than one parameter, or on no parameter.
    fn single_parameter(&self, scene: &Scene) -> Option<SingleParameter<'_, S>>;
}

/// The one parameter that the operating points of a scene are a function of.
pub struct SingleParameter<'a, S> {
    /// Distribution that the parameter is drawn from.
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
