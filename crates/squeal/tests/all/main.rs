//! Tests of what is asked of studies: one program, which is linked once.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

mod broken_brakes;
mod cancelled;
#[path = "../common/cases.rs"]
mod cases;
#[path = "../../../study/tests/common/mod.rs"]
mod common;
mod cycles_of_draws;
mod how_sure;
mod identity;
mod instability;
mod rare;
mod screen;
mod user_brake;
mod variants;
mod why;
