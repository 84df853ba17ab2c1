//! A brake whose sets of constraints are sets of changes of another brake.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use cea::Mode;
use cycle::ContactSystem;
use linsys::{ChannelGain, OperatingPoint, SecondOrder};
use montecarlo::StreamRng;
use nalgebra::DVector;
use num_complex::Complex;
use study::identity::{Identity, Written};
use study::{
    BandMode, Bridge, CoarsePath, Configuration, DrawnContacts, DrawnInputs, FullChecks, ModeIdentity, ModeNaming,
    ModeSource, Modifiable, ModifiablePlan, Origin, Parametrised, Plan, Scene, SceneKey, SceneLabels, SlidingContacts,
    Symmetry, UncertainBrake, WholeContact, WholeEigenvalue,
};

use super::change::{Attached, Change, ChangedBrake};
use crate::Error;

/// Changes of a brake together, compared as one.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct ChangeSet {
    /// Name of the set.
    pub name: String,
    /// Index of the set of constraints of the brake that is changed.
    pub of: usize,
    /// Changes of the set; none is the brake as it is.
    pub changes: Vec<Change>,
}

impl ChangeSet {
    /// Writes the changes out, for an identity.
    fn written(to: &mut Written, Self { name, of, changes }: &Self) {
        to.text(name);
        to.count(*of);
        to.list(changes, |to, change| match change {
            Change::Hold { dof } => {
                to.text("hold");
                to.count(*dof);
            }
            Change::Attach { what, size, along } => {
                to.text(match what {
                    Attached::Mass => "mass",
                    Attached::Spring => "spring",
                    Attached::Dashpot => "dashpot",
                });
                to.number(*size);
                to.list(along, |to, vector| {
                    to.list(vector, |to, &(dof, value)| {
                        to.count(dof);
                        to.number(value);
                    });
                });
            }
            Change::Scale { term, what, factor } => {
                to.text("scale");
                to.text(term);
                to.text(what.name());
                to.number(*factor);
            }
            Change::TakeOut { contact } => {
                to.text("take out");
                to.count(*contact);
            }
        });
    }
}

/// A brake with several sets of changes as its sets of constraints, so that a study compares them on the same draws.
///
/// Modes are known by their frequency ranks in each sample: the numbers of unstable modes are compared.
///
/// A scene of the brake can stand for several arrangements, its members: one configuration is computed, and a symmetry maps it onto the
/// arrangement of each member. Changes of a member are made in that configuration, mapped back by the inverse of its symmetry. Members whose
/// changes come out alike there share a scene; the scene is divided into as many as there are changes that differ.
pub struct Modified<'a, B> {
    inner: &'a B,
    plan: Plan,
    /// Origin of each configuration in the inner brake.
    from: Vec<FromInner>,
}

/// Modifiable parts of a brake: the parts that it gives itself, else the parts that are seen from its plan.
///
/// # Errors
/// [`Error::NotGiven`] for a brake that gives none and has a scene that stands for several arrangements, as a plan does not say which symmetry
/// maps one onto another, and for one whose scenes stand for arrangements that differ draw by draw: the largest growth of a draw is that of all of them.
pub(super) fn modifiable_of<'a, B: UncertainBrake>(
    brake: &'a B,
    by_plan: &'a ModifiablePlan<'a>,
) -> Result<&'a dyn Modifiable, Error> {
    match brake.modifiable() {
        Some(given) if given.members_are_equal() => Ok(given),
        Some(_) => Err(Error::NotGiven {
            capability: "a scene for each arrangement, as LatticeBrake::of_equal_draws has",
            needed_by: "a screen with a draw for each contact",
        }),
        None if by_plan.0.scenes.iter().all(|scene| scene.members.len() == 1) => Ok(by_plan),
        None => Err(Error::NotGiven {
            capability: "modifiable()",
            needed_by: "a screen of scenes that stand for several arrangements",
        }),
    }
}

/// Configuration of the inner brake with changes.
struct FromInner {
    /// First scene of the inner brake that has the configuration.
    scene: Scene,
    changed: ChangedBrake,
}

/// Indices of the configurations that have been made, by the index of the inner configuration and the index of the image of the changes.
type LaidOut = HashMap<(usize, usize), usize>;

