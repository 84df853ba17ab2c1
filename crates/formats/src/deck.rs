//! Nodes, elements and node sets of an input deck of Abaqus or CalculiX (`.inp`).
//!
//! Read are `*NODE`, `*ELEMENT`, `*NSET` and the sets that `NSET=` of `*NODE` makes; all other keywords are passed over. Decks
//! with parts and instances have node numbers that are not those of the exported matrices, and are refused.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use crate::error::FormatsError;
use crate::limits::Limits;
use crate::lines::Lines;
use crate::mesh::{Cell, CellKind, Mesh, Node};
use crate::numbers::{fortran, signed};
use crate::problem::Problem;
use crate::source::{Contents, open};

/// A mesh, and its sets of nodes by their names in capitals.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Deck {
    /// Nodes and elements. Of elements of higher order the corners are kept.
    pub mesh: Mesh,
    /// Numbers of the nodes of each set, ascending.
    pub sets: BTreeMap<String, Vec<i64>>,
}

/// Reads the nodes, elements and node sets of an input deck, compressed by gzip or not.
///
/// # Errors
/// A file that cannot be read or is not a regular one; a fault at a line: a node twice, an element of an unknown node, a set of
/// an unknown node or set, a number that is none.
pub fn read_deck(path: &Path, limits: &Limits) -> Result<Deck, FormatsError> {
    let ((file, size), limits) = (open(path)?, limits.bounded());
    let mut lines = Lines::new(Contents::new(file, size, &limits, None)?.whole());
    let mut reading = Reading { limits, deck: Deck::default(), places: HashMap::new(), block: Block::Other };
    reading.all(&mut lines).map_err(|problem| lines.located(problem))?;
    Ok(reading.deck)
}

/// What the data lines after a keyword are.
enum Block {
    Nodes {
        set: Option<String>,
    },
    /// Elements of a kind, `nodes` numbers each, which may take several lines.
    Elements {
        kind: Option<CellKind>,
        nodes: usize,
        pending: Vec<i64>,
    },
    Set {
        name: String,
        is_generated: bool,
    },
    Other,
}

struct Reading {
    limits: Limits,
    deck: Deck,
    /// Place of each node in the mesh.
    places: HashMap<i64, usize>,
    block: Block,
}

impl Reading {
    fn all(&mut self, lines: &mut Lines<'_>) -> Result<(), Problem> {
        let mut is_deck = false;
        while let Some(line) = lines.next_but("**")? {
            if line.starts_with('*') {
                is_deck = true;
                self.end_of_block()?;
                self.block = self.keyword(line)?;
            } else if !is_deck {
                let allowed = "a keyword such as *NODE";
                return Err(Problem::Keyword { what: "line", found: crate::shortened::cut(line), allowed });
            } else {
                self.data(line)?;
            }
        }
        self.end_of_block()?;
        if self.deck.mesh.nodes.is_empty() {
            return Err(Problem::End { what: "a block *NODE" });
        }
        for nodes in self.deck.sets.values_mut() {
            nodes.sort_unstable();
            nodes.dedup();
        }
        Ok(())
    }

    fn keyword(&self, line: &str) -> Result<Block, Problem> {
        let mut parts = line.split(',').map(|part| part.trim().to_ascii_uppercase());
        let name = parts.next().unwrap_or_default();
        let options: Vec<(String, String)> = parts
            .map(|part| {
                let (key, value) = part.split_once('=').unwrap_or((&part, ""));
                (key.trim().to_owned(), value.trim().trim_matches('"').to_owned())
            })
            .collect();
        let option = |key: &str| options.iter().find(|(k, _)| k == key).map(|(_, value)| value.clone());
        Ok(match name.as_str() {
            "*NODE" => Block::Nodes { set: option("NSET") },
            "*ELEMENT" => {
                let element = option("TYPE").unwrap_or_default();
                let (kind, nodes) = element_kind(&element);
                Block::Elements { kind, nodes, pending: Vec::new() }
            }
            "*NSET" => Block::Set {
                name: option("NSET").ok_or(Problem::Keyword {
                    what: "keyword",
                    found: crate::shortened::cut(line),
                    allowed: "*NSET, NSET=name",
                })?,
                is_generated: option("GENERATE").is_some(),
            },
            "*PART" | "*INSTANCE" | "*INCLUDE" => {
                let allowed = "one flat deck, as CalculiX or Abaqus (NO PARTS INPUT FILE) writes it";
                return Err(Problem::Keyword { what: "keyword", found: crate::shortened::cut(line), allowed });
            }
            _ => Block::Other,
        })
    }

