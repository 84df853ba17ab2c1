//! Tests of spectra, verdicts and sensitivities: one program, which is linked once.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

mod batch;
mod census;
mod exact;
mod secular;
mod sensitivity;
