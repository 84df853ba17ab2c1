//! Sets of two bodies of a mesh that look at each other, from which a draft of a case proposes contacts.

use std::collections::{BTreeSet, HashMap};

use contact::{Interface, Pairing, Sliding};
use elements::FaceId;

use super::entries::Nodes;
use super::faces::Solids;
use super::names_on_mesh::bodies;

/// How far two faces may be apart, as a part of the mean size of the slave's; chosen: less than what parts two faces of a body.
const NEAR: f64 = 0.25;

/// A set of one body, all of whose faces look at those of a set of another.
#[derive(Debug, Clone)]
pub(super) struct Facing {
    /// Set, or surface, that looks.
    pub slave: String,
    /// Set, or surface, that it looks at.
    pub master: String,
    /// Number of faces that look.
    pub faces: usize,
    /// Distance within which they do.
    pub reach: f64,
    /// Node sets that part the nodes of the slave; empty where none do.
    pub patches: Vec<String>,
}

/// A set whose faces are of one body.
struct Candidate {
    name: String,
    body: usize,
    /// Number of nodes of this body.
    body_nodes: usize,
    faces: Vec<FaceId>,
    reach: f64,
    /// Least and largest coordinates.
    bounds: [[f64; 3]; 2],
}

/// Pairs of sets of two bodies that look at each other: of sets that share faces the largest as slave, before the smallest that will do as
/// master. No pair has a face of one before it.
pub(super) fn facing(solids: &Solids<'_>) -> Vec<Facing> {
    let mut candidates = candidates(solids);
    // Large slaves first; of equal ones that of the smaller body, as pads are, and by name, so that no order of a map shows.
    candidates.sort_by(|a, b| {
        b.faces.len().cmp(&a.faces.len()).then(a.body_nodes.cmp(&b.body_nodes)).then_with(|| a.name.cmp(&b.name))
    });
    let mut taken: BTreeSet<FaceId> = BTreeSet::new();
    let mut found: Vec<Facing> = Vec::new();
    for slave in &candidates {
        if slave.faces.iter().any(|face| taken.contains(face)) {
            continue;
        }
        // The smallest set that all faces of the slave look at.
        let mut masters = candidates.iter().rev().filter(|master| is_near(slave, master));
        let Some(master) = masters.find(|master| looks_at(solids, slave, master)) else { continue };
        taken.extend(slave.faces.iter().chain(&master.faces));
        found.push(Facing {
            slave: slave.name.clone(),
            master: master.name.clone(),
            faces: slave.faces.len(),
            reach: slave.reach,
            patches: patches(solids, slave),
        });
    }
    found.sort_by(|a, b| a.slave.cmp(&b.slave));
    found
}

fn candidates(solids: &Solids<'_>) -> Vec<Candidate> {
    let model = solids.model;
    let bodies: HashMap<i64, usize> = model.mesh.iter().flat_map(bodies).collect();
    let of = |name: &String| {
        let faces = solids.faces("", &Nodes::One(name.clone())).ok()?;
        let drawn = faces.iter().map(|&face| solids.mesh.face(face)).collect::<Result<Vec<_>, _>>().ok()?;
        // Corners, by which elements are joined.
        let corners = || drawn.iter().flat_map(|face| face.nodes.iter().take(face.kind.corners()));
        let body = |node: &usize| bodies.get(&solids.mesh.labels()[*node]).copied();
        let first = body(corners().next()?)?;
        if corners().any(|node| body(node) != Some(first)) {
            return None;
        }
        let mean = drawn.iter().map(|face| face.area().norm()).sum::<f64>() / drawn.len() as f64;
        let positions = || corners().map(|&node| solids.mesh.positions()[node]);
        let end = |of: fn(f64, f64) -> f64, from: f64| {
            std::array::from_fn(|axis| positions().map(|x| x[axis]).fold(from, of))
        };
        let bounds = [end(f64::min, f64::INFINITY), end(f64::max, f64::NEG_INFINITY)];
        let body_nodes = bodies.values().filter(|body| **body == first).count();
        Some(Candidate { name: name.clone(), body: first, body_nodes, faces, reach: NEAR * mean.sqrt(), bounds })
    };
    let names: BTreeSet<&String> = model.sets.keys().chain(model.surfaces.keys()).collect();
    names.into_iter().filter_map(of).collect()
}

/// True if two sets are of two bodies and their bounds meet within the reach of the first.
fn is_near(slave: &Candidate, master: &Candidate) -> bool {
    let [from, to] = slave.bounds;
    let meets = |axis: usize| {
        from[axis] - slave.reach <= master.bounds[1][axis] && master.bounds[0][axis] <= to[axis] + slave.reach
    };
    slave.body != master.body && (0..3).all(meets)
}

fn looks_at(solids: &Solids<'_>, slave: &Candidate, master: &Candidate) -> bool {
    // Whatever slides: who looks at whom does not depend on it.
    let pairing = Pairing::new(Sliding::Along([1.0, 0.0, 0.0]), slave.reach);
    let looking = Interface::facing(&solids.mesh, &slave.faces, &master.faces, &pairing);
    looking.is_ok_and(|looking| looking.len() == slave.faces.len())
}

/// Node sets that part the nodes of the faces of a set.
fn patches(solids: &Solids<'_>, slave: &Candidate) -> Vec<String> {
    let all: BTreeSet<i64> = solids.nodes_of(&slave.faces).into_iter().collect();
    let is_part = |nodes: &[i64]| nodes.len() < all.len() && nodes.iter().all(|node| all.contains(node));
    let parts: Vec<(&String, &Vec<i64>)> = solids.model.sets.iter().filter(|(_, nodes)| is_part(nodes)).collect();
    let covered: BTreeSet<i64> = parts.iter().flat_map(|(_, nodes)| nodes.iter().copied()).collect();
    let is_partition = parts.iter().map(|(_, nodes)| nodes.len()).sum::<usize>() == all.len() && covered == all;
    if is_partition { parts.into_iter().map(|(name, _)| name.clone()).collect() } else { Vec::new() }
}
