//! Modes that are unstable at the medians, which a screening is to get rid of, with their shapes.

use std::collections::BTreeMap;

use linsys::DofMap;
use nalgebra::DVector;
use num_complex::Complex;

use study::{ModeLabel, Scene, Study, UncertainBrake};

use crate::Error;

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

/// The unstable modes of a set of constraints at the medians: for each law and speed the modes of the scene with most in contact. A brake with loss factors
/// finds its own modes, each with the names of the nearest mode of the system with dashpots.
///
/// # Errors
/// Modes that a brake with loss factors does not find.
pub(super) fn growing_modes<B: UncertainBrake>(
    study: &Study<'_, B>,
    constraints: usize,
) -> Result<Vec<GrowingMode>, Error> {
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
        let growing = |names: &[ModeLabel], lambda, shape: &DVector<Complex<f64>>| GrowingMode {
            scene: plan.describe(scene),
            mode: ModeLabel::candidates(names),
            lambda,
            dofs: plan.brake(scene).dofs.clone(),
            shape: shape.clone(),
        };
        let is_wanted = |lambda: Complex<f64>| plan.threshold.margin(lambda) > 0.0 && plan.is_studied(lambda);
        match study.brake().source_with_losses(scene) {
            Some(source) => {
                let at = study.brake().operating_point(scene, &study.brake().median())?;
                let modes = source.band_modes(scene, &[at]).into_iter().next().transpose()?.unwrap_or_default();
                for mode in modes.iter().filter(|mode| is_wanted(mode.lambda)) {
                    let distance = |at: &usize| (reference.modes[*at].lambda - mode.lambda).norm();
                    let nearest = (0..reference.modes.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
                    let names = nearest.map_or(&[][..], |at| &reference.names[at]);
                    found.push(growing(names, mode.lambda, &mode.shape));
                }
            }
            None => {
                let modes = reference.modes.iter().zip(&reference.names).filter(|(mode, _)| is_wanted(mode.lambda));
                found.extend(modes.map(|(mode, names)| growing(names, mode.lambda, &mode.shape)));
            }
        }
    }
    Ok(found)
}
