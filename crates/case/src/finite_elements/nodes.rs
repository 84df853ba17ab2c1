//! Nodes, node sets and degrees of freedom by the names that a case gives them.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use formats::{Dof, Mesh, Solid, SurfaceSet};

use super::missing::{MissingRows, listed};
use crate::CaseError;
use crate::check::Check;

/// Most names that a message lists; chosen, so that the message stays short.
const MOST_NAMES_LISTED: usize = 12;

/// The nodes of a model: where they are, in which sets, and their rows in the matrices.
pub(super) struct Model<'a> {
    pub check: &'a Check<'a>,
    pub mesh: Option<Mesh>,
    pub sets: BTreeMap<String, Vec<i64>>,
    pub dofs: Vec<Dof>,
    /// Solid elements of the mesh with all their nodes, sets of elements, and surfaces.
    pub solids: Vec<Solid>,
    pub element_sets: BTreeMap<String, Vec<i64>>,
    pub surfaces: BTreeMap<String, SurfaceSet>,
    /// Displacements that the deck holds.
    pub held: BTreeSet<Dof>,
    rows: HashMap<Dof, usize>,
    positions: HashMap<i64, [f64; 3]>,
}

impl<'a> Model<'a> {
    pub fn new(check: &'a Check<'a>, deck: Option<formats::Deck>, dofs: Vec<Dof>) -> Self {
        let has_mesh = deck.is_some();
        let formats::Deck { mesh, sets, solids, element_sets, surfaces, held } = deck.unwrap_or_default();
        let mesh = has_mesh.then_some(mesh);
        let rows = dofs.iter().copied().zip(0..).collect();
        let nodes = mesh.iter().flat_map(|mesh| &mesh.nodes);
        let positions = nodes.map(|node| (node.label, node.position)).collect();
        Self { check, mesh, sets, dofs, solids, element_sets, surfaces, held, rows, positions }
    }

    /// The row of a node in a direction (1 to 3); `None` where the model holds it.
    pub fn row(&self, node: i64, direction: u32) -> Option<usize> {
        self.rows.get(&Dof { node, direction }).copied()
    }

    /// Position (x, y, z) of a node, in the unit of the mesh.
    pub fn position(&self, field: &str, node: i64) -> Result<[f64; 3], CaseError> {
        let unknown = || self.check.value(field, node, "a node of the mesh, which brake.mesh names");
        self.positions.get(&node).copied().ok_or_else(unknown)
    }

    /// The nodes of sets and numbers, each once, ascending.
    pub fn nodes(&self, field: &str, items: &[String]) -> Result<Vec<i64>, CaseError> {
        let mut all = Vec::new();
        for item in items {
            all.extend(self.set_or_node(field, item)?);
        }
        all.sort_unstable();
        all.dedup();
        if all.is_empty() {
            return Err(self.check.value(field, "[]", "one node or more"));
        }
        Ok(all)
    }

    /// Names of the first rows, as examples in messages.
    pub fn some_rows(&self) -> String {
        let named: Vec<String> = self.dofs.iter().filter(|dof| dof.direction > 0).take(3).map(Dof::to_string).collect();
        if named.is_empty() { "no names".to_owned() } else { format!("{}, ...", named.join(", ")) }
    }

    /// The nodes of a set: by its name as it is written, else in capitals without blanks as decks have it, else the only one that has it in
    /// other letters.
    pub fn set(&self, item: &str) -> Option<&Vec<i64>> {
        let plain = item.split_whitespace().collect::<String>().to_ascii_uppercase();
        let exact = self.sets.get(item).or_else(|| self.sets.get(&plain));
        let mut alike = self.sets.iter().filter(|(name, _)| name.eq_ignore_ascii_case(item)).map(|(_, nodes)| nodes);
        exact.or_else(|| alike.next().filter(|_| alike.next().is_none()))
    }

    fn set_or_node(&self, field: &str, item: &str) -> Result<Vec<i64>, CaseError> {
        if let Some(nodes) = self.set(item) {
            return Ok(nodes.clone());
        }
        let node = item.parse::<i64>().ok();
        let is_known = |node: &i64| self.positions.contains_key(node) || self.dofs.iter().any(|dof| dof.node == *node);
        node.filter(is_known).map(|node| vec![node]).ok_or_else(|| {
            let names: Vec<&str> = self.sets.keys().map(String::as_str).take(MOST_NAMES_LISTED).collect();
            let more = if self.sets.len() > MOST_NAMES_LISTED { ", ..." } else { "" };
            let allowed = format!("the number of a node, or a node set of the mesh: {}{more}", names.join(", "));
            self.check.value(field, format!("{item:?}"), &allowed)
        })
    }

    /// The rows of `SET`, `SET.z`, `1042` and `1042.z`, each once, ascending. Rows that the model holds anyway are left out, and counted.
    pub fn rows(&self, field: &str, items: &[String]) -> Result<(Vec<usize>, Vec<MissingRows>), CaseError> {
        let (mut all, mut missing) = (Vec::new(), Vec::new());
        for item in items {
            let (name, direction) = match item.rsplit_once('.') {
                // A name in quotes may have a point.
                _ if self.set(item).is_some() => (item.as_str(), None),
                None => (item.as_str(), None),
                Some((name, direction)) => {
                    let dof = format!("0.{direction}").parse::<Dof>();
                    let refused = |_| {
                        let allowed = "SET, SET.z, 1042 or 1042.z, with x, y, z, rx, ry or rz";
                        self.check.value(field, format!("{item:?}"), allowed)
                    };
                    (name, Some(dof.map_err(refused)?.direction))
                }
            };
            let nodes = self.set_or_node(field, name)?;
            let is_meant = |dof: &Dof| direction.is_none_or(|d| d == dof.direction) && nodes.contains(&dof.node);
            let before = all.len();
            all.extend((0..self.dofs.len()).filter(|&row| is_meant(&self.dofs[row])));
            if all.len() == before {
                return Err(self.check.value(field, format!("{item:?}"), "a degree of freedom that the matrices have"));
            }
            let with_rows: HashSet<i64> = all[before..].iter().map(|&row: &usize| self.dofs[row].node).collect();
            if with_rows.len() < nodes.len() {
                let (field, without) = (format!("{field} {item:?}"), nodes.len() - with_rows.len());
                missing.push(MissingRows { field, nodes: nodes.len(), without, partly: 0 });
            }
        }
        all.sort_unstable();
        all.dedup();
        Ok((all, missing))
    }

    /// The nodes of a field that lack rows in some of these directions (1 to 6); `None` where none does.
    ///
    /// # Errors
    /// No node has a row: a body that the matrices do not have would be ground without a word.
    pub fn missing_rows(
        &self,
        field: &str,
        nodes: &[i64],
        directions: &[u32],
    ) -> Result<Option<MissingRows>, CaseError> {
        let rows = |node: i64| directions.iter().filter(|&&direction| self.row(node, direction).is_some()).count();
        let without = nodes.iter().filter(|&&node| rows(node) == 0).count();
        let partly = nodes.iter().filter(|&&node| (1..directions.len()).contains(&rows(node))).count();
        if without == nodes.len() {
            let found = format!("{}, of which the matrices have no row", listed(nodes));
            let allowed = format!("nodes with rows in the matrices, as {}", self.some_rows());
            return Err(self.check.value(field, found, &allowed));
        }
        let missing = MissingRows { field: field.to_owned(), nodes: nodes.len(), without, partly };
        Ok((without + partly > 0).then_some(missing))
    }
}
