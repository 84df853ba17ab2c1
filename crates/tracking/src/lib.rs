//! Following modes from one system to another: which mode of the one becomes which of the other.
//!
//! This crate never sees a lattice, a friction law or a random number.

mod mac;
mod trace;
mod track;
mod walk;

pub use mac::mac;
pub use track::{Links, Start, Way, follow, identify, identify_all};
