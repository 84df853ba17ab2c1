//! Errors of systems and constraints.

use std::fmt;

/// Names a matrix of a [`SecondOrder`](crate::SecondOrder) in an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Matrix {
    /// Mass matrix M, n x n.
    Mass,
    /// Damping matrix C, n x n.
    Damping,
    /// Stiffness matrix K, n x n.
    Stiffness,
    /// Structural damping matrix H, n x n, of a stiffness `K + i H`.
    StructuralDamping,
    /// Decay rates a of the internal states, length s.
    Decay,
    /// Drive matrix E, s x n: velocities into internal states.
    Drive,
    /// Force matrix F, n x s: internal states into forces.
    Force,
}

impl fmt::Display for Matrix {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Mass => "mass",
            Self::Damping => "damping",
            Self::Stiffness => "stiffness",
            Self::StructuralDamping => "structural damping",
            Self::Decay => "decay",
            Self::Drive => "drive",
            Self::Force => "force",
        })
    }
}

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinsysError {
    /// A matrix does not have the shape that the others imply.
    #[error("the {matrix} matrix is {rows} x {columns}; expected {expected_rows} x {expected_columns}")]
    Shape {
        /// The matrix.
        matrix: Matrix,
        /// Rows of the matrix.
        rows: usize,
        /// Columns of the matrix.
        columns: usize,
        /// Rows that fit the other matrices.
        expected_rows: usize,
        /// Columns that fit the other matrices.
        expected_columns: usize,
    },
    /// A term of an affine system that is larger or smaller than the first one.
    #[error("the term \"{term}\" has {found} degrees of freedom; expected {expected}, as the first one")]
    TermOrder {
        /// The term.
        term: String,
        /// Degrees of freedom of the term.
        found: usize,
        /// Degrees of freedom of the first term.
        expected: usize,
    },
    /// A term of an affine system that has internal states; only channels may have them.
    #[error("the term \"{term}\" has {states} internal states; expected none")]
    TermStates {
        /// The term.
        term: String,
        /// Internal states of the term.
        states: usize,
    },
    /// A list, a vector or a basis of another length than the system asks for, as an operating point of another system has.
    #[error("{found} {what}; expected {expected}")]
    Count {
        /// Name of what is counted: term coefficients, channel gains, degrees of freedom, entries of a shape, rows of a basis.
        what: &'static str,
        /// Number given.
        found: usize,
        /// Number that the system needs.
        expected: usize,
    },
    /// A friction channel that the system does not have.
    #[error("channel {channel}; the system has {total}, numbered from 0")]
    NoChannel {
        /// Index of the channel, from 0.
        channel: usize,
        /// Number of channels.
        total: usize,
    },
    /// A coefficient that is NaN or infinite.
    #[error("the coefficient of the term \"{term}\" is {value}; it must be finite")]
    Coefficient {
        /// The term.
        term: String,
        /// The coefficient.
        value: f64,
    },
    /// A number of a friction channel that is NaN or infinite.
    #[error("the channel \"{channel}\" has a number that is not finite")]
    ChannelGain {
        /// The channel.
        channel: String,
    },
    /// The system has no degrees of freedom.
    #[error("the system has no degrees of freedom")]
    Empty,
    /// An entry is NaN or infinite.
    #[error("the {matrix} matrix has {value} in row {row}, column {column}; every entry must be finite")]
    NotFinite {
        /// The matrix.
        matrix: Matrix,
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// A constraint or a channel names a degree of freedom that does not exist.
    #[error("constraint on degree of freedom {dof}; there are {total}, numbered from 0")]
    UnknownDof {
        /// The index asked for, from 0.
        dof: usize,
        /// Number of degrees of freedom.
        total: usize,
    },
    /// A degree of freedom is constrained twice.
    #[error("degree of freedom {dof} is constrained twice")]
    ConstrainedTwice {
        /// The index, from 0.
        dof: usize,
    },
    /// Constraints on all degrees of freedom.
    #[error("all {total} degrees of freedom are constrained")]
    AllConstrained {
        /// Number of degrees of freedom.
        total: usize,
    },
}
