//! The tasks of this project: `cargo xtask reproduce`, `readings`, `accuracy`, `bench` and `same`.

mod accuracy;
mod again;
mod bench;
mod error;
mod reproduce;
mod same;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

#[derive(Debug, Parser)]
#[command(name = "cargo xtask", version, about = "The project's own tasks")]
struct Cli {
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    Accuracy(accuracy::AccuracyArgs),
    Bench(bench::BenchArgs),
    Readings(reproduction::readings::ReadingsArgs),
    Reproduce(reproduce::ReproduceArgs),
    Same(same::SameArgs),
}

/// The checkout.
fn root() -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return ExitCode::from(squeal_cli::refuse(&error)),
    };
    let result: Result<(), Box<dyn std::error::Error>> = match &cli.task {
        Task::Accuracy(args) => accuracy::run(args).map_err(Into::into),
        Task::Bench(args) => bench::run(args).map_err(Into::into),
        Task::Readings(args) => reproduction::readings::run(args, &root()).map_err(Into::into),
        Task::Reproduce(args) => reproduce::run(args).map_err(Into::into),
        Task::Same(args) => same::run(args).map_err(Into::into),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            squeal_cli::terminal::note(&format!("error: {error}"));
            ExitCode::from(2)
        }
    }
}
