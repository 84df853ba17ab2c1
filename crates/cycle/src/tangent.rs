//! The tangent of the equations of motion about steady sliding, beside the system of the complex eigenvalue analysis.

use linsys::{Internal, SecondOrder};
use nalgebra::{DMatrix, Dyn, SymmetricEigen};
use num_complex::Complex;

use crate::contact::along;
use crate::{ContactSystem, Error, SlidingContact};

/// Largest relative deviation of the tangent from the system of the complex eigenvalue analysis; chosen, some hundred roundings.
const TANGENT_TOLERANCE: f64 = 1e-10;

/// Eigenvalues of a stiffness below this part of its largest entry, negative, count as negative; chosen, far above rounding.
const NEGATIVE: f64 = 1e-9;

impl ContactSystem {
    /// The linear system of small motion about steady sliding.
    #[must_use]
    pub fn tangent(&self) -> SecondOrder {
        let n = self.order();
        let mut tangent = self.structure.clone();
        tangent.internal = Internal::zeros(n, self.dimension - 2 * n);
        let at_rest = vec![0.0; self.dimension];
        for (contact, of) in self.contacts.iter().enumerate() {
            let forces = self.forces_in(contact, &at_rest);
            for &(i, b) in &of.sliding {
                of.normal.iter().for_each(|&(j, c)| tangent.k[(i, j)] -= b * forces.friction_by_gap * of.stiffness * c);
                of.sliding.iter().for_each(|&(j, other)| tangent.c[(i, j)] += b * forces.friction_by_velocity * other);
            }
            if let Some(state) = self.bristles[contact].map(|place| place - 2 * n) {
                tangent.internal.decay[state] = -forces.rate_by_state;
                for &(i, b) in &of.sliding {
                    tangent.internal.drive[(state, i)] -= b * forces.rate_by_velocity;
                    tangent.internal.force[(i, state)] += b * forces.friction_by_state;
                }
            }
        }
        tangent
    }

    /// Checks that K can hold the springs of the contacts that are closed in steady sliding: without `sum_i k_i c_i c_i^T` its symmetric part has no more negative eigenvalues
    /// than with them. A k that is too small gives a spring too stiff for K, which an open contact would take from it.
    fn check_springs(&self) -> Result<(), Error> {
        let symmetric = |k: &DMatrix<f64>| SymmetricEigen::new((k + k.transpose()) * 0.5);
        let mut opened = self.structure.k.clone();
        let closed = || self.contacts.iter().filter(|contact| contact.is_closed());
        for contact in closed() {
            for (&(i, a), &(j, b)) in contact.normal.iter().flat_map(|a| contact.normal.iter().map(move |b| (a, b))) {
                opened[(i, j)] -= contact.stiffness * a * b;
            }
        }
        let rounding = NEGATIVE * self.structure.k.amax();
        let negative = |of: &SymmetricEigen<f64, Dyn>| of.eigenvalues.iter().filter(|k| **k < -rounding).count();
        let (with, without) = (symmetric(&self.structure.k), symmetric(&opened));
        if negative(&without) <= negative(&with) {
            return Ok(());
        }
        // The contact whose spring takes most in the most negative direction.
        let direction = without.eigenvectors.column(without.eigenvalues.imin());
        let taken = |contact: &SlidingContact| contact.stiffness * along(&contact.normal, direction.as_slice()).powi(2);
        let Some(contact) = closed().max_by(|a, b| taken(a).total_cmp(&taken(b))) else { return Ok(()) };
        Err(Error::Contact {
            contact: contact.name.clone(),
            field: "stiffness",
            value: contact.stiffness,
            allowed: "that of the spring which K holds: K without the springs of the contacts would have a negative stiffness",
        })
    }

    /// Checks that the tangent is the system of the complex eigenvalue analysis: `Q(i w)` of both at `w`, half and twice it, rad/s. Returns
    /// the largest deviation, relative to the norms of the terms of Q. No tangent knows the springs of contacts: that K can hold them is
    /// checked too.
    ///
    /// # Errors
    /// [`Error::Tangent`] where it is more than rounding; [`Error::Contact`] for a spring that K does not hold; a system of another order.
    pub fn check_tangent(&self, of_cea: &SecondOrder, omega: f64) -> Result<f64, Error> {
        self.check_springs()?;
        let (found, expected) = (of_cea.order(), self.order());
        if found != expected {
            return Err(
                linsys::LinsysError::Count { what: "degrees of freedom of the analysis", found, expected }.into()
            );
        }
        let (tangent, mut deviation) = (self.tangent(), 0.0_f64);
        for omega in [0.5 * omega, omega, 2.0 * omega] {
            let lambda = Complex::new(0.0, omega);
            let difference = (tangent.dynamic_stiffness(lambda) - of_cea.dynamic_stiffness(lambda)).norm();
            let scale = of_cea.m.norm() * omega * omega + of_cea.c.norm() * omega + of_cea.k.norm();
            // Not a number must not pass.
            deviation = if difference.is_finite() { deviation.max(difference / scale) } else { f64::INFINITY };
        }
        if deviation <= TANGENT_TOLERANCE {
            Ok(deviation)
        } else {
            Err(Error::Tangent { deviation, allowed: TANGENT_TOLERANCE })
        }
    }
}
