//! Power of the forces of a motion, and its kinetic energy.

use nalgebra::DMatrix;

use crate::contact::along;
use crate::path::Path;
use crate::system::{ContactForces, product};
use crate::{ContactSystem, Part};

impl ContactSystem {
    /// Power of each family of forces on the structure in a state of motion of a piece, W, in the order of [`ContactSystem::families`].
    pub(crate) fn powers(&self, families: &[String], (motion, x): (&Path<'_>, &[f64]), out: &mut [f64]) {
        let n = self.order();
        let (u, velocity) = (&x[..n], &x[n..2 * n]);
        out.fill(0.0);
        let place = |family: &str| families.iter().position(|name| name == family);
        for Part { family, matrices } in &self.parts {
            let Some(place) = place(family) else { continue };
            let product = |matrix: &DMatrix<f64>, x: &[f64]| -> f64 {
                matrix.column_iter().zip(x).map(|(column, x)| x * along_column(column.as_slice(), velocity)).sum()
            };
            out[place] -= product(&matrices.c, velocity) + product(&matrices.k, u);
        }
        let mut held = vec![0.0; self.contacts.len()];
        let mut forces: Vec<ContactForces> =
            (0..held.len()).map(|contact| self.forces_in_phase(contact, x, motion.phase(contact))).collect();
        let mut rate = vec![0.0; self.dimension()];
        self.rate_with(&forces, x, &mut rate);
        motion.hold(&mut rate[n..2 * n], |contact, force| held[contact] = force);
        forces.iter_mut().zip(&held).for_each(|(forces, held)| forces.friction += held);
        for (contact, of) in self.contacts.iter().enumerate() {
            let forces = &forces[contact];
            if let Some(place) = place(&of.family) {
                out[place] += forces.friction * along(&of.sliding, velocity);
            }
            // A contact that opens gives back what it took.
            out[families.len() - 1] -= forces.excess * along(&of.normal, velocity);
        }
    }

    /// Names of the families of forces; the last is that of contacts that open, which is elastic.
    #[must_use]
    pub fn families(&self) -> Vec<String> {
        let mut families: Vec<String> = Vec::new();
        let named =
            self.contacts.iter().map(|contact| &contact.family).chain(self.parts.iter().map(|part| &part.family));
        for family in named {
            if !families.contains(family) {
                families.push(family.clone());
            }
        }
        families.push("opening".into());
        families
    }

    /// Kinetic energy of a state of motion, J.
    #[must_use]
    pub fn kinetic_energy(&self, x: &[f64]) -> f64 {
        let velocity = &x[self.order()..2 * self.order()];
        let mut momentum = vec![0.0; velocity.len()];
        product(&self.structure.m, velocity, &mut momentum);
        0.5 * along_column(&momentum, velocity)
    }
}

fn along_column(column: &[f64], x: &[f64]) -> f64 {
    column.iter().zip(x).map(|(a, x)| a * x).sum()
}
