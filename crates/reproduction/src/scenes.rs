//! The panels and scenes of the paper's case, by what the paper calls them.

use squeal::results::Results;
use squeal::study::{Panel, Reference, Scene};

/// Index of the paper's constraint set without constraints, in its case.
pub(crate) const UNCONSTRAINED: usize = 0;
/// Index of the set that holds the corners in x.
pub(crate) const CORNERS_HELD: usize = 1;
/// Index of the set with six constraints: the corners and two more.
pub(crate) const SIX_HELD: usize = 2;

pub(super) fn number_in_contact(results: &Results, panel: &Panel) -> usize {
    results.plan().labels.panels[panel.key.panel].in_contact
}

pub(super) fn law_name<'a>(results: &'a Results, panel: &Panel) -> &'a str {
    &results.plan().labels.laws[panel.key.law].name
}

pub(super) fn speed_name<'a>(results: &'a Results, panel: &Panel) -> &'a str {
    panel.key.speed.map_or("all speeds", |range| &results.plan().labels.speeds[range].name)
}

/// The name of the law of a scene.
pub(super) fn law_of(results: &Results, scene: &Scene) -> String {
    results.plan().labels.laws[scene.key.law].name.clone()
}

/// The scenes of a constraint set with every oscillator in contact, each with its index and its reference modes; of the laws
/// that the results are of.
pub(super) fn full_contact(results: &Results, constraints: usize) -> impl Iterator<Item = (usize, &Scene, &Reference)> {
    let scenes = results.plan().scenes.iter().zip(results.references()).enumerate();
    let is_meant = move |scene: &Scene| scene.wants_work && scene.key.constraints == constraints;
    let has_panel = |scene: &Scene| results.panels().iter().any(|panel| panel.key == scene.key);
    scenes
        .filter(move |(_, (scene, _))| is_meant(scene) && has_panel(scene))
        .map(|(at, (scene, reference))| (at, scene, reference))
}
