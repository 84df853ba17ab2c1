//! The lines of a text file, one at a time.

use std::io::{BufRead, Read};

use crate::error::{FormatsError, Place};
use crate::problem::Problem;

/// The longest line, bytes. Chosen: programs write at most a few hundred; it bounds the memory of a file without line ends.
const LONGEST: usize = 1 << 16;

/// Lines with their number.
pub(crate) struct Lines<'a> {
    source: Box<dyn BufRead + 'a>,
    line: Vec<u8>,
    /// Number of the line last read, from 1.
    pub number: usize,
    /// Whether the line last read had an end.
    ended: bool,
    /// Whether the line last read is to come again.
    again: bool,
}

impl<'a> Lines<'a> {
    pub fn new(source: Box<dyn BufRead + 'a>) -> Self {
        Self { source, line: Vec::new(), number: 0, ended: true, again: false }
    }

    /// The next line without its end.
    pub fn next(&mut self) -> Result<Option<&str>, Problem> {
        if std::mem::take(&mut self.again) {
            return Ok(Some(self.current()));
        }
        self.line.clear();
        let read = (&mut self.source).take(LONGEST as u64 + 1).read_until(b'\n', &mut self.line);
        if read.map_err(|e| Problem::Read { what: crate::shortened::cut(&e.to_string()) })? == 0 {
            return Ok(None);
        }
        self.ended = self.line.last() == Some(&b'\n');
        self.number += 1;
        if self.line.len() > LONGEST {
            return Err(Problem::LongLine { most: LONGEST });
        }
        std::str::from_utf8(&self.line).map_err(|_| Problem::NotText)?;
        Ok(Some(self.current()))
    }

    /// The next line that is neither blank nor a comment, without blanks around it.
    pub fn next_but(&mut self, comment: &str) -> Result<Option<&str>, Problem> {
        loop {
            match self.next()?.map(str::trim) {
                // The borrow ends here; the line is looked at again below.
                Some(line) if line.is_empty() || line.starts_with(comment) => {}
                Some(_) => break,
                None => return Ok(None),
            }
        }
        Ok(Some(self.current().trim()))
    }

    /// Lets the line last read come again.
    pub fn push_back(&mut self) {
        self.again = true;
    }

    /// The line last read without its end.
    pub fn current(&self) -> &str {
        let line = self.line.strip_suffix(b"\n").unwrap_or(&self.line);
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        let line = if self.number == 1 { line.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(line) } else { line };
        std::str::from_utf8(line).unwrap_or_default()
    }

    /// Checks that the last line had an end. Where a format has no count of entries, a missing one is all that tells a file
    /// that was cut in the middle of a number from a whole one.
    pub fn check_end(&self) -> Result<(), Problem> {
        if self.ended { Ok(()) } else { Err(Problem::End { what: "a line; a whole file ends with a line end" }) }
    }

    /// A problem, with the line where it was met.
    pub fn located(&self, problem: Problem) -> FormatsError {
        FormatsError::At { place: Place::Line(self.number.max(1)), problem: Box::new(problem) }
    }
}
