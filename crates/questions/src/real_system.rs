//! Computations by real systems: what a brake with loss factors cannot have.

use study::UncertainBrake;

use crate::Error;

/// Refuses what `needed_by` names, which is by the real systems of a brake, where one of its scenes has dashpots in the place of loss factors there.
///
/// # Errors
/// [`Error::LossFactors`].
pub fn check_real<B: UncertainBrake>(brake: &B, needed_by: &'static str) -> Result<(), Error> {
    let plan = brake.plan();
    match plan.scenes.iter().any(|scene| brake.source_with_losses(scene).is_some()) {
        true => Err(Error::LossFactors { study: plan.source(), needed_by }),
        false => Ok(()),
    }
}
