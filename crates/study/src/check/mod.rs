//! The checks of a brake before it is studied: whatever it forgets or contradicts would be a wrong number later, or a panic.

mod parameters;
mod plan;
mod same;
mod samples;

use super::{Scene, UncertainBrake};
use crate::Error;

/// Checks a plan and what its brake computes, by a few operating points and assemblies.
///
/// # Errors
/// The first [`Contradiction`](super::Contradiction); errors of the brake at its medians.
pub fn check<B: UncertainBrake>(brake: &B) -> Result<(), Error> {
    plan::check(brake.plan())?;
    samples::check(brake)?;
    parameters::check(brake)
}

/// The first scene of each kind; `kind` tells kinds apart.
fn first_of_each<K: PartialEq>(scenes: &[Scene], kind: impl Fn(&Scene) -> K) -> Vec<&Scene> {
    let mut first: Vec<(K, &Scene)> = Vec::new();
    for scene in scenes {
        let kind = kind(scene);
        if first.iter().all(|(known, _)| *known != kind) {
            first.push((kind, scene));
        }
    }
    first.into_iter().map(|(_, scene)| scene).collect()
}
