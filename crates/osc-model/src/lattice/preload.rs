//! Normal loads of the contacts from the preload.

use linsys::{ChannelGain, OperatingPoint};
use nalgebra::DVector;

use super::operating_point::ContactSpring;
use super::parameters::check_value;
use super::{ContactPoint, Lateral, Preload, PreparedLattice};
use crate::OscModelError;
use crate::error::Allowed;

impl PreparedLattice {
    /// Normal load of each contact, N, in the order of the arrangement.
    ///
    /// `contacts` gives the friction coefficients; their `normal_load` is not read.
    ///
    /// Under [`Preload::Equilibrium`] the loads solve `(K + K_friction) u = f` with the given force in -z on each oscillator in contact whose z is free,
    /// `N_i = k_z (z_p - z_i)`; K is the elastic stiffness, K_friction the drag `mu N_i` in x and, under [`Lateral::Coupled`], in y.
    ///
    /// # Errors
    /// A preload that is not positive, a malformed contact, and for the equilibrium a contact whose load is not positive
    /// or a singular stiffness.
    pub fn normal_loads(&self, preload: Preload, contacts: &[ContactPoint]) -> Result<Vec<f64>, OscModelError> {
        self.check_contacts(contacts)?;
        let (Preload::PerContact(given) | Preload::Clamp(given) | Preload::Equilibrium(given)) = preload;
        check_value("preload", given, Allowed::Positive)?;
        match preload {
            Preload::PerContact(load) => Ok(vec![load; contacts.len()]),
            Preload::Clamp(total) => Ok(vec![total / contacts.len() as f64; contacts.len()]),
            Preload::Equilibrium(force) => self.equilibrium(force, contacts),
        }
    }

    fn equilibrium(&self, force: f64, contacts: &[ContactPoint]) -> Result<Vec<f64>, OscModelError> {
        let along = contacts.iter().map(|point| ChannelGain::proportional(point.tangent.mu));
        let across = contacts.iter().filter_map(|point| match self.lateral() {
            Lateral::None => None,
            Lateral::Coupled { .. } => Some(ChannelGain::proportional(point.lateral_mu)),
            Lateral::Vector => Some(ChannelGain::default()),
        });
        let drag = OperatingPoint { coefficients: vec![1.0], channels: along.chain(across).collect() };
        let stiffness = self.brake().system.assemble(&drag)?.k;
        let mut pressed = DVector::zeros(stiffness.nrows());
        for z in self.contacts().iter().filter_map(|contact| contact.z) {
            pressed[z] -= force;
        }
        let u = stiffness.lu().solve(&pressed).filter(|u| u.iter().all(|x| x.is_finite()));
        let u = u.ok_or(OscModelError::NoEquilibrium)?;
        let height = |place: Option<usize>| place.map_or(0.0, |i| u[i]);
        let load = |contact: &ContactSpring| {
            let load = contact.stiffness * (height(self.plate_z()) - height(contact.z));
            if load <= 0.0 {
                let (oscillator, in_contact) = (contact.oscillator + 1, self.contacts().len());
                return Err(OscModelError::LostContact { oscillator, in_contact, load });
            }
            Ok(load)
        };
        self.contacts().iter().map(load).collect()
    }
}
