//! One arrangement of contacts, ready to be linearised sample after sample.

use friction::Tangent;
use linsys::{DofMap, Internal, SecondOrder};
use nalgebra::DMatrix;

use crate::assembly::dof;
use crate::error::Allowed;
use crate::{Axis, ContactArrangement, Lateral, Linearise, OscModelError};

/// A state of steady sliding.
#[derive(Debug, Clone, PartialEq)]
pub struct Sliding {
    /// Speed v of the plate, m/s; > 0.
    pub speed: f64,
    /// One entry per oscillator in contact, in the order of the arrangement.
    pub contacts: Vec<ContactPoint>,
}

/// One contact in steady sliding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPoint {
    /// Friction along the sliding. A law with an internal state adds one bristle to the system.
    pub tangent: Tangent,
    /// mu_y, friction coefficient across the sliding; without effect under [`Lateral::None`].
    pub lateral_mu: f64,
    /// Normal load N0, N; >= 0.
    pub normal_load: f64,
    /// Factor on this contact's k_z, 1 in full contact, 0 <= factor. To take an oscillator out of contact smoothly let
    /// this and `normal_load` go to 0 together; at 0 the system is the one without that contact, plus a bristle, if
    /// there is one, that acts on nothing.
    pub stiffness_factor: f64,
}

/// Where a contact stands among the free degrees of freedom, `None` where it is constrained.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Contact {
    pub oscillator: usize,
    pub stiffness: f64,
    pub place: [Option<usize>; 3],
}

/// A [`LatticeModel`](crate::LatticeModel) with its contacts fixed.
#[derive(Debug, Clone, PartialEq)]
pub struct PreparedLattice {
    structure: SecondOrder,
    dofs: DofMap,
    lateral: Lateral,
    arrangement: ContactArrangement,
    contacts: Vec<Contact>,
    plate: [Option<usize>; 3],
    bodies: Vec<Vec<usize>>,
}

impl PreparedLattice {
    pub(crate) fn new(
        structure: SecondOrder,
        dofs: DofMap,
        lateral: Lateral,
        arrangement: ContactArrangement,
        contact_stiffness: &[f64],
    ) -> Self {
        let place = |body: usize| Axis::ALL.map(|axis| dofs.position(dof(body, axis)));
        let contacts = arrangement
            .in_contact()
            .iter()
            .map(|&i| Contact { oscillator: i, stiffness: contact_stiffness[i], place: place(i) })
            .collect();
        let plate = place(arrangement.oscillators());
        let bodies = (0..=arrangement.oscillators()).map(|i| place(i).into_iter().flatten().collect()).collect();
        Self { structure, dofs, lateral, arrangement, contacts, plate, bodies }
    }

    /// Which degrees of freedom of the lattice are free.
    pub fn dof_map(&self) -> &DofMap {
        &self.dofs
    }

    /// Free degrees of freedom, as indices into the reduced system, of each oscillator and last of the plate.
    pub fn bodies(&self) -> &[Vec<usize>] {
        &self.bodies
    }

    /// The oscillators in contact.
    pub fn arrangement(&self) -> &ContactArrangement {
        &self.arrangement
    }

    pub(crate) fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    pub(crate) fn lateral(&self) -> Lateral {
        self.lateral
    }

    pub(crate) fn plate(&self) -> [Option<usize>; 3] {
        self.plate
    }

    /// Adds the springs' change where a contact's factor is not 1.
    pub(crate) fn add_scaled_contact_springs(&self, contacts: &[ContactPoint], k: &mut DMatrix<f64>) {
        let [.., plate_z] = self.plate;
        for (contact, point) in self.contacts.iter().zip(contacts) {
            if point.stiffness_factor != 1.0 {
                let change = (point.stiffness_factor - 1.0) * contact.stiffness;
                let [.., z] = contact.place;
                add_pair(k, [z, plate_z], [z, plate_z], change);
            }
        }
    }

    /// Adds `mu k_z (z_i - z_p)` in the rows of the contact, opposite on the plate: normal load times friction.
    pub(crate) fn add_coupling(&self, contact: &Contact, point: &ContactPoint, k: &mut DMatrix<f64>) {
        let ([x, y, z], [plate_x, plate_y, plate_z]) = (contact.place, self.plate);
        let stiffness = point.stiffness_factor * contact.stiffness;
        add_pair(k, [x, plate_x], [z, plate_z], point.tangent.mu * stiffness);
        if let Lateral::Coupled { sign } = self.lateral {
            add_pair(k, [y, plate_y], [z, plate_z], sign.value() * point.lateral_mu * stiffness);
        }
    }

