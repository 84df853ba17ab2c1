//! The power that the faces of a brake would radiate in a cycle, were each of them a piston in an infinite plane.

use study::{Scene, UncertainBrake};

use super::MotionOfMode;
use crate::Error;

/// Specific impedance of air at 20 degrees Celsius and 101,325 Pa, rho c, Ns/m^3: 1.204 kg/m^3 times 343.2 m/s.
const AIR: f64 = 1.204 * 343.2;

/// Sets the power of each harmonic of each cycle, `rho c int <v_n^2> dA` over the outer faces, W, of a brake that has some. That is radiation efficiency 1.
///
/// # Errors
/// As [`OuterFaces::squares_along_normals`](study::OuterFaces::squares_along_normals).
pub(super) fn radiate<B: UncertainBrake>(brake: &B, scene: &Scene, motions: &mut [MotionOfMode]) -> Result<(), Error> {
    let Some(faces) = brake.outer_faces() else { return Ok(()) };
    let length = brake.plan().units.length();
    for of in motions {
        let Some(harmonics) = &of.harmonics else { continue };
        let squares = faces.squares_along_normals(scene, &harmonics.velocity)?;
        // Velocities are in m/s, areas in the brake's units.
        let power = |square: f64| 0.5 * AIR * square * length * length;
        of.radiated_power = squares.map(|squares| squares.into_iter().map(power).collect());
    }
    Ok(())
}
