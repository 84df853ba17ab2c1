//! The model: parameters, readings and constraints, before any arrangement is chosen.

use linsys::{DofMap, SecondOrder};

use super::assembly::assemble;
use super::{ContactArrangement, Dof, Lateral, LatticeParameters, PreparedLattice};
use crate::OscModelError;

/// A lattice of friction oscillators on a sliding plate.
///
/// A constrained degree of freedom is eliminated: its row and column leave the matrices. Its contact goes on sliding, so
/// the plate keeps its friction terms, and a bristle is then driven by the plate alone.
#[derive(Debug, Clone, PartialEq)]
pub struct LatticeModel {
    parameters: LatticeParameters,
    lateral: Lateral,
    dofs: DofMap,
}

impl LatticeModel {
    /// The lattice with these parameters, with `constraints` held.
    ///
    /// # Errors
    /// A parameter out of its range, a list of a wrong length, a constraint on what is not there or twice on the same
    /// degree of freedom, or nothing left free.
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

    /// What the lattice is made of.
    pub fn parameters(&self) -> &LatticeParameters {
        &self.parameters
    }

    /// How friction acts in y.
    pub fn lateral(&self) -> Lateral {
        self.lateral
    }

    /// Which of the 3 (oscillators + 1) degrees of freedom are free.
    pub fn dof_map(&self) -> &DofMap {
        &self.dofs
    }

    /// Refuses an arrangement of a lattice of another size.
    pub(crate) fn check_size(&self, arrangement: &ContactArrangement) -> Result<(), OscModelError> {
        let (arrangement, oscillators) = (arrangement.oscillators(), self.parameters.grid.oscillators());
        if arrangement == oscillators { Ok(()) } else { Err(OscModelError::OtherLattice { arrangement, oscillators }) }
    }

    /// Assembles all that does not change from sample to sample.
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
