//! The lattice with one arrangement of contacts, prepared for the linearisation of many samples.

use friction::Tangent;
use linsys::{AffineSystem, Channel, ChannelGain, DofMap, Lag, OperatingPoint, SecondOrder, Term};

use super::assembly::dof;
use super::parameters::check_value;
use super::{Axis, ContactArrangement, Lateral};
use crate::error::Allowed;
use crate::{Body, Brake, OscModelError, Sectors};

/// A state of steady sliding.
#[derive(Debug, Clone, PartialEq)]
pub struct Sliding {
    /// Speed v of the plate, m/s; > 0.
    pub speed: f64,
    /// Contacts, one per oscillator in contact, in the order of the arrangement.
    pub contacts: Vec<ContactPoint>,
}

/// A contact in steady sliding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPoint {
    /// Friction along the sliding. A law with an internal state adds one bristle to the system.
    pub tangent: Tangent,
    /// mu_y, friction coefficient across the sliding; without effect under [`Lateral::None`].
    pub lateral_mu: f64,
    /// Normal load N0, N; >= 0.
    pub normal_load: f64,
}

impl ContactPoint {
    /// The gain of the channel along the sliding.
    pub fn gain(&self) -> ChannelGain {
        let Tangent { mu, slope, internal } = self.tangent;
        let lag =
            internal.map(|state| Lag { decay: state.decay, drive: state.drive, force: self.normal_load * state.force });
        ChannelGain { mu, slope: self.normal_load * slope, lag }
    }
}

/// A contact spring between an oscillator and the plate.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ContactSpring {
    pub oscillator: usize,
    pub stiffness: f64,
    /// Index of the oscillator's z among the free degrees of freedom; `None` where it is constrained.
    pub z: Option<usize>,
}

/// A [`LatticeModel`](super::LatticeModel) with its contacts fixed: a [`Brake`], and the data for its operating points.
#[derive(Debug, Clone, PartialEq)]
pub struct PreparedLattice {
    brake: Brake,
    lateral: Lateral,
    arrangement: ContactArrangement,
    contacts: Vec<ContactSpring>,
    plate_z: Option<usize>,
}

impl PreparedLattice {
    pub(super) fn new(
        structure: SecondOrder,
        dofs: DofMap,
        lateral: Lateral,
        arrangement: ContactArrangement,
        contact_stiffness: &[f64],
    ) -> Result<Self, OscModelError> {
        let place = |body: usize, axis: Axis| dofs.position(dof(body, axis));
        let plate = arrangement.oscillators();
        let springs = arrangement.in_contact().iter().map(|&oscillator| ContactSpring {
            oscillator,
            stiffness: contact_stiffness[oscillator],
            z: place(oscillator, Axis::Z),
        });
        let contacts: Vec<ContactSpring> = springs.collect();
        let difference = |oscillator: usize, axis: Axis, value: f64| -> Vec<(usize, f64)> {
            let ends = [(place(oscillator, axis), value), (place(plate, axis), -value)];
            ends.into_iter().filter_map(|(place, value)| Some((place?, value))).collect()
        };
        let along = contacts.iter().map(|contact| {
            let force = difference(contact.oscillator, Axis::X, 1.0);
            let reading = difference(contact.oscillator, Axis::Z, contact.stiffness);
            Channel::new((contact.oscillator + 1).to_string(), "friction", force, reading)
        });
        // Friction across the sliding direction is a second channel of each contact.
        let across = contacts.iter().filter_map(|contact| {
            let reading = match lateral {
                Lateral::None => return None,
                Lateral::Coupled { sign } => difference(contact.oscillator, Axis::Z, sign.value() * contact.stiffness),
                Lateral::Vector => Vec::new(),
            };
            let force = difference(contact.oscillator, Axis::Y, 1.0);
            Some(Channel::new(format!("{} across", contact.oscillator + 1), "friction", force, reading))
        });
        let channels: Vec<Channel> = along.chain(across).collect();
        let body = |i: usize| Body {
            name: if i == plate { "plate".into() } else { (i + 1).to_string() },
            dofs: Axis::ALL.into_iter().filter_map(|axis| place(i, axis)).collect(),
        };
        let bodies = (0..=plate).map(body).collect();
        let sectors = Sectors::whole(structure.order(), channels.len());
        let plate_z = place(plate, Axis::Z);
        let system = AffineSystem::new(vec![Term::new("structure", "damping", structure)?], channels)?;
        Ok(Self { brake: Brake { system, dofs, bodies, sectors }, lateral, arrangement, contacts, plate_z })
    }

    /// The lattice as a brake; one sector unless [`PreparedLattice::split`] has been called.
    pub fn brake(&self) -> &Brake {
        &self.brake
    }

    /// Gives the brake the sectors that [`LatticeModel::sectors`](super::LatticeModel::sectors) found for it.
    pub fn split(&mut self, sectors: Sectors) {
        self.brake.sectors = sectors;
    }

    /// The part without friction: M, the dashpots C, and the elastic K with every contact spring.
    pub fn structural(&self) -> &SecondOrder {
        self.brake.system.terms()[0].matrices()
    }

    /// The oscillators in contact.
    pub fn arrangement(&self) -> &ContactArrangement {
        &self.arrangement
    }

    pub(super) fn contacts(&self) -> &[ContactSpring] {
        &self.contacts
    }

    pub(super) fn lateral(&self) -> Lateral {
        self.lateral
    }

    pub(super) fn plate_z(&self) -> Option<usize> {
        self.plate_z
    }

    /// The operating point of a state of sliding.
    ///
    /// # Errors
    /// A speed, a number of contacts or a value of a contact that is not allowed.
    pub fn operating_point(&self, sliding: &Sliding) -> Result<OperatingPoint, OscModelError> {
        check_value("speed", sliding.speed, Allowed::Positive)?;
        self.check_contacts(&sliding.contacts)?;
        let along = sliding.contacts.iter().map(ContactPoint::gain);
        let across = sliding.contacts.iter().filter_map(|point| match self.lateral {
            Lateral::None => None,
            Lateral::Coupled { .. } => Some(ChannelGain::proportional(point.lateral_mu)),
            Lateral::Vector => {
                let slope = point.lateral_mu * point.normal_load / sliding.speed;
                Some(ChannelGain { slope, ..ChannelGain::default() })
            }
        });
        Ok(OperatingPoint { coefficients: vec![1.0], channels: along.chain(across).collect() })
    }

    /// The linearised system of a state of sliding.
    ///
    /// # Errors
    /// A speed, a number of contacts or a value of a contact that is not allowed.
    pub fn linearised(&self, sliding: &Sliding) -> Result<SecondOrder, OscModelError> {
        Ok(self.brake.system.assemble(&self.operating_point(sliding)?)?)
    }

    pub(super) fn check_contacts(&self, contacts: &[ContactPoint]) -> Result<(), OscModelError> {
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
            ];
            if let Some(&(field, value, allowed)) = fields.iter().find(|(_, value, allowed)| !allowed.contains(*value))
            {
                return Err(OscModelError::Contact { oscillator: contact.oscillator + 1, field, value, allowed });
            }
        }
        Ok(())
    }
}
