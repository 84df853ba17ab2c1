//! Reading files whose sizes are bounded.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// The largest case file, bytes. Chosen: its parser takes up to 75 times as much memory, 300 MB; matrices that large belong
/// into files of their own.
pub const LARGEST_CASE: u64 = 4_000_000;
/// The largest file with a matrix, bytes. Chosen: enough for 1,600 x 1,600 numbers of 25 characters each.
pub const LARGEST_MATRIX: u64 = 64_000_000;

/// Most rows or columns of a matrix of a case that is full; chosen: 4096 x 4096 takes 128 MB.
pub const LARGEST_ORDER: usize = 4096;

/// Refuses what is no regular file of at most `most` bytes. Anything else could be without an end, or never begin.
pub fn check_size(path: &Path, most: u64) -> io::Result<()> {
    let found = std::fs::metadata(path)?;
    match found.is_file() {
        true if found.len() <= most => Ok(()),
        true => Err(of_at_most(most, &format!("it has {} MB", found.len() / 1_000_000))),
        false => Err(of_at_most(most, if found.is_dir() { "it is a directory" } else { "it is no regular file" })),
    }
}

fn of_at_most(most: u64, found: &str) -> io::Error {
    io::Error::other(format!("{found}; allowed: a regular file of at most {} MB", most / 1_000_000))
}

/// The contents of a regular file of at most `most` bytes, also where it grows meanwhile.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    check_size(path, most)?;
    let mut bytes = Vec::new();
    File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(of_at_most(most, "it has more by now"));
    }
    Ok(bytes)
}

/// [`read`], of a file that must be text.
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    String::from_utf8(read(path, most)?).map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "it is no UTF-8 text"))
}
