//! Types of elements: how many nodes they list and how they are drawn.

use crate::mesh::CellKind;

/// A type of elements: nodes and shape, as far as they are known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ElementType {
    /// Number of nodes that an element lists, where that is known.
    pub nodes: Option<usize>,
    /// An element may list more than `nodes`, such as a node for the direction of a beam.
    pub may_have_more: bool,
    /// Shape, and the indices, among the nodes that an element lists, of the corners of that shape.
    pub shape: Option<(CellKind, &'static [usize])>,
}

/// Corners of a hexahedron by its nodes.
const HEXAHEDRON: &[usize] = &[0, 1, 2, 3, 4, 5, 6, 7];
/// Corners of a prism by its nodes: a hexahedron of which two pairs of corners coincide.
const PRISM: &[usize] = &[0, 1, 2, 2, 3, 4, 5, 5];
/// Corners of a pyramid by its nodes: a hexahedron of which four corners coincide.
const PYRAMID: &[usize] = &[0, 1, 2, 3, 4, 4, 4, 4];

/// Letters before the number of nodes in the names of solid elements.
const SOLIDS: [&str; 7] = ["C3D", "DC3D", "DCC3D", "AC3D", "F3D", "COH3D", "SC"];
/// Letters before the number of nodes in the names of flat elements, in a plane or on a surface.
const FLAT: [&str; 16] = [
    "STRI", "S", "DS", "M3D", "SFM3D", "R3D", "CPS", "CPE", "CPEG", "CAX", "DC2D", "AC2D", "DCAX", "ACAX", "F2D",
    "DSAX",
];

impl ElementType {
    const UNKNOWN: Self = Self { nodes: None, may_have_more: false, shape: None };

    /// The type of a name in capitals.
    pub fn new(name: &str) -> Self {
        let (before, rest) = match name.strip_prefix("STRI") {
            // STRI3 and STRI65, which has six nodes.
            Some(rest) => ("STRI", rest),
            None => {
                // The last number is that of the nodes: C3D20R, S8R5 and SFM3D4R.
                let known = SOLIDS.iter().chain(&FLAT).filter(|known| name.starts_with(**known));
                match known.max_by_key(|known| known.len()) {
                    Some(known) => (*known, &name[known.len()..]),
                    None => (name, ""),
                }
            }
        };
        let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
        let number: Option<usize> = rest[..digits].parse().ok();
        let of_solid = SOLIDS.contains(&before);
        let with = |nodes: usize, kind: CellKind, corners: &'static [usize]| Self {
            nodes: Some(nodes),
            may_have_more: false,
            shape: Some((kind, corners)),
        };
        match (number, of_solid) {
            (Some(4 | 10), true) => with(number.unwrap_or(4), CellKind::Tetrahedron, &HEXAHEDRON[..4]),
            (Some(5), true) => with(5, CellKind::Hexahedron, PYRAMID),
            // Of types with V the number of nodes differs from element to element.
            (Some(6), true) => with(6, CellKind::Hexahedron, PRISM),
            (Some(15), true) if !rest.contains('V') => with(15, CellKind::Hexahedron, PRISM),
            (Some(8 | 20), true) => with(number.unwrap_or(8), CellKind::Hexahedron, HEXAHEDRON),
            (Some(65), false) if before == "STRI" => with(6, CellKind::Triangle, &HEXAHEDRON[..3]),
            (Some(3 | 6), false) if before != name => with(number.unwrap_or(3), CellKind::Triangle, &HEXAHEDRON[..3]),
            (Some(4 | 8 | 9), false) if before != name => {
                with(number.unwrap_or(4), CellKind::Quadrilateral, &HEXAHEDRON[..4])
            }
            _ => Self::thin(name),
        }
    }

    /// The type of a line or a single node.
    fn thin(name: &str) -> Self {
        let (nodes, shape): (usize, Option<(CellKind, &'static [usize])>) = match name {
            "T3D2" | "T2D2" | "B31" | "B31H" | "B31R" | "B33" | "B33H" => (2, Some((CellKind::Line, &HEXAHEDRON[..2]))),
            "B21" | "B21H" | "B23" | "B23H" => (2, None),
            "B32" | "B32H" | "B32R" | "T3D3" | "T2D3" => (3, None),
            "MASS" | "ROTARYI" | "SPRING1" | "DASHPOT1" => (1, None),
            "SPRINGA" | "SPRING2" | "DASHPOTA" | "DASHPOT2" => (2, None),
            _ => return Self::UNKNOWN,
        };
        Self { nodes: Some(nodes), may_have_more: name.starts_with('B'), shape }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_nodes_and_shape() {
        use CellKind::{Hexahedron, Line, Quadrilateral, Tetrahedron, Triangle};
        for (name, nodes, kind) in [
            ("C3D8", 8, Some(Hexahedron)),
            ("C3D8RT", 8, Some(Hexahedron)),
            ("C3D20RH", 20, Some(Hexahedron)),
            ("C3D10HS", 10, Some(Tetrahedron)),
            ("C3D4", 4, Some(Tetrahedron)),
            ("C3D15", 15, Some(Hexahedron)),
            ("C3D6", 6, Some(Hexahedron)),
            ("C3D5", 5, Some(Hexahedron)),
            ("DC3D8", 8, Some(Hexahedron)),
            ("COH3D6", 6, Some(Hexahedron)),
            ("SC8R", 8, Some(Hexahedron)),
            ("S4RSW", 4, Some(Quadrilateral)),
            ("S8R5", 8, Some(Quadrilateral)),
            ("S9R5", 9, Some(Quadrilateral)),
            ("S6", 6, Some(Triangle)),
            ("STRI3", 3, Some(Triangle)),
            ("STRI65", 6, Some(Triangle)),
            ("SFM3D4R", 4, Some(Quadrilateral)),
            ("M3D9R", 9, Some(Quadrilateral)),
            ("R3D3", 3, Some(Triangle)),
            ("CPE6M", 6, Some(Triangle)),
            ("CPEG4", 4, Some(Quadrilateral)),
            ("B31", 2, Some(Line)),
            ("B32", 3, None),
            ("MASS", 1, None),
            ("SPRING2", 2, None),
        ] {
            let found = ElementType::new(name);
            assert_eq!((found.nodes, found.shape.map(|(kind, _)| kind)), (Some(nodes), kind), "{name}");
            assert!(found.shape.is_none_or(|(kind, corners)| corners.len() == kind.nodes()), "{name}");
        }
        for name in ["C3D15V", "C3D27", "CONN3D2", "U1", "SAX1", "SPRING", "Z12", "", "S", "GAPUNI", "DCOUP3D", "RB3D2"]
        {
            assert_eq!(ElementType::new(name), ElementType::UNKNOWN, "{name}");
        }
    }
}
