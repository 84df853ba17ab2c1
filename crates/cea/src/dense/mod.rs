//! The fast route for dense systems: scaled standard form, QR iteration, vectors, and which eigenvalues are modes.

mod batch;
#[cfg(feature = "lapack")]
mod lapack;
mod mode;
mod modes;
mod null_vectors;
mod qr;
mod scaling;
mod solver;
mod split;
mod vectors;

pub use batch::BatchSolver;
#[cfg(feature = "lapack")]
pub use lapack::{LapackSolver, dgeev, dggev};
pub use mode::Mode;
pub use modes::{Modes, mass_norm_squared, pair_numbers, ranks_together};
pub(crate) use null_vectors::{NullVector, null_vectors};
pub(crate) use qr::MOST_QR_STEPS;
pub use qr::QrSolver;
pub(crate) use scaling::MassRoot;
pub use scaling::{StandardForm, check_mass};
pub use solver::{EigenSolver, WholeSpectra};
pub use vectors::{
    backward_error, fix_phase, left_vector, right_and_left_vectors_of_all, right_vector, right_vectors,
    right_vectors_of_all, singular_vectors,
};
pub(crate) use vectors::{size, start};
