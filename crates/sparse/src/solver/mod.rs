//! Eigenvalues of large sparse systems.

mod argument;
mod blocks;
mod branches;
mod certified;
mod combinations;
mod counted;
mod disc;
mod errors;
mod factor;
mod fronts;
mod groups;
mod in_threads;
mod krylov;
mod lanes;
mod left;
mod near;
mod on_axis;
mod orthogonal;
mod pencil;
mod polish;
mod products;
mod reach;
mod rectangle;
mod ritz;
mod scaling;
mod settle;
mod substitution;
mod types;

pub(crate) use blocks::PAR;
pub use disc::Problem;
pub use near::Guess;
pub use rectangle::eigenpairs_in;
pub use types::{Circle, Count, Counters, Disc, Eigenpair, Found, Options, Progress, Reach, Rectangle};
