//! Lines and texts for people who run the program.

use std::io::{self, Write};

use output::printable;

use crate::Error;

/// Says a line on standard error; nobody has to listen, so that a closed or full one is no error.
pub fn note(text: &str) {
    let _ = writeln!(io::stderr(), "{}", printable(text));
}

/// Writes text to standard output, where a reader that has closed its end, as `head` does, has what it wants.
///
/// # Errors
/// [`Error::StandardOutput`].
pub fn say(text: &str) -> Result<(), Error> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Error::StandardOutput(error)),
        _ => Ok(()),
    }
}