impl<'a, B: UncertainBrake> Modified<'a, B> {
    /// A brake with these sets of changes.
    ///
    /// # Errors
    /// Changes that leave nothing free.
    pub fn new(inner: &'a B, sets: &[ChangeSet]) -> Result<Self, Error> {
        let of = inner.plan();
        let by_plan = ModifiablePlan(of);
        let modifiable = modifiable_of(inner, &by_plan)?;
        let identity =
            Identity::read(&of.name, &of.identity).part("changes", |to| to.list(sets, ChangeSet::written)).into_line();
        let mut plan = Plan::without_scenes(&of.name, identity, of.samples, of.seed);
        plan.source_file.clone_from(&of.source_file);
        plan.commit = of.commit;
        (plan.mode_labels, plan.mode_identity) = (ModeNaming::Rank, ModeIdentity::Mac);
        (plan.band, plan.least_growth) = (of.band, of.least_growth);
        (plan.threshold, plan.is_named_at_medians) = (of.threshold, of.is_named_at_medians);
        plan.labels =
            SceneLabels { constraints: sets.iter().map(|set| set.name.clone()).collect(), ..of.labels.clone() };
        let mut modified = Self { inner, plan, from: Vec::new() };
        for (place, set) in sets.iter().enumerate() {
            modified.lay_out(modifiable, place, set)?;
        }
        Ok(modified)
    }

    /// Adds the configurations and scenes of a set of changes.
    fn lay_out(&mut self, modifiable: &dyn Modifiable, place: usize, set: &ChangeSet) -> Result<(), Error> {
        let images = Images::new(&set.changes, &modifiable.symmetries(set.of));
        let mut laid_out = LaidOut::default();
        for scene in self.inner.plan().scenes.iter().filter(|scene| scene.key.constraints == set.of) {
            let mut members: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
            for (at, &member) in scene.members.iter().enumerate() {
                let image = images.of_member(modifiable.symmetry_of_member(scene, at));
                members.entry(image).or_default().push(member);
            }
            for (image, members) in members {
                let configuration = self.configuration(
                    scene,
                    &modifiable.contacts(scene),
                    (&images.distinct[image], image),
                    &mut laid_out,
                )?;
                let key = SceneKey { constraints: place, ..scene.key };
                let mut changed = scene.clone();
                (changed.key, changed.members, changed.configuration) = (key, members, configuration);
                changed.wants_work = false;
                self.plan.scenes.push(changed);
            }
        }
        Ok(())
    }

    /// Index of the configuration of a scene with changes; the configuration is made if it does not exist yet.
    fn configuration(
        &mut self,
        scene: &Scene,
        contacts: &[WholeContact],
        (changes, image): (&[Change], usize),
        laid_out: &mut LaidOut,
    ) -> Result<usize, Error> {
        if let Some(&known) = laid_out.get(&(scene.configuration, image)) {
            return Ok(known);
        }
        let from = self.inner.plan().configuration(scene);
        let changed = ChangedBrake::new(&from.brake, contacts, changes)?;
        let (brake, naming_point) = (Arc::new(changed.brake.clone()), changed.point(from.naming_point.clone()));
        // Modes have no names here but their ranks, so that each configuration is the origin of its own.
        self.plan.origins.push(Origin { brake: Arc::clone(&brake), naming_point: naming_point.clone() });
        let (origin, contacts) = (self.plan.origins.len() - 1, from.contacts.clone());
        self.plan.configurations.push(Configuration { brake, naming_point, origin, contacts });
        self.from.push(FromInner { scene: scene.clone(), changed });
        let place = self.from.len() - 1;
        laid_out.insert((scene.configuration, image), place);
        Ok(place)
    }
}

impl<B: UncertainBrake> Modified<'_, B> {
    /// The scene of the inner brake that a scene is changed from, with its law and speed.
    fn inner_scene(&self, scene: &Scene) -> Scene {
        let mut inner = self.from[scene.configuration].scene.clone();
        inner.key = SceneKey { constraints: inner.key.constraints, ..scene.key };
        inner
    }
}

