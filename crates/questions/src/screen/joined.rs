//! A brake and variants of it as one brake, so that they are compared on the same draws.

use std::ops::Range;

use cea::Mode;
use cycle::ContactSystem;
use linsys::{OperatingPoint, SecondOrder};
use montecarlo::StreamRng;
use nalgebra::DVector;
use num_complex::Complex;
use study::identity::{Identity, of_study};
use study::{
    BandMode, Bridge, CoarsePath, DrawnContacts, DrawnInputs, FullChecks, ModeSource, Modifiable, ModifiablePlan,
    Parametrised, Place, Plan, Scene, SceneKey, SlidingContacts, Symmetry, UncertainBrake, WholeContact,
    WholeEigenvalue, doubts_of_checks,
};

use super::confirm::analyses;
use super::modified::modifiable_of;
use crate::Error;

/// A brake whose sets of constraints are its own, and after them its variants: other brakes, each with one of its sets of constraints.
///
/// A sample has a draw of each of the brakes from one random stream. Numbers that are drawn in the same order are the same in all of them;
/// the comparison is right also where they are not, and less sharp.
pub struct Joined<'a, B> {
    plan: Plan,
    parts: Vec<Part<'a, B>>,
}

/// One of the brakes that are joined.
struct Part<'a, B> {
    brake: &'a B,
    by_plan: ModifiablePlan<'a>,
    /// Its configurations among the configurations of the whole.
    configurations: Range<usize>,
    /// Its sets of constraints among the sets of the whole, and the first of them in its own plan.
    constraints: (Range<usize>, usize),
    /// Indices of its panels among the panels of the whole.
    panels: Vec<usize>,
}

