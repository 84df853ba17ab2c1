//! Nodes, elements and node sets of an input deck of Abaqus or CalculiX (`.inp`).
//!
//! Read are `*NODE`, `*ELEMENT`, `*NSET`, `*ELSET`, `*SURFACE`, `*SYSTEM` and `*INCLUDE`, and of `*BOUNDARY` what it fixes. Keywords that are known to change
//! nothing of this are passed over; all others are refused, so that no node is elsewhere, no set another, and no direction a local one unnoticed. Decks
//! with parts and instances have other node numbers than the exported matrices, and are refused too.

mod boundary;
mod element;
mod frame;
mod keyword;
mod sets;
mod solids;

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::Path;

use self::element::ElementType;
use self::frame::{Coordinates, Frame};
use self::keyword::{Keyword, set_name, split};
use self::sets::{Elements, Range};
pub use self::solids::{Solid, SurfaceSet};
use crate::dof::Dof;
use crate::error::FormatsError;
use crate::limits::Limits;
use crate::lines::Lines;
use crate::mesh::{Cell, Mesh, Node};
use crate::numbers::{fortran, signed};
use crate::problem::Problem;
use crate::source::{Contents, open};

/// Files that may include each other, one within the other; chosen: more are a ring.
const MOST_INCLUDED: usize = 10;

/// A mesh, and its sets of nodes by their names: in capitals and without blanks, but for those in double quotes, which are as they are
/// written.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Deck {
    /// Nodes and elements. Of elements of higher order the corners are kept; prisms and pyramids are hexahedra of which corners coincide.
    pub mesh: Mesh,
    /// Numbers of the nodes of each set, ascending.
    pub sets: BTreeMap<String, Vec<i64>>,
    /// Solid elements (types that begin with `C3D`) with all their nodes.
    pub solids: Vec<Solid>,
    /// Numbers of the elements of each set, ascending; of sets that are made of unknown ones, what is known.
    pub element_sets: BTreeMap<String, Vec<i64>>,
    /// Surfaces, as they are written.
    pub surfaces: BTreeMap<String, SurfaceSet>,
    /// Displacements, directions 1 to 3, that any `*BOUNDARY` fixes.
    pub held: BTreeSet<Dof>,
}

/// Reads the nodes, elements and node sets of an input deck, compressed by gzip or not, with the files that it includes, by their paths
/// from its folder.
///
/// # Errors
/// A file that cannot be read or is not a regular one; a fault at a line: a keyword that changes nodes, elements or sets and is not read,
/// a node or an element twice, an element of an unknown node, a set of an unknown node or set, a number that cannot be read.
pub fn read_deck(path: &Path, limits: &Limits) -> Result<Deck, FormatsError> {
    let mut reading = Reading {
        limits: limits.bounded(),
        deck: Deck::default(),
        places: HashMap::new(),
        elements: Elements::default(),
        frame: Frame::GLOBAL,
        is_in_step: false,
        is_deck: false,
        block: Block::Other,
    };
    reading.file(path, path.parent().unwrap_or(Path::new("")), 0)?;
    Ok(reading.deck)
}

/// Contents of the data lines after a keyword.
enum Block {
    Nodes {
        set: Option<String>,
        coordinates: Coordinates,
    },
    /// Elements, of which the numbers of one may take several lines.
    Elements {
        of: ElementType,
        name: String,
        set: Option<String>,
        pending: Vec<i64>,
    },
    NodeSet {
        name: String,
        is_generated: bool,
    },
    ElementSet {
        name: String,
        is_generated: bool,
    },
    System {
        lines: Vec<Vec<f64>>,
    },
    Surface {
        name: String,
    },
    Boundary,
    Other,
}

struct Reading {
    limits: Limits,
    deck: Deck,
    /// Index of each node in the mesh, by its number.
    places: HashMap<i64, usize>,
    elements: Elements,
    /// The system in which nodes are given.
    frame: Frame,
    is_in_step: bool,
    /// A keyword was met.
    is_deck: bool,
    block: Block,
}

