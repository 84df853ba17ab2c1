//! Pairs of sets, of two bodies of a mesh, whose faces face each other: the contacts that a draft of a case proposes.

use std::collections::{BTreeSet, HashMap};

use contact::{OppositeFaces, Pairing, Sliding};
use elements::FaceId;

use super::entries::Nodes;
use super::faces::Solids;
use super::names_on_mesh::bodies;

/// Largest distance of two faces that face each other, as a fraction of the square root of the slave's mean face area; chosen: less than the distance
/// between two faces of one body.
const REACH: f64 = 0.25;

/// Slave and master: a set of one body, all of whose faces face faces of a set of another body.
#[derive(Debug, Clone)]
pub(super) struct Facing {
    /// Name of the slave, a set or surface.
    pub slave: String,
    /// Name of the master, a set or surface.
    pub master: String,
    /// Number of faces of the slave.
    pub faces: usize,
    /// Distance within which they face the master, in the unit of the mesh.
    pub reach: f64,
    /// Names of node sets that divide the nodes of the slave: each node is in exactly one of them. Empty if no sets do.
    pub patches: Vec<String>,
}

/// A set or surface whose faces are all of one body: a possible slave or master.
struct Candidate {
    name: String,
    /// Number of the body.
    body: usize,
    /// Number of nodes of the body.
    body_nodes: usize,
    faces: Vec<FaceId>,
    /// Distance within which its faces face others if it is a slave, in the unit of the mesh.
    reach: f64,
    /// Least and largest coordinates, x, y and z of each.
    bounds: [[f64; 3]; 2],
}

/// Pairs of slave and master, found greedily: sets are tried as slaves from the set with the most faces down, of equally large sets first the set of the
/// smaller body (the pad), then by name. Each gets the smallest master that all its faces face. A slave has no face of a pair before it; two pairs may have
/// one master.
pub(super) fn facing(solids: &Solids<'_>) -> Vec<Facing> {
    let mut candidates = candidates(solids);
    // By name at last, so that the result does not depend on the order of a map.
    candidates.sort_by(|a, b| {
        b.faces.len().cmp(&a.faces.len()).then(a.body_nodes.cmp(&b.body_nodes)).then_with(|| a.name.cmp(&b.name))
    });
    let mut taken: BTreeSet<FaceId> = BTreeSet::new();
    let mut found: Vec<Facing> = Vec::new();
    for slave in &candidates {
        if slave.faces.iter().any(|face| taken.contains(face)) {
            continue;
        }
        // From the smallest up.
        let mut masters = candidates.iter().rev().filter(|master| is_near(slave, master));
        let Some(master) = masters.find(|master| faces_wholly(solids, slave, master)) else { continue };
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

/// The sets and surfaces of a mesh whose faces are all of one body.
fn candidates(solids: &Solids<'_>) -> Vec<Candidate> {
    let model = solids.model;
    let bodies: HashMap<i64, usize> = model.mesh.iter().flat_map(bodies).collect();
    let of = |name: &String| {
        let faces = solids.faces("", &Nodes::One(name.clone())).ok()?;
        let shapes = faces.iter().map(|&face| solids.mesh.face(face)).collect::<Result<Vec<_>, _>>().ok()?;
        // The corners alone: of quadratic elements, bodies have no other nodes.
        let corners = || shapes.iter().flat_map(|face| face.nodes.iter().take(face.kind.corners()));
        let body = |node: &usize| bodies.get(&solids.mesh.labels()[*node]).copied();
        let first = body(corners().next()?)?;
        if corners().any(|node| body(node) != Some(first)) {
            return None;
        }
        let mean_area = shapes.iter().map(|face| face.area().norm()).sum::<f64>() / shapes.len() as f64;
        let positions = || corners().map(|&node| solids.mesh.positions()[node]);
        let end = |of: fn(f64, f64) -> f64, from: f64| {
            std::array::from_fn(|axis| positions().map(|x| x[axis]).fold(from, of))
        };
        let bounds = [end(f64::min, f64::INFINITY), end(f64::max, f64::NEG_INFINITY)];
        let body_nodes = bodies.values().filter(|body| **body == first).count();
        Some(Candidate { name: name.clone(), body: first, body_nodes, faces, reach: REACH * mean_area.sqrt(), bounds })
    };
    let names: BTreeSet<&String> = model.sets.keys().chain(model.surfaces.keys()).collect();
    names.into_iter().filter_map(of).collect()
}

/// True if two sets are of two bodies, and their boxes of coordinates are no farther apart than the slave reaches.
fn is_near(slave: &Candidate, master: &Candidate) -> bool {
    let [from, to] = slave.bounds;
    let meets = |axis: usize| {
        from[axis] - slave.reach <= master.bounds[1][axis] && master.bounds[0][axis] <= to[axis] + slave.reach
    };
    slave.body != master.body && (0..3).all(meets)
}

/// True if all faces of the slave face faces of the master, within its reach.
fn faces_wholly(solids: &Solids<'_>, slave: &Candidate, master: &Candidate) -> bool {
    // Any direction of sliding will do: which faces face each other does not depend on it.
    let pairing = Pairing::new(Sliding::Along([1.0, 0.0, 0.0]), slave.reach);
    let facing = OppositeFaces::new(&solids.mesh, &slave.faces, &master.faces, &pairing);
    facing.is_ok_and(|facing| facing.faces.len() == slave.faces.len())
}

/// Names of all node sets that consist of some, not all, nodes of the slave's faces, if each of these nodes is in exactly one of the sets; else empty.
fn patches(solids: &Solids<'_>, slave: &Candidate) -> Vec<String> {
    let all: BTreeSet<i64> = solids.nodes_of(&slave.faces).into_iter().collect();
    let is_subset = |nodes: &[i64]| nodes.len() < all.len() && nodes.iter().all(|node| all.contains(node));
    let parts: Vec<(&String, &Vec<i64>)> = solids.model.sets.iter().filter(|(_, nodes)| is_subset(nodes)).collect();
    let covered: BTreeSet<i64> = parts.iter().flat_map(|(_, nodes)| nodes.iter().copied()).collect();
    let is_partition = parts.iter().map(|(_, nodes)| nodes.len()).sum::<usize>() == all.len() && covered == all;
    if is_partition { parts.into_iter().map(|(name, _)| name.clone()).collect() } else { Vec::new() }
}