impl<'a, B: UncertainBrake> Joined<'a, B> {
    /// A brake with its variants, each by a name, of which the set of constraints called as number `constraints` of the brake is taken, or the only one.
    ///
    /// # Errors
    /// [`Error::Variant`]: what is counted in a variant cannot be compared, or a set of constraints has its name.
    pub fn new(brake: &'a B, variants: &[(&str, &'a B)], constraints: usize) -> Result<Self, Error> {
        let of = brake.plan();
        let identity = Identity::read(&of.name, &of.identity).part("variants", |to| {
            to.list(variants, |to, (name, variant)| {
                to.text(name);
                to.text(&of_study(*variant).into_line());
            });
        });
        let mut plan = of.clone();
        plan.identity = identity.into_line();
        let own = Part {
            brake,
            by_plan: ModifiablePlan(of),
            configurations: 0..of.configurations.len(),
            constraints: (0..of.labels.constraints.len(), 0),
            panels: (0..of.labels.panels.len()).collect(),
        };
        let mut joined = Self { plan, parts: vec![own] };
        joined.plan.doubts.extend(checks_of(brake));
        for (name, variant) in variants {
            let taken = joined.comparable(name, variant.plan(), &of.labels.constraints[constraints])?;
            joined.add(name, variant, taken);
        }
        Ok(joined)
    }

    /// The set of constraints of a variant that is compared with one of the brake's.
    fn comparable(&self, name: &str, of: &Plan, constraints: &str) -> Result<usize, Error> {
        let refused = |what, found: String, allowed: String| {
            Err(Error::Variant { name: name.to_owned(), what, found, allowed: format!("that of the case, {allowed}") })
        };
        let Plan { labels, .. } = &self.plan;
        if labels.constraints.iter().any(|known| known == name) {
            let allowed = "a name of its own".into();
            return Err(Error::Variant { name: name.to_owned(), what: "name", found: name.into(), allowed });
        }
        let joined =
            |names: &mut dyn Iterator<Item = &String>| names.map(String::as_str).collect::<Vec<_>>().join(", ");
        let said = |of: &Plan| {
            [
                ("laws", joined(&mut of.labels.laws.iter().map(|law| &law.name))),
                ("speeds", joined(&mut of.labels.speeds.iter().map(|speed| &speed.name))),
                ("band", of.band.map_or("all frequencies".into(), |[from, to]| format!("{from} to {to} rad/s"))),
                ("threshold of squeal", of.threshold.to_string()),
                ("units", of.units.name().to_owned()),
            ]
        };
        for ((what, found), (_, own)) in said(of).into_iter().zip(said(&self.plan)) {
            if found != own {
                return refused(what, found, own);
            }
        }
        let place = |of: &Plan| of.labels.constraints.iter().position(|known| known == constraints);
        let taken = match (place(of), of.labels.constraints.len()) {
            (Some(place), _) => place,
            (None, 1) => 0,
            _ => return refused("sets of constraints", of.labels.constraints.join(", "), constraints.to_owned()),
        };
        // Counts of all analyses of a draw are subtracted from each other.
        let in_set = |of: &Plan, set: usize| {
            let scenes = of.scenes.iter().filter(|scene| scene.key.constraints == set);
            scenes.map(|scene| analyses(of, scene)).sum::<usize>()
        };
        let (found, own) = (in_set(of, taken), place(&self.plan).map_or(0, |set| in_set(&self.plan, set)));
        if found != own {
            let words = |count: usize| format!("{count} for each draw");
            return refused("arrangements, laws and ranges of speed", words(found), words(own));
        }
        Ok(taken)
    }

    fn add(&mut self, name: &str, brake: &'a B, taken: usize) {
        let (of, plan) = (brake.plan(), &mut self.plan);
        let (origins, first, set) = (plan.origins.len(), plan.configurations.len(), plan.labels.constraints.len());
        plan.labels.constraints.push(name.to_owned());
        let mut panels = Vec::new();
        for panel in &of.labels.panels {
            let known = plan.labels.panels.iter().position(|known| known == panel);
            panels.push(known.unwrap_or(plan.labels.panels.len()));
            if known.is_none() {
                plan.labels.panels.push(panel.clone());
            }
        }
        plan.origins.extend(of.origins.iter().cloned());
        plan.configurations.extend(of.configurations.iter().cloned().map(|mut configuration| {
            configuration.origin += origins;
            configuration
        }));
        for scene in of.scenes.iter().filter(|scene| scene.key.constraints == taken) {
            let key = SceneKey { constraints: set, panel: panels[scene.key.panel], ..scene.key };
            let mut joined = scene.clone();
            (joined.key, joined.configuration) = (key, first + scene.configuration);
            plan.scenes.push(joined);
        }
        let doubts = of.doubts.iter().cloned().chain(checks_of(brake));
        plan.doubts.extend(doubts.map(|doubt| format!("{name}: {doubt}")));
        self.parts.push(Part {
            brake,
            by_plan: ModifiablePlan(of),
            configurations: first..plan.configurations.len(),
            constraints: (set..set + 1, taken),
            panels,
        });
    }

    /// The part that a scene belongs to, its index, and the scene as the part's own plan has it.
    fn own(&self, scene: &Scene) -> Option<(usize, &Part<'a, B>, Scene)> {
        let of = |(_, part): &(usize, &Part<'a, B>)| part.configurations.contains(&scene.configuration);
        let (at, part) = self.parts.iter().enumerate().find(of)?;
        let mut own = scene.clone();
        own.configuration -= part.configurations.start;
        own.key.constraints = scene.key.constraints - part.constraints.0.start + part.constraints.1;
        own.key.panel = part.panels.iter().position(|&panel| panel == scene.key.panel)?;
        Some((at, part, own))
    }

    /// Modifiable parts of the brake that a scene belongs to, and the scene as its own plan has it.
    fn of_scene(&self, scene: &Scene) -> Option<(&dyn Modifiable, Scene)> {
        let (_, part, own) = self.own(scene)?;
        Some((modifiable_of(part.brake, &part.by_plan).ok()?, own))
    }

    /// Modifiable parts of the brake that a set of constraints belongs to, and the set in its own plan.
    fn of_set(&self, constraints: usize) -> Option<(&dyn Modifiable, usize)> {
        let part = self.parts.iter().find(|part| part.constraints.0.contains(&constraints))?;
        let own = constraints - part.constraints.0.start + part.constraints.1;
        Some((modifiable_of(part.brake, &part.by_plan).ok()?, own))
    }
}

/// Sentences that speak against the results of a brake by its checks against the full model, if it is reduced.
pub(super) fn checks_of<B: UncertainBrake>(brake: &B) -> Vec<String> {
    let source = brake.mode_source();
    doubts_of_checks(brake.plan(), source.is_some(), source.and_then(|source| source.full_checks()))
}

