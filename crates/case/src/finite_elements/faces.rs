//! Faces of solid elements by the names that a mesh has for them, and the mesh that is integrated over.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use elements::{ElementsError, FaceId, Kind, Mesh, Rows};
use formats::Solid;

use super::entries::Nodes;
use super::nodes::Model;
use crate::CaseError;

/// Most names that a message lists; chosen, so that the message stays short.
const MOST_NAMES_LISTED: usize = 12;

/// Solid elements that are integrated over.
const KNOWN: &str = "C3D4, C3D6, C3D8, C3D10, C3D15 or C3D20";

/// The solid elements of a case with all their nodes, and their rows in its matrices.
pub(super) struct Solids<'a> {
    pub model: &'a Model<'a>,
    pub mesh: Mesh,
    pub rows: Rows,
    /// Places of the elements by their numbers.
    places: HashMap<i64, usize>,
    /// Solids whose types cannot be integrated over, at each of their nodes: faces towards them are not outer ones.
    unknown: HashMap<i64, Vec<&'a Solid>>,
}

impl<'a> Solids<'a> {
    /// # Errors
    /// A case without a mesh, a mesh without solids that are known.
    pub fn new(model: &'a Model<'a>, field: &str) -> Result<Self, CaseError> {
        let missing = || model.check.value("brake.mesh", "missing", &format!("a mesh, as {field} needs its elements"));
        let drawn = model.mesh.as_ref().ok_or_else(missing)?;
        let nodes = drawn.nodes.iter().map(|node| (node.label, node.position)).collect();
        let mut unknown: HashMap<i64, Vec<&Solid>> = HashMap::new();
        for solid in model.solids.iter().filter(|solid| Kind::of_type(&solid.of_type).is_none()) {
            solid.nodes.iter().for_each(|&node| unknown.entry(node).or_default().push(solid));
        }
        let known = |solid: &Solid| Some((solid.label, Kind::of_type(&solid.of_type)?, solid.nodes.clone()));
        let elements: Vec<_> = model.solids.iter().filter_map(known).collect();
        if elements.is_empty() {
            let allowed = format!("a mesh with elements {KNOWN}");
            return Err(model.check.value("brake.mesh", "no solid elements", &allowed));
        }
        let mesh = Mesh::new(nodes, elements).map_err(model.check.contact("brake.mesh"))?;
        let row = |node: i64, direction: usize| model.row(node, direction as u32 + 1);
        let rows = Rows::new(&mesh, model.dofs.len(), row).map_err(model.check.contact("brake.mesh"))?;
        let places = mesh.elements().iter().map(|element| element.label).zip(0..).collect();
        Ok(Self { model, mesh, rows, places, unknown })
    }

    /// Elements of sets and numbers, by their indices in the mesh, each once.
    pub fn elements(&self, field: &str, names: &Nodes) -> Result<Vec<usize>, CaseError> {
        let place = |label: i64| self.places.get(&label).copied();
        let mut places = BTreeSet::new();
        for name in names.items() {
            if let Some(set) = find(&self.model.element_sets, name) {
                for &label in set {
                    // What is not integrated over would be missing from the result, and nobody would know.
                    let other = || {
                        let found = format!("{name:?} with element {label}, which is another");
                        self.model.check.value(field, found, &format!("a set of solid elements {KNOWN} alone"))
                    };
                    places.insert(place(label).ok_or_else(other)?);
                }
            } else if let Some(place) = name.parse().ok().and_then(place) {
                places.insert(place);
            } else {
                let sets = listed(self.model.element_sets.keys());
                let allowed = format!("an element set of the mesh, or the number of a solid element: {sets}");
                return Err(self.model.check.value(field, format!("{name:?}"), &allowed));
            }
        }
        if places.is_empty() {
            return Err(self.model.check.value(field, format!("{:?}", names.items()), "sets with solid elements"));
        }
        Ok(places.into_iter().collect())
    }

    /// The faces of surfaces, node sets (outer faces all of whose corners are in one) and element sets (their outer faces), each once. A face
    /// that a surface gives by its number must be an outer one.
    pub fn faces(&self, field: &str, names: &Nodes) -> Result<Vec<FaceId>, CaseError> {
        let check = self.model.check;
        let mut faces = BTreeSet::new();
        for name in names.items() {
            let before = faces.len();
            if find(&self.model.surfaces, name).is_some() {
                faces.extend(self.surface(field, name)?);
            } else if let Some(nodes) = self.model.set(name) {
                faces.extend(self.outer_on(field, nodes)?);
            } else if find(&self.model.element_sets, name).is_some() {
                faces.extend(self.outer_of(field, &self.elements(field, &Nodes::One(name.clone()))?)?);
            } else {
                let Model { sets, element_sets, surfaces, .. } = self.model;
                let allowed = format!(
                    "a surface ({}), a node set ({}) or an element set ({}) of the mesh",
                    listed(surfaces.keys()),
                    listed(sets.keys()),
                    listed(element_sets.keys())
                );
                return Err(check.value(field, format!("{name:?}"), &allowed));
            }
            if faces.len() == before {
                let allowed = format!("a set with whole outer faces of solid elements {KNOWN}, each once");
                return Err(check.value(field, format!("{name:?}"), &allowed));
            }
        }
        Ok(faces.into_iter().collect())
    }

