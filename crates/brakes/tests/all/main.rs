//! Brakes of case files, each kind against something independent. One program: what all of them compile is compiled once.

#![allow(clippy::unwrap_used, clippy::panic)] // Test code, which the lints do not recognise outside test functions.

mod alike_arrangements;
mod cycles;
mod finite_element_cycles;
mod finite_elements;
mod friction_across;
mod growing_modes;
mod opening_paths;
mod prepared;
mod two_pads;
mod two_pads_case;
mod values_with_atoms;
