//! Errors in contacts.

use std::fmt;

use elements::ElementsError;
use linsys::LinsysError;
use sparse::SparseError;

/// Side of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The side whose faces are integrated over: the pad.
    Slave,
    /// The side that these points are projected on: the disc.
    Master,
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if *self == Self::Slave { "slave" } else { "master" })
    }
}

/// Errors of this crate. Elements and nodes are named by their numbers in the model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContactError {
    /// A fault of the mesh.
    #[error(transparent)]
    Mesh(#[from] ElementsError),
    /// A fault of a system of equations.
    #[error(transparent)]
    Sparse(#[from] SparseError),
    /// A fault of a channel.
    #[error(transparent)]
    Linsys(#[from] LinsysError),
    /// A side without faces.
    #[error("the {side} has no faces; it must have one or more")]
    NoFaces {
        /// Side that has no faces.
        side: Side,
    },
    /// A face without area.
    #[error("the {side} has a face without area: S{face} of element {element}")]
    NoArea {
        /// Side that has the face.
        side: Side,
        /// The number of the element.
        element: i64,
        /// The number of the face.
        face: usize,
    },
    /// A setting that is not allowed.
    #[error("{what} is {value}; allowed is {allowed}")]
    Value {
        /// Name of the setting.
        what: &'static str,
        /// Value of the setting.
        value: f64,
        /// Values that are allowed, in words.
        allowed: &'static str,
    },
    /// Faces that are farther from each other than they may be.
    #[error(
        "the faces do not meet: node {node} of the slave is {distance:.3e} from the nearest face of the master, in the unit of length of the mesh, of which at most {reach:.3e} is allowed"
    )]
    Apart {
        /// The number of the node of the slave next to the point.
        node: i64,
        /// Distance of the point from the nearest face that it is over; infinite where it is over none.
        distance: f64,
        /// The largest that is allowed.
        reach: f64,
    },
    /// A part of the slave beside the master, some of it at whatever distance.
    #[error(
        "the master is smaller than the slave: {:.3} % of the area has no face of it within reach, first at node {node}, where none is at any distance; allowed with an overhang, which carries nothing", 100.0 * share
    )]
    MasterSmaller {
        /// The number of the node of the slave next to the first point of that part.
        node: i64,
        /// Share of the slave's area that has no face of the master opposite within reach, 0 to 1.
        share: f64,
    },
    /// Faces that do not look at each other.
    #[error(
        "the normals contradict: the face of the master opposite to node {node} of the slave does not look at it (cosine {cosine:.3}, allowed at most {allowed})"
    )]
    Normals {
        /// The number of the node of the slave next to the point.
        node: i64,
        /// Cosine of the angle between both normals to the outside.
        cosine: f64,
        /// The largest that is allowed.
        allowed: f64,
    },
    /// Faces of one side that lie on each other.
    #[error(
        "at node {node} of the slave two faces of the {side} lie on each other, of elements {first} and {second}; one is allowed: which of them is in contact \
         follows from nothing"
    )]
    OnEachOther {
        /// Side whose faces they are.
        side: Side,
        /// The number of the node of the slave next to the point.
        node: i64,
        /// The number of the element of the one face.
        first: i64,
        /// The number of the element of the other face.
        second: i64,
    },
    /// A velocity without a direction along the face.
    #[error("nothing slides at node {node}: the velocity {velocity:?} has no part along the face")]
    NoSliding {
        /// The number of the node of the slave next to the point.
        node: i64,
        /// The velocity there.
        velocity: [f64; 3],
    },
    /// An axis of rotation that goes through the slave.
    #[error("the axis of rotation goes through the slave, at node {node} of element {element}, where nothing slides")]
    AxisThroughSlave {
        /// The number of the element.
        element: i64,
        /// The number of the node next to it.
        node: i64,
    },
    /// A point that belongs to no patch.
    #[error("node {node} of the slave is in no patch; faces that do not touch belong out of the slave")]
    NoPatch {
        /// The number of the node next to the point.
        node: i64,
    },
    /// A point that belongs to two patches equally.
    #[error("node {node} of the slave is in patch {first:?} and in patch {second:?} alike")]
    TwoPatches {
        /// The number of the node next to the point.
        node: i64,
        /// A patch.
        first: String,
        /// Another patch.
        second: String,
    },
    /// A list of another length.
    #[error("there are {found} {what}; {expected} are expected")]
    Count {
        /// Name of the things that are counted, in the plural.
        what: &'static str,
        /// Number of them that there are.
        found: usize,
        /// Number of them that there should be.
        expected: usize,
    },
    /// A node without a pressure.
    #[error("node {node} of the slave has no pressure")]
    NoPressure {
        /// Number of the node.
        node: i64,
    },
    /// Pressures that are of nodes that the slave lacks.
    #[error("there is a pressure of node {node}, which the slave lacks")]
    UnknownNode {
        /// Number of the node.
        node: i64,
    },
    /// A node with two pressures.
    #[error("node {node} has a pressure twice: a file may hold several steps")]
    PressedTwice {
        /// Number of the node.
        node: i64,
    },
    /// Contact points that neither press nor are open by more than rounding.
    #[error(
        "whether {points} of {of} points are closed is not determined: under loads of {loads:e} N they neither press nor open by more than rounding"
    )]
    Undetermined {
        /// Number of these points.
        points: usize,
        /// Number of all points.
        of: usize,
        /// Sum of the sizes of all loads, N.
        loads: f64,
    },
    /// A structure that moves though all contacts are closed.
    #[error(
        "nothing holds the bodies: with all contacts closed there is a motion without stiffness (a solution has the size {growth:e} of what the stiffness asks for)"
    )]
    NothingHolds {
        /// The norm of the solution times that of the stiffness over that of the forces; infinite where there is none.
        growth: f64,
    },
    /// Friction that locks.
    #[error("friction locks: with all contacts closed the normal forces are not determined by the loads")]
    Locks,
    /// No state of open and closed contacts is in balance.
    #[error("there is no equilibrium: {reason}")]
    NoEquilibrium {
        /// Reason why it is known that there is none, in words.
        reason: &'static str,
    },
    /// An iteration that did not end.
    #[error("the equilibrium was not found in {steps} steps; gaps are out of balance by {residual:e} of the largest")]
    NotFound {
        /// Number of steps of Newton's method.
        steps: usize,
        /// Largest gap that is missing to balance, relative to the largest gap.
        residual: f64,
    },
    /// A complementarity problem that Lemke's method leaves without an answer: it took all steps that it may, or lost its digits.
    #[error(
        "the equilibrium of {unknowns} contact points was not found: rounding took too many digits from the path of Lemke's method"
    )]
    NotSolved {
        /// Number of contact points.
        unknowns: usize,
    },
}
