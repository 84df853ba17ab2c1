//! The command line program.

use std::io::Write;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use squeal::commands::{CeaArgs, CheckArgs, EigArgs, RunArgs};

/// Which modes of a brake will squeal, how sure are we, and what stops them?
#[derive(Debug, Parser)]
#[command(version, about)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Run(RunArgs),
    Cea(CeaArgs),
    Check(CheckArgs),
    Eig(EigArgs),
}

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return squeal::commands::refuse(&error),
    };
    let mut out = std::io::stdout().lock();
    let result = match &cli.command {
        Command::Run(args) => args.run(&mut out),
        Command::Cea(args) => args.run(&mut out),
        Command::Check(args) => args.run(&mut out),
        Command::Eig(args) => args.run(&mut out),
    };
    let result =
        result.map_err(|error| error.to_string()).and_then(|()| out.flush().map_err(|error| error.to_string()));
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {}", message.replace('\n', " "));
            ExitCode::from(2)
        }
    }
}
