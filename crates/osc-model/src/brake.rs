//! A brake in one configuration.

use linsys::{AffineSystem, DofMap};

use crate::Sectors;

/// A brake with its contacts and constraints fixed: the equations, and the meaning of their degrees of freedom.
///
/// A brake is made by the lattice of this crate, by a case file with matrices, or by a user's own type; a study does not
/// distinguish between them.
#[derive(Debug, Clone, PartialEq)]
pub struct Brake {
    /// The equations, affine in a few coefficients.
    pub system: AffineSystem,
    /// Free degrees of freedom, among those of the unconstrained brake.
    pub dofs: DofMap,
    /// The bodies whose net work is computed separately.
    pub bodies: Vec<Body>,
    /// The sectors into which a symmetry divides the system where all contacts have the same friction; without a symmetry one
    /// sector, the whole system.
    pub sectors: Sectors,
}

/// A group of degrees of freedom with a name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Body {
    /// Name of the body.
    pub name: String,
    /// Free degrees of freedom of the body, as indices into the reduced system.
    pub dofs: Vec<usize>,
}

impl AsRef<[usize]> for Body {
    fn as_ref(&self) -> &[usize] {
        &self.dofs
    }
}

impl Brake {
    /// A brake without constraints and symmetry, with all degrees of freedom in one body called "all".
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
