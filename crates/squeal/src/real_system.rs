//! Computations by real systems: what a brake with loss factors cannot have.

use study::{ModeSource, UncertainBrake};

use crate::Error;

/// Refuses what `needed_by` names, which is by the real systems of a brake, where one of its scenes has dashpots in the place of loss factors there.
///
/// # Errors
/// [`Error::LossFactors`].
pub fn check_real<B: UncertainBrake>(brake: &B, needed_by: &'static str) -> Result<(), Error> {
    let plan = brake.plan();
    let has_dashpots = |source: &dyn ModeSource| plan.scenes.iter().any(|scene| source.has_dashpots_for_losses(scene));
    match brake.mode_source().is_some_and(has_dashpots) {
        true => Err(Error::LossFactors { study: plan.source(), needed_by }),
        false => Ok(()),
    }
}
