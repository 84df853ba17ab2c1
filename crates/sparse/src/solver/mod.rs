//! Eigenvalues of large sparse systems.

mod blocks;
mod combinations;
mod cover;
mod disc;
mod errors;
mod factor;
mod fronts;
mod krylov;
mod lanes;
mod left;
mod near;
mod orthogonal;
mod pencil;
mod polish;
mod products;
mod reach;
mod ritz;
mod substitution;
mod types;

pub(crate) use blocks::PAR;
pub use cover::eigenpairs_in;
pub(crate) use disc::Problem;
pub use near::eigenpair_near;
pub use types::{Counters, Disc, Eigenpair, Found, Options, Progress, Reach, Rectangle};