    /// Adds friction to `out`, whose bristles must be zero.
    fn add_friction(&self, sliding: &Sliding, out: &mut SecondOrder) {
        let [plate_x, plate_y, _] = self.plate;
        let mut state = 0;
        for (contact, point) in self.contacts.iter().zip(&sliding.contacts) {
            let [x, y, _] = contact.place;
            let load = point.normal_load;
            self.add_coupling(contact, point, &mut out.k);
            add_pair(&mut out.c, [x, plate_x], [x, plate_x], load * point.tangent.slope);
            if self.lateral == Lateral::Vector {
                add_pair(&mut out.c, [y, plate_y], [y, plate_y], point.lateral_mu * load / sliding.speed);
            }
            if let Some(bristle) = point.tangent.internal {
                out.internal.decay[state] = bristle.decay;
                // The relative velocity is v + x_p' - x_i'; its friction drags the oscillator along.
                for (place, sign) in [(x, -1.0), (plate_x, 1.0)] {
                    if let Some(place) = place {
                        out.internal.drive[(state, place)] = sign * bristle.drive;
                        out.internal.force[(place, state)] = -sign * load * bristle.force;
                    }
                }
                state += 1;
            }
        }
    }

    pub(crate) fn check_contacts(&self, contacts: &[ContactPoint]) -> Result<(), OscModelError> {
        if contacts.len() != self.contacts.len() {
            return Err(OscModelError::ContactCount { found: contacts.len(), expected: self.contacts.len() });
        }
        for (contact, point) in self.contacts.iter().zip(contacts) {
            let bristle = point.tangent.internal.map_or([0.0; 3], |b| [b.decay, b.drive, b.force]);
            let fields = [
                ("tangent.mu", point.tangent.mu, Allowed::NonNegative),
                ("tangent.slope", point.tangent.slope, Allowed::Finite),
                ("tangent.internal.decay", bristle[0], Allowed::NonNegative),
                ("tangent.internal.drive", bristle[1], Allowed::Finite),
                ("tangent.internal.force", bristle[2], Allowed::Finite),
                ("lateral_mu", point.lateral_mu, Allowed::NonNegative),
                ("normal_load", point.normal_load, Allowed::NonNegative),
                ("stiffness_factor", point.stiffness_factor, Allowed::NonNegative),
            ];
            if let Some(&(field, value, allowed)) = fields.iter().find(|(_, value, allowed)| !allowed.contains(*value))
            {
                return Err(OscModelError::Contact { oscillator: contact.oscillator + 1, field, value, allowed });
            }
        }
        Ok(())
    }

    /// Checks the state and gives `out` its order and number of bristles, the latter zero.
    fn begin(&self, sliding: &Sliding, out: &mut SecondOrder) -> Result<(), OscModelError> {
        crate::parameters::check_value("speed", sliding.speed, Allowed::Positive)?;
        self.check_contacts(&sliding.contacts)?;
        let order = self.structure.order();
        let states = sliding.contacts.iter().filter(|point| point.tangent.internal.is_some()).count();
        if out.order() != order {
            *out = SecondOrder::zeros(order, states);
        } else if out.states() != states {
            out.internal = Internal::zeros(order, states);
        } else {
            out.internal.drive.fill(0.0);
            out.internal.force.fill(0.0);
        }
        Ok(())
    }
}

impl Linearise for PreparedLattice {
    type Sliding = Sliding;
    type Error = OscModelError;

    fn structural(&self) -> &SecondOrder {
        &self.structure
    }

    fn linearise_friction(&self, sliding: &Sliding, out: &mut SecondOrder) -> Result<(), OscModelError> {
        self.begin(sliding, out)?;
        for matrix in [&mut out.m, &mut out.c, &mut out.k] {
            matrix.fill(0.0);
        }
        self.add_friction(sliding, out);
        Ok(())
    }

    fn linearise(&self, sliding: &Sliding, out: &mut SecondOrder) -> Result<(), OscModelError> {
        self.begin(sliding, out)?;
        out.m.copy_from(&self.structure.m);
        out.c.copy_from(&self.structure.c);
        out.k.copy_from(&self.structure.k);
        self.add_scaled_contact_springs(&sliding.contacts, &mut out.k);
        self.add_friction(sliding, out);
        Ok(())
    }
}

/// Adds `value (e_r0 - e_r1)(e_c0 - e_c1)^T`, leaving out what is constrained.
fn add_pair(matrix: &mut DMatrix<f64>, rows: [Option<usize>; 2], columns: [Option<usize>; 2], value: f64) {
    for (row, row_sign) in rows.into_iter().zip([1.0, -1.0]) {
        for (column, column_sign) in columns.into_iter().zip([1.0, -1.0]) {
            if let (Some(row), Some(column)) = (row, column) {
                matrix[(row, column)] += row_sign * column_sign * value;
            }
        }
    }
}
