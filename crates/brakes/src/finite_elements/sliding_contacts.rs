//! The contacts of a finite element brake beyond their tangents, on its reduced brake: for the motion after the onset.

use std::sync::Arc;

use cycle::{ContactFriction, ContactSystem, SlidingContact};
use friction::{BristleMotion, FrictionSeries};
use linsys::{AffineSystem, OperatingPoint};
use study::{DrawnContacts, Scene, SlidingContacts};

use super::parameters::{self, SceneOf, Values};
use super::sliding::{PairInMotion, sliding};
use super::{FiniteElementBrake, FiniteElementSample, points};
use crate::Error;
use crate::case::{CaseError, FiniteElementCase, Law, PatchContact};

/// Refuses a case whose motion after the onset is not computed, before anything of it is reduced.
///
/// # Errors
/// A case without a contact; viscoelastic springs, friction across the sliding, a stiffness that grows with the pressure: their motion is not in the equations; a
/// law that knows no speed where nothing else says one; rows that are rotations, whose velocities have no common unit with others.
pub fn check_motion(case: &FiniteElementCase) -> Result<(), Error> {
    let refused = |field: &str, value: &str, allowed: &str| {
        let (path, field, value, allowed) = (case.header.path.clone(), field.into(), value.into(), allowed.into());
        Err(CaseError::Value { path, field, value, allowed }.into())
    };
    let Some(contact) = &case.contact else {
        return refused(
            "contact",
            "missing",
            "a contact that could open, slide or stick: without one motion is linear",
        );
    };
    if let Some(branch) = case.branches.first() {
        let allowed = "springs that do not relax: the motion after the onset is followed without their states";
        return refused(&branch.field, "given", allowed);
    }
    let table = if contact.is_of_faces { "all_contacts" } else { "contact" };
    if contact.is_lateral {
        let allowed = "\"none\": the motion after the onset is followed without friction across the sliding, which would turn with it";
        return refused(&format!("{table}.lateral"), "\"vector\"", allowed);
    }
    if contact.has_power_law {
        let allowed =
            "a stiffness that is the same at any pressure: the motion after the onset is followed with springs";
        return refused("contact.stiffness", "{ c, m }", allowed);
    }
    if contact.laws.contains(&Law::AmontonsCoulomb) && contact.speeds.is_empty() && contact.own_speed.is_none() {
        let allowed = "a range of speed, or --speed: a contact sticks at its speed, which no eigenvalue under this law depends on";
        return refused("speeds", "missing", allowed);
    }
    match case.dofs.iter().find(|dof| dof.direction > 3) {
        Some(dof) => {
            let allowed = "rows of displacements alone: the velocities of all rows are measured together";
            refused("terms", &format!("with a row {dof}"), allowed)
        }
        None => Ok(()),
    }
}

impl SlidingContacts for FiniteElementBrake {
    fn contact_system(
        &self,
        scene: &Scene,
        values: &[(usize, f64)],
        stick: f64,
    ) -> Result<ContactSystem, study::Error> {
        Ok(contact_system(self, scene, parameters::changed(&self.scene_of(scene), values), stick)?)
    }
}

impl DrawnContacts<FiniteElementSample> for FiniteElementBrake {
    fn contact_system_of(
        &self,
        scene: &Scene,
        sample: &FiniteElementSample,
        stick: f64,
    ) -> Result<ContactSystem, study::Error> {
        let at = parameters::of_sample(&self.scene_of(scene), sample.clone());
        Ok(contact_system(self, scene, at, stick)?)
    }
}

/// The equations of motion of a scene on the basis of its part: a contact for each pair of its closed patches.
fn contact_system(
    brake: &FiniteElementBrake,
    scene: &Scene,
    mut at: Values,
    stick: f64,
) -> Result<ContactSystem, Error> {
    check_motion(&brake.case)?;
    let of_scene = brake.scene_of(scene);
    if let (Some((law, None)), Some(contact)) = (of_scene.state, &brake.case.contact) {
        at.friction = Some((law, own_speed(contact, &at)));
    }
    let system = brake.part(scene).reduced.system();
    let point = parameters::whole_point(&of_scene, &at)?;
    let contacts = contacts(&of_scene, &at, system, stick)?;
    Ok(ContactSystem::new(parts(&of_scene, system, &point)?, contacts)?)
}

/// The speed of a scene under a law whose tangent knows none, m/s: of the sample in the first range, where its motion sticks at a speed.
fn own_speed(contact: &PatchContact, at: &Values) -> f64 {
    let quantile = at.sample.contacts.as_ref().map_or(0.5, |contacts| contacts.speed_quantile);
    let given = contact.speeds.first().map(|range| range.quantile(quantile));
    // The parameters say it where no range does.
    given.or(at.friction.map(|(_, speed)| speed)).unwrap_or_default()
}

