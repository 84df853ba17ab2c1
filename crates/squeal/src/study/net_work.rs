//! Work of each family of forces on each body in a mode.

use cea::Mode;
use linsys::{AffineSystem, OperatingPoint, SecondOrder};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use osc_model::Brake;
use work::{ForceFamily, ModeWork, family_work};

use crate::Error;

/// The work in one mode of a brake at an operating point, by force family and body.
///
/// # Errors
/// An operating point of another system; those of [`family_work`].
pub fn mode_work(brake: &Brake, at: &OperatingPoint, mode: &Mode) -> Result<ModeWork, Error> {
    WorkSystems::new(&brake.system, at)?.of(mode.lambda, &mode.shape, brake)
}

/// What work is computed from at one operating point.
pub(super) struct WorkSystems<'a> {
    names: &'a [String],
    mass: DMatrix<f64>,
    families: Vec<SecondOrder>,
}

impl<'a> WorkSystems<'a> {
    /// # Errors
    /// An operating point of another system.
    pub fn new(system: &'a AffineSystem, at: &OperatingPoint) -> Result<Self, Error> {
        let names = system.families();
        let mut families = vec![SecondOrder::zeros(system.order(), 0); names.len()];
        for (name, family) in names.iter().zip(&mut families) {
            system.family_into(name, at, family)?;
        }
        Ok(Self { names, mass: system.mass(&at.coefficients)?, families })
    }

    /// The work in a mode with this shape over the free degrees of freedom, on the bodies of a brake.
    ///
    /// # Errors
    /// Those of [`family_work`].
    pub fn of(&self, lambda: Complex<f64>, shape: &DVector<Complex<f64>>, brake: &Brake) -> Result<ModeWork, Error> {
        let families: Vec<ForceFamily<'_>> =
            self.names.iter().zip(&self.families).map(|(name, system)| ForceFamily { name, system }).collect();
        Ok(family_work(&self.mass, &families, lambda, shape, &brake.bodies)?)
    }
}
