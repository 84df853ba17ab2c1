//! Tests of studies: one program, which is linked once.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

mod certificate;
#[path = "../common/mod.rs"]
mod common;
mod estimators;
mod independent;
mod names;
#[path = "../common/paper_brake.rs"]
mod paper_brake;
mod sectors;
mod set_links;
mod study;
mod threshold;
