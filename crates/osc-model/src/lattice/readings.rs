//! Readings: named choices where a published description leaves the model open.

/// Which way the inclined springs lean, seen along the sliding direction +x.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lean {
    /// s = -1: from the oscillator to the foundation the spring runs against the sliding.
    Against,
    /// s = +1: it runs along the sliding.
    Along,
}

impl Lean {
    /// s.
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
    /// +1 or -1.
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
    /// Amontons-Coulomb taken at its word: `sign mu_y N` in y as `mu N` in x, although nothing slides in y.
    Coupled {
        /// Its direction.
        sign: Sign,
    },
    /// Isotropic Coulomb friction along the relative velocity: about sliding in x a dashpot `mu_y N0 / v` in y.
    Vector,
}

/// What presses the oscillators on the plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Preload {
    /// This normal load on each contact, N.
    PerContact(f64),
    /// This force in total, N, shared equally by the oscillators in contact.
    Clamp(f64),
    /// This force in -z on each oscillator in contact, N; the loads follow from static equilibrium with friction drag.
    Equilibrium(f64),
}
