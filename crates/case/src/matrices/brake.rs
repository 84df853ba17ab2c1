//! The brake of a case with one set of constraints.

use linsys::{AffineSystem, DofMap, Term};
use nalgebra::DMatrix;
use osc_model::{Body, Brake, Sectors};

use super::{FixedDofs, MatricesCase};
use crate::CaseError;
use crate::check::Check;

impl MatricesCase {
    /// The brake with a set of constraints, whose rows and columns are left out, with the dashpots of its loss factors.
    ///
    /// # Errors
    /// A set of another case, with degrees of freedom that do not exist here.
    pub fn brake(&self, constraints: &FixedDofs) -> Result<Brake, CaseError> {
        let check = Check::new(&self.header.path);
        let refused = check.system(&format!("constraints {:?}", constraints.name));
        let dofs = DofMap::new(self.dofs.len(), &constraints.fixed).map_err(&refused)?;
        let mut system = self.system.on(&dofs).map_err(&refused)?;
        if !constraints.dashpots.is_empty() {
            let with_dashpots = |(term, dashpot): (&Term, &Option<DMatrix<f64>>)| {
                let mut matrices = term.matrices().clone();
                dashpot.iter().for_each(|dashpot| matrices.c += dashpot);
                Term::new(term.name.clone(), term.family.clone(), matrices)
            };
            let terms = system.terms().iter().zip(&constraints.dashpots).map(with_dashpots).collect::<Result<_, _>>();
            system = terms.and_then(|terms| AffineSystem::new(terms, system.channels().to_vec())).map_err(&refused)?;
        }
        let free = |body: &[usize]| body.iter().filter_map(|&dof| dofs.position(dof)).collect();
        let bodies = self.bodies.iter().map(|body| Body { name: body.name.clone(), dofs: free(&body.dofs) }).collect();
        let sectors = Sectors::whole(system.order(), system.channels().len());
        Ok(Brake { system, bodies, sectors, dofs })
    }
}
