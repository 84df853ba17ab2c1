//! The lines of a text file, one at a time, whatever ends them and in whatever encoding their comments are.

use std::io::BufRead;

use crate::error::{FormatsError, Place};
use crate::problem::Problem;

/// The longest line, bytes. Chosen: programs write at most a few hundred; it bounds the memory of a file without line ends.
const LONGEST: usize = 1 << 16;

/// Text whatever program wrote it: without a byte order mark, its lines ended by line feeds alone.
#[must_use]
pub fn plain_text(text: &str) -> String {
    text.trim_start_matches('\u{feff}').replace("\r\n", "\n").replace('\r', "\n")
}

/// Lines with their number.
pub(crate) struct Lines<'a> {
    source: Box<dyn BufRead + 'a>,
    line: Vec<u8>,
    /// Number of the line last read, from 1.
    pub number: usize,
    /// The line last read had an end.
    ended: bool,
    /// The line last read is to come again.
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
        if !self.read().map_err(|e| Problem::Read { what: crate::shortened::cut(&e.to_string()) })? {
            return Ok(None);
        }
        self.number += 1;
        if self.line.len() > LONGEST {
            return Err(Problem::LongLine { most: LONGEST });
        }
        if self.number == 1 {
            if self.line.starts_with(&[0xff, 0xfe]) || self.line.starts_with(&[0xfe, 0xff]) {
                return Err(Problem::Utf16);
            }
            if let Some(rest) = self.line.strip_prefix(b"\xEF\xBB\xBF") {
                self.line = rest.to_vec();
            }
        }
        if self.line.contains(&0) {
            return Err(Problem::NotText);
        }
        if std::str::from_utf8(&self.line).is_err() {
            // Every byte is a character of Latin-1, the beginning of Unicode.
            self.line = self.line.iter().map(|&byte| char::from(byte)).collect::<String>().into_bytes();
        }
        Ok(Some(self.current()))
    }

    /// Reads a line up to its end, which is LF, CR LF or CR alone, and that end; whether there was one. It stops after the longest.
    fn read(&mut self) -> std::io::Result<bool> {
        let mut any = false;
        loop {
            let buffer = self.source.fill_buf()?;
            if buffer.is_empty() {
                return Ok(any);
            }
            // Where nothing is left the line before is still the last one.
            (any, self.ended) = (true, false);
            let end = buffer.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
            let (length, is_cr) = (end.unwrap_or(buffer.len()), end.is_some_and(|at| buffer[at] == b'\r'));
            self.line.extend_from_slice(&buffer[..length.min(LONGEST + 1)]);
            self.source.consume(length + usize::from(end.is_some()));
            if end.is_some() {
                self.ended = true;
                if is_cr && self.source.fill_buf()?.first() == Some(&b'\n') {
                    self.source.consume(1);
                }
                return Ok(true);
            }
            if self.line.len() > LONGEST {
                return Ok(true);
            }
        }
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
        std::str::from_utf8(&self.line).unwrap_or_default()
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

#[cfg(test)]
mod tests {
    use super::*;

    fn all(bytes: &[u8], buffer: usize) -> Result<(Vec<String>, bool), Problem> {
        let mut lines = Lines::new(Box::new(std::io::BufReader::with_capacity(buffer, bytes)));
        let mut found = Vec::new();
        while let Some(line) = lines.next()? {
            found.push(line.to_owned());
        }
        Ok((found, lines.check_end().is_ok()))
    }

    #[test]
    fn lines_are_the_same_whatever_ends_them_and_however_they_are_encoded() {
        let text = ["* Beläge über 20 µm", "", "1, 2", "é"];
        let utf8: Vec<Vec<u8>> = text.iter().map(|line| line.as_bytes().to_vec()).collect();
        let latin1: Vec<Vec<u8>> = text.iter().map(|line| line.chars().map(|c| c as u8).collect()).collect();
        for lines in [utf8, latin1] {
            for end in [&b"\n"[..], b"\r\n", b"\r"] {
                for (mark, last) in [(&b""[..], true), (b"\xEF\xBB\xBF", false)] {
                    if !mark.is_empty() && std::str::from_utf8(&lines[0]).is_err() {
                        continue;
                    }
                    let bytes = [mark, &lines.join(end)[..], if last { end } else { b"" }].concat();
                    for buffer in [1, 2, 7, 1000] {
                        let expected = (text.map(str::to_owned).to_vec(), last);
                        assert_eq!(all(&bytes, buffer), Ok(expected), "{end:?}, {buffer}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_no_text_is_refused() {
        let utf16 = |mark: &[u8]| {
            [mark, &"*NODE\n".encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>()[..]].concat()
        };
        assert_eq!(all(&utf16(&[0xff, 0xfe]), 100), Err(Problem::Utf16));
        assert_eq!(all(&utf16(&[]), 100), Err(Problem::NotText));
        assert_eq!(all(&vec![b'x'; 3 * LONGEST], 100), Err(Problem::LongLine { most: LONGEST }));
        assert_eq!(all(&vec![b'x'; LONGEST], 100).map(|(lines, _)| lines.len()), Ok(1));
    }
}
