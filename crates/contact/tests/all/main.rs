//! Tests of contacts: one program, which is linked once.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

mod blocks;
mod calculix;
mod equilibrium;
#[path = "../making/mod.rs"]
mod making;
mod two_pads;
