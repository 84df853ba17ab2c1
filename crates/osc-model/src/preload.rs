//! Normal loads of the contacts from what presses the pad.

use nalgebra::DVector;

use crate::error::Allowed;
use crate::parameters::check_value;
use crate::{ContactPoint, Linearise, OscModelError, Preload, PreparedLattice};

impl PreparedLattice {
    /// Normal load of each contact, N, in the order of the arrangement.
    ///
    /// `contacts` gives the friction coefficients and the stiffness factors; their `normal_load` is not read. A contact
    /// with a factor below 1 carries its share of the load, so that the load goes to 0 with the stiffness.
    ///
    /// Under [`Preload::Equilibrium`] the loads solve `(K + K_friction) u = f` with the given force in -z on each
    /// oscillator in contact, `N_i = k_z (z_p - z_i)`; K is the elastic stiffness, K_friction the drag `mu N_i` in x and,
    /// under [`Lateral::Coupled`](crate::Lateral::Coupled), in y. A contact with a factor below 1 that its neighbours lift
    /// off has the load 0.
    ///
    /// # Errors
    /// A preload that is not positive, a malformed contact, and for the equilibrium a full contact whose load is not positive or a
    /// singular stiffness.
    pub fn normal_loads(&self, preload: Preload, contacts: &[ContactPoint]) -> Result<Vec<f64>, OscModelError> {
        self.check_contacts(contacts)?;
        let factors = contacts.iter().map(|point| point.stiffness_factor);
        match preload {
            Preload::PerContact(load) => {
                check_value("preload", load, Allowed::Positive)?;
                Ok(factors.map(|factor| factor * load).collect())
            }
            Preload::Clamp(total) => {
                check_value("preload", total, Allowed::Positive)?;
                let sum: f64 = factors.clone().sum();
                Ok(factors.map(|factor| if factor == 0.0 { 0.0 } else { factor * total / sum }).collect())
            }
            Preload::Equilibrium(force) => {
                check_value("preload", force, Allowed::Positive)?;
                self.equilibrium(force, contacts)
            }
        }
    }

    fn equilibrium(&self, force: f64, contacts: &[ContactPoint]) -> Result<Vec<f64>, OscModelError> {
        let mut stiffness = self.structural().k.clone();
        self.add_scaled_contact_springs(contacts, &mut stiffness);
        let mut pressed = DVector::zeros(stiffness.nrows());
        for (contact, point) in self.contacts().iter().zip(contacts) {
            self.add_coupling(contact, point, &mut stiffness);
            if let [.., Some(z)] = contact.place {
                pressed[z] -= point.stiffness_factor * force;
            }
        }
        let u = stiffness.lu().solve(&pressed).filter(|u| u.iter().all(|x| x.is_finite()));
        let u = u.ok_or(OscModelError::NoEquilibrium)?;
        let height = |place: Option<usize>| place.map_or(0.0, |i| u[i]);
        let [.., plate_z] = self.plate();
        let load = |(contact, point): (&crate::prepared::Contact, &ContactPoint)| {
            let [.., z] = contact.place;
            let load = point.stiffness_factor * contact.stiffness * (height(plate_z) - height(z));
            if load <= 0.0 && point.stiffness_factor >= 1.0 {
                return Err(OscModelError::LostContact { oscillator: contact.oscillator + 1, load });
            }
            Ok(load.max(0.0))
        };
        self.contacts().iter().zip(contacts).map(load).collect()
    }
}
