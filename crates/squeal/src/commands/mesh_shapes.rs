//! Mode shapes of a finite element brake on its mesh.

use std::path::Path;

use formats::{Dof, FormatsError, Mesh, ModeShape, Surface, write_vtu};

use crate::Error;
use crate::brakes::FiniteElementBrake;
use crate::output::write;
use crate::report::{Geometry, MeshModes, Results};
use crate::study::ModeLabel;

/// Writes `shapes-SET.vtu` for each set of constraints: the modes from which the others have their names, with all patches in contact at
/// the medians, at the nodes of the mesh. Returns how a page shows the same modes. No file where the case has no mesh.
pub(super) fn write_mesh_shapes(
    brake: &FiniteElementBrake,
    results: &Results<'_>,
    dir: &Path,
) -> Result<Geometry, Error> {
    let Some(mesh) = &brake.case.mesh else {
        return Ok(Geometry::none(
            "The case names no mesh (brake.mesh), so that it is not known where its degrees of freedom are.",
        ));
    };
    let surface = Surface::new(mesh);
    let mut sets = Vec::new();
    for (place, name) in brake.plan.labels.constraints.iter().enumerate() {
        let path = dir.join(format!("shapes-{name}.vtu"));
        let failed = |source| Error::Write { path: path.clone(), source: std::io::Error::other(source) };
        let named = shapes_of_set(brake, mesh, results, place).map_err(failed)?;
        let shapes: Vec<ModeShape> = named.iter().map(|(_, shape)| shape.clone()).collect();
        let mut text = Vec::new();
        write_vtu(&mut text, mesh, &shapes).map_err(failed)?;
        write(&path, &text)?;
        let on_surface = |shape: &ModeShape| surface.nodes.iter().flat_map(|&node| shape.displacements[node]).collect();
        sets.push(named.iter().map(|(label, shape)| (*label, on_surface(shape))).collect());
    }
    let nodes = || surface.nodes.iter().map(|&node| mesh.nodes[node]);
    Ok(Geometry::mesh(MeshModes {
        labels: nodes().map(|node| node.label).collect(),
        positions: nodes().map(|node| node.position).collect(),
        faces: surface.faces,
        of_solids: surface.of_solids,
        shapes: sets,
    }))
}

/// The modes of a set of constraints at the nodes of the mesh.
fn shapes_of_set(
    brake: &FiniteElementBrake,
    mesh: &Mesh,
    results: &Results<'_>,
    place: usize,
) -> Result<Vec<(ModeLabel, ModeShape)>, FormatsError> {
    let (set, reduced) = (&brake.sets[place], &brake.origin(place).reduced);
    let rows: Vec<Dof> = set.dofs.free().iter().map(|&row| brake.case.dofs[row]).collect();
    let shapes = results.modes_of_set(place).into_iter().map(|(label, mode)| {
        let name = format!("mode {}", results.mode_label(place, label));
        let shape = ModeShape::new(name, mode.lambda, mesh, &rows, reduced.lift(&mode.shape).as_slice())?;
        Ok((label, shape))
    });
    shapes.collect()
}
