//! Contents of a file from a path or bytes: regular files only, decompressed, bounded, with progress.

use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Read};
use std::path::Path;

use flate2::bufread::MultiGzDecoder;

use crate::error::FormatsError;
use crate::limits::{Limits, Progress};

/// Bytes looked at to tell the format; chosen: comments before the first keyword are rarely longer.
const HEAD: usize = 1 << 16;
/// Bytes between two calls of a progress callback; chosen: with fewer calls take time, with more a bar stands still.
const STEP: u64 = 1 << 20;

/// A file that is open, and its size. Anything but a regular file could be without an end, or never begin.
pub(crate) fn open(path: &Path) -> Result<(File, u64), FormatsError> {
    let found = std::fs::metadata(path).map_err(FormatsError::Open)?;
    if !found.is_file() {
        return Err(FormatsError::NotRegular { found: if found.is_dir() { "a directory" } else { "no regular file" } });
    }
    Ok((File::open(path).map_err(FormatsError::Open)?, found.len()))
}

/// Decompressed contents, the beginning of which is known.
pub(crate) struct Contents<'a> {
    pub head: Vec<u8>,
    rest: Box<dyn BufRead + 'a>,
}

impl<'a> Contents<'a> {
    /// # Errors
    /// A stream that cannot be read.
    pub fn new(
        raw: impl Read + 'a,
        total: u64,
        limits: &Limits,
        progress: Option<Progress<'a>>,
    ) -> Result<Self, FormatsError> {
        let mut raw = BufReader::with_capacity(HEAD, Counted { inner: raw, read: 0, told: 0, total, progress });
        let start = raw.fill_buf().map_err(FormatsError::Open)?;
        let compressed = start.starts_with(&[0x1f, 0x8b]);
        let all: Box<dyn Read + 'a> = if compressed { Box::new(MultiGzDecoder::new(raw)) } else { Box::new(raw) };
        let mut rest = BufReader::with_capacity(HEAD, Bounded { inner: all, left: limits.bytes, most: limits.bytes });
        let mut head = Vec::new();
        (&mut rest).take(HEAD as u64).read_to_end(&mut head).map_err(FormatsError::Open)?;
        Ok(Self { head, rest: Box::new(rest) })
    }

    /// The contents from their beginning.
    pub fn whole(self) -> Box<dyn BufRead + 'a> {
        Box::new(Cursor::new(self.head).chain(self.rest))
    }
}

/// Tells how far the file is read.
struct Counted<'a, R> {
    inner: R,
    read: u64,
    told: u64,
    total: u64,
    progress: Option<Progress<'a>>,
}

impl<R: Read> Read for Counted<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let read = self.inner.read(buffer)?;
        self.read += read as u64;
        if let Some(progress) = &mut self.progress
            && (self.read - self.told >= STEP || (read == 0 && self.told < self.read))
        {
            self.told = self.read;
            progress(self.read, self.total);
        }
        Ok(read)
    }
}

/// Reader that fails after `most` bytes, in place of an end that would look like a shorter file.
struct Bounded<R> {
    inner: R,
    left: u64,
    most: u64,
}

impl<R: Read> Read for Bounded<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let read = self.inner.read(buffer)?;
        match self.left.checked_sub(read as u64) {
            Some(left) => self.left = left,
            None => {
                return Err(std::io::Error::other(format!("more than {} bytes of contents", self.most)));
            }
        }
        Ok(read)
    }
}
