//! Kinds of solid elements: their nodes, and where these are in coordinates of their own.

/// Kind of a solid element, with the order of nodes of Abaqus and CalculiX: corners first, then the middles of edges.
///
/// Own coordinates are `r, s, t`: of a tetrahedron from its first corner, each >= 0 with a sum <= 1; of a wedge r and s likewise and t from
/// -1 to 1; of a hexahedron all from -1 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// C3D4.
    Tetrahedron4,
    /// C3D10.
    Tetrahedron10,
    /// C3D6.
    Wedge6,
    /// C3D15.
    Wedge15,
    /// C3D8, C3D8R and C3D8I.
    Hexahedron8,
    /// C3D20 and C3D20R.
    Hexahedron20,
}

/// Nodes of the largest element.
pub(crate) const MOST_NODES: usize = 20;

/// Edges of a tetrahedron by their corners, in the order of the nodes in their middles.
const TETRAHEDRON: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];
/// Edges of a wedge, likewise.
const WEDGE: [[usize; 2]; 9] = [[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]];
/// Edges of a hexahedron, likewise.
const HEXAHEDRON: [[usize; 2]; 12] =
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];

impl Kind {
    /// Kinds, all of them.
    pub const ALL: [Self; 6] =
        [Self::Tetrahedron4, Self::Tetrahedron10, Self::Wedge6, Self::Wedge15, Self::Hexahedron8, Self::Hexahedron20];

    /// The kind of a type of Abaqus or CalculiX, such as `C3D20R`: what stands after the number of nodes (reduced integration, hybrid,
    /// incompatible modes) changes no node. `None` of what is no solid of this crate, such as `C3D27` or `C3D15V`, whose nodes vary.
    ///
    /// ```
    /// use elements::Kind;
    /// assert_eq!(Kind::of_type("C3D8I"), Some(Kind::Hexahedron8));
    /// assert_eq!(Kind::of_type("C3D10MT"), Some(Kind::Tetrahedron10));
    /// assert_eq!(Kind::of_type("S4R"), None);
    /// ```
    #[must_use]
    pub fn of_type(name: &str) -> Option<Self> {
        let name = name.trim().to_ascii_uppercase();
        let rest = name.strip_prefix("C3D")?;
        let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
        let (number, letters) = rest.split_at(digits);
        if letters.contains('V') {
            return None;
        }
        Self::ALL.into_iter().find(|kind| number == kind.nodes().to_string())
    }

    /// Number of nodes.
    #[must_use]
    pub fn nodes(self) -> usize {
        match self {
            Self::Tetrahedron4 => 4,
            Self::Tetrahedron10 => 10,
            Self::Wedge6 => 6,
            Self::Wedge15 => 15,
            Self::Hexahedron8 => 8,
            Self::Hexahedron20 => 20,
        }
    }

    /// Number of corners, which are its first nodes.
    #[must_use]
    pub fn corners(self) -> usize {
        match self {
            Self::Tetrahedron4 | Self::Tetrahedron10 => 4,
            Self::Wedge6 | Self::Wedge15 => 6,
            Self::Hexahedron8 | Self::Hexahedron20 => 8,
        }
    }

    /// True if there are nodes in the middles of edges.
    #[must_use]
    pub fn is_quadratic(self) -> bool {
        self.nodes() > self.corners()
    }

    /// Pairs of corners that an edge joins, in the order of the nodes in their middles.
    #[must_use]
    pub fn edges(self) -> &'static [[usize; 2]] {
        match self.corners() {
            4 => &TETRAHEDRON,
            6 => &WEDGE,
            _ => &HEXAHEDRON,
        }
    }

    /// Own coordinates of the nodes, in their order.
    #[must_use]
    pub fn places(self) -> Vec<[f64; 3]> {
        let corner = |at: usize| match self.corners() {
            4 => [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]][at],
            6 => {
                let [r, s] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]][at % 3];
                [r, s, if at < 3 { -1.0 } else { 1.0 }]
            }
            _ => {
                let [r, s] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]][at % 4];
                [r, s, if at < 4 { -1.0 } else { 1.0 }]
            }
        };
        let mut places: Vec<[f64; 3]> = (0..self.corners()).map(corner).collect();
        if self.is_quadratic() {
            for &[a, b] in self.edges() {
                let (a, b) = (places[a], places[b]);
                places.push([0, 1, 2].map(|axis| 0.5 * (a[axis] + b[axis])));
            }
        }
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_of_decks_are_known() {
        for (name, kind) in [
            ("c3d4", Some(Kind::Tetrahedron4)),
            ("C3D10", Some(Kind::Tetrahedron10)),
            ("C3D10HS", Some(Kind::Tetrahedron10)),
            ("C3D6", Some(Kind::Wedge6)),
            ("C3D15", Some(Kind::Wedge15)),
            ("C3D15V", None),
            ("C3D8R", Some(Kind::Hexahedron8)),
            ("C3D20RH", Some(Kind::Hexahedron20)),
            ("C3D27", None),
            ("DC3D8", None),
            ("C3D", None),
        ] {
            assert_eq!(Kind::of_type(name), kind, "{name}");
        }
    }

    #[test]
    fn middles_of_edges_are_as_many_as_nodes_beyond_the_corners() {
        for kind in Kind::ALL {
            let middles = if kind.is_quadratic() { kind.edges().len() } else { 0 };
            assert_eq!(kind.corners() + middles, kind.nodes(), "{kind:?}");
            assert_eq!(kind.places().len(), kind.nodes());
            assert!(kind.nodes() <= MOST_NODES);
        }
    }
}