impl Reading {
    /// Reads a file in place of the line that includes it.
    fn file(&mut self, path: &Path, folder: &Path, depth: usize) -> Result<(), FormatsError> {
        let (file, size) = open(path)?;
        let mut lines = Lines::new(Contents::new(file, size, &self.limits, None)?.whole());
        loop {
            let included = match self.next(&mut lines, depth) {
                Ok(Next::End) => return Ok(()),
                Ok(Next::Line) => continue,
                Ok(Next::Include(file)) => file,
                Err(problem) => return Err(lines.located(problem)),
            };
            self.file(&folder.join(&included), folder, depth + 1).map_err(|source| FormatsError::Included {
                file: crate::shortened::cut(&included),
                source: Box::new(source),
            })?;
        }
    }

    fn next(&mut self, lines: &mut Lines<'_>, depth: usize) -> Result<Next, Problem> {
        let Some(line) = lines.next_but("**")? else {
            if depth == 0 {
                self.end()?;
            }
            return Ok(Next::End);
        };
        if !line.starts_with('*') {
            if !self.is_deck {
                let allowed = "a keyword such as *NODE";
                return Err(Problem::Keyword { what: "line", found: crate::shortened::cut(line), allowed });
            }
            self.data(line)?;
            return Ok(Next::Line);
        }
        let keyword = Keyword::new(&continued(lines)?);
        self.is_deck = true;
        if keyword.name == "INCLUDE" {
            keyword.has_only(&["INPUT"], "*INCLUDE, INPUT=file")?;
            return included(&keyword, "*INCLUDE, INPUT=file", depth);
        }
        self.end_of_block()?;
        self.block = self.keyword(&keyword)?;
        match keyword.option("INPUT") {
            Some(_) if !matches!(self.block, Block::Other | Block::Boundary) => included(&keyword, "INPUT=file", depth),
            _ => Ok(Next::Line),
        }
    }

    fn end(&mut self) -> Result<(), Problem> {
        self.end_of_block()?;
        if self.deck.mesh.nodes.is_empty() {
            return Err(Problem::End { what: "a block *NODE" });
        }
        for nodes in self.deck.sets.values_mut() {
            nodes.sort_unstable();
            nodes.dedup();
        }
        self.deck.element_sets = std::mem::take(&mut self.elements).into_sets();
        Ok(())
    }

    fn keyword(&mut self, keyword: &Keyword) -> Result<Block, Problem> {
        Ok(match keyword.name.as_str() {
            "NODE" => {
                keyword.has_only(&["NSET", "SYSTEM", "INPUT"], "*NODE with NSET, SYSTEM=R or C, and INPUT")?;
                let coordinates = match keyword.option("SYSTEM").map(str::to_ascii_uppercase).as_deref() {
                    None | Some("R") => Coordinates::Rectangular,
                    Some("C") if self.frame == Frame::GLOBAL => Coordinates::Cylindrical,
                    Some("C") => return Err(keyword.refused("SYSTEM=C without *SYSTEM, or *SYSTEM with SYSTEM=R")),
                    Some(_) => return Err(keyword.refused("SYSTEM=R or SYSTEM=C")),
                };
                Block::Nodes { set: keyword.set("NSET")?, coordinates }
            }
            "ELEMENT" => {
                let allowed = "*ELEMENT, TYPE=type, with ELSET and INPUT";
                // An offset is one of numbers of harmonics, and the numbering of a solid has no part in its shape.
                keyword.has_only(&["TYPE", "ELSET", "INPUT", "OFFSET", "SOLIDELEMENTNUMBERING"], allowed)?;
                let name = keyword.option("TYPE").unwrap_or_default().trim_matches('"').to_ascii_uppercase();
                if name.is_empty() {
                    return Err(keyword.refused(allowed));
                }
                let set = keyword.set("ELSET")?;
                Block::Elements { of: ElementType::new(&name), name, set, pending: Vec::new() }
            }
            "NSET" => {
                let allowed = "*NSET, NSET=name, with GENERATE or ELSET=name";
                keyword.has_only(&["NSET", "ELSET", "GENERATE", "UNSORTED", "INTERNAL"], allowed)?;
                let name = keyword.set("NSET")?.ok_or_else(|| keyword.refused(allowed))?;
                if let Some(elements) = keyword.set("ELSET")? {
                    let members = self.elements.nodes_of(&elements, &self.deck.mesh)?;
                    sets::add(self.deck.sets.entry(name).or_default(), members, self.places.len());
                    return Ok(Block::Other);
                }
                Block::NodeSet { name, is_generated: keyword.option("GENERATE").is_some() }
            }
            "ELSET" => {
                let allowed = "*ELSET, ELSET=name, with GENERATE";
                keyword.has_only(&["ELSET", "GENERATE", "UNSORTED", "INTERNAL"], allowed)?;
                let name = keyword.set("ELSET")?.ok_or_else(|| keyword.refused(allowed))?;
                Block::ElementSet { name, is_generated: keyword.option("GENERATE").is_some() }
            }
            "SYSTEM" => {
                keyword.has_only(&[], "*SYSTEM without parameters")?;
                Block::System { lines: Vec::new() }
            }
            "SURFACE" => match SurfaceSet::of_keyword(keyword) {
                Some((name, surface)) => {
                    self.deck.surfaces.insert(name.clone(), surface);
                    Block::Surface { name }
                }
                None => Block::Other,
            },
            "BOUNDARY" => Block::Boundary,
            "STEP" => {
                self.is_in_step = true;
                Block::Other
            }
            "ENDSTEP" => {
                self.is_in_step = false;
                Block::Other
            }
            _ => {
                keyword.check_harmless(self.is_in_step)?;
                Block::Other
            }
        })
    }

