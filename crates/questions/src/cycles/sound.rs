//! The power that the faces of a brake would radiate in a cycle, were each of them a piston in an infinite plane.

use montecarlo::Progress;
use nalgebra::DVector;
use num_complex::Complex;
use study::{FacesInMotion, Scene, UncertainBrake};

use crate::Error;

/// Specific impedance of air at 20 degrees Celsius and 101,325 Pa, rho c, Ns/m^3: 1.204 kg/m^3 times 343.2 m/s.
const AIR: f64 = 1.204 * 343.2;

/// The sound of motions of a scene.
#[derive(Debug)]
pub(super) struct Sound {
    faces: FacesInMotion,
    /// Unit of length of the brake, m.
    length: f64,
}

impl Sound {
    /// The sound of a brake that has outer faces.
    ///
    /// # Errors
    /// As [`OuterFaces::faces_in_motion`](study::OuterFaces::faces_in_motion).
    pub fn of<B: UncertainBrake>(brake: &B, scene: &Scene, progress: &dyn Progress) -> Result<Option<Self>, Error> {
        let faces = brake.outer_faces().map(|faces| faces.faces_in_motion(scene, progress)).transpose()?.flatten();
        Ok(faces.map(|faces| Self { faces, length: brake.plan().units.length() }))
    }

    /// Power `rho c int <v_n^2> dA` over the outer faces of a harmonic with these amplitudes of the velocity v, m/s: in W, at radiation efficiency 1.
    pub fn power(&self, velocity: &[Complex<f64>]) -> f64 {
        let square = |part: fn(&Complex<f64>) -> f64| {
            let v = DVector::from_iterator(velocity.len(), velocity.iter().map(part));
            v.dot(&(&self.faces.form * &v))
        };
        // Areas are in the brake's units.
        0.5 * AIR * (square(|v| v.re) + square(|v| v.im)) * self.length * self.length
    }

    /// Part of the outer area that counts as at rest though nothing is known to hold it, 0 to 1.
    pub fn without_rows(&self) -> f64 {
        self.faces.without_rows
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;

    /// A block with sides of 0.02, 0.03 and 0.05 m, whose coordinates are its velocities in x, y and z: the areas on which these are along the normal are
    /// 0.003, 0.002 and 0.0012 m^2. The mean square of `3 cos + 4 sin` is 12.5.
    #[test]
    fn a_rigid_block_radiates_half_of_rho_c_times_its_squares_and_areas() {
        let form = DMatrix::from_diagonal(&DVector::from_vec(vec![0.003, 0.002, 0.0012]));
        let si = Sound { faces: FacesInMotion { form: form.clone(), without_rows: 0.0 }, length: 1.0 };
        let velocity = [Complex::new(3.0, 4.0), Complex::new(0.0, 2.0), Complex::default()];
        let expected = 413.2128 * (0.003 * 12.5 + 0.002 * 2.0);
        assert!((si.power(&velocity) / expected - 1.0).abs() < 1e-14, "{}", si.power(&velocity));
        // The same block in mm, its velocities in m/s.
        let mm = Sound { faces: FacesInMotion { form: form * 1e6, without_rows: 0.0 }, length: 1e-3 };
        assert!((mm.power(&velocity) / expected - 1.0).abs() < 1e-14);
    }
}
