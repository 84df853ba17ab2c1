//! Errors of brakes, arrangements, constraints and sliding states.

use std::fmt;

use linsys::LinsysError;

use crate::Dof;

/// The largest absolute value of a number that is given, and the reciprocal of the least value of one that has to be positive. Chosen: sums, products and
/// squares of such numbers stay far from the ends of a double's range.
const LARGEST: f64 = 1e100;

/// The range that a value must lie in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Allowed {
    /// Range -1e100 to 1e100.
    Finite,
    /// Range 1e-100 to 1e100.
    Positive,
    /// Range 0 to 1e100.
    NonNegative,
}

impl Allowed {
    pub(crate) fn contains(self, value: f64) -> bool {
        match self {
            Self::Finite => value.abs() <= LARGEST,
            Self::Positive => (1.0 / LARGEST..=LARGEST).contains(&value),
            Self::NonNegative => (0.0..=LARGEST).contains(&value),
        }
    }
}

impl fmt::Display for Allowed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Finite => "finite, at most 1e100 in size",
            Self::Positive => "finite and > 0, from 1e-100 to 1e100",
            Self::NonNegative => "finite and >= 0, at most 1e100",
        })
    }
}

/// Errors of this crate. Oscillators are numbered from 1 in messages.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OscModelError {
    /// A parameter of the lattice, or the preload, is out of its range.
    #[error("{field} = {value}; allowed: {allowed}")]
    Value {
        /// Name of the field, with the position in a list from 1: `contact_stiffness[3]`.
        field: String,
        /// The value given.
        value: f64,
        /// The allowed range.
        allowed: Allowed,
    },
    /// A list does not have one entry for each spring, dashpot or oscillator.
    #[error("{field} has {found} entries; the lattice of {rows} x {columns} needs {expected}")]
    Length {
        /// The list.
        field: &'static str,
        /// Entries given.
        found: usize,
        /// Entries needed.
        expected: usize,
        /// Rows of the lattice.
        rows: usize,
        /// Columns of the lattice.
        columns: usize,
    },
    /// A grid without oscillators or with too many.
    #[error("the lattice is {rows} x {columns}; allowed: 1 to {most} oscillators")]
    GridSize {
        /// Rows given.
        rows: usize,
        /// Columns given.
        columns: usize,
        /// The most oscillators allowed.
        most: usize,
    },
    /// An oscillator that does not exist.
    #[error("oscillator {number} is not there; allowed: 1 to {oscillators}")]
    UnknownOscillator {
        /// The number asked for, from 1.
        number: usize,
        /// Number of oscillators.
        oscillators: usize,
    },
    /// An arrangement names an oscillator twice.
    #[error("oscillator {number} is named twice in the contact arrangement; allowed: each once")]
    RepeatedOscillator {
        /// Number of the oscillator, from 1.
        number: usize,
    },
    /// More contacts asked for than there are oscillators.
    #[error("{in_contact} oscillators in contact; allowed: 0 to {oscillators}")]
    TooManyInContact {
        /// Contacts asked for.
        in_contact: usize,
        /// Number of oscillators.
        oscillators: usize,
    },
    /// An arrangement for a lattice of another size.
    #[error("the contact arrangement is for {arrangement} oscillators, the lattice has {oscillators}")]
    OtherLattice {
        /// Oscillators that the arrangement was made for.
        arrangement: usize,
        /// Oscillators of the lattice.
        oscillators: usize,
    },
    /// Text that names no degree of freedom.
    #[error(
        "`{text}` names no degree of freedom; allowed: x, y or z and an oscillator's number or p, as in x1, z9, xp"
    )]
    DofSyntax {
        /// The text.
        text: String,
    },
    /// A degree of freedom of an oscillator that does not exist.
    #[error("{dof} is not there; allowed: oscillators 1 to {oscillators}, and p")]
    UnknownDof {
        /// The degree of freedom.
        dof: Dof,
        /// Number of oscillators.
        oscillators: usize,
    },
    /// A degree of freedom is constrained twice.
    #[error("{dof} is constrained twice; allowed: each once")]
    ConstrainedTwice {
        /// The degree of freedom.
        dof: Dof,
    },
    /// An error of a system, its operating point or its constraints.
    #[error(transparent)]
    System(#[from] LinsysError),
    /// A sliding state does not have one entry per oscillator in contact.
    #[error("the sliding state has {found} contacts; the arrangement has {expected}")]
    ContactCount {
        /// Entries given.
        found: usize,
        /// Oscillators in contact.
        expected: usize,
    },
    /// A value of one contact of a sliding state is out of its range.
    #[error("{field} of oscillator {oscillator} = {value}; allowed: {allowed}")]
    Contact {
        /// The oscillator, from 1.
        oscillator: usize,
        /// The field of the contact.
        field: &'static str,
        /// The value given.
        value: f64,
        /// The allowed range.
        allowed: Allowed,
    },
    /// An operating point breaks the symmetry by which its brake is split.
    #[error("the contacts {first} and {second} differ; allowed: alike, where the brake is split into sectors")]
    UnequalContacts {
        /// Name of a contact.
        first: String,
        /// Name of a contact that the symmetry exchanges with the first.
        second: String,
    },
    /// A system of another brake than the one that was split.
    #[error(
        "a system of {order} degrees of freedom and {states} states; allowed: {expected}, and 0 or {channels} states"
    )]
    OtherSystem {
        /// Degrees of freedom of the system.
        order: usize,
        /// Internal states of the system.
        states: usize,
        /// Free degrees of freedom of the brake.
        expected: usize,
        /// Channels of the brake.
        channels: usize,
    },
    /// An oscillator in contact that is not pressed on the plate in static equilibrium with friction drag.
    #[error(
        "oscillator {oscillator} of {in_contact} in contact lifts off in static equilibrium: normal load {load} N; allowed: > 0"
    )]
    LostContact {
        /// The oscillator, from 1.
        oscillator: usize,
        /// Number of oscillators in contact.
        in_contact: usize,
        /// Normal load of the oscillator, N.
        load: f64,
    },
    /// Static equilibrium does not exist: elastic stiffness and friction coupling together are singular.
    #[error("static equilibrium does not exist: the stiffness with friction coupling is singular")]
    NoEquilibrium,
}
