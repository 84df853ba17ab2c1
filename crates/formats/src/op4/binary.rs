//! OP4 as Fortran's binary records: a length, as many bytes, the length again.

use super::{Open, short_header};
use crate::bytes::{Bytes, Endian};
use crate::dmig::Found;
use crate::limits::Limits;
use crate::problem::Problem;

/// Bytes of the header of a matrix, and of that of a column.
const HEADER: u32 = 24;
const COLUMN: u32 = 12;

/// The byte order, if the file begins with a header.
pub(crate) fn detect(head: &[u8]) -> Option<Endian> {
    let mark = |at: usize| head.get(at..at + 4).and_then(|b| <[u8; 4]>::try_from(b).ok());
    let (first, last) = (mark(0)?, mark(4 + HEADER as usize)?);
    [Endian::Little, Endian::Big].into_iter().find(|e| e.u32(first) == HEADER && e.u32(last) == HEADER)
}

/// Whether the file begins with a header of 8-byte words.
pub(crate) fn has_long_words(head: &[u8]) -> bool {
    let mark = |at: usize| head.get(at..at + 4).and_then(|b| <[u8; 4]>::try_from(b).ok());
    let (Some(first), Some(last)) = (mark(0), mark(4 + 2 * HEADER as usize)) else { return false };
    [Endian::Little, Endian::Big].iter().any(|e| e.u32(first) == 2 * HEADER && e.u32(last) == 2 * HEADER)
}

/// Reads all matrices.
pub(crate) fn parse(bytes: &mut Bytes<'_>, limits: &Limits) -> Result<Found, Problem> {
    let mut found = Found::default();
    while let Some(first) = bytes.first()? {
        let [b, c, d] = bytes.array("the header of a matrix")?;
        let length = bytes.endian.u32([first, b, c, d]);
        if length != HEADER {
            return Err(Problem::field("bytes of the header of a matrix", length, HEADER.to_string()));
        }
        let mut numbers = [0; 4];
        for number in &mut numbers {
            *number = i64::from(bytes.i32("the header of a matrix")?);
        }
        let name = bytes.text(8, "the header of a matrix")?;
        end_record(bytes, length)?;
        let mut open = Open::new(numbers, name, limits)?;
        while read_column(bytes, &mut open)? {}
        open.finish(&mut found)?;
    }
    Ok(found)
}

fn end_record(bytes: &mut Bytes<'_>, length: u32) -> Result<(), Problem> {
    let found = bytes.u32("a record")?;
    if found == length {
        return Ok(());
    }
    Err(Problem::field("length after a record", found, format!("{length}, as before it")))
}

/// Reads one column; false where it was the one beyond the last.
fn read_column(bytes: &mut Bytes<'_>, open: &mut Open) -> Result<bool, Problem> {
    let length = bytes.u32("a matrix")?;
    let data = length.checked_sub(COLUMN).ok_or_else(|| Problem::field("bytes of a column", length, "12 or more"))?;
    let column = bytes.i32("a column")?;
    let row = bytes.i32("a column")?;
    let words = bytes.u32("a column")?;
    let within = open.column(i64::from(column))?;
    if !within {
        bytes.skip(u64::from(data), "the last column")?;
    } else if u64::from(words) * 4 != u64::from(data) {
        return Err(Problem::field("words of a column", words, format!("{} as by the length of the record", data / 4)));
    } else if row != 0 {
        if !(words as usize).is_multiple_of(open.words) {
            return Err(Problem::field("words of a column", words, format!("a multiple of {}", open.words)));
        }
        stretch(bytes, open, i64::from(row), words as usize / open.words)?;
    } else {
        let mut left = i64::from(words);
        while left > 0 {
            let first = i64::from(bytes.i32("a string")?);
            let (length, row) =
                if open.bigmat { (first, i64::from(bytes.i32("a string")?)) } else { short_header(first) };
            let count = open.numbers_of(length)?;
            left -= length + i64::from(open.bigmat);
            if left < 0 {
                return Err(Problem::field("length of a string", length, "within its column"));
            }
            stretch(bytes, open, row, count)?;
        }
    }
    end_record(bytes, length)?;
    Ok(within)
}

fn stretch(bytes: &mut Bytes<'_>, open: &mut Open, row: i64, count: usize) -> Result<(), Problem> {
    let row = open.stretch(row, count)?;
    for at in 0..count {
        let value = if open.words == 1 { bytes.f32("a column")? } else { bytes.f64("a column")? };
        open.put(row, at, value)?;
    }
    Ok(())
}
