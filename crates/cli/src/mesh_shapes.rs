//! Mode shapes of a finite element brake on its mesh.

use std::path::Path;

use brakes::{CaseBrake, FiniteElementBrake};
use formats::{Mesh, ModeShape, Surface, write_vtu};
use num_complex::Complex;
use output::{OutputError, write};
use report::{BasisOf, Geometry, MeshSurface, ModeOf};
use squeal::results::Results;

use crate::Error;

/// Geometry by which a page shows the modes of a brake: on its mesh, as a lattice, or by its bodies.
pub(super) fn geometry<B: CaseBrake>(brake: &B) -> Geometry<'_> {
    match (brake.finite_elements(), brake.grid()) {
        (Some(brake), _) => mesh_geometry(brake),
        (None, Some(grid)) => Geometry::lattice(grid.rows(), grid.columns()),
        (None, None) => Geometry::bodies(brake.plan()),
    }
}

/// Geometry by which a page shows modes on the mesh of the case, if it names one.
fn mesh_geometry(brake: &FiniteElementBrake) -> Geometry<'_> {
    let Some(mesh) = &brake.case.mesh else {
        return Geometry::none(
            "The case names no mesh (brake.mesh), so that it is not known where its degrees of freedom are.",
        );
    };
    let Surface { nodes, faces, of_solids } = Surface::new(mesh);
    let at = || nodes.iter().map(|&node| mesh.nodes[node]);
    let surface = MeshSurface {
        labels: at().map(|node| node.label).collect(),
        positions: at().map(|node| node.position).collect(),
        faces,
        of_solids,
    };
    let motion = move |mode: ModeOf<'_>| -> Result<Vec<Complex<f64>>, report::Error> {
        let shape = on_mesh(brake, mesh, String::new(), Complex::default(), mode)
            .map_err(|error| report::Error::Mesh(Box::new(error)))?;
        Ok(nodes.iter().flat_map(|&node| shape.displacements[node]).collect())
    };
    Geometry::mesh(surface, Box::new(motion))
}

/// Writes `shapes-SET.vtu` for each set of constraints: the modes from which the others have their names, with all patches in contact at
/// the medians, at the nodes of the mesh. No file where the case has no mesh.
pub(super) fn write_mesh_shapes(brake: &FiniteElementBrake, results: &Results, dir: &Path) -> Result<(), Error> {
    let Some(mesh) = &brake.case.mesh else { return Ok(()) };
    for (constraints, name) in brake.plan.labels.constraints.iter().enumerate() {
        let path = dir.join(format!("shapes-{name}.vtu"));
        let dofs = &brake.sets[constraints].dofs;
        let shapes = results.modes_of_set(constraints).into_iter().map(|(label, mode)| {
            let name = format!("mode {}", results.mode_label(constraints, label));
            on_mesh(
                brake,
                mesh,
                name,
                mode.lambda,
                ModeOf { basis: BasisOf::Set(constraints), dofs, shape: &mode.shape },
            )
        });
        let shapes = shapes.collect::<Result<Vec<_>, Error>>()?;
        let mut text = Vec::new();
        let failed = |source| OutputError::Write { path: path.clone(), source: std::io::Error::other(source) };
        write_vtu(&mut text, mesh, &shapes).map_err(failed)?;
        write(&path, &text)?;
    }
    Ok(())
}

/// A mode at the nodes of the mesh.
fn on_mesh(
    brake: &FiniteElementBrake,
    mesh: &Mesh,
    name: String,
    lambda: Complex<f64>,
    mode: ModeOf<'_>,
) -> Result<ModeShape, Error> {
    let (set, part) = match mode.basis {
        BasisOf::Set(set) => (set, brake.origin(set)),
        BasisOf::Scene(scene) => (scene.key.constraints, brake.part(scene)),
    };
    Ok(ModeShape::new(name, lambda, mesh, &brake.free_rows(set), part.reduced.lift(mode.shape).as_slice())?)
}