/// Images of a set of changes under the symmetries of a brake.
struct Images {
    /// Images that differ.
    pub distinct: Vec<Vec<Change>>,
    /// Index of the image under the inverse of each symmetry.
    by_inverse: Vec<usize>,
}

impl Images {
    fn new(changes: &[Change], symmetries: &[Symmetry]) -> Self {
        let mut images = Self { distinct: Vec::new(), by_inverse: Vec::new() };
        if symmetries.is_empty() {
            return Self { distinct: vec![changes.to_vec()], by_inverse: vec![0] };
        }
        for symmetry in symmetries {
            let mut image: Vec<Change> = changes.iter().map(|change| change.image(&inverse(symmetry))).collect();
            image.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
            let place = images.distinct.iter().position(|other| *other == image);
            images.by_inverse.push(place.unwrap_or(images.distinct.len()));
            if place.is_none() {
                images.distinct.push(image);
            }
        }
        images
    }

    /// Index of the changes to be made in the configuration of a scene so that they become the changes of a member onto which this
    /// symmetry maps the configuration.
    fn of_member(&self, symmetry: usize) -> usize {
        self.by_inverse.get(symmetry).copied().unwrap_or(0)
    }
}

/// The symmetry that undoes another.
pub(super) fn inverse(symmetry: &Symmetry) -> Symmetry {
    let inverse = |of: &[usize]| {
        let mut inverse = vec![0; of.len()];
        of.iter().enumerate().for_each(|(from, &to)| inverse[to] = from);
        inverse
    };
    Symmetry { dofs: inverse(&symmetry.dofs), contacts: inverse(&symmetry.contacts) }
}

impl<B: UncertainBrake> UncertainBrake for Modified<'_, B> {
    type Sample = B::Sample;

    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<B::Sample, study::Error> {
        self.inner.draw(rng)
    }

    fn median(&self) -> B::Sample {
        self.inner.median()
    }

    fn operating_point(&self, scene: &Scene, sample: &B::Sample) -> Result<OperatingPoint, study::Error> {
        let changed = &self.from[scene.configuration].changed;
        Ok(changed.point(self.inner.operating_point(&self.inner_scene(scene), sample)?))
    }

    fn operating_points(&self, scene: &Scene, samples: &[&B::Sample]) -> Vec<Result<OperatingPoint, study::Error>> {
        let changed = &self.from[scene.configuration].changed;
        let unchanged = self.inner.operating_points(&self.inner_scene(scene), samples);
        unchanged.into_iter().map(|point| Ok(changed.point(point?))).collect()
    }

    /// `None`: scenes here are not the scenes of the inner brake, to which its inputs belong.
    fn drawn_inputs(&self) -> Option<&dyn DrawnInputs<B::Sample>> {
        None
    }

    /// `None`: the systems of the inner brake with values of parameters do not have the changes.
    fn parametrised(&self) -> Option<&dyn Parametrised> {
        None
    }

    /// `None`: changes are made once, in [`Modified::new`].
    fn modifiable(&self) -> Option<&dyn Modifiable> {
        None
    }

    /// Source of an inner brake with loss factors, which no system here has. Of another one `None`: modes that it finds are those without the changes; spectra
    /// are taken instead.
    fn mode_source(&self) -> Option<&dyn ModeSource> {
        let source = self.inner.mode_source()?;
        let has_dashpots = |scene: &Scene| source.has_dashpots_for_losses(&self.inner_scene(scene));
        self.plan.scenes.iter().any(has_dashpots).then_some(self)
    }

    /// Error of the inner brake: what the changes add to it is not known.
    fn error_of_reduction(&self, scene: &Scene) -> f64 {
        self.inner.error_of_reduction(&self.inner_scene(scene))
    }

    /// `None`: the motion of the inner brake is that without the changes.
    fn sliding_contacts(&self) -> Option<&dyn SlidingContacts> {
        None
    }

    fn drawn_contacts(&self) -> Option<&dyn DrawnContacts<B::Sample>> {
        self.inner.drawn_contacts().map(|_| self as _)
    }
}

