//! Modes that are unstable at the medians, which a screening is to get rid of, with their shapes.

use std::collections::BTreeMap;

use linsys::DofMap;
use nalgebra::DVector;
use num_complex::Complex;

use study::{ModeLabel, Scene, Study, UncertainBrake};

/// A mode that is unstable at the medians, of the brake as it is.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct GrowingMode {
    /// Scene, in words.
    pub scene: String,
    /// Candidates for the name of the mode.
    pub mode: String,
    /// Eigenvalue, rad/s.
    pub lambda: Complex<f64>,
    /// Free degrees of freedom of the scene.
    #[serde(skip)]
    pub dofs: DofMap,
    /// Right eigenvector over the free degrees of freedom.
    #[serde(skip)]
    pub shape: DVector<Complex<f64>>,
}

/// The unstable modes of a set of constraints at the medians: for each law and speed those of the scene with most in contact.
pub(super) fn growing_modes<B: UncertainBrake>(study: &Study<'_, B>, constraints: usize) -> Vec<GrowingMode> {
    let plan = study.plan();
    let in_contact = |scene: &Scene| plan.labels.panels[scene.key.panel].in_contact;
    let mut fullest: BTreeMap<(usize, Option<usize>), usize> = BTreeMap::new();
    for (place, scene) in plan.scenes.iter().enumerate().filter(|(_, scene)| scene.key.constraints == constraints) {
        let best = fullest.entry((scene.key.law, scene.key.speed)).or_insert(place);
        if in_contact(scene) > in_contact(&plan.scenes[*best]) {
            *best = place;
        }
    }
    let mut found = Vec::new();
    for place in fullest.into_values() {
        let (scene, reference) = (&plan.scenes[place], &study.references()[place]);
        for (mode, names) in reference.modes.iter().zip(&reference.names) {
            if plan.threshold.margin(mode.lambda) > 0.0 && plan.is_studied(mode.lambda) {
                found.push(GrowingMode {
                    scene: plan.describe(scene),
                    mode: ModeLabel::candidates(names),
                    lambda: mode.lambda,
                    dofs: plan.brake(scene).dofs.clone(),
                    shape: mode.shape.clone(),
                });
            }
        }
    }
    found
}
