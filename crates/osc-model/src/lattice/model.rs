//! The model: parameters, readings and constraints, before an arrangement is chosen.

use linsys::{DofMap, SecondOrder};

use super::assembly::assemble;
use super::{ContactArrangement, Dof, Lateral, LatticeParameters, PreparedLattice};
use crate::OscModelError;

/// A lattice of friction oscillators on a sliding plate.
///
/// A constrained degree of freedom is eliminated: its row and column leave the matrices. The contact of a constrained oscillator
/// slides on, so that the plate keeps the friction terms, and a bristle is driven by the plate alone.
#[derive(Debug, Clone, PartialEq)]
pub struct LatticeModel {
    parameters: LatticeParameters,
    lateral: Lateral,
    dofs: DofMap,
}

impl LatticeModel {
    /// The lattice with these parameters and constraints.
    ///
    /// # Errors
    /// A parameter out of its range, a list of a wrong length, a constraint on a degree of freedom that does not exist or is
    /// constrained already, or no degree of freedom left free.
    pub fn new(parameters: LatticeParameters, lateral: Lateral, constraints: &[Dof]) -> Result<Self, OscModelError> {
        parameters.check()?;
        let oscillators = parameters.grid.oscillators();
        let held = constraints.iter().map(|dof| dof.index(oscillators)).collect::<Result<Vec<_>, _>>()?;
        if let Some(place) = (0..held.len()).find(|&i| held[..i].contains(&held[i])) {
            return Err(OscModelError::ConstrainedTwice { dof: constraints[place] });
        }
        let dofs = DofMap::new(3 * (oscillators + 1), &held)?;
        Ok(Self { parameters, lateral, dofs })
    }

    /// The parameters of the lattice.
    pub fn parameters(&self) -> &LatticeParameters {
        &self.parameters
    }

    /// Action of friction in y.
    pub fn lateral(&self) -> Lateral {
        self.lateral
    }

    /// Free degrees of freedom, of the 3 (oscillators + 1) of the lattice.
    pub fn dof_map(&self) -> &DofMap {
        &self.dofs
    }

    /// An error for an arrangement of a lattice of another size.
    pub(crate) fn check_size(&self, arrangement: &ContactArrangement) -> Result<(), OscModelError> {
        let (arrangement, oscillators) = (arrangement.oscillators(), self.parameters.grid.oscillators());
        if arrangement == oscillators { Ok(()) } else { Err(OscModelError::OtherLattice { arrangement, oscillators }) }
    }

    /// Assembles the parts of the equations that do not change from sample to sample.
    ///
    /// # Errors
    /// An arrangement of a lattice of another size.
    pub fn prepare(&self, arrangement: &ContactArrangement) -> Result<PreparedLattice, OscModelError> {
        self.check_size(arrangement)?;
        let SecondOrder { m, c, k, .. } = assemble(&self.parameters, arrangement);
        let [m, c, k] = [m, c, k].map(|full| self.dofs.reduce(&full));
        let structure = SecondOrder::new(m, c, k)?;
        let stiffness = &self.parameters.contact_stiffness;
        PreparedLattice::new(structure, self.dofs.clone(), self.lateral, arrangement.clone(), stiffness)
    }
}
