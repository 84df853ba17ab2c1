//! Tests of bodies: one program, which is linked once.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

mod bodies;
mod ring;
