//! MATLAB's `.mat` files of version 4 (`save -v4`): for each array five numbers (type, rows, columns, imaginary flag, length of the name), the name, then the
//! columns. The type is written in decimal digits MOPT: M byte order (0 little, 1 big), O always 0, P type of the numbers (0 to 5: f64, f32, i32, i16, u16, u8), T 0 full, 1 text, 2 sparse. A sparse array is stored
//! as a full one with three columns (four if complex): row, column, value, imaginary part; its last row is the size of the matrix.

use super::elements::{Storage, fill, index};
use crate::builder::{Builder, Found, Head, Stated};
use crate::bytes::{Bytes, Endian};
use crate::limits::Limits;
use crate::numbers::order;
use crate::problem::Problem;

/// Longest name; MATLAB's own limit is 63 and a final zero.
const LONGEST_NAME: u32 = 64;

/// The byte order, if the file begins with a header of an array.
pub(crate) fn detect(head: &[u8]) -> Option<Endian> {
    let word = |endian: Endian, at: usize| Some(endian.u32(head.get(4 * at..4 * at + 4)?.try_into().ok()?));
    [Endian::Little, Endian::Big].into_iter().find(|&endian| {
        let known = word(endian, 0).and_then(|kind| parse_type(kind, endian)).is_some();
        let sizes = [1, 2].iter().all(|&at| word(endian, at).is_some_and(|size| size < 1 << 31));
        let length = word(endian, 4).filter(|length| (2..=LONGEST_NAME).contains(length));
        let name = length.and_then(|length| head.get(20..20 + length as usize - 1));
        let spelled = name.is_some_and(|name| name.iter().all(|b| b.is_ascii_alphanumeric() || *b == b'_'));
        known && sizes && word(endian, 3).is_some_and(|flag| flag < 2) && spelled
    })
}

/// Storage of the numbers and T of a type MOPT; `None` where O is not 0, P or T is unknown, or M is not this byte order.
fn parse_type(kind: u32, endian: Endian) -> Option<(Storage, u32)> {
    let order = if endian == Endian::Little { 0 } else { 1 };
    let storage = [Storage::F64, Storage::F32, Storage::I32, Storage::I16, Storage::U16, Storage::U8]
        .get(kind as usize / 10 % 10)?;
    (kind / 1000 == order && (kind / 100).is_multiple_of(10) && kind % 10 < 3).then_some((*storage, kind % 10))
}

/// Reads all arrays.
pub(crate) fn parse(bytes: &mut Bytes<'_>, limits: &Limits) -> Result<Found, Problem> {
    let mut found = Found::default();
    while let Some(first) = bytes.first()? {
        let what = "the header of an array";
        let [b, c, d] = bytes.array(what)?;
        let kind = bytes.endian.u32([first, b, c, d]);
        let (storage, shape) = parse_type(kind, bytes.endian)
            .ok_or_else(|| Problem::field("type of an array", kind, "MOPT of version 4"))?;
        let [rows, columns, imaginary, length] =
            [bytes.u32(what)?, bytes.u32(what)?, bytes.u32(what)?, bytes.u32(what)?];
        if !(1..=LONGEST_NAME).contains(&length) {
            return Err(Problem::field("length of a name", length, format!("1 to {LONGEST_NAME}")));
        }
        let name = bytes.text(length as usize, what)?;
        let numbers = u64::from(rows).saturating_mul(u64::from(columns));
        let reason = match shape {
            1 => "text",
            _ if numbers == 0 => "empty",
            _ => "",
        };
        if !reason.is_empty() {
            let blocks = if imaginary == 1 { 2 } else { 1 };
            bytes.skip(numbers.saturating_mul(storage.size()).saturating_mul(blocks), "an array")?;
            found.leave_out(&name, reason);
            continue;
        }
        let (builder, size) = if shape == 2 {
            sparse(bytes, storage, (rows, columns), limits)?
        } else {
            let size = (
                order("number of rows", rows as usize, limits.order)?,
                order("number of columns", columns as usize, limits.order)?,
            );
            let mut builder = Builder::new(limits);
            fill(bytes, storage, size, &mut builder)?;
            if imaginary == 1 {
                for _ in 0..numbers {
                    builder.note_imaginary(storage.read(bytes, "an array")?)?;
                }
            }
            (builder, size)
        };
        found.keep(&name, builder.finish(Stated::Array, Head::unlabelled(name.clone(), None, size)))?;
    }
    Ok(found)
}

/// Reads a sparse array of `lines` x `columns` stored numbers, column by column: row indices, column indices (from 1), values, imaginary parts. The last line is the size of the matrix.
fn sparse(
    bytes: &mut Bytes<'_>,
    storage: Storage,
    (lines, columns): (u32, u32),
    limits: &Limits,
) -> Result<(Builder, (usize, usize)), Problem> {
    if !matches!(columns, 3 | 4) {
        return Err(Problem::field("columns of a sparse array", columns, "3, or 4 of complex numbers"));
    }
    let lines = lines as usize;
    if lines > limits.entries.saturating_add(1) {
        return Err(Problem::Limit { what: "entries of a matrix", most: limits.entries as u64 });
    }
    let (mut places, mut size) = ([Vec::new(), Vec::new()], [0; 2]);
    for (which, places) in places.iter_mut().enumerate() {
        for _ in 1..lines {
            places.push(index("index", storage.read(bytes, "a sparse array")?, limits.order)?);
        }
        let what = if which == 0 { "number of rows" } else { "number of columns" };
        size[which] = order(what, index(what, storage.read(bytes, "a sparse array")?, limits.order)?, limits.order)?;
    }
    let mut builder = Builder::new(limits);
    for (&row, &column) in places[0].iter().zip(&places[1]) {
        for (what, found, largest) in [("row", row, size[0]), ("column", column, size[1])] {
            if found == 0 || found > largest {
                return Err(Problem::Index { what, found, largest });
            }
        }
        builder.push(row - 1, column - 1, storage.read(bytes, "a sparse array")?)?;
    }
    storage.read(bytes, "a sparse array")?;
    if columns == 4 {
        for _ in 0..lines {
            builder.note_imaginary(storage.read(bytes, "a sparse array")?)?;
        }
    }
    Ok((builder, (size[0], size[1])))
}
