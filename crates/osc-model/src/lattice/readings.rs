//! Readings: named choices where the published description leaves the model open.

/// The direction in which the inclined springs lean, relative to the sliding direction +x.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lean {
    /// s = -1: from the oscillator to the foundation the spring runs against the sliding direction.
    Against,
    /// s = +1: from the oscillator to the foundation the spring runs in the sliding direction.
    Along,
}

impl Lean {
    /// Sign s of the x component.
    pub fn sign(self) -> f64 {
        match self {
            Self::Against => -1.0,
            Self::Along => 1.0,
        }
    }
}

/// The sign of a lateral friction force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sign {
    /// The oscillators are dragged along +y.
    Plus,
    /// The oscillators are dragged along -y.
    Minus,
}

impl Sign {
    /// The sign as a number, +1 or -1.
    pub fn value(self) -> f64 {
        match self {
            Self::Plus => 1.0,
            Self::Minus => -1.0,
        }
    }
}

/// Friction in y, across the sliding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lateral {
    /// No force in y.
    None,
    /// Amontons-Coulomb friction in y as in x: the force `sign mu_y N`, although the contact does not slide in y.
    Coupled {
        /// Direction of the force.
        sign: Sign,
    },
    /// Isotropic Coulomb friction along the relative velocity; linearised about sliding in x, a dashpot `mu_y N0 / v` in y.
    Vector,
}

/// The force that presses the oscillators on the plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Preload {
    /// Normal load of each contact, N.
    PerContact(f64),
    /// Sum of the normal loads, N, shared equally by the oscillators in contact.
    Clamp(f64),
    /// Force in -z on each oscillator in contact, N; the loads follow from static equilibrium with friction drag.
    Equilibrium(f64),
}
