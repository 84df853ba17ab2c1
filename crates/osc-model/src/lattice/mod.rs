//! The lattice of friction oscillators on a sliding plate, one of the models that make a [`Brake`](crate::Brake).

mod arrangement;
mod assembly;
mod dof;
mod dof_names;
mod model;
mod operating_point;
mod parameters;
mod preload;
mod readings;
mod sectors;
mod symmetry;

pub use arrangement::ContactArrangement;
pub use dof::{Axis, Dof, LatticeBody};
pub use model::LatticeModel;
pub use operating_point::{ContactPoint, PreparedLattice, Sliding};
pub use parameters::{Grid, LatticeParameters, PlateParameters};
pub use readings::{Lateral, Lean, Preload, Sign};
pub use symmetry::{Member, Reversal, SymmetryClass};
