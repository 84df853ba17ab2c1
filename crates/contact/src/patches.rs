//! Patches: parts of the slave's faces with a name.

use std::collections::HashSet;

use elements::Mesh;

use crate::{ContactError, Interface};

/// Largest difference, relative, of the weights of two patches that have a point alike; chosen, above rounding.
const ALIKE: f64 = 1e-9;

impl Interface {
    /// The patch of each point, by its place in the list of names with the nodes of each, given by their places in the mesh: the one whose
    /// nodes have most of the slave's shape functions there, by the sum of their squares. So patches may share the nodes on a border, as sets
    /// of faces do, or part them among each other.
    ///
    /// # Errors
    /// A point none of whose nodes is in a patch, or whose nodes two patches have alike.
    pub fn patches(&self, mesh: &Mesh, patches: &[(String, Vec<usize>)]) -> Result<Vec<usize>, ContactError> {
        let nodes: Vec<HashSet<usize>> = patches.iter().map(|(_, nodes)| nodes.iter().copied().collect()).collect();
        let of = |point: &crate::ContactPoint| {
            let node = mesh.labels()[point.node()];
            let weight = |nodes: &HashSet<usize>| {
                point.slave.iter().filter(|(node, _)| nodes.contains(node)).map(|(_, n)| n * n).sum::<f64>()
            };
            let mut ranked: Vec<(usize, f64)> = nodes.iter().map(weight).enumerate().collect();
            ranked.sort_by(|(_, a), (_, b)| b.total_cmp(a));
            match ranked[..] {
                [(first, weight), (second, other), ..] if weight > 0.0 && weight - other < ALIKE * weight => {
                    let [first, second] = [first, second].map(|at| patches[at].0.clone());
                    Err(ContactError::TwoPatches { node, first, second })
                }
                [(first, weight), ..] if weight > 0.0 => Ok(first),
                _ => Err(ContactError::NoPatch { node }),
            }
        };
        self.points().iter().map(of).collect()
    }
}
