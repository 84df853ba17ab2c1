//! Nodes of the mesh that the matrices have no rows of: held ones, or a mistake.

use std::fmt;

/// Nodes that a field names and that lack rows. They count as held, like the nodes that a finite element program leaves out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MissingRows {
    /// The field.
    pub field: String,
    /// Number of nodes that the field names.
    pub nodes: usize,
    /// Number of them that have no row in the directions that are meant.
    pub without: usize,
    /// Number of them that have a row in some of these directions only.
    pub partly: usize,
}

impl fmt::Display for MissingRows {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { field, nodes, without, partly } = self;
        write!(
            f,
            "{field}: of {nodes} nodes {without} have no row and {partly} lack one of their directions; they count as held there, which is \
             wrong of nodes that an equation or a tie moves"
        )
    }
}

/// The numbers of nodes in words.
pub(super) fn listed(nodes: &[i64]) -> String {
    match (nodes.iter().min(), nodes.iter().max()) {
        (Some(first), Some(last)) if first < last => format!("{} nodes from {first} to {last}", nodes.len()),
        (Some(only), _) => format!("node {only}"),
        _ => "no nodes".to_owned(),
    }
}