    /// Outer faces of elements.
    fn outer_of(&self, field: &str, elements: &[usize]) -> Result<Vec<FaceId>, CaseError> {
        self.outer(field, self.mesh.outer_faces(elements))
    }

    /// Outer faces all of whose corners are among `nodes`.
    fn outer_on(&self, field: &str, nodes: &[i64]) -> Result<Vec<FaceId>, CaseError> {
        let places: Vec<usize> = nodes.iter().filter_map(|&node| self.mesh.place(node)).collect();
        self.outer(field, self.mesh.faces_on(&places))
    }

    /// Faces with no known solid on their other side, without faces towards a solid of unknown type.
    fn outer(&self, field: &str, faces: Result<Vec<FaceId>, ElementsError>) -> Result<Vec<FaceId>, CaseError> {
        let faces = faces.map_err(self.model.check.contact(field))?;
        Ok(faces.into_iter().filter(|&face| self.beyond(face).is_none()).collect())
    }

    /// The solid of unknown type on the other side of a face.
    fn beyond(&self, face: FaceId) -> Option<&'a Solid> {
        let face = self.mesh.face(face).ok()?;
        let corners: Vec<i64> = face.nodes[..3].iter().map(|&node| self.mesh.labels()[node]).collect();
        let mut there = self.unknown.get(&corners[0])?.iter().copied();
        there.find(|solid| corners.iter().all(|corner| solid.nodes.contains(corner)))
    }

    /// True if names are of sets of elements alone, all of whose outer faces are then meant.
    pub fn are_bodies(&self, names: &Nodes) -> bool {
        let is_body = |name: &String| {
            find(&self.model.surfaces, name).is_none()
                && self.model.set(name).is_none()
                && find(&self.model.element_sets, name).is_some()
        };
        names.items().iter().all(is_body)
    }

    /// The faces of a `*SURFACE`.
    fn surface(&self, field: &str, name: &str) -> Result<Vec<FaceId>, CaseError> {
        let check = self.model.check;
        let of_mesh = check.contact::<ElementsError>(field);
        let Some(surface) = find(&self.model.surfaces, name) else { return Ok(Vec::new()) };
        if !surface.unread.is_empty() {
            let found = format!("{name:?} with {}", surface.unread.join(", "));
            return Err(check.value(field, found, "a surface of TYPE=ELEMENT or NODE without further parameters"));
        }
        let mut faces = Vec::new();
        for (what, face) in &surface.lines {
            let found = || format!("{name:?}, line \"{what}, {face}\"");
            if surface.of_nodes {
                faces.extend(self.outer_on(field, &self.model.nodes(field, std::slice::from_ref(what))?)?);
                continue;
            }
            let elements = self.elements(field, &Nodes::One(what.clone()))?;
            if face.is_empty() {
                faces.extend(self.outer_of(field, &elements)?);
                continue;
            }
            let number = face.strip_prefix('S').and_then(|number| number.parse().ok());
            let number = number.ok_or_else(|| check.value(field, found(), "faces S1 to S6 of solid elements"))?;
            for element in elements {
                let id = FaceId { element, number };
                self.mesh.face(id).map_err(&of_mesh)?;
                if let Some(solid) = self.beyond(id) {
                    let found = format!(
                        "{name:?}, S{number}: a face towards element {} of type {}",
                        solid.label, solid.of_type
                    );
                    let allowed = format!("outer faces of solid elements; elements {KNOWN} are known");
                    return Err(check.value(field, found, &allowed));
                }
                faces.push(id);
            }
        }
        Ok(faces)
    }

    /// The numbers of the nodes of faces, ascending.
    pub fn nodes_of(&self, faces: &[FaceId]) -> Vec<i64> {
        let nodes = faces.iter().filter_map(|id| self.mesh.face(*id).ok()).flat_map(|face| face.nodes);
        let labels: BTreeSet<i64> = nodes.map(|node| self.mesh.labels()[node]).collect();
        labels.into_iter().collect()
    }
}

/// Entry of a map of a deck by its name: as it is written, else in capitals without blanks.
fn find<'m, T>(map: &'m BTreeMap<String, T>, name: &str) -> Option<&'m T> {
    let plain = name.split_whitespace().collect::<String>().to_ascii_uppercase();
    map.get(name).or_else(|| map.get(&plain))
}

fn listed<'n>(names: impl ExactSizeIterator<Item = &'n String>) -> String {
    let (count, some): (usize, Vec<&str>) = (names.len(), names.take(MOST_NAMES_LISTED).map(String::as_str).collect());
    match count {
        0 => "none".to_owned(),
        _ if count > MOST_NAMES_LISTED => format!("{}, ...", some.join(", ")),
        _ => some.join(", "),
    }
}
