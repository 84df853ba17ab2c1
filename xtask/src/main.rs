//! The tasks of this project: `cargo xtask reproduce`, `readings`, `accuracy`, `bench` and `same`; `release-check`, and what it needs:
//! `refusals`, `licences` and `release-files`.

mod accuracy;
mod again;
mod bench;
mod error;
mod release;
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
    /// Make THIRD-PARTY.md: what others wrote, and under which licences.
    Licences,
    Readings(reproduction::readings::ReadingsArgs),
    /// Make docs/refusals.md, which has every line with which the program refuses something.
    Refusals,
    ReleaseCheck(release::ReleaseCheckArgs),
    ReleaseFiles(release::ReleaseFilesArgs),
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
        Task::Licences => release::make_licences(&root()).map_err(Into::into),
        Task::Refusals => release::make_refusals(&root()).map_err(Into::into),
        Task::ReleaseCheck(args) => release::check(args, &root()).map_err(Into::into),
        Task::ReleaseFiles(args) => release::files(args).map_err(Into::into),
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
