//! The program as its user meets it: what it says to bad input, and that its results are always the same bytes.

#![allow(clippy::unwrap_used, clippy::panic)] // Test code, which the lints do not recognise outside test functions.

mod bad_cases;
mod bad_folders;
mod cea;
mod command_line;
mod common;
mod compare;
mod cycle;
mod cycle_beside;
mod digests;
mod documents;
mod estimates;
mod exports;
mod failed_checks;
mod failures;
mod help;
mod how_sure;
mod instability;
mod measured;
mod memory;
mod more_than_modes;
mod names;
mod own_brake;
mod parquet;
mod predicted;
mod prepared;
mod rare;
mod rectangle;
mod report_page;
mod same_bytes;
mod screen;
mod set;
mod shards;
mod sizes;
mod strengths;
mod study_tables;
mod sweep;
mod sweep_ranges;
mod tables;
mod tables_of_points;
mod terminal;
mod tutorial;
mod two_runs;
mod words;