/// Modes of the inner brake with the changes and its loss factors. [`UncertainBrake::mode_source`] hands this out only where the inner brake has some.
impl<B: UncertainBrake> ModeSource for Modified<'_, B> {
    fn band_modes(&self, scene: &Scene, at: &[OperatingPoint]) -> Vec<Result<Vec<BandMode>, study::Error>> {
        let Some(source) = self.inner.mode_source() else {
            return at.iter().map(|_| Err(study::Error::OtherSample)).collect();
        };
        let (inner, changed) = (self.inner_scene(scene), &self.from[scene.configuration].changed);
        if changed.is_unchanged() {
            return source.band_modes(&inner, at);
        }
        let of_inner = &self.inner.plan().brake(&inner).system;
        let modes = |at: &OperatingPoint| {
            let system = changed.brake.system.assemble(at)?;
            let coefficients = at.coefficients[..of_inner.terms().len()].to_vec();
            let channels = vec![ChannelGain::default(); of_inner.channels().len()];
            source.band_modes_of_changed(&inner, &OperatingPoint { coefficients, channels }, &system)
        };
        at.iter().map(modes).collect()
    }

    fn has_dashpots_for_losses(&self, scene: &Scene) -> bool {
        let inner = self.inner_scene(scene);
        self.inner.mode_source().is_some_and(|source| source.has_dashpots_for_losses(&inner))
    }

    /// Refused: a set of changes has no parameters.
    fn band_modes_with(&self, _scene: &Scene, _values: &[(usize, f64)]) -> Result<Vec<BandMode>, study::Error> {
        Err(study::Error::OtherSample)
    }

    /// Refused: changes are made once, in [`Modified::new`].
    fn band_modes_of_changed(
        &self,
        _scene: &Scene,
        _at: &OperatingPoint,
        _changed: &SecondOrder,
    ) -> Result<Vec<BandMode>, study::Error> {
        Err(study::Error::OtherSample)
    }

    fn coarse(&self, _scene: &Scene, _at: [&OperatingPoint; 2]) -> Result<Option<CoarsePath<'_>>, study::Error> {
        Ok(None)
    }

    /// `None`: each configuration is the origin of its own.
    fn bridge(&self, _configuration: usize, _modes: [&[Mode]; 2]) -> Result<Option<Bridge>, study::Error> {
        Ok(None)
    }

    fn relative_error(&self, scene: &Scene) -> f64 {
        self.inner.error_of_reduction(&self.inner_scene(scene))
    }

    fn unknown_error(&self, scene: &Scene) -> Option<&'static str> {
        let inner = self.inner_scene(scene);
        self.inner.mode_source().and_then(|source| source.unknown_error(&inner))
    }

    /// Refused: the full model has none of the changes.
    fn whole_eigenvalue(
        &self,
        _scene: &Scene,
        _values: &[(usize, f64)],
        _near: Complex<f64>,
    ) -> Result<WholeEigenvalue, study::Error> {
        Err(study::Error::OtherSample)
    }

    fn eigenvalue_at_origin(&self, _constraints: usize, lambda: Complex<f64>) -> Complex<f64> {
        lambda
    }

    fn whole_shape(&self, _constraints: usize, _shape: &DVector<Complex<f64>>) -> Vec<(String, Complex<f64>)> {
        Vec::new()
    }

    fn routes(&self) -> Vec<(&'static str, u64)> {
        self.inner.mode_source().map_or_else(Vec::new, ModeSource::routes)
    }

    fn full_checks(&self) -> Option<&FullChecks> {
        None
    }
}

/// Contacts of the inner brake with the changes. [`UncertainBrake::drawn_contacts`] hands this out only where the inner brake has some.
impl<B: UncertainBrake> DrawnContacts<B::Sample> for Modified<'_, B> {
    fn contact_system_of(&self, scene: &Scene, sample: &B::Sample, stick: f64) -> Result<ContactSystem, study::Error> {
        let contacts = self.inner.drawn_contacts().ok_or(study::Error::OtherSample)?;
        let inner = self.inner_scene(scene);
        let unchanged = contacts.contact_system_of(&inner, sample, stick)?;
        let changed = &self.from[scene.configuration].changed;
        let at = self.operating_point(scene, sample)?;
        changed
            .motion((self.inner.plan().brake(&inner), &unchanged), &at)
            .map_err(|error| study::Error::Brake(Box::new(error)))
    }
}
