//! Pictures of a contact, so that a wrong normal or sliding is seen before anything is computed with it.

use std::path::Path;

use brakes::case::{FiniteElementCase, PairPlace, PatchContact};
use brakes::loads_at_medians;
use formats::{Cell, CellKind, Mesh, MeshField, Node, write_fields_vtu};
use output::{OutputError, make_folder, printable, write};

use super::Lines;
use crate::Error;

/// Writes `contact.vtu`, the pairs of the contact with their directions and loads, and `mesh.vtu`, the mesh under them where the case has one, into a
/// folder. The lines that say so.
///
/// # Errors
/// A file that cannot be written, a load at the medians that is not allowed.
pub(super) fn write_pictures(case: &FiniteElementCase, contact: &PatchContact, dir: &Path) -> Result<Lines, Error> {
    make_folder(dir)?;
    let (points, fields) = of_pairs(contact, &loads_at_medians(case)?);
    let file = write_one(dir, "contact.vtu", &points, &fields)?;
    let what = format!("{} pairs with normal, sliding, gap and N0 at the medians", points.nodes.len());
    let mut lines = Lines::default();
    lines.add("drawn", format!("{file}: {what}"));
    if let Some(mesh) = &case.mesh {
        lines.add("", format!("{}: the mesh", write_one(dir, "mesh.vtu", mesh, &[])?));
    }
    Ok(lines)
}

/// The pairs as a mesh of single points, numbered from 1, and what is known of each.
fn of_pairs(contact: &PatchContact, loads: &[Vec<f64>]) -> (Mesh, Vec<MeshField>) {
    let patches = &contact.patches;
    let places: Vec<&PairPlace> = patches.iter().flat_map(|patch| &patch.places).collect();
    let nodes = (1..).zip(&places).map(|(label, place)| Node { label, position: place.position }).collect();
    let cells = (0..places.len()).map(|at| Cell { kind: CellKind::Vertex, nodes: vec![at] }).collect();
    let vector = |name: &str, of: fn(&PairPlace) -> [f64; 3]| MeshField {
        name: name.into(),
        values: (0..3).map(|x| places.iter().map(|place| of(place)[x]).collect()).collect(),
    };
    let number = |name: &str, values: Vec<f64>| MeshField { name: name.into(), values: vec![values] };
    let of_pair =
        |side: usize| patches.iter().flat_map(move |patch| patch.pairs.iter().map(move |pair| pair[side] as f64));
    let of_patch = (1..).zip(patches).flat_map(|(number, patch)| patch.pairs.iter().map(move |_| f64::from(number)));
    let fields = vec![
        vector("normal", |place| place.normal),
        vector("sliding", |place| place.sliding),
        number("gap", places.iter().map(|place| place.gap).collect()),
        number("N0", loads.concat()),
        number("patch", of_patch.collect()),
        number("node of the pad", of_pair(0).collect()),
        number("node of the disc", of_pair(1).collect()),
    ];
    (Mesh { nodes, cells }, fields)
}

/// Writes a file; its path, to be printed.
fn write_one(dir: &Path, name: &str, mesh: &Mesh, fields: &[MeshField]) -> Result<String, Error> {
    let path = dir.join(name);
    let mut text = Vec::new();
    let failed = |source| OutputError::Write { path: path.clone(), source: std::io::Error::other(source) };
    write_fields_vtu(&mut text, mesh, fields).map_err(failed)?;
    write(&path, &text)?;
    Ok(printable(&path.display().to_string()))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use brakes::case::CaseFile;

    use super::{of_pairs, write_pictures};

    #[test]
    fn pairs_are_drawn_where_they_are_with_their_directions_and_loads() -> Result<(), Box<dyn std::error::Error>> {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/disc-pad/disc-pad.toml");
        let text = std::fs::read_to_string(&path)?;
        let Ok(CaseFile::FiniteElements(case)) = CaseFile::parse(&path, text) else {
            return Err("another case".into());
        };
        let contact = case.contact.as_ref().ok_or("no contact")?;
        let (points, fields) = of_pairs(contact, &brakes::loads_at_medians(&case)?);
        let field = |name: &str| fields.iter().find(|field| field.name == name).ok_or_else(|| name.to_owned());
        let (normal, sliding, load) = (field("normal")?, field("sliding")?, field("N0")?);
        assert_eq!(points.nodes.len(), 27);
        for (at, node) in points.nodes.iter().enumerate() {
            let [x, y, _] = node.position;
            let r = x.hypot(y);
            assert_eq!([0, 1, 2].map(|axis| normal.values[axis][at]), [0.0, 0.0, 1.0]);
            let found = [0, 1, 2].map(|axis| sliding.values[axis][at]);
            assert!(found.iter().zip([-y / r, x / r, 0.0]).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
            assert_eq!(load.values[0][at], 156.0);
        }
        let folder = tempfile::tempdir()?;
        let said = write_pictures(&case, contact, &folder.path().join("new"))?.text();
        assert!(said.contains("contact.vtu: 27 pairs with normal, sliding, gap and N0 at the medians"), "{said}");
        let drawn = std::fs::read_to_string(folder.path().join("new/mesh.vtu"))?;
        let nodes = case.mesh.as_ref().map_or(0, |mesh| mesh.nodes.len());
        assert!(drawn.contains(&format!("NumberOfPoints=\"{nodes}\"")));
        Ok(())
    }
}
