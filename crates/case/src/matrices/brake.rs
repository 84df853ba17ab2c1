//! The brake of a case with one set of constraints.

use linsys::DofMap;
use osc_model::{Body, Brake, Sectors};

use super::{FixedDofs, MatricesCase};
use crate::CaseError;
use crate::check::Check;

impl MatricesCase {
    /// The brake with a set of constraints, whose rows and columns are left out.
    ///
    /// # Errors
    /// A set of another case, with degrees of freedom that do not exist here.
    pub fn brake(&self, constraints: &FixedDofs) -> Result<Brake, CaseError> {
        let check = Check::new(&self.header.path);
        let refused = check.system(&format!("constraints {:?}", constraints.name));
        let dofs = DofMap::new(self.dofs.len(), &constraints.fixed).map_err(&refused)?;
        let system = self.system.on(&dofs).map_err(&refused)?;
        let free = |body: &[usize]| body.iter().filter_map(|&dof| dofs.position(dof)).collect();
        let bodies = self.bodies.iter().map(|body| Body { name: body.name.clone(), dofs: free(&body.dofs) }).collect();
        let sectors = Sectors::whole(system.order(), system.channels().len());
        Ok(Brake { system, bodies, sectors, dofs })
    }
}