    fn data(&mut self, line: &str) -> Result<(), Problem> {
        let fields = || line.split(',').map(str::trim).filter(|field| !field.is_empty());
        let Self { deck, places, limits, block } = self;
        match block {
            Block::Other => Ok(()),
            Block::Nodes { set } => {
                let mut fields = fields();
                let label = signed("number of the node", fields.next().unwrap_or_default())?;
                let mut position = [0.0; 3];
                for (coordinate, field) in position.iter_mut().zip(&mut fields) {
                    *coordinate = fortran(field)?;
                }
                if places.insert(label, deck.mesh.nodes.len()).is_some() {
                    return Err(Problem::field("node", label, "each number once"));
                }
                if deck.mesh.nodes.len() >= limits.order {
                    return Err(Problem::field("node", label, "fewer nodes than the limit of rows"));
                }
                deck.mesh.nodes.push(Node { label, position });
                if let Some(set) = set {
                    deck.sets.entry(set.clone()).or_default().push(label);
                }
                Ok(())
            }
            Block::Elements { kind, nodes, pending } => {
                for field in fields() {
                    pending.push(signed("number of a node", field)?);
                }
                if pending.len() <= *nodes {
                    return Ok(());
                }
                let Some(kind) = *kind else {
                    pending.clear();
                    return Ok(());
                };
                let corners = &pending[1..=kind.nodes()];
                let place = |label: &i64| {
                    places
                        .get(label)
                        .copied()
                        .ok_or_else(|| Problem::field("node", *label, "a node that is defined above"))
                };
                let cell = Cell { kind, nodes: corners.iter().map(place).collect::<Result<_, _>>()? };
                deck.mesh.cells.push(cell);
                pending.clear();
                Ok(())
            }
            Block::Set { name, is_generated: true } => {
                let numbers = fields().map(|field| signed("number of a node", field)).collect::<Result<Vec<_>, _>>()?;
                let (first, last, step) = match numbers[..] {
                    [first, last] => (first, last, 1),
                    [first, last, step] if step > 0 => (first, last, step),
                    _ => {
                        let allowed = "first, last and, if not 1, step > 0";
                        return Err(Problem::Fields { what: "a range of nodes", found: numbers.len(), allowed });
                    }
                };
                // Numbers without a node are passed over, as the programs do; nodes are fewer than a range may be long.
                let is_multiple = |label: i64| (i128::from(label) - i128::from(first)) % i128::from(step) == 0;
                let is_member = |label: &i64| (first..=last).contains(label) && is_multiple(*label);
                let members: Vec<i64> = places.keys().copied().filter(is_member).collect();
                add_members(deck.sets.entry(name.clone()).or_default(), members, places.len());
                Ok(())
            }
            Block::Set { name, is_generated: false } => {
                for field in fields() {
                    let members = match field.parse::<i64>() {
                        Ok(label) if places.contains_key(&label) => vec![label],
                        Ok(label) => return Err(Problem::field("node", label, "a node that is defined above")),
                        Err(_) => deck.sets.get(&field.to_ascii_uppercase()).cloned().ok_or_else(|| {
                            Problem::field("node set", crate::shortened::cut(field), "a set that is defined above")
                        })?,
                    };
                    add_members(deck.sets.entry(name.clone()).or_default(), members, places.len());
                }
                Ok(())
            }
        }
    }

    /// An element whose nodes are fewer than its type has.
    fn end_of_block(&self) -> Result<(), Problem> {
        match &self.block {
            Block::Elements { kind: Some(_), nodes, pending } if !pending.is_empty() => Err(Problem::Fields {
                what: "an element",
                found: pending.len() - 1,
                allowed: if *nodes == 8 { "its number and 8 nodes" } else { "its number and the nodes of its type" },
            }),
            _ => Ok(()),
        }
    }
}

/// The shape of an element type and how many nodes its definition lists; no shape for a type that is not drawn.
fn element_kind(name: &str) -> (Option<CellKind>, usize) {
    match name {
        "C3D8" | "C3D8R" | "C3D8I" | "C3D8H" => (Some(CellKind::Hexahedron), 8),
        "C3D20" | "C3D20R" => (Some(CellKind::Hexahedron), 20),
        "C3D4" => (Some(CellKind::Tetrahedron), 4),
        "C3D10" | "C3D10M" => (Some(CellKind::Tetrahedron), 10),
        "S3" | "S3R" => (Some(CellKind::Triangle), 3),
        "S4" | "S4R" => (Some(CellKind::Quadrilateral), 4),
        "S8" | "S8R" => (Some(CellKind::Quadrilateral), 8),
        "B31" | "T3D2" => (Some(CellKind::Line), 2),
        _ => (None, 0),
    }
}

