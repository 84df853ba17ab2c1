//! The brake of a case with one set of constraints.

use linsys::{AffineSystem, Channel, DofMap, LinsysError, SecondOrder, Term};
use osc_model::{Body, Brake, Sectors};

use super::{FixedDofs, MatricesCase};
use crate::case::CaseError;
use crate::case::check::Check;

impl MatricesCase {
    /// The brake with a set of constraints, whose rows and columns are left out.
    ///
    /// # Errors
    /// A set of another case, with degrees of freedom that do not exist here.
    pub fn brake(&self, constraints: &FixedDofs) -> Result<Brake, CaseError> {
        let check = Check { path: &self.path };
        let refused = check.system(&format!("constraints {:?}", constraints.name));
        let dofs = DofMap::new(self.dofs.len(), &constraints.fixed).map_err(&refused)?;
        let system = reduced(&self.system, &dofs).map_err(&refused)?;
        let free = |body: &[usize]| body.iter().filter_map(|&dof| dofs.position(dof)).collect();
        let bodies = self.bodies.iter().map(|body| Body { name: body.name.clone(), dofs: free(&body.dofs) }).collect();
        let sectors = Sectors::whole(system.order(), system.channels().len());
        Ok(Brake { system, bodies, sectors, dofs })
    }
}

/// The system over the free degrees of freedom. Channels keep the entries of their forces and readings at these.
fn reduced(system: &AffineSystem, dofs: &DofMap) -> Result<AffineSystem, LinsysError> {
    let term = |term: &Term| {
        let SecondOrder { m, c, k, .. } = term.matrices();
        let matrices = SecondOrder::new(dofs.reduce(m), dofs.reduce(c), dofs.reduce(k))?;
        Term::new(term.name.clone(), term.family.clone(), matrices)
    };
    let free = |entries: &[(usize, f64)]| {
        entries.iter().filter_map(|&(dof, value)| Some((dofs.position(dof)?, value))).collect()
    };
    let channel = |Channel { name, family, force, reading }: &Channel| {
        Channel::new(name.clone(), family.clone(), free(force), free(reading))
    };
    let terms = system.terms().iter().map(term).collect::<Result<_, _>>()?;
    AffineSystem::new(terms, system.channels().iter().map(channel).collect())
}
