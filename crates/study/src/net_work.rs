//! Work of each family of forces on each body in a mode.

use cea::Mode;
use linsys::OperatingPoint;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use osc_model::Brake;
use work::{FamilyForces, ModeWork, work_of_forces};

use crate::Error;

/// The work in one mode of a brake at an operating point, by force family and body.
///
/// # Errors
/// An operating point of another system; errors of [`work_of_forces`].
pub fn mode_work(brake: &Brake, at: &OperatingPoint, mode: &Mode) -> Result<ModeWork, Error> {
    work_with(&brake.system.mass(&at.coefficients)?, brake, at, mode.lambda, &mode.shape)
}

/// The work in one mode, as [`mode_work`] has it, with the mass matrix of the operating point given.
pub(super) fn work_with(
    mass: &DMatrix<f64>,
    brake: &Brake,
    at: &OperatingPoint,
    lambda: Complex<f64>,
    shape: &DVector<Complex<f64>>,
) -> Result<ModeWork, Error> {
    let forces = brake.system.families().iter().zip(brake.system.family_forces(at, lambda, shape)?);
    let families: Vec<_> = forces.map(|(name, forces)| FamilyForces { name, forces }).collect();
    Ok(work_of_forces(mass, &families, lambda, shape, &brake.bodies)?)
}
