//! Agreement between the nodes of a mesh and the rows of the matrices.

use std::collections::{HashMap, HashSet};

use formats::Mesh;

use super::missing::listed;
use super::nodes::Model;
use crate::CaseError;

/// Agreement between the nodes of a mesh and the rows of the matrices.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamesOnMesh {
    /// Number of nodes of the mesh.
    pub nodes: usize,
    /// Number of them that have a row.
    pub with_rows: usize,
    /// Number of nodes that have rows and are not of the mesh.
    pub not_on_mesh: usize,
    /// The first node of each body of the mesh, as its elements join it, none of whose nodes has a row.
    pub bodies_without: Vec<i64>,
}

impl NamesOnMesh {
    /// # Errors
    /// No node of the mesh has a row.
    pub(super) fn new(model: &Model<'_>) -> Result<Option<Self>, CaseError> {
        let Some(mesh) = &model.mesh else { return Ok(None) };
        let of_rows: HashSet<i64> = model.dofs.iter().filter(|dof| dof.direction > 0).map(|dof| dof.node).collect();
        let labels: HashSet<i64> = mesh.nodes.iter().map(|node| node.label).collect();
        let with_rows = labels.intersection(&of_rows).count();
        if with_rows == 0 {
            let nodes: Vec<i64> = mesh.nodes.iter().map(|node| node.label).collect();
            let found = format!("a mesh of {}, and no row of the matrices has a name of it", listed(&nodes));
            let allowed = format!(
                "the mesh of matrices whose rows have names, node and direction; these have {}",
                model.some_rows()
            );
            return Err(model.check.value("brake.mesh", found, &allowed));
        }
        Ok(Some(Self {
            nodes: mesh.nodes.len(),
            with_rows,
            not_on_mesh: of_rows.difference(&labels).count(),
            bodies_without: bodies_without(mesh, &of_rows),
        }))
    }
}

/// The nodes of a mesh by their numbers, each with its body: nodes that elements join are one body, numbered by its first node.
pub(super) fn bodies(mesh: &Mesh) -> impl Iterator<Item = (i64, usize)> + use<'_> {
    // A forest: each node leads to another of its body, the root to itself.
    let mut above: Vec<usize> = (0..mesh.nodes.len()).collect();
    fn root(above: &mut [usize], mut node: usize) -> usize {
        while above[node] != node {
            above[node] = above[above[node]];
            node = above[node];
        }
        node
    }
    for cell in &mesh.cells {
        for pair in cell.nodes.windows(2) {
            let (a, b) = (root(&mut above, pair[0]), root(&mut above, pair[1]));
            above[a.max(b)] = a.min(b);
        }
    }
    // Of quadratic elements the mesh has the corners: nodes within edges are bodies of their own, which nobody asks about.
    (0..mesh.nodes.len()).map(move |node| (mesh.nodes[node].label, root(&mut above, node)))
}

/// The first nodes of bodies none of whose nodes is in `of_rows`.
fn bodies_without(mesh: &Mesh, of_rows: &HashSet<i64>) -> Vec<i64> {
    let of_node: HashMap<i64, usize> = bodies(mesh).collect();
    let mut has_row: HashMap<usize, bool> = HashMap::new();
    for &node in mesh.cells.iter().flat_map(|cell| &cell.nodes) {
        let label = mesh.nodes[node].label;
        *has_row.entry(of_node[&label]).or_default() |= of_rows.contains(&label);
    }
    let mut without: Vec<i64> =
        has_row.iter().filter(|(_, has_row)| !**has_row).map(|(&root, _)| mesh.nodes[root].label).collect();
    without.sort_unstable();
    without
}
