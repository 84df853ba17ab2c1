//! The named parameters of a brake: checks that the systems that they make are the systems of its samples, and change with each parameter.

use linsys::SecondOrder;

use super::first_of_each;
use super::same::{Difference, systems_differ};
use crate::Error;
use crate::{Contradiction, NamedParameter, Parametrised, Plan, Scene, UncertainBrake};

/// Factors of the median by which a parameter is changed until the system changes, in the order in which they are tried; chosen: those far from 1 are for
/// parameters that act through a threshold, those near 1 for parameters of which a brake allows no other values.
const FACTORS: [f64; 8] = [1.1, 0.9, 1.01, 0.99, 1.5, 0.5, 2.0, 0.1];
/// Numbers that are added instead, for a median of zero; chosen: of the units of the parameter nothing is known.
const SUMMANDS: [f64; 6] = [1.0, -1.0, 1e-3, -1e-3, 1e3, -1e3];
/// The coordinate of quantile samples by which a parameter that is drawn is changed; chosen: any but one half, where the medians are.
const COORDINATE: f64 = 0.75;

pub(super) fn check<B: UncertainBrake>(brake: &B) -> Result<(), Error> {
    let (plan, Some(parametrised)) = (brake.plan(), brake.parametrised()) else { return Ok(()) };
    for scene in first_of_each(&plan.scenes, |scene| (scene.key.constraints, scene.key.law, scene.key.speed)) {
        if !parametrised.parameters(scene).is_empty() {
            let (found, expected) = (parametrised.system_with(scene, &[])?, brake.system(scene, &brake.median())?);
            agree(plan, scene, "system_with() without values", "the system of median()", &found, &expected)?;
        }
    }
    // What a case file makes follows its tables; what follows takes a system for each parameter.
    if plan.source_file.is_some() {
        return Ok(());
    }
    let mut idle: Vec<Idle> = Vec::new();
    let mut moving: Vec<String> = Vec::new();
    for scene in first_of_each(&plan.scenes, |scene| scene.key.law) {
        let changed = Changed::new(brake, parametrised, scene)?;
        changed.as_drawn()?;
        changed.all_count()?;
        for (parameter, moved) in changed.parameters.iter().zip(&changed.moved) {
            match moved {
                Moved::To(..) | Moved::Refused => moving.push(parameter.name.clone()),
                Moved::Nowhere(tried) => {
                    let tried: Vec<String> = tried.iter().map(f64::to_string).collect();
                    idle.push(Idle {
                        scene: plan.describe(scene),
                        parameter: parameter.name.clone(),
                        tried: tried.join(", "),
                    });
                }
            }
        }
    }
    match idle.into_iter().find(|idle| !moving.contains(&idle.parameter)) {
        None => Ok(()),
        Some(Idle { scene, parameter, tried }) => Err(Contradiction::IdleParameter { scene, parameter, tried }.into()),
    }
}

/// A parameter that changes nothing in a scene.
struct Idle {
    scene: String,
    parameter: String,
    tried: String,
}

/// Result of the values that were tried for a parameter.
enum Moved {
    /// Another system, at this value.
    To(f64, Box<SecondOrder>),
    /// No value allowed but the median.
    Refused,
    /// No other system at any of these values.
    Nowhere(Vec<f64>),
}

/// The systems of a scene with each parameter changed.
struct Changed<'a, B> {
    brake: &'a B,
    parametrised: &'a dyn Parametrised,
    scene: &'a Scene,
    parameters: Vec<NamedParameter>,
    moved: Vec<Moved>,
}

impl<'a, B: UncertainBrake> Changed<'a, B> {
    fn new(brake: &'a B, parametrised: &'a dyn Parametrised, scene: &'a Scene) -> Result<Self, Error> {
        let parameters = parametrised.parameters(scene);
        let mut moved = Vec::with_capacity(parameters.len());
        if !parameters.is_empty() {
            let unchanged = parametrised.system_with(scene, &[])?;
            for (place, &NamedParameter { ref name, median, .. }) in parameters.iter().enumerate() {
                let one = format!("system_with() at the median of {name}, {median},");
                let found = parametrised.system_with(scene, &[(place, median)])?;
                agree(brake.plan(), scene, &one, "the system of median()", &found, &unchanged)?;
                let values: Vec<f64> = match median == 0.0 {
                    true => SUMMANDS.to_vec(),
                    false => FACTORS.map(|factor| factor * median).to_vec(),
                };
                let of = |&value: &f64| Some((value, parametrised.system_with(scene, &[(place, value)]).ok()?));
                let mut allowed = values.iter().filter_map(of).peekable();
                moved.push(if allowed.peek().is_none() {
                    Moved::Refused
                } else {
                    allowed
                        .find(|(_, system)| *system != unchanged)
                        .map_or(Moved::Nowhere(values.clone()), |(value, system)| Moved::To(value, Box::new(system)))
                });
            }
        }
        Ok(Self { brake, parametrised, scene, parameters, moved })
    }

    /// Checks that a value that a sample by quantiles has makes the system of that sample.
    fn as_drawn(&self) -> Result<(), Error> {
        let Self { brake, parametrised, scene, .. } = *self;
        let Some(drawn) = brake.drawn_inputs() else { return Ok(()) };
        for (at, input) in drawn.inputs(scene).iter().enumerate().filter(|(_, input)| !input.is_correlated) {
            let Some(place) = self.parameters.iter().position(|parameter| parameter.name == input.name) else {
                continue;
            };
            let uniform = |coordinate| if coordinate == input.coordinate { COORDINATE } else { 0.5 };
            let sample = drawn.quantile_sample(scene, &uniform);
            let Some(&value) = drawn.input_values(scene, &sample).get(at) else { continue };
            let (found, expected) =
                (parametrised.system_with(scene, &[(place, value)])?, brake.system(scene, &sample)?);
            let one = format!("system_with() at {} = {value}", input.name);
            agree(brake.plan(), scene, &one, "the system of the sample with this value", &found, &expected)?;
        }
        Ok(())
    }

    /// Checks that several values count together.
    fn all_count(&self) -> Result<(), Error> {
        let mut moved = Vec::new();
        for (place, of) in self.moved.iter().enumerate() {
            if let Moved::To(value, system) = of {
                moved.push((place, *value, system));
            }
        }
        let values: Vec<(usize, f64)> = moved.iter().map(|&(place, value, _)| (place, value)).collect();
        if let ([_, _, ..], Ok(all)) = (&moved[..], self.parametrised.system_with(self.scene, &values))
            && let Some(&(place, ..)) = moved.iter().find(|(_, _, alone)| ***alone == all)
        {
            let (scene, parameter) = (self.brake.plan().describe(self.scene), self.parameters[place].name.clone());
            return Err(Contradiction::LostValues { scene, parameter }.into());
        }
        Ok(())
    }
}

fn agree(
    plan: &Plan,
    scene: &Scene,
    one: &str,
    other: &str,
    found: &SecondOrder,
    expected: &SecondOrder,
) -> Result<(), Contradiction> {
    let Some(Difference { what, found, expected }) = systems_differ(found, expected) else { return Ok(()) };
    let (scene, one, other) = (plan.describe(scene), one.to_owned(), other.to_owned());
    Err(Contradiction::Differ { scene, one, other, what, found, expected })
}
