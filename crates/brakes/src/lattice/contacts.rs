//! The contacts of a lattice beyond their tangents.

use cycle::{ContactSystem, Part, SlidingContact};
use osc_model::{Lateral, PreparedLattice};

use super::{LatticeSample, sliding_under};
use crate::Error;
use crate::case::{LatticeReadings, Law};

/// The equations of motion of a lattice whose contacts open, slide along x and stick: with the stiffness of the contact of each oscillator, N/m, of a
/// sample at a speed, m/s. A contact sticks where it slides with less than `stick` of that speed.
///
/// # Errors
/// Friction across the sliding; errors of the friction law; no static equilibrium.
pub(super) fn contact_system(
    lattice: &PreparedLattice,
    law: Law,
    (readings, stiffness): (&LatticeReadings, &[f64]),
    (speed, sample): (f64, &LatticeSample),
    stick: f64,
) -> Result<ContactSystem, Error> {
    if readings.lateral != Lateral::None {
        return Err(Error::Motion { what: "friction across the sliding", allowed: "readings.lateral = \"none\"" });
    }
    let state = sliding_under(readings, lattice, law, speed, sample)?;
    let system = &lattice.brake().system;
    let oscillators = lattice.arrangement().in_contact();
    let contact = |((channel, &oscillator), point): ((&linsys::Channel, &usize), &osc_model::ContactPoint)| {
        let stiffness = stiffness[oscillator];
        let draw = sample.contact(oscillator);
        let friction = draw.in_motion(law, stick * speed, readings.bristle_damping).map_err(study::Error::from)?;
        Ok(SlidingContact {
            name: channel.name.clone(),
            family: channel.family.clone(),
            sliding: channel.force.clone(),
            // The channel reads k (z_i - z_p), and the normal force is k (z_p - z_i).
            normal: channel.reading.iter().map(|&(dof, value)| (dof, -value / stiffness)).collect(),
            stiffness,
            load: point.normal_load,
            speed,
            friction,
        })
    };
    let contacts = system.channels().iter().zip(oscillators).zip(&state.contacts).map(contact);
    Ok(ContactSystem::new(Part::of_terms(system, &[1.0]), contacts.collect::<Result<_, Error>>()?)?)
}
