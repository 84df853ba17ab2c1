//! What a command line that cannot be understood gets.

use std::process::ExitCode;

use clap::error::ErrorKind;

/// Prints what clap says about a command line: help and version in full, anything wrong as one line on standard error
/// with exit code 2, like every other error of the program.
pub fn refuse(error: &clap::Error) -> ExitCode {
    if !error.use_stderr() || error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        // A closed pipe is no reason to fail after help was asked for.
        let _ = error.print();
        return if error.use_stderr() { ExitCode::from(2) } else { ExitCode::SUCCESS };
    }
    let text = error.to_string();
    let first = text.split("\n\n").next().unwrap_or_default();
    eprintln!("{}", first.split_whitespace().collect::<Vec<_>>().join(" "));
    ExitCode::from(2)
}