    fn data(&mut self, line: &str) -> Result<(), Problem> {
        let all = || split(line).into_iter().map(str::trim);
        let fields = || all().filter(|field| !field.is_empty());
        let Self { deck, places, limits, elements, frame, block, .. } = self;
        match block {
            Block::Other => Ok(()),
            Block::Boundary => {
                boundary::add(&mut deck.held, &all().collect::<Vec<_>>(), places, &deck.sets);
                Ok(())
            }
            Block::Surface { name } => {
                deck.surfaces.entry(name.clone()).or_default().add(line);
                Ok(())
            }
            Block::System { lines } => {
                // A missing number between commas is 0, as everywhere.
                let number = |field: &str| if field.is_empty() { Ok(0.0) } else { fortran(field) };
                let line = line.trim().trim_end_matches(',');
                lines.push(split(line).into_iter().map(|field| number(field.trim())).collect::<Result<_, _>>()?);
                Ok(())
            }
            Block::Nodes { set, coordinates } => {
                /// Most fields of a node: its number, three coordinates and three numbers of a normal.
                const MOST_FIELDS: usize = 7;
                let given: Vec<&str> = all().collect();
                let label = signed("number of the node", given.first().copied().unwrap_or_default())?;
                if given.iter().rposition(|field| !field.is_empty()).is_some_and(|last| last >= MOST_FIELDS) {
                    let allowed = "its number and three coordinates, perhaps with a normal";
                    return Err(Problem::Fields { what: "a node", found: given.len(), allowed });
                }
                let mut local = [0.0; 3];
                for (coordinate, field) in local.iter_mut().zip(&given[1..]) {
                    if !field.is_empty() {
                        *coordinate = fortran(field)?;
                    }
                }
                let position = frame.global(coordinates.rectangular(local));
                if position.iter().any(|x| !x.is_finite()) {
                    return Err(Problem::field("node", label, "coordinates whose sums are finite numbers"));
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
            Block::Elements { of, name, set, pending } => {
                for field in fields() {
                    pending.push(signed("number of a node", field)?);
                }
                let Some(nodes) = of.nodes else {
                    // Where nobody knows how many nodes there are, a comma at the end says that there are more.
                    if !line.ends_with(',')
                        && let Some(&element) = pending.first()
                    {
                        elements.add_unknown(element, name, set.as_deref());
                        pending.clear();
                    }
                    return Ok(());
                };
                if pending.len() <= nodes {
                    return Ok(());
                }
                if pending.len() > nodes + 1 && !of.may_have_more {
                    let allowed = "its number and the nodes of its type";
                    return Err(Problem::Fields { what: "an element", found: pending.len(), allowed });
                }
                let place = |label: &i64| {
                    places
                        .get(label)
                        .copied()
                        .ok_or_else(|| Problem::field("node", *label, "a node that is defined above"))
                };
                let places = pending[1..].iter().map(place).collect::<Result<Vec<usize>, _>>()?;
                if let Some((kind, corners)) = of.shape {
                    let nodes = corners.iter().map(|&corner| places[corner]).collect();
                    deck.mesh.cells.push(Cell { kind, nodes });
                }
                elements.add(pending[0], &places, set.as_deref())?;
                if ["C3D", "COH3D", "SC"].iter().any(|solid| name.starts_with(solid)) {
                    let nodes = pending[1..].to_vec();
                    deck.solids.push(Solid { label: pending[0], of_type: name.clone(), nodes });
                }
                pending.clear();
                Ok(())
            }
            Block::NodeSet { name, is_generated: true } => {
                // Numbers without a node are passed over, as the programs do; nodes are fewer than a range may be long.
                let range = Range::new(fields())?;
                let members: Vec<i64> = places.keys().copied().filter(|label| range.has(*label)).collect();
                sets::add(deck.sets.entry(name.clone()).or_default(), members, places.len());
                Ok(())
            }
            Block::NodeSet { name, is_generated: false } => {
                for field in fields() {
                    let members = match field.parse::<i64>() {
                        Ok(label) if places.contains_key(&label) => vec![label],
                        Ok(label) => return Err(Problem::field("node", label, "a node that is defined above")),
                        Err(_) => deck.sets.get(&set_name(field)?).cloned().ok_or_else(|| {
                            Problem::field("node set", crate::shortened::cut(field), "a set that is defined above")
                        })?,
                    };
                    sets::add(deck.sets.entry(name.clone()).or_default(), members, places.len());
                }
                Ok(())
            }
            Block::ElementSet { name, is_generated: true } => {
                elements.add_range(name, &Range::new(fields())?);
                Ok(())
            }
            Block::ElementSet { name, is_generated: false } => {
                fields().try_for_each(|field| elements.add_member(name, field))
            }
        }
    }

    /// Ends a block: an element with fewer nodes than its type has is a fault; a local system begins.
    fn end_of_block(&mut self) -> Result<(), Problem> {
        match &self.block {
            Block::Elements { of: ElementType { nodes: Some(nodes), .. }, pending, .. } if !pending.is_empty() => {
                Err(Problem::Fields {
                    what: "an element",
                    found: pending.len() - 1,
                    allowed: if *nodes == 8 {
                        "its number and 8 nodes"
                    } else {
                        "its number and the nodes of its type"
                    },
                })
            }
            Block::System { lines } => {
                self.frame = Frame::of_points(lines)?;
                Ok(())
            }
            _ => Ok(()),
        }
    }
}

/// Continuation after a line: the next line, another file, or the end.
enum Next {
    Line,
    /// A file, by its path from the folder of the deck.
    Include(String),
    End,
}

fn included(keyword: &Keyword, allowed: &'static str, depth: usize) -> Result<Next, Problem> {
    let file = keyword.option("INPUT").unwrap_or_default().trim_matches('"');
    match (file.is_empty(), depth < MOST_INCLUDED) {
        (false, true) => Ok(Next::Include(file.to_owned())),
        (true, _) => Err(keyword.refused(allowed)),
        (_, false) => Err(keyword.refused("files that include each other 10 deep at most")),
    }
}

/// The keyword line that was read last, with the lines after it as long as there is a comma at the end. One that begins with a number is
/// data: no parameter does.
fn continued(lines: &mut Lines<'_>) -> Result<String, Problem> {
    let mut line = lines.current().trim().to_owned();
    while line.ends_with(',') {
        match lines.next_but("**")? {
            None => break,
            Some(next)
                if next.starts_with('*') || next.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) =>
            {
                lines.push_back();
                break;
            }
            Some(next) => line += next,
        }
    }
    Ok(line)
}

#[cfg(test)]
mod tests;