/// Adds members to a set. One with more members than there are nodes has some twice; they go, so that a set that is added to itself
/// again and again does not grow.
fn add_members(set: &mut Vec<i64>, members: Vec<i64>, nodes: usize) {
    set.extend(members);
    if set.len() > nodes {
        set.sort_unstable();
        set.dedup();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn deck(text: &str) -> Result<Deck, String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        read_deck(file.path(), &Limits::default()).map_err(|error| error.to_string())
    }

    const BRICK: &str = "** a brick\n*HEADING\nanything, 1\n*Node, nset=All\n 1, 0, 0, 0\n2,1.,0,0\n3,1,1D0,0\n4,0,1\n5,0,0,1\n\
                         6,1,0,1\n7,1,1,1\n8,0,1,1\n*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1,2,3,4,\n5,6,7,8\n*NSET,NSET=Bottom,GENERATE\n\
                         1,4,1\n*nset, nset=two\nBOTTOM, 7\n7\n*ELEMENT, TYPE=MASS\n9, 1\n*STEP\n*FREQUENCY\n10\n";

    #[test]
    fn nodes_elements_and_sets_are_read_and_the_rest_is_passed_over() {
        let found = deck(BRICK).unwrap();
        assert_eq!(found.mesh.nodes.len(), 8);
        assert_eq!(found.mesh.nodes[2].position, [1.0, 1.0, 0.0]);
        assert_eq!(found.mesh.cells, [Cell { kind: CellKind::Hexahedron, nodes: (0..8).collect() }]);
        assert_eq!(found.sets["BOTTOM"], [1, 2, 3, 4]);
        assert_eq!(found.sets["TWO"], [1, 2, 3, 4, 7]);
        assert_eq!(found.sets["ALL"].len(), 8);
    }

    #[test]
    fn quadratic_elements_have_the_surface_of_their_corners() {
        // Two bricks, one on the other. The nodes within edges, 101 to 132, are all at one place: only their number counts here.
        let mut text = "*NODE\n".to_owned();
        for layer in 0..3 {
            for (corner, [x, y]) in [[0, 0], [1, 0], [1, 1], [0, 1]].iter().enumerate() {
                text += &format!("{}, {x}, {y}, {layer}\n", 4 * layer + corner + 1);
            }
        }
        text += &(101..=132).map(|label| format!("{label}, 5, 5, 5\n")).collect::<String>();
        let within = |labels: std::ops::Range<i32>| labels.map(|label| format!(", {label}")).collect::<String>();
        text += "*ELEMENT, TYPE=C3D20R\n";
        text += &format!("1, 1,2,3,4,5,6,7,8{},\n{}\n", within(101..106), &within(106..113)[2..]);
        text += &format!("2, 5,6,7,8,9,10,11,12{},\n{}\n", within(105..110), &within(126..133)[2..]);
        let surface = crate::Surface::new(&deck(&text).unwrap().mesh);
        assert_eq!((surface.faces.len(), surface.nodes), (10, (0..12).collect()));
        let ten = format!("*ELEMENT, TYPE=C3D10\n3, 1,2,4,5{}\n", within(101..107));
        let text = format!("{}{ten}", &text[..text.find("*ELEMENT").unwrap()]);
        let surface = crate::Surface::new(&deck(&text).unwrap().mesh);
        assert_eq!((surface.faces.len(), surface.nodes), (4, vec![0, 1, 3, 4]));
    }

    #[test]
    fn ranges_and_sets_of_any_size_take_no_more_than_the_nodes() {
        let nodes = "*NODE\n1, 0\n9223372036854775807, 1\n-9223372036854775808, 2\n";
        let range = "*NSET, NSET=R, GENERATE\n-9223372036854775808, 9223372036854775807, 3\n";
        assert_eq!(deck(&format!("{nodes}{range}")).unwrap().sets["R"], [i64::MIN, 1, i64::MAX]);
        // Each line would double the set.
        let again = "*NSET, NSET=A\nA, A\n".repeat(60);
        assert_eq!(deck(&format!("{nodes}*NSET, NSET=A\n1\n{again}")).unwrap().sets["A"], [1]);
    }

    #[test]
    fn faults_are_named_with_their_line() {
        for (text, expected) in [
            ("1, 2\n", "line 1: line \"1, 2\" is not supported; allowed: a keyword such as *NODE"),
            ("*NODE\n1, 0, 0, 0\n1, 0, 0, 0\n", "line 3"),
            ("*NODE\n1, x, 0, 0\n", "line 2"),
            ("*NODE\n1, 0\n*ELEMENT, TYPE=C3D8\n1, 1, 2, 3, 4, 5, 6, 7, 8\n", "line 4"),
            ("*NODE\n1, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 1\n*STEP\n", "line 5"),
            ("*NODE\n1, 0\n*NSET, NSET=A\nB\n", "line 4"),
            ("*NODE\n1, 0\n*NSET, NSET=A, GENERATE\n1, 2, 0\n", "line 4"),
            ("*NODE\n1, 0\n*PART, NAME=P\n", "line 3"),
            ("*STEP\n", "line 1"),
        ] {
            let found = deck(text).unwrap_err();
            assert!(found.starts_with(expected), "{text:?}: {found}");
        }
    }
}
