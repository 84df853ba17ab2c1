//! Where friction along the sliding enters the equations.

use nalgebra::DMatrix;

use crate::{Lateral, PreparedLattice};

/// The places of friction along the sliding, with m contacts and n free degrees of freedom.
///
/// Friction adds `sum_i b_i (mu_i p_i^T + lambda N0_i h_i(lambda) b_i^T)` to the dynamic stiffness, `b_i = e_xi - e_xp`,
/// `p_i = k_z (e_zi - e_zp)`.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionChannels {
    /// The b_i, n x m.
    pub force: DMatrix<f64>,
    /// The p_i as rows, N/m, m x n.
    pub coupling: DMatrix<f64>,
}

impl PreparedLattice {
    /// The channels of friction, contacts at full stiffness; `None` where there is friction across the sliding too.
    pub fn friction_channels(&self) -> Option<FrictionChannels> {
        if self.lateral() != Lateral::None {
            return None;
        }
        let (order, contacts) = (self.dof_map().free().len(), self.contacts());
        let mut channels = FrictionChannels {
            force: DMatrix::zeros(order, contacts.len()),
            coupling: DMatrix::zeros(contacts.len(), order),
        };
        let [plate_x, _, plate_z] = self.plate();
        for (at, contact) in contacts.iter().enumerate() {
            let [x, _, z] = contact.place;
            for (x, z, sign) in [(x, z, 1.0), (plate_x, plate_z, -1.0)] {
                if let Some(x) = x {
                    channels.force[(x, at)] = sign;
                }
                if let Some(z) = z {
                    channels.coupling[(at, z)] = sign * contact.stiffness;
                }
            }
        }
        Some(channels)
    }
}
