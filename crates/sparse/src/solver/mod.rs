//! Eigenvalues of large sparse systems.

mod cover;
mod disc;
mod factor;
mod krylov;
mod pencil;
mod polish;
mod ritz;
mod types;

pub use cover::eigenpairs_in;
pub use types::{Counters, Disc, Eigenpair, Found, Options, Progress, Rectangle};
