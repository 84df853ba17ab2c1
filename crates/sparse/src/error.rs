//! Errors of sparse systems.

use cea::CeaError;
use linsys::{LinsysError, Matrix};
use num_complex::Complex;

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SparseError {
    /// The system has no degrees of freedom.
    #[error("the system has no degrees of freedom")]
    Empty,
    /// A matrix does not have the order of the mass matrix, or is not square.
    #[error("the {matrix} matrix is {rows} x {columns}; expected {order} x {order}")]
    Shape {
        /// The matrix.
        matrix: Matrix,
        /// Number of its rows.
        rows: usize,
        /// Number of its columns.
        columns: usize,
        /// Degrees of freedom of the mass matrix.
        order: usize,
    },
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
    /// A matrix in units in which squares of its entries leave the range of a double.
    #[error(
        "the largest entry of the {matrix} matrix is {largest:e}; allowed: 1e-140 to 1e140 in size, or a matrix of zeros: choose other units"
    )]
    Units {
        /// The matrix.
        matrix: Matrix,
        /// Magnitude of its largest entry.
        largest: f64,
    },
    /// Q is singular at this shift and at others beside it.
    #[error(
        "lambda^2 M + lambda C + K is singular at {shift} rad/s and at shifts beside it: perhaps at every lambda, or next to an eigenvalue of \
         many copies, as 0 is of free bodies; allowed: a rectangle with its centre farther from that"
    )]
    Singular {
        /// The shift, rad/s.
        shift: Complex<f64>,
    },
    /// A factorisation that does not fit into memory.
    #[error("a factorisation of {order} degrees of freedom does not fit into memory")]
    Memory {
        /// Degrees of freedom.
        order: usize,
    },
    /// A solution with Q(shift) that refinement did not make accurate.
    #[error("solutions with Q({shift}) have a backward error of {residual:.1e}")]
    Solve {
        /// The shift, rad/s.
        shift: Complex<f64>,
        /// The smallest backward error reached.
        residual: f64,
    },
    /// The eigenvalues of a projected problem were not found.
    #[error("the projected problem of order {order} at {shift} rad/s has no eigenvalues that can be computed")]
    Projected {
        /// The shift, rad/s.
        shift: Complex<f64>,
        /// Order of the projected problem.
        order: usize,
    },
    /// A candidate that inverse iteration did not make an eigenpair.
    #[error("an eigenvalue near {lambda:.6e} rad/s does not converge: its backward error stays at {residual:.1e}")]
    NotConverged {
        /// Eigenvalue near which the pair was sought, rad/s.
        lambda: Complex<f64>,
        /// The backward error reached.
        residual: f64,
    },
    /// An eigenvalue of a higher multiplicity than any block shows.
    #[error(
        "an eigenvalue within reach of {shift} rad/s occurs {copies} times or more: too often for a search to find all"
    )]
    Multiplicity {
        /// The shift, rad/s.
        shift: Complex<f64>,
        /// Number of copies that were found.
        copies: usize,
    },
    /// A group of eigenvalues that were not found again in the space of their vectors.
    #[error(
        "{found} eigenvalues next to {lambda:.6e} rad/s were found, of which {settled} could be settled together in the space of their vectors"
    )]
    GroupLost {
        /// Eigenvalue of the group, one of them, rad/s.
        lambda: Complex<f64>,
        /// Number of eigenvalues that a disc has.
        found: usize,
        /// Number of eigenvalues that the space has.
        settled: usize,
    },
    /// A rectangle of no extent, reversed, or without end.
    #[error("{part} from {from} to {to} rad/s; both must be finite and the first below the second")]
    Rectangle {
        /// Name of the side: `Re lambda` or `Im lambda`.
        part: &'static str,
        /// Lower border of that side, rad/s.
        from: f64,
        /// Upper border of that side, rad/s.
        to: f64,
    },
    /// A loss factor that is negative or not finite, or a matrix H among the matrices of a term, whose structural damping its loss factor has to give.
    #[error(
        "term {term:?} has structural damping, loss factor {loss}; allowed: a finite loss factor >= 0 of the stiffness, and no matrix of it"
    )]
    Loss {
        /// Name of the term.
        term: String,
        /// Loss factor of it.
        loss: f64,
    },
    /// A rectangle that is not above the real axis, of a system with structural damping.
    #[error(
        "Im lambda from {from} rad/s; allowed with structural damping: > 0, as its stiffness is K + i H above the real axis alone"
    )]
    StructuralDamping {
        /// Lower border of Im lambda, rad/s.
        from: f64,
    },
    /// A rectangle that needs more than is allowed.
    #[error(
        "the rectangle {}; allowed: {most_shifts} shifts and {most_pairs} eigenvalues, in {}",
        foreseen(*shifts, *found, *covered),
        if *covered > 0.0 { "a smaller rectangle" } else { "one farther from eigenvalues that are defective or occur many times" }
    )]
    RectangleTooLarge {
        /// Shifts so far.
        shifts: usize,
        /// Eigenvalues found so far.
        found: usize,
        /// Fraction of the rectangle that was covered.
        covered: f64,
        /// The shifts allowed.
        most_shifts: usize,
        /// The eigenvalues allowed: their vectors take memory.
        most_pairs: usize,
    },
    /// A rectangle around all eigenvalues of a system that has more of them than is allowed.
    #[error("the rectangle holds all {eigenvalues} eigenvalues; allowed: {most}, in a smaller rectangle")]
    WholeSpectrum {
        /// Number of eigenvalues of the system.
        eigenvalues: usize,
        /// The eigenvalues allowed: their vectors take memory.
        most: usize,
    },
    /// Two counts of the eigenvalues in a circle that contradict each other.
    #[error(
        "{listed} eigenvalues were found within {radius} of {centre} rad/s, but the argument principle counts {counted}: neither is \
         to be trusted"
    )]
    CountsDiffer {
        /// Number of eigenvalues that were found.
        listed: usize,
        /// Number of zeros that det Q has there.
        counted: usize,
        /// The centre of the circle, rad/s.
        centre: Complex<f64>,
        /// Radius of the circle, rad/s.
        radius: f64,
    },
    /// A dense decomposition did not converge, or its matrix has an entry that is not finite.
    #[error("the {what} could not be computed")]
    Decomposition {
        /// Name of what was to be computed.
        what: &'static str,
    },
    /// An argument that is out of its range.
    #[error("{option} is {value}; it must be {allowed}")]
    Option {
        /// The argument.
        option: &'static str,
        /// Value of the argument.
        value: f64,
        /// The values that it may have.
        allowed: &'static str,
    },
    /// A dense solver failed.
    #[error(transparent)]
    Dense(#[from] CeaError),
    /// An operating point that does not belong to the system, or a channel that acts on a degree of freedom that does not exist.
    #[error(transparent)]
    System(#[from] LinsysError),
}

impl SparseError {
    /// The error of the system in its own units, from the error of the scaled system: shifts, eigenvalues and circles times `gamma`, rad/s.
    pub(crate) fn times(self, gamma: f64) -> Self {
        match self {
            Self::CountsDiffer { listed, counted, centre, radius } => {
                Self::CountsDiffer { listed, counted, centre: centre * gamma, radius: radius * gamma }
            }
            Self::Singular { shift } => Self::Singular { shift: shift * gamma },
            Self::Solve { shift, residual } => Self::Solve { shift: shift * gamma, residual },
            Self::Projected { shift, order } => Self::Projected { shift: shift * gamma, order },
            Self::NotConverged { lambda, residual } => Self::NotConverged { lambda: lambda * gamma, residual },
            Self::Multiplicity { shift, copies } => Self::Multiplicity { shift: shift * gamma, copies },
            Self::GroupLost { lambda, found, settled } => Self::GroupLost { lambda: lambda * gamma, found, settled },
            other => other,
        }
    }
}

/// Words for what a rectangle needs, by the part of it that a number of shifts covered.
fn foreseen(shifts: usize, found: usize, covered: f64) -> String {
    if covered == 0.0 {
        return format!("is covered nowhere by {shifts} shifts");
    }
    let [shifts_in_all, found_in_all] = [shifts, found].map(|count| count as f64 / covered);
    format!(
        "needs roughly {shifts_in_all:.2e} shifts and holds roughly {found_in_all:.2e} eigenvalues, by the {covered:.1e} of it that {shifts} shifts covered"
    )
}
