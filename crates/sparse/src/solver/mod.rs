//! Eigenvalues of large sparse systems.

mod cover;
mod disc;
mod factor;
mod krylov;
mod near;
mod pencil;
mod polish;
mod reach;
mod ritz;
mod types;

pub use cover::eigenpairs_in;
pub(crate) use disc::Problem;
pub(crate) use factor::PAR;
pub use near::eigenpair_near;
pub use types::{Counters, Disc, Eigenpair, Found, Options, Progress, Reach, Rectangle};