impl<B: UncertainBrake> UncertainBrake for Joined<'_, B> {
    type Sample = Vec<B::Sample>;

    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<Self::Sample, study::Error> {
        let start = rng.clone();
        let of_part = |part: &Part<'_, B>| {
            *rng = start.clone();
            part.brake.draw(rng)
        };
        self.parts.iter().map(of_part).collect()
    }

    fn median(&self) -> Self::Sample {
        self.parts.iter().map(|part| part.brake.median()).collect()
    }

    fn operating_point(&self, scene: &Scene, sample: &Self::Sample) -> Result<OperatingPoint, study::Error> {
        let (at, part, own) = self.own(scene).ok_or(study::Error::OtherSample)?;
        part.brake.operating_point(&own, sample.get(at).ok_or(study::Error::OtherSample)?)
    }

    fn operating_points(&self, scene: &Scene, samples: &[&Self::Sample]) -> Vec<Result<OperatingPoint, study::Error>> {
        let part = self.own(scene).and_then(|(at, part, own)| {
            let samples = samples.iter().map(|sample| sample.get(at)).collect::<Option<Vec<_>>>()?;
            Some(part.brake.operating_points(&own, &samples))
        });
        part.unwrap_or_else(|| samples.iter().map(|_| Err(study::Error::OtherSample)).collect())
    }

    /// `None`: inputs belong to one of the brakes.
    fn drawn_inputs(&self) -> Option<&dyn DrawnInputs<Self::Sample>> {
        None
    }

    /// `None`: parameters belong to one of the brakes.
    fn parametrised(&self) -> Option<&dyn Parametrised> {
        None
    }

    fn modifiable(&self) -> Option<&dyn Modifiable> {
        let is_given = |part: &Part<'_, B>| modifiable_of(part.brake, &part.by_plan).is_ok();
        self.parts.iter().all(is_given).then_some(self)
    }

    /// Of brakes that find their modes themselves, one of which at least has loss factors; else `None`, as spectra are what all of them have.
    fn mode_source(&self) -> Option<&dyn ModeSource> {
        let are_sources = self.parts.iter().all(|part| part.brake.mode_source().is_some());
        let has_dashpots = |scene: &Scene| self.has_dashpots_for_losses(scene);
        (are_sources && self.plan.scenes.iter().any(has_dashpots)).then_some(self)
    }

    fn error_of_reduction(&self, scene: &Scene) -> f64 {
        self.own(scene).map_or(0.0, |(_, part, own)| part.brake.error_of_reduction(&own))
    }

    /// `None`: the scenes of a motion belong to one of the brakes.
    fn sliding_contacts(&self) -> Option<&dyn SlidingContacts> {
        None
    }

    fn drawn_contacts(&self) -> Option<&dyn DrawnContacts<Self::Sample>> {
        self.parts.iter().all(|part| part.brake.drawn_contacts().is_some()).then_some(self)
    }
}

/// Modifiable parts of the brake that a set of constraints belongs to.
impl<B: UncertainBrake> Modifiable for Joined<'_, B> {
    fn contacts(&self, scene: &Scene) -> Vec<WholeContact> {
        self.of_scene(scene).map_or_else(Vec::new, |(of, own)| of.contacts(&own))
    }

    fn places(&self, constraints: usize) -> Result<Option<Vec<Place>>, study::Error> {
        self.of_set(constraints).map_or(Ok(None), |(of, own)| of.places(own))
    }

    fn symmetries(&self, constraints: usize) -> Vec<Symmetry> {
        self.of_set(constraints).map_or_else(Vec::new, |(of, own)| of.symmetries(own))
    }

    fn symmetry_of_member(&self, scene: &Scene, member: usize) -> usize {
        self.of_scene(scene).map_or(0, |(of, own)| of.symmetry_of_member(&own, member))
    }

    fn members_are_equal(&self) -> bool {
        let are_equal =
            |part: &Part<'_, B>| modifiable_of(part.brake, &part.by_plan).is_ok_and(|of| of.members_are_equal());
        self.parts.iter().all(are_equal)
    }

    fn scalable_terms(&self, constraints: usize) -> Vec<String> {
        self.of_set(constraints).map_or_else(Vec::new, |(of, own)| of.scalable_terms(own))
    }
}

