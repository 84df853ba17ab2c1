//! The command line program.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(squeal_cli::program(std::env::args_os()))
}
