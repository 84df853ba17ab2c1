//! Errors in computing the work in a mode.

use linsys::LinsysError;
use num_complex::Complex;

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WorkError {
    /// No force family was given.
    #[error("no force family is given; work needs at least one")]
    NoFamily,
    /// The mass matrix is not square.
    #[error("the mass matrix is {rows} x {columns}; it must be square")]
    MassShape {
        /// Rows of the mass matrix.
        rows: usize,
        /// Columns of the mass matrix.
        columns: usize,
    },
    /// The mode shape does not fit the mass matrix.
    #[error("the mode shape has {found} degrees of freedom, the mass matrix has {expected}")]
    ShapeOrder {
        /// Degrees of freedom of the mode shape.
        found: usize,
        /// Degrees of freedom of the mass matrix.
        expected: usize,
    },
    /// A family does not fit the mass matrix.
    #[error("the force family {family:?} has {found} degrees of freedom, the mass matrix has {expected}")]
    FamilyOrder {
        /// Name of the family.
        family: String,
        /// Degrees of freedom of the family.
        found: usize,
        /// Degrees of freedom of the mass matrix.
        expected: usize,
    },
    /// The matrices of a family do not fit each other, or have an entry that is not finite.
    #[error("the force family {family:?} is no system")]
    Family {
        /// Name of the family.
        family: String,
        /// Fault of the matrices.
        source: LinsysError,
    },
    /// No part of a structure was given.
    #[error("no part of the structure is given; energy needs at least one")]
    NoPart,
    /// A part does not fit the mode shape.
    #[error("the part {part:?} has {found} degrees of freedom, the mode shape has {expected}")]
    PartOrder {
        /// Name of the part.
        part: String,
        /// Degrees of freedom of the part.
        found: usize,
        /// Degrees of freedom of the mode shape.
        expected: usize,
    },
    /// The matrices of a part do not fit each other, or have an entry that is not finite.
    #[error("the part {part:?} is no system")]
    Part {
        /// Name of the part.
        part: String,
        /// Fault of the matrices.
        source: LinsysError,
    },
    /// A body lists a degree of freedom that does not exist.
    #[error("body {body} owns degree of freedom {dof}; there are {order}, numbered from 0")]
    UnknownDof {
        /// The body, from 0.
        body: usize,
        /// The degree of freedom, from 0.
        dof: usize,
        /// Number of degrees of freedom.
        order: usize,
    },
    /// `phi^H M phi` cannot normalise the work.
    #[error("phi^H M phi = {value}; it must be finite and positive")]
    ModalMass {
        /// Value of `phi^H M phi`.
        value: f64,
    },
    /// The forces of a family are not finite.
    #[error("the forces of the family {family:?} are not finite at lambda = {lambda}")]
    Forces {
        /// Name of the family.
        family: String,
        /// The eigenvalue.
        lambda: Complex<f64>,
    },
    /// The eigenvalue belongs to an uncoupled internal state, whose amplitude does not follow from phi.
    #[error("lambda = {lambda} equals minus the decay rate of internal state {state} of the force family {family:?}")]
    InternalPole {
        /// Name of the family.
        family: String,
        /// The eigenvalue.
        lambda: Complex<f64>,
        /// The state, from 0.
        state: usize,
    },
}