/// The contacts of all pairs of the closed patches.
fn contacts(scene: &SceneOf<'_>, at: &Values, system: &AffineSystem, stick: f64) -> Result<Vec<SlidingContact>, Error> {
    let SceneOf { case, closed, .. } = *scene;
    let (coefficients, factor) = points::coefficients(case, &at.sample, at.scales())?;
    let Some(slides) = sliding((case, closed), at.friction, &at.sample, at.scales())? else { return Ok(Vec::new()) };
    let in_motion = slides.in_motion(&coefficients, factor, stick)?;
    let patches = case.contact.iter().flat_map(|contact| closed.iter().map(|&patch| &contact.patches[patch]));
    let of_patch = patches.zip(in_motion).flat_map(|(patch, pairs)| {
        let channels = &system.channels()[patch.channels.clone()];
        channels.iter().zip(&patch.springs).zip(pairs).map(|((channel, spring), pair)| {
            let PairInMotion { load, stiffness, speed, friction: (law, factor) } = pair;
            SlidingContact {
                name: channel.name.clone(),
                family: channel.family.clone(),
                sliding: channel.force.clone(),
                // The channel reads the spring times the gap, which closes as the faces approach.
                normal: channel.reading.iter().map(|&(column, value)| (column, -value / spring)).collect(),
                stiffness,
                load,
                speed,
                friction: if factor == 1.0 { law } else { Arc::new(Times { factor, law }) },
            }
        })
    });
    Ok(of_patch.collect())
}

/// The structure with its closed contact springs, a part for each family: all terms, and the stiffness of the springs of pairs beyond what the term of
/// their patch has of it.
fn parts(scene: &SceneOf<'_>, system: &AffineSystem, at: &OperatingPoint) -> Result<Vec<cycle::Part>, Error> {
    let mut parts: Vec<cycle::Part> = Vec::new();
    for part in cycle::Part::of_terms(system, &at.coefficients) {
        match parts.iter_mut().find(|other| other.family == part.family) {
            Some(same) => {
                same.matrices.m += part.matrices.m;
                same.matrices.c += part.matrices.c;
                same.matrices.k += part.matrices.k;
            }
            None => parts.push(part),
        }
    }
    let patches = scene.case.contact.iter().flat_map(|contact| &contact.patches);
    // Channels behind the channels of friction; friction across the sliding is refused.
    for channel in patches.flat_map(|patch| patch.channels.clone().skip(patch.pairs.len())) {
        let (gain, channel) = (at.channels[channel].mu, &system.channels()[channel]);
        let Some(part) = parts.iter_mut().find(|part| part.family == channel.family) else {
            return Err(cycle::Error::Structure("the springs of contacts are in no term").into());
        };
        for &(i, b) in &channel.force {
            channel.reading.iter().for_each(|&(j, r)| part.matrices.k[(i, j)] += gain * b * r);
        }
    }
    Ok(parts)
}

/// A law whose coefficient is multiplied.
#[derive(Debug)]
struct Times {
    factor: f64,
    law: Arc<dyn ContactFriction>,
}

impl Times {
    fn times(&self, mut motion: BristleMotion) -> BristleMotion {
        for value in [&mut motion.mu, &mut motion.mu_by_velocity, &mut motion.mu_by_state] {
            *value *= self.factor;
        }
        motion
    }
}

impl ContactFriction for Times {
    fn at(&self, velocity: f64, state: f64) -> BristleMotion {
        self.times(self.law.at(velocity, state))
    }

    fn sliding(&self, speed: f64, is_forwards: bool) -> Option<BristleMotion> {
        self.law.sliding(speed, is_forwards).map(|motion| self.times(motion))
    }

    fn steady_state(&self, speed: f64) -> Option<f64> {
        self.law.steady_state(speed)
    }

    fn stick_speed(&self) -> f64 {
        self.law.stick_speed()
    }

    fn is_constant(&self) -> bool {
        self.law.is_constant()
    }

    fn series(&self) -> Option<Box<dyn FrictionSeries>> {
        Some(Box::new(SeriesTimes { factor: self.factor, series: self.law.series()? }))
    }
}

/// The series of such a law.
struct SeriesTimes {
    factor: f64,
    series: Box<dyn FrictionSeries>,
}

impl FrictionSeries for SeriesTimes {
    fn begin(&mut self, is_forwards: bool) {
        self.series.begin(is_forwards);
    }

    fn next(&mut self, velocity: f64, state: f64) -> [f64; 2] {
        let [mu, rate] = self.series.next(velocity, state);
        [self.factor * mu, rate]
    }
}
