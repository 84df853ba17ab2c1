//! The bytes of a binary file, read forwards.

use std::io::{ErrorKind, Read};

use crate::problem::Problem;
use crate::shortened::cut;

/// The order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Endian {
    Little,
    Big,
}

/// A reader that knows its position.
pub(crate) struct Bytes<'a> {
    source: Box<dyn Read + 'a>,
    /// Bytes read so far.
    pub position: u64,
    /// The order of bytes in numbers.
    pub endian: Endian,
}

impl<'a> Bytes<'a> {
    pub fn new(source: Box<dyn Read + 'a>, endian: Endian) -> Self {
        Self { source, position: 0, endian }
    }

    /// The next `N` bytes.
    pub fn array<const N: usize>(&mut self, what: &'static str) -> Result<[u8; N], Problem> {
        let mut bytes = [0; N];
        self.fill(&mut bytes, what)?;
        Ok(bytes)
    }

    fn fill(&mut self, bytes: &mut [u8], what: &'static str) -> Result<(), Problem> {
        self.source.read_exact(bytes).map_err(|e| unread(&e, what))?;
        self.position += bytes.len() as u64;
        Ok(())
    }

    /// The first byte of what follows, which is read; `None` at the end of the file.
    pub fn first(&mut self) -> Result<Option<u8>, Problem> {
        let mut byte = [0];
        loop {
            match self.source.read(&mut byte) {
                Ok(0) => return Ok(None),
                Ok(_) => {
                    self.position += 1;
                    return Ok(Some(byte[0]));
                }
                Err(e) if e.kind() == ErrorKind::Interrupted => {}
                Err(e) => return Err(unread(&e, "an element")),
            }
        }
    }

    pub fn u32(&mut self, what: &'static str) -> Result<u32, Problem> {
        Ok(self.endian.u32(self.array(what)?))
    }

    pub fn i32(&mut self, what: &'static str) -> Result<i32, Problem> {
        Ok(self.u32(what)? as i32)
    }

    pub fn i64(&mut self, what: &'static str) -> Result<i64, Problem> {
        Ok(self.endian.u64(self.array(what)?) as i64)
    }

    pub fn f64(&mut self, what: &'static str) -> Result<f64, Problem> {
        Ok(f64::from_bits(self.endian.u64(self.array(what)?)))
    }

    pub fn f32(&mut self, what: &'static str) -> Result<f64, Problem> {
        Ok(f64::from(f32::from_bits(self.u32(what)?)))
    }

    /// A short text whose length the caller has bounded.
    pub fn text(&mut self, length: usize, what: &'static str) -> Result<String, Problem> {
        let mut bytes = vec![0; length];
        self.fill(&mut bytes, what)?;
        let end = bytes.iter().position(|&b| b == 0).unwrap_or(length);
        Ok(String::from_utf8_lossy(&bytes[..end]).trim().to_owned())
    }

    /// Reads over `count` bytes, which must be there.
    pub fn skip(&mut self, count: u64, what: &'static str) -> Result<(), Problem> {
        let skipped =
            std::io::copy(&mut (&mut self.source).take(count), &mut std::io::sink()).map_err(|e| unread(&e, what))?;
        self.position += skipped;
        if skipped == count { Ok(()) } else { Err(Problem::End { what }) }
    }

    /// The bytes that follow, as a reader of their own.
    pub fn rest(&mut self) -> &mut (dyn Read + 'a) {
        &mut self.source
    }
}

fn unread(error: &std::io::Error, what: &'static str) -> Problem {
    match error.kind() {
        ErrorKind::UnexpectedEof => Problem::End { what },
        _ => Problem::Read { what: cut(&error.to_string()) },
    }
}

impl Endian {
    pub fn u16(self, bytes: [u8; 2]) -> u16 {
        if self == Self::Little { u16::from_le_bytes(bytes) } else { u16::from_be_bytes(bytes) }
    }

    pub fn u32(self, bytes: [u8; 4]) -> u32 {
        if self == Self::Little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) }
    }

    pub fn u64(self, bytes: [u8; 8]) -> u64 {
        if self == Self::Little { u64::from_le_bytes(bytes) } else { u64::from_be_bytes(bytes) }
    }
}
