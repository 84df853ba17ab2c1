//! Tests of lattices: one program, which is linked once.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

mod closed_forms;
#[path = "../common/mod.rs"]
mod common;
mod invariance;
mod sectors;
mod sliding;
mod symmetry;
