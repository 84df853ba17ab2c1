//! How right the answers are, and at what price: estimators of an occurrence against the exact integral, solver routes
//! against refined eigenvalues, the lattice at its worst.

mod branches;
mod critical;
mod distribution;
mod error;
mod exact;
mod family;

pub use critical::{Crossing, Crossings};
pub use distribution::{cumulative, quantile, support};
pub use error::AccuracyError;
pub use exact::{Exact, Occurrence, Piece, exact};
pub use family::{Derivative, Family};