impl<'a, B: UncertainBrake> Joined<'a, B> {
    /// The source of the modes of the brake that a scene belongs to, and the scene as its own plan has it.
    fn source(&self, scene: &Scene) -> Result<(&'a dyn ModeSource, Scene), study::Error> {
        let found = self.own(scene).and_then(|(_, part, own)| Some((part.brake.mode_source()?, own)));
        found.ok_or(study::Error::OtherSample)
    }
}

/// Modes of the brake that a scene belongs to. [`UncertainBrake::mode_source`] hands this out only where all of them find theirs.
impl<B: UncertainBrake> ModeSource for Joined<'_, B> {
    fn band_modes(&self, scene: &Scene, at: &[OperatingPoint]) -> Vec<Result<Vec<BandMode>, study::Error>> {
        match self.source(scene) {
            Ok((source, own)) => source.band_modes(&own, at),
            Err(_) => at.iter().map(|_| Err(study::Error::OtherSample)).collect(),
        }
    }

    fn has_dashpots_for_losses(&self, scene: &Scene) -> bool {
        self.source(scene).is_ok_and(|(source, own)| source.has_dashpots_for_losses(&own))
    }

    fn band_modes_with(&self, scene: &Scene, values: &[(usize, f64)]) -> Result<Vec<BandMode>, study::Error> {
        let (source, own) = self.source(scene)?;
        source.band_modes_with(&own, values)
    }

    fn band_modes_of_changed(
        &self,
        scene: &Scene,
        at: &OperatingPoint,
        changed: &SecondOrder,
    ) -> Result<Vec<BandMode>, study::Error> {
        let (source, own) = self.source(scene)?;
        source.band_modes_of_changed(&own, at, changed)
    }

    fn coarse(&self, scene: &Scene, at: [&OperatingPoint; 2]) -> Result<Option<CoarsePath<'_>>, study::Error> {
        let (source, own) = self.source(scene)?;
        source.coarse(&own, at)
    }

    /// `None`: modes are counted, and not followed.
    fn bridge(&self, _configuration: usize, _modes: [&[Mode]; 2]) -> Result<Option<Bridge>, study::Error> {
        Ok(None)
    }

    fn relative_error(&self, scene: &Scene) -> f64 {
        self.source(scene).map_or(1.0, |(source, own)| source.relative_error(&own))
    }

    fn unknown_error(&self, scene: &Scene) -> Option<&'static str> {
        self.source(scene).ok().and_then(|(source, own)| source.unknown_error(&own))
    }

    fn whole_eigenvalue(
        &self,
        scene: &Scene,
        values: &[(usize, f64)],
        near: Complex<f64>,
    ) -> Result<WholeEigenvalue, study::Error> {
        let (source, own) = self.source(scene)?;
        source.whole_eigenvalue(&own, values, near)
    }

    fn eigenvalue_at_origin(&self, _constraints: usize, lambda: Complex<f64>) -> Complex<f64> {
        lambda
    }

    fn whole_shape(&self, _constraints: usize, _shape: &DVector<Complex<f64>>) -> Vec<(String, Complex<f64>)> {
        Vec::new()
    }

    fn routes(&self) -> Vec<(&'static str, u64)> {
        Vec::new()
    }

    fn full_checks(&self) -> Option<&FullChecks> {
        None
    }
}

/// Contacts of the brake that a scene belongs to. [`UncertainBrake::drawn_contacts`] hands this out only where all of them have some.
impl<B: UncertainBrake> DrawnContacts<Vec<B::Sample>> for Joined<'_, B> {
    fn contact_system_of(
        &self,
        scene: &Scene,
        sample: &Vec<B::Sample>,
        stick: f64,
    ) -> Result<ContactSystem, study::Error> {
        let (at, part, own) = self.own(scene).ok_or(study::Error::OtherSample)?;
        let (contacts, sample) = (part.brake.drawn_contacts(), sample.get(at));
        let (contacts, sample) = contacts.zip(sample).ok_or(study::Error::OtherSample)?;
        contacts.contact_system_of(&own, sample, stick)
    }
}
