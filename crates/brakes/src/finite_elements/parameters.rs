//! The parameters of a finite element brake by the names that its case file has for them.

use linsys::OperatingPoint;
use study::NamedParameter;

use super::FiniteElementSample;
use super::points;
use super::samples::{self, State};
use super::sliding::Scales;
use crate::Error;
use crate::LatticeSample;
use crate::case::{FiniteElementCase, Law, PatchContact};
use crate::friction_parameters::{FRICTION, FrictionParameter, FrictionUse};

/// A scene of a case, reduced or not.
#[derive(Clone, Copy)]
pub(super) struct SceneOf<'a> {
    pub case: &'a FiniteElementCase,
    /// The closed patches, from 0.
    pub closed: &'a [usize],
    pub state: State,
}

/// A parameter of a scene.
enum Choice {
    /// A parameter of the case's own, by its index.
    Own(usize),
    Friction(&'static FrictionParameter),
    Speed,
    /// The load of every closed patch, as a factor.
    Load,
    /// The stiffness of a closed patch, as a factor.
    Stiffness(usize),
}

/// Values that the parameters of a scene can change.
pub(super) struct Values {
    pub sample: FiniteElementSample,
    pub friction: Option<(Law, f64)>,
    load: f64,
    /// Factors of the stiffness, one of each patch.
    stiffness: Vec<f64>,
}

impl Values {
    /// The factors of all loads and of the stiffness of each patch.
    pub fn scales(&self) -> Scales<'_> {
        Scales { load: self.load, stiffness: &self.stiffness }
    }
}

fn medians(scene: &SceneOf<'_>) -> Values {
    of_sample(scene, samples::median(scene.case))
}

/// The values of a sample.
pub(super) fn of_sample(scene: &SceneOf<'_>, sample: FiniteElementSample) -> Values {
    let patches = scene.case.contact.as_ref().map_or(0, |contact| contact.patches.len());
    let friction = samples::law_and_speed(scene.case, scene.state, &sample);
    Values { friction, sample, load: 1.0, stiffness: vec![1.0; patches] }
}

/// The parameters on which the systems of a scene depend: the parameters of the case, of friction, speed and load, and the stiffness of each closed patch.
fn of_scene(scene: &SceneOf<'_>) -> Vec<Choice> {
    let acts = |place: &usize| scene.case.contact.as_ref().is_none_or(|of| of.spread.acts_in(*place, scene.closed));
    let own = (0..scene.case.parameters.len()).filter(acts).map(Choice::Own);
    let Some((contact, (law, _))) = scene.case.contact.as_ref().zip(scene.state) else { return own.collect() };
    let of = FrictionUse { law, has_lateral_mu: false, has_bristle_damping: contact.bristle_damping.is_some() };
    let friction = FRICTION.iter().filter(|parameter| (parameter.matters)(&of)).map(Choice::Friction);
    // A speed that parameters say is theirs.
    let has_own = contact.own_speed.is_some() && contact.speeds.is_empty();
    let speed = (!has_own).then_some(Choice::Speed);
    let sliding = speed.into_iter().chain([Choice::Load]).filter(|_| points::depends_on_speed(contact, law));
    own.chain(friction).chain(sliding).chain(scene.closed.iter().map(|&patch| Choice::Stiffness(patch))).collect()
}

pub(super) fn named(scene: &SceneOf<'_>) -> Vec<NamedParameter> {
    let (at, units) = (medians(scene), scene.case.header.units);
    let patches = scene.case.contact.as_ref().map_or(&[][..], |contact: &PatchContact| &contact.patches);
    let named = |choice: Choice| {
        let (name, unit, median) = match choice {
            Choice::Own(place) => {
                let parameter = &scene.case.parameters[place];
                (parameter.name.clone(), parameter.unit.clone(), at.sample.values[place])
            }
            Choice::Friction(parameter) => {
                let draw = at.sample.contacts.as_ref()?.contact(0);
                (parameter.name.into(), units.of(parameter.unit).into(), (parameter.get)(draw))
            }
            Choice::Speed => ("v".into(), units.of("m/s").into(), at.friction?.1),
            Choice::Load => ("load".into(), "times the load".into(), 1.0),
            Choice::Stiffness(patch) => {
                (format!("contact_stiffness.{}", patches[patch].name), "times the stiffness".into(), 1.0)
            }
        };
        Some(NamedParameter { name, unit, median })
    };
    of_scene(scene).into_iter().filter_map(named).collect()
}

/// The values of a scene whose parameters have `values`, by their indices in [`named`] (not checked), and all others their medians.
pub(super) fn changed(scene: &SceneOf<'_>, values: &[(usize, f64)]) -> Values {
    let (mut at, parameters) = (medians(scene), of_scene(scene));
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
    at
}

/// Names of the contact points of a scene that open and close, by patch and number from 1; none where loads are given.
pub(super) fn contact_points(scene: &SceneOf<'_>) -> Vec<String> {
    let contact = scene.case.contact.as_ref().filter(|contact| contact.balance.is_some());
    let of_patch = |contact: &PatchContact, patch: usize| {
        let patch = &contact.patches[patch];
        (1..=patch.points.len()).map(|number| format!("{}.{number}", patch.name)).collect::<Vec<_>>()
    };
    contact.into_iter().flat_map(|contact| scene.closed.iter().flat_map(move |&at| of_patch(contact, at))).collect()
}

/// Flags of [`contact_points`], true of those that press, with parameters at `values` as of [`changed`].
pub(super) fn closed_points(scene: &SceneOf<'_>, values: &[(usize, f64)]) -> Result<Vec<bool>, Error> {
    let at = changed(scene, values);
    points::closed_points(scene.case, scene.closed, at.friction, &at.sample, at.scales())
}

/// The operating point of the whole brake, reduced or not, with parameters at `values` as of [`changed`]. What is constant in the brake of a scene is
/// taken apart again: each patch is a term.
pub(super) fn point(scene: &SceneOf<'_>, values: &[(usize, f64)]) -> Result<OperatingPoint, Error> {
    whole_point(scene, &changed(scene, values))
}

/// As [`point`], of values that were put together before.
pub(super) fn whole_point(scene: &SceneOf<'_>, at: &Values) -> Result<OperatingPoint, Error> {
    let point = points::scaled_point(scene.case, scene.closed, at.friction, &at.sample, at.scales())?;
    let mut whole = points::of_brake(scene.case, scene.closed, &point);
    let first_patch = whole.coefficients.len() - at.stiffness.len();
    for (patch, factor) in at.stiffness.iter().enumerate() {
        whole.coefficients[first_patch + patch] *= factor;
        // A channel reads the normal force of its spring.
        points::channels_of(scene.case, patch).for_each(|channel| whole.channels[channel].mu *= factor);
    }
    Ok(whole)
}
