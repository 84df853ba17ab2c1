//! A brake in one configuration, as everything after this crate sees it.

use linsys::{AffineSystem, DofMap};

use crate::Sectors;

/// A brake with its contacts and constraints fixed: the equations, and what the degrees of freedom in them stand for.
///
/// The lattice of this crate makes one, a case file with matrices another, a user's own type a third; a study treats all alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Brake {
    /// The equations, affine in a few coefficients.
    pub system: AffineSystem,
    /// Which degrees of freedom of the unconstrained brake are free.
    pub dofs: DofMap,
    /// The bodies whose net work is told apart.
    pub bodies: Vec<Body>,
    /// The parts into which a symmetry divides the system where all contacts have the same friction: one, the whole, where there
    /// is no symmetry.
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
