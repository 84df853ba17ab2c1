//! Tests of sampling: one program, which is linked once.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

mod checkpoint;
#[path = "../common/mod.rs"]
mod common;
mod distribution;
mod kill;
mod quantile_sketch;
mod reproducible;
mod salib;
mod sobol_indices;
