//! The parameters of a finite element brake by the names that its case file has for them.

use linsys::SecondOrder;

use super::{FiniteElementBrake, FiniteElementSample, points};
use crate::Error;
use crate::brakes::LatticeSample;
use crate::brakes::friction_parameters::{FRICTION, FrictionParameter, FrictionUse};
use crate::case::{Law, PatchContact};
use crate::study::{NamedParameter, Scene, UncertainBrake};

/// A parameter of a scene.
enum Choice {
    /// One of the case's own, by its place.
    Own(usize),
    Friction(&'static FrictionParameter),
    Speed,
    /// The load of every closed patch, as a factor.
    Load,
    /// The stiffness of a closed patch, as a factor.
    Stiffness(usize),
}

/// All that the parameters of a scene can change.
struct Values {
    sample: FiniteElementSample,
    friction: Option<(Law, f64)>,
    load: f64,
    /// Of each patch.
    stiffness: Vec<f64>,
}

fn medians(brake: &FiniteElementBrake, scene: &Scene) -> Values {
    let sample = brake.median();
    let patches = brake.case.contact.as_ref().map_or(0, |contact| contact.patches.len());
    Values { friction: brake.law_and_speed(scene, &sample), sample, load: 1.0, stiffness: vec![1.0; patches] }
}

/// The parameters on which the systems of a scene depend: the case's own, those of friction, speed and load, and the stiffness of each
/// closed patch.
fn of_scene(brake: &FiniteElementBrake, scene: &Scene) -> Vec<Choice> {
    let own = (0..brake.case.parameters.len()).map(Choice::Own);
    let Some(contact) = &brake.case.contact else { return own.collect() };
    let law = contact.laws[scene.key.law];
    let of = FrictionUse { law, is_lateral: false, has_bristle_damping: contact.bristle_damping.is_some() };
    let friction = FRICTION.iter().filter(|parameter| (parameter.matters)(&of)).map(Choice::Friction);
    // Coulomb friction knows neither speed nor load.
    let sliding = [Choice::Speed, Choice::Load].into_iter().filter(|_| law != Law::AmontonsCoulomb);
    own.chain(friction)
        .chain(sliding)
        .chain(brake.closed(scene).iter().map(|&patch| Choice::Stiffness(patch)))
        .collect()
}

pub(super) fn named(brake: &FiniteElementBrake, scene: &Scene) -> Vec<NamedParameter> {
    let at = medians(brake, scene);
    let patches = brake.case.contact.as_ref().map_or(&[][..], |contact: &PatchContact| &contact.patches);
    let named = |choice: Choice| {
        let (name, unit, median) = match choice {
            Choice::Own(place) => {
                let parameter = &brake.case.parameters[place];
                (parameter.name.clone(), parameter.unit.clone(), at.sample.values[place])
            }
            Choice::Friction(parameter) => {
                let draw = at.sample.contacts.as_ref()?.contact(0);
                (parameter.name.into(), parameter.unit.into(), (parameter.get)(draw))
            }
            Choice::Speed => ("v".into(), "m/s".into(), at.friction?.1),
            Choice::Load => ("load".into(), "times the load".into(), 1.0),
            Choice::Stiffness(patch) => {
                (format!("contact_stiffness.{}", patches[patch].name), "times the stiffness".into(), 1.0)
            }
        };
        Some(NamedParameter { name, unit, median })
    };
    of_scene(brake, scene).into_iter().filter_map(named).collect()
}

/// The reduced system with some parameters at other values. What is constant in the brake of a scene is taken apart again: each patch
/// is a term of the reduced system.
pub(super) fn system(brake: &FiniteElementBrake, scene: &Scene, values: &[(usize, f64)]) -> Result<SecondOrder, Error> {
    let (mut at, parameters) = (medians(brake, scene), of_scene(brake, scene));
    for &(place, value) in values {
        match &parameters[place] {
            Choice::Own(place) => at.sample.values[*place] = value,
            Choice::Friction(parameter) => {
                at.sample.contacts = at.sample.contacts.map(|sample| {
                    let mut draw = *sample.contact(0);
                    (parameter.set)(&mut draw, value);
                    LatticeSample::shared(draw, sample.speed_quantile)
                });
            }
            Choice::Speed => at.friction = at.friction.map(|(law, _)| (law, value)),
            Choice::Load => at.load = value,
            Choice::Stiffness(patch) => at.stiffness[*patch] = value,
        }
    }
    let mut point = points::scene_point(&brake.case, brake.closed(scene), at.friction, &at.sample)?;
    for gain in &mut point.channels {
        gain.slope *= at.load;
        gain.lag = gain.lag.map(|lag| linsys::Lag { force: at.load * lag.force, ..lag });
    }
    let mut whole = brake.full_point(scene, &point);
    let first_patch = whole.coefficients.len() - at.stiffness.len();
    for (patch, factor) in at.stiffness.iter().enumerate() {
        whole.coefficients[first_patch + patch] *= factor;
        // A channel reads the normal force of its spring.
        points::channels_of(&brake.case, patch).for_each(|channel| whole.channels[channel].mu *= factor);
    }
    Ok(brake.part(scene).reduced.system().assemble(&whole)?)
}
