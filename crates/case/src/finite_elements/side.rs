//! Sides of the contact on which the bodies lie, by the mesh: the normal points from the disc into the pad.

use std::collections::HashSet;
use std::fmt;

use formats::{CellKind, Mesh, Surface};
use nalgebra::Vector3;

use super::nodes::Model;
use crate::CaseError;

/// The least cosine of the angle between the normal of the contact and the direction from a face into its body; chosen: at 84 degrees a body lies
/// beside the contact, not behind it.
const LEAST_OF_FACE: f64 = 0.1;
/// The least cosine of the angle between the normal of the contact and the direction from its nodes to the middles of elements; chosen, larger than
/// the least cosine of faces, because middles tell the direction only roughly.
const LEAST_OF_ELEMENTS: f64 = 0.3;

/// Evidence in the mesh for the side of the contact on which a body lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Number of outer faces of its elements that tell it: all of their corners are nodes of the contact.
    Faces(usize),
    /// Number of solid elements at nodes of the contact whose middles tell it.
    Elements(usize),
    /// No evidence: there are no solid elements at nodes of the contact, or they lie beside rather than behind it.
    Unknown,
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Faces(count) => write!(f, "{count} faces"),
            Self::Elements(count) => write!(f, "{count} elements"),
            Self::Unknown => write!(f, "nothing"),
        }
    }
}

/// Checks that the pad lies where the normal points to and the disc where it comes from. `nodes` are the nodes of the contact on the pad and on the disc.
///
/// # Errors
/// A body whose faces, or whose elements, lie on the other side.
pub(super) fn sides(model: &Model<'_>, nodes: [&[i64]; 2], normal: &Vector3<f64>) -> Result<[Side; 2], CaseError> {
    let Some(mesh) = &model.mesh else { return Ok([Side::Unknown; 2]) };
    let surface = Surface::new(mesh);
    let mut found = [Side::Unknown; 2];
    for (at, body) in ["pad", "disc"].into_iter().enumerate() {
        let of_contact: HashSet<i64> = nodes[at].iter().copied().collect();
        let of_contact: HashSet<usize> =
            (0..mesh.nodes.len()).filter(|&place| of_contact.contains(&mesh.nodes[place].label)).collect();
        // From the contact into the body: along the normal for the pad, against it for the disc.
        let sign = if at == 0 { 1.0 } else { -1.0 };
        let inwards = inward_directions(mesh, &surface, &of_contact);
        let wrong = inwards.iter().filter(|inward| sign * inward.normalize().dot(normal) < LEAST_OF_FACE).count();
        let sum: Vector3<f64> = inwards.iter().sum();
        if wrong > 0 {
            return Err(refused(model, normal, body, format!("{wrong} of the {} faces", inwards.len()), sign * sum));
        }
        if !inwards.is_empty() {
            found[at] = Side::Faces(inwards.len());
            continue;
        }
        let offsets = offsets(mesh, &of_contact);
        let sum: Vector3<f64> = offsets.iter().sum();
        let cosine = sign * sum.dot(normal) / offsets.iter().map(|offset| offset.norm()).sum::<f64>();
        if cosine < -LEAST_OF_ELEMENTS {
            return Err(refused(model, normal, body, format!("the {} elements", offsets.len()), sign * sum));
        }
        if cosine > LEAST_OF_ELEMENTS {
            found[at] = Side::Elements(offsets.len());
        }
    }
    Ok(found)
}

fn refused(model: &Model<'_>, normal: &Vector3<f64>, body: &str, by: String, right: Vector3<f64>) -> CaseError {
    let list = |v: &Vector3<f64>| format!("[{:.3}, {:.3}, {:.3}]", v[0] + 0.0, v[1] + 0.0, v[2] + 0.0);
    let side = if body == "pad" { "does not point into it" } else { "does not come out of it" };
    let found = format!("{}, which by {by} of the {body} at the contact {side}", list(normal));
    let along = right.try_normalize(0.0).map_or_else(String::new, |right| format!(", about {}", list(&right)));
    let allowed =
        format!("a direction from the disc into the pad{along}, or contact.pad and contact.disc the other way round");
    model.check.value("contact.normal", found, &allowed)
}

/// Areas of the outer faces of solids all of whose corners are nodes of the contact, each times the direction into its element.
fn inward_directions(mesh: &Mesh, surface: &Surface, of_contact: &HashSet<usize>) -> Vec<Vector3<f64>> {
    let place = |node: usize| surface.nodes[node];
    let at = |node: usize| Vector3::from(mesh.nodes[place(node)].position);
    let is_of_contact = |face: &&[usize; 4]| face.iter().all(|&node| of_contact.contains(&place(node)));
    let faces = surface.faces[..surface.of_solids].iter().filter(is_of_contact);
    let inward = |&[a, b, c, d]: &[usize; 4]| -(at(c) - at(a)).cross(&(at(d) - at(b))) / 2.0;
    faces.map(inward).filter(|inward| inward.norm() > 0.0).collect()
}

/// Offsets of the solid elements at nodes of the contact: from the middle of these nodes of an element to its own middle.
fn offsets(mesh: &Mesh, of_contact: &HashSet<usize>) -> Vec<Vector3<f64>> {
    let middle = |nodes: &[usize]| {
        let sum: Vector3<f64> = nodes.iter().map(|&node| Vector3::from(mesh.nodes[node].position)).sum();
        sum / nodes.len() as f64
    };
    let from_contact = |nodes: &Vec<usize>| {
        let own: Vec<usize> = nodes.iter().copied().filter(|node| of_contact.contains(node)).collect();
        (!own.is_empty()).then(|| middle(nodes) - middle(&own))
    };
    // Shells and the like may lie in the plane of the contact, on no side of it.
    let solids = mesh.cells.iter().filter(|cell| matches!(cell.kind, CellKind::Tetrahedron | CellKind::Hexahedron));
    solids.filter_map(|cell| from_contact(&cell.nodes)).collect()
}
