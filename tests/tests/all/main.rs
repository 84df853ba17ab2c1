//! Tests across the crates: one program, which is linked once.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

mod given_by_matrices;
mod golden;
mod layers;
mod named_tests;
