//! OP4 as Fortran's binary records: a length, as many bytes, the length again.

use super::{Open, short_header};
use crate::builder::Found;
use crate::bytes::{Bytes, Endian};
use crate::limits::Limits;
use crate::problem::Problem;

/// Words of the header of a matrix, of which two are its name.
const HEADER: u32 = 6;
/// Words of the header of a column.
const COLUMN: u32 = 3;
/// Bytes of a word: of a whole number, and of a real one in single precision. Of 8 bytes all real numbers are in double precision,
/// one word each; marks of a record's length have 4 bytes nevertheless.
const WORDS: [u32; 2] = [4, 8];

/// The byte order, if the file begins with a header.
pub(crate) fn detect(head: &[u8]) -> Option<Endian> {
    let mark = |at: usize| head.get(at..at + 4).and_then(|b| <[u8; 4]>::try_from(b).ok());
    let first = mark(0)?;
    let is_header = |endian: &Endian| {
        let length = endian.u32(first);
        word_of_header(length).is_some() && mark(4 + length as usize).is_some_and(|last| endian.u32(last) == length)
    };
    [Endian::Little, Endian::Big].into_iter().find(is_header)
}

/// The bytes of a word in a file whose headers have `length` bytes.
fn word_of_header(length: u32) -> Option<u32> {
    WORDS.into_iter().find(|word| length == HEADER * word)
}

/// Reads all matrices.
pub(crate) fn parse(bytes: &mut Bytes<'_>, limits: &Limits) -> Result<Found, Problem> {
    let mut found = Found::default();
    while let Some(first) = bytes.first()? {
        let [b, c, d] = bytes.array("the header of a matrix")?;
        let length = bytes.endian.u32([first, b, c, d]);
        let allowed = || WORDS.map(|word| (HEADER * word).to_string()).join(" or ");
        let word = word_of_header(length)
            .ok_or_else(|| Problem::field("bytes of the header of a matrix", length, allowed()))?;
        let mut numbers = [0; 4];
        for number in &mut numbers {
            *number = whole(bytes, word, "the header of a matrix")?;
        }
        // Words of 8 bytes may have four letters each, and blanks.
        let name = bytes.text(2 * word as usize, "the header of a matrix")?.replace(' ', "");
        end_record(bytes, length)?;
        let mut open = Open::new(numbers, name, limits)?;
        if word == 8 {
            open.words = 1;
        }
        while read_column(bytes, word, &mut open)? {}
        open.finish(&mut found)?;
    }
    Ok(found)
}

/// A whole number of one word.
fn whole(bytes: &mut Bytes<'_>, word: u32, what: &'static str) -> Result<i64, Problem> {
    if word == 8 { bytes.i64(what) } else { bytes.i32(what).map(i64::from) }
}

fn end_record(bytes: &mut Bytes<'_>, length: u32) -> Result<(), Problem> {
    let found = bytes.u32("a record")?;
    if found == length {
        return Ok(());
    }
    Err(Problem::field("length after a record", found, format!("{length}, as before it")))
}

/// Reads one column; false where it was the one beyond the last.
fn read_column(bytes: &mut Bytes<'_>, word: u32, open: &mut Open) -> Result<bool, Problem> {
    let length = bytes.u32("a matrix")?;
    let least = COLUMN * word;
    let data = length
        .checked_sub(least)
        .ok_or_else(|| Problem::field("bytes of a column", length, format!("{least} or more")))?;
    let column = whole(bytes, word, "a column")?;
    let row = whole(bytes, word, "a column")?;
    let words = whole(bytes, word, "a column")?;
    let within = open.column(column)?;
    if !within {
        bytes.skip(u64::from(data), "the last column")?;
    } else if words.checked_mul(i64::from(word)) != Some(i64::from(data)) {
        let allowed = format!("{} as by the length of the record", data / word);
        return Err(Problem::field("words of a column", words, allowed));
    } else if row != 0 {
        let words = (data / word) as usize;
        if !words.is_multiple_of(open.words) {
            return Err(Problem::field("words of a column", words, format!("a multiple of {}", open.words)));
        }
        stretch(bytes, word, open, row, words / open.words)?;
    } else {
        let mut left = words;
        while left > 0 {
            let first = whole(bytes, word, "a string")?;
            let (length, row) =
                if open.bigmat { (first, whole(bytes, word, "a string")?) } else { short_header(first) };
            let count = open.numbers_of(length)?;
            left = left.saturating_sub(length).saturating_sub(i64::from(open.bigmat));
            if left < 0 {
                return Err(Problem::field("length of a string", length, "within its column"));
            }
            stretch(bytes, word, open, row, count)?;
        }
    }
    end_record(bytes, length)?;
    Ok(within)
}

fn stretch(bytes: &mut Bytes<'_>, word: u32, open: &mut Open, row: i64, count: usize) -> Result<(), Problem> {
    let row = open.stretch(row, count)?;
    let is_single = word as usize * open.words == size_of::<f32>();
    for at in 0..count {
        let value = if is_single { bytes.f32("a column")? } else { bytes.f64("a column")? };
        open.put(row, at, value)?;
    }
    Ok(())
}
