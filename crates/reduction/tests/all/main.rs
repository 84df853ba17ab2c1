//! The reduction against whole spectra, with each of its tiers forced.

#![allow(clippy::unwrap_used, clippy::panic)] // Test code, which the lints do not recognise outside test functions.

mod reduction;
mod snapshots;
mod tiers;
