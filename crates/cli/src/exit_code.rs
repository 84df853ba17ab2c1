//! Ends of the program: with a command line that cannot be understood, an error, or well.

use clap::error::ErrorKind;

use crate::Error;
use crate::terminal::note;

/// Prints what clap says about a command line: help and version in full, anything wrong as one line on standard error
/// with the exit code 2, like every other error of the program.
pub fn refuse(error: &clap::Error) -> u8 {
    if !error.use_stderr() || error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        // A closed pipe is no reason to fail after help was asked for.
        let _ = error.print();
        return if error.use_stderr() { 2 } else { 0 };
    }
    let text = error.to_string();
    let first = text.split("\n\n").next().unwrap_or_default();
    note(&first.split_whitespace().collect::<Vec<_>>().join(" "));
    2
}

/// Exit code of a command that has ended: an error is one line on standard error and exit code 2, or 1 where results are written that may
/// be wrong. A reader that has closed its end of standard output, as `head` does, has what it wants.
pub fn finish(result: Result<(), Error>) -> u8 {
    match result {
        Ok(()) => 0,
        Err(Error::StandardOutput(source)) if source.kind() == std::io::ErrorKind::BrokenPipe => 0,
        Err(error) => {
            note(&format!("error: {error}"));
            if matches!(error, Error::NotTheWholeBrake { .. }) { 1 } else { 2 }
        }
    }
}
