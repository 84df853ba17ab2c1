//! Eigenvalues of large systems in rectangles, against spectra that are known.

#![allow(clippy::unwrap_used, clippy::panic)] // Test code, which the lints do not recognise outside test functions.

mod counted;
mod crowds;
mod near_critical;
mod rectangle;
mod undamped;
