//! Reduction: a large brake projected on a few columns is a brake, with the residual of each mode in the large one.
//!
//! | to | use |
//! | --- | --- |
//! | hold the modes at chosen points, with columns that follow modes and not contacts | [`Snapshots`] |
//! | have modes at many points, nearly, from those at one | [`NearModes`] |
//! | find a smaller basis within these for one arrangement | [`within()`] |
//! | have the brake on a basis, with what bounds residuals there | [`Reduced::within`], [`Combinations`] |
//! | find the wanted modes at an operating point, with residuals | [`Reduced::modes`] |
//! | find some of them at many points, from coarse modes | [`Reduced::with_coarse`], [`Reduced::modes_of_all`] |
//! | compare eigenvalues of two systems | [`compared`] |
//! | hold the shapes of modes | [`shape_directions`] |
//! | follow modes while contacts open | [`ContactPath`] |
//! | have a dense brake for a study | [`Reduced::system`] |
//!
//! A basis V is real, n x k and orthonormal, and both sides of the equation are projected on it, so that terms stay symmetric and
//! channels stay channels. It holds the right and left vectors of the wanted modes at a few operating points, as proper orthogonal
//! decomposition does (Graebner, Mehrmann, Quraishi, Schroeder and von Wagner, ZAMM 96, 2016).

mod coarse;
mod coarse_states;
mod combinations;
mod compared;
mod contact_path;
mod dense;
mod directions;
mod error;
mod inverse_iteration;
mod loss;
mod near_modes;
mod nearest;
mod norms;
mod outer_products;
mod reduced;
mod residual;
mod route;
mod shapes;
mod shared;
mod snapshots;
mod spectra;
mod split;
mod state_modes;
mod wanted;
mod within;

pub use coarse::{CoarseBasis, Doubt};
pub use coarse_states::CoarseStates;
pub use combinations::Combinations;
pub use compared::{Compared, compared};
pub use contact_path::{ContactPath, OnContactPath};
pub use error::ReductionError;
pub use loss::Losses;
pub use near_modes::NearModes;
pub use reduced::{Reduced, ReducedModes};
pub use residual::largest_residual;
pub use route::{Route, RouteCounts};
pub use shapes::shape_directions;
pub use snapshots::{Snapshot, SnapshotMode, Snapshots};
pub use within::{Within, error_within, within};

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
