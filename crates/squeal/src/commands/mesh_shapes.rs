//! Mode shapes of a finite element brake on its mesh.

use std::path::Path;

use formats::{Dof, ModeShape, write_vtu};

use crate::Error;
use crate::brakes::FiniteElementBrake;
use crate::output::write;
use crate::report::Results;

/// Writes `shapes-SET.vtu` for each set of constraints: the modes from which the others have their names, with all patches in contact at
/// the medians, at the nodes of the mesh. Nothing where the case has no mesh.
pub(super) fn write_mesh_shapes(brake: &FiniteElementBrake, results: &Results<'_>, dir: &Path) -> Result<(), Error> {
    let Some(mesh) = &brake.case.mesh else { return Ok(()) };
    for (place, name) in brake.plan.labels.constraints.iter().enumerate() {
        let (set, reduced) = (&brake.sets[place], &brake.origin(place).reduced);
        let rows: Vec<Dof> = set.dofs.free().iter().map(|&row| brake.case.dofs[row]).collect();
        let path = dir.join(format!("shapes-{name}.vtu"));
        let failed = |source| Error::Write { path: path.clone(), source: std::io::Error::other(source) };
        let shapes = results.modes_of_set(place).into_iter().map(|(label, mode)| {
            let name = format!("mode {}", results.mode_label(place, label));
            ModeShape::new(name, mode.lambda, mesh, &rows, reduced.lift(&mode.shape).as_slice())
        });
        let shapes = shapes.collect::<Result<Vec<_>, _>>().map_err(failed)?;
        let mut text = Vec::new();
        write_vtu(&mut text, mesh, &shapes).map_err(failed)?;
        write(&path, &text)?;
    }
    Ok(())
}
