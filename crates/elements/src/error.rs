//! Errors in meshes and what is integrated over them.

/// Errors of this crate. Elements and nodes are named by their numbers in the model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ElementsError {
    /// A mesh without nodes or without elements.
    #[error("the mesh has no {what}; it must have one or more")]
    Empty {
        /// `nodes` or `elements`.
        what: &'static str,
    },
    /// A number that two nodes or two elements have.
    #[error("{what} {label} is there twice; each number must be there once")]
    Twice {
        /// `node` or `element`.
        what: &'static str,
        /// Number of the node or element.
        label: i64,
    },
    /// A node that is nowhere.
    #[error("node {node} is not at finite coordinates")]
    Position {
        /// Number of the node.
        node: i64,
    },
    /// An element with more or fewer nodes than its kind has.
    #[error("element {element} has {found} nodes; a {kind:?} has {expected}")]
    NodeCount {
        /// Number of the element.
        element: i64,
        /// Kind of the element.
        kind: crate::Kind,
        /// Number of nodes that it has.
        found: usize,
        /// Number of nodes that its kind has.
        expected: usize,
    },
    /// An element of a node that the mesh lacks.
    #[error("element {element} has node {node}, which the mesh lacks")]
    UnknownNode {
        /// Number of the element.
        element: i64,
        /// The number of the node.
        node: i64,
    },
    /// An index of an element beyond the last.
    #[error("there is no element at place {place}; the mesh has {total}, from 0")]
    NoElement {
        /// Index, from 0.
        place: usize,
        /// Number of elements.
        total: usize,
    },
    /// A face that elements of this kind do not have.
    #[error("element {element} has no face S{face}; it has S1 to S{faces}")]
    NoFace {
        /// The number of the element.
        element: i64,
        /// The number of the face.
        face: usize,
        /// Number of faces that it has.
        faces: usize,
    },
    /// An element that is turned inside out near one of its nodes.
    #[error(
        "element {element} is inverted near its node {node}: its Jacobian has the determinant {determinant:e}, which must be > 0"
    )]
    Inverted {
        /// Number of the element.
        element: i64,
        /// The number of the node.
        node: i64,
        /// The determinant, cubic units of length.
        determinant: f64,
    },
    /// An element without volume near one of its nodes.
    #[error("element {element} has no volume near its node {node}: its Jacobian has the determinant {determinant:e}")]
    NoVolume {
        /// Number of the element.
        element: i64,
        /// The number of the node.
        node: i64,
        /// The determinant, cubic units of length.
        determinant: f64,
    },
    /// A face without area near one of its nodes.
    #[error("face S{face} of element {element} has no area near node {node}")]
    NoArea {
        /// The number of the element.
        element: i64,
        /// The number of the face.
        face: usize,
        /// The number of the node.
        node: i64,
    },
    /// An axis without direction, or none.
    #[error("the axis has the direction {direction:?}; three finite numbers are allowed, not all 0")]
    Axis {
        /// The direction.
        direction: [f64; 3],
    },
    /// A number of a material that is none.
    #[error("{what} is {value}; allowed is {allowed}")]
    Material {
        /// Name of the number.
        what: &'static str,
        /// Value of the number.
        value: f64,
        /// Values that are allowed, in words.
        allowed: &'static str,
    },
    /// Displacements that are not those of the nodes of the mesh.
    #[error("there are displacements of {found} nodes; the mesh has {expected}")]
    Displacements {
        /// Number of displacements that there are.
        found: usize,
        /// Number of nodes of the mesh.
        expected: usize,
    },
    /// A degree of freedom beyond the last.
    #[error("node {node} has the degree of freedom {row}; there are {order}, numbered from 0")]
    Row {
        /// The number of the node.
        node: i64,
        /// The degree of freedom, from 0.
        row: usize,
        /// Number of degrees of freedom.
        order: usize,
    },
}
