//! What can be wrong with a mode whose work is asked for.

use num_complex::Complex;

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WorkError {
    /// The mode shape, or the friction part, does not fit the structure.
    #[error("the {part} has {found} degrees of freedom, the structure has {expected}")]
    Order {
        /// "mode shape" or "friction part".
        part: &'static str,
        /// Its degrees of freedom.
        found: usize,
        /// Those of the structure.
        expected: usize,
    },
    /// A body owns a degree of freedom that is not there.
    #[error("body {body} owns degree of freedom {dof}; there are {order}, numbered from 0")]
    UnknownDof {
        /// The body, from 0.
        body: usize,
        /// The degree of freedom, from 0.
        dof: usize,
        /// How many there are.
        order: usize,
    },
    /// `phi^H M phi` cannot normalise the work.
    #[error("phi^H M phi = {value}; it must be finite and positive")]
    ModalMass {
        /// Its value.
        value: f64,
    },
    /// The eigenvalue is that of an uncoupled internal state: the state's amplitude does not follow from phi.
    #[error("lambda = {lambda} equals minus the decay rate of internal state {state}")]
    InternalPole {
        /// The eigenvalue.
        lambda: Complex<f64>,
        /// The state, from 0.
        state: usize,
    },
}
