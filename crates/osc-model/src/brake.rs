//! A brake in one configuration, as everything after this crate sees it.

use linsys::{AffineSystem, DofMap};

use crate::Sectors;

/// A brake with its contacts and constraints fixed: terms and friction channels, and what is known of them beyond numbers.
///
/// Whoever makes one, the lattice of this crate, a case file with matrices or a user's own type, gets the same studies.
#[derive(Debug, Clone, PartialEq)]
pub struct Brake {
    /// The equations, affine in a few coefficients.
    pub system: AffineSystem,
    /// Which degrees of freedom of the unconstrained brake are free.
    pub dofs: DofMap,
    /// The bodies whose net work is told apart.
    pub bodies: Vec<Body>,
    /// The symmetry by which the system falls apart for alike contacts: one sector, the whole, where there is none.
    pub sectors: Sectors,
}

/// A group of degrees of freedom with a name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Body {
    /// Its name.
    pub name: String,
    /// Its free degrees of freedom, as indices into the reduced system.
    pub dofs: Vec<usize>,
}

impl AsRef<[usize]> for Body {
    fn as_ref(&self) -> &[usize] {
        &self.dofs
    }
}

impl Brake {
    /// A brake without constraints, bodies or symmetry: all of a system is one body called "all".
    pub fn new(system: AffineSystem) -> Self {
        let (order, channels) = (system.order(), system.channels().len());
        Self {
            dofs: DofMap::all(order),
            bodies: vec![Body { name: "all".into(), dofs: (0..order).collect() }],
            sectors: Sectors::whole(order, channels),
            system,
        }
    }
}
