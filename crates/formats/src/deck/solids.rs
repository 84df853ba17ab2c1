//! Solid elements with all their nodes, and surfaces as a deck defines them: for whoever integrates over them.

use super::keyword::{Keyword, set_name, split};
use crate::problem::Problem;

/// Solid element of a deck, a cohesive one and a shell with thickness as well: its type with all nodes, where [`crate::Mesh`] has the corners alone.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Solid {
    /// Number of the element.
    pub label: i64,
    /// Type of the element in capitals, such as `C3D20R`.
    pub of_type: String,
    /// Numbers of the nodes, in the order of the deck.
    pub nodes: Vec<i64>,
}

/// Surface of a deck, as `*SURFACE` defines it.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SurfaceSet {
    /// True for a surface of nodes, `TYPE=NODE`; else it is of faces of elements.
    pub of_nodes: bool,
    /// Lines of the surface: the number of an element or node, or the name of a set, and the face as it is written in capitals (`S3`), empty where
    /// the line has no face.
    pub lines: Vec<(String, String)>,
    /// Parameters that change the surface and are not read, such as `COMBINE`.
    pub unread: Vec<String>,
}

/// The parameters of `*SURFACE` that are read, or change no face.
const KNOWN: [&str; 6] = ["NAME", "TYPE", "INTERNAL", "REGIONTYPE", "NOTHICK", "NOOFFSET"];

impl SurfaceSet {
    /// The name and an empty surface of a keyword line; `None` of a line without a name, which other programs take for other things.
    pub(super) fn of_keyword(keyword: &Keyword) -> Option<(String, Self)> {
        let name = set_name(keyword.option("NAME")?).ok()?;
        let of_type = keyword.option("TYPE").unwrap_or("ELEMENT").to_ascii_uppercase();
        let mut unread: Vec<String> = keyword.options().filter(|key| !KNOWN.contains(key)).map(str::to_owned).collect();
        if of_type != "ELEMENT" && of_type != "NODE" {
            unread.push(format!("TYPE={of_type}"));
        }
        Some((name, Self { of_nodes: of_type == "NODE", lines: Vec::new(), unread }))
    }

    /// Adds a line. What is wrong with it is said where the surface is used.
    pub(super) fn add(&mut self, line: &str) {
        let mut fields = split(line).into_iter().map(str::trim);
        let what = fields.next().unwrap_or_default();
        let face = fields.next().unwrap_or_default().to_ascii_uppercase();
        if !what.is_empty() {
            let name = if what.parse::<i64>().is_ok() { Ok(what.to_owned()) } else { set_name(what) };
            self.lines.push((name.unwrap_or_else(|_: Problem| what.to_owned()), face));
        }
    }
}
