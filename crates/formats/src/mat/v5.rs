//! Versions 5 to 7: a header of 128 bytes, then elements of a tag and data, each an array or a compressed array.

use flate2::read::ZlibDecoder;
use std::io::Read;

use super::elements::{Storage, index};
use crate::builder::{Builder, Head, Stated};
use crate::bytes::{Bytes, Endian};
use crate::dmig::Found;
use crate::limits::Limits;
use crate::numbers::order;
use crate::problem::Problem;

const HEADER: u64 = 128;
/// Types of elements.
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Flags of an array.
const COMPLEX: u32 = 0x800;
/// Longest name; MATLAB's own limit is 63.
const LONGEST_NAME: u64 = 255;

/// The byte order, if the file begins with this header.
pub(crate) fn detect(head: &[u8]) -> Option<Endian> {
    match head.get(124..128)? {
        [0, 1, b'I', b'M'] => Some(Endian::Little),
        [1, 0, b'M', b'I'] => Some(Endian::Big),
        _ => None,
    }
}

/// Reads all arrays.
pub(crate) fn parse(bytes: &mut Bytes<'_>, limits: &Limits) -> Result<Found, Problem> {
    let mut found = Found::default();
    bytes.skip(HEADER, "the header")?;
    let endian = bytes.endian;
    while let Some(first) = bytes.first()? {
        let [b, c, d] = bytes.array("the tag of an element")?;
        let kind = endian.u32([first, b, c, d]);
        let length = u64::from(bytes.u32("the tag of an element")?);
        let start = bytes.position;
        match kind {
            MATRIX => {
                let mut inner = Bytes::new(Box::new(bytes.rest().take(length)), endian);
                array(&mut inner, length, limits, &mut found)?;
                let used = inner.position;
                drop(inner);
                bytes.position += used;
                bytes.skip(length - used, "an array")?;
            }
            COMPRESSED => {
                let mut raw = bytes.rest().take(length);
                let mut inner = Bytes::new(Box::new(ZlibDecoder::new(&mut raw).take(limits.bytes)), endian);
                let kind = inner.u32("a compressed array")?;
                let size = u64::from(inner.u32("a compressed array")?);
                if kind != MATRIX {
                    return Err(Problem::field("type of a compressed element", kind, "14, an array"));
                }
                array(&mut inner, size, limits, &mut found)?;
                drop(inner);
                // The decoder reads ahead; what it left is the rest of the element.
                let left = raw.limit();
                bytes.position += length - left;
                bytes.skip(left, "a compressed array")?;
            }
            // Other elements (such as a subsystem's data) hold no variable.
            1..=18 => bytes.skip(length, "an element")?,
            found => return Err(Problem::field("type of an element", found, "1 to 18")),
        }
        // Arrays are padded to 8 bytes; compressed elements are not.
        if kind != COMPRESSED && length % 8 != 0 {
            bytes.skip(8 - length % 8, "an element")?;
        }
        debug_assert!(bytes.position >= start + length);
    }
    Ok(found)
}

/// The tag of a part of an array: its type and the bytes of its data; small data stand in the tag itself.
struct Tag {
    kind: u32,
    length: u64,
    /// Bytes after the data up to where the next part begins.
    padding: u64,
}

fn tag(bytes: &mut Bytes<'_>) -> Result<Tag, Problem> {
    let word = bytes.u32("the tag of an array's part")?;
    if word >> 16 != 0 {
        let (kind, length) = (word & 0xffff, u64::from(word >> 16));
        let padding = 4_u64.checked_sub(length).ok_or_else(|| Problem::field("bytes in a tag", length, "1 to 4"))?;
        return Ok(Tag { kind, length, padding });
    }
    let length = u64::from(bytes.u32("the tag of an array's part")?);
    Ok(Tag { kind: word, length, padding: length.wrapping_neg() % 8 })
}

fn storage(kind: u32) -> Result<Storage, Problem> {
    Ok(match kind {
        1 => Storage::I8,
        2 => Storage::U8,
        3 => Storage::I16,
        4 => Storage::U16,
        5 => Storage::I32,
        6 => Storage::U32,
        7 => Storage::F32,
        9 => Storage::F64,
        12 => Storage::I64,
        13 => Storage::U64,
        found => return Err(Problem::field("type of numbers", found, "1 to 7, 9, 12 or 13")),
    })
}

/// Numbers of a part, which must be as many as expected.
fn numbers(bytes: &mut Bytes<'_>, expected: u64) -> Result<(Storage, u64), Problem> {
    let Tag { kind, length, padding } = tag(bytes)?;
    let storage = storage(kind)?;
    if expected.checked_mul(storage.size()) != Some(length) {
        return Err(Problem::field("bytes of an array's part", length, format!("{expected} numbers")));
    }
    Ok((storage, padding))
}

fn array(bytes: &mut Bytes<'_>, size: u64, limits: &Limits, found: &mut Found) -> Result<(), Problem> {
    if size == 0 {
        return Ok(());
    }
    let flags = tag(bytes)?;
    if (flags.kind, flags.length) != (6, 8) {
        return Err(Problem::field(
            "flags of an array",
            format!("type {}, {} bytes", flags.kind, flags.length),
            "type 6, 8 bytes",
        ));
    }
    let (flags, most) = (bytes.u32("flags")?, bytes.u32("flags")?);
    let class = flags & 0xff;
    if matches!(class, 16..) {
        // Functions and opaque objects have parts of another order, and no name that could be found.
        found.1.push((format!("an object of class {class}"), "no array of numbers".to_owned()));
        return Ok(());
    }
    let dimensions = tag(bytes)?;
    if dimensions.kind != 5 || dimensions.length % 4 != 0 || dimensions.length == 0 || dimensions.length > 4 * 32 {
        return Err(Problem::field("bytes of the dimensions", dimensions.length, "4 each, up to 32 of them"));
    }
    let mut shape = Vec::new();
    for _ in 0..dimensions.length / 4 {
        let found = bytes.i32("the dimensions")?;
        shape.push(usize::try_from(found).map_err(|_| Problem::field("a dimension", found, "0 or more"))?);
    }
    bytes.skip(dimensions.padding, "the dimensions")?;
    let name = tag(bytes)?;
    if !matches!(name.kind, 1 | 2 | 16) || name.length > LONGEST_NAME {
        return Err(Problem::field("bytes of a name", name.length, format!("at most {LONGEST_NAME} characters")));
    }
    let padding = name.padding;
    let name = bytes.text(name.length as usize, "a name")?;
    bytes.skip(padding, "a name")?;
    let reason = match (class, shape.as_slice()) {
        (1, _) => "a cell array",
        (2, _) => "a structure",
        (3, _) => "an object",
        (4, _) => "text",
        (5..=15, _) if flags & COMPLEX != 0 => "complex numbers, of which none are read here",
        (5..=15, [0, _] | [_, 0]) => "empty",
        (5..=15, [_, _]) => "",
        (5..=15, _) => "not of two dimensions",
        _ => return Err(Problem::field("class of an array", class, "1 to 15")),
    };
    if !reason.is_empty() {
        found.1.push((name, reason.to_owned()));
        return Ok(());
    }
    let size = (order("number of rows", shape[0], limits.order)?, order("number of columns", shape[1], limits.order)?);
    let mut builder = Builder::new(limits);
    if class == 5 {
        sparse(bytes, size, u64::from(most), limits, &mut builder)?;
    } else {
        let (storage, _) = numbers(bytes, size.0 as u64 * size.1 as u64)?;
        fill(bytes, storage, size, &mut builder)?;
    }
    found.0.push(builder.finish(Stated::Nothing, Head::unlabelled(name, None, size))?);
    Ok(())
}

/// Reads a full array by columns and keeps what is not zero.
pub(super) fn fill(
    bytes: &mut Bytes<'_>,
    storage: Storage,
    (rows, columns): (usize, usize),
    builder: &mut Builder,
) -> Result<(), Problem> {
    for column in 0..columns {
        for row in 0..rows {
            let value = storage.read(bytes, "an array")?;
            if value != 0.0 {
                builder.push(row, column, value)?;
            }
        }
    }
    Ok(())
}

/// Reads compressed columns: rows, the offsets of the columns, values. There may be room for more rows than are used.
fn sparse(
    bytes: &mut Bytes<'_>,
    (rows, columns): (usize, usize),
    most: u64,
    limits: &Limits,
    builder: &mut Builder,
) -> Result<(), Problem> {
    let Tag { kind, length, padding } = tag(bytes)?;
    let of_rows = storage(kind)?;
    let count = length / of_rows.size();
    if length % of_rows.size() != 0 || count > most.max(1) {
        return Err(Problem::field("rows of a sparse array", count, format!("at most {most}, as its flags say")));
    }
    if count > limits.entries as u64 {
        return Err(Problem::Limit { what: "entries of a matrix", most: limits.entries as u64 });
    }
    let mut places = Vec::new();
    for _ in 0..count {
        places.push(of_rows.read(bytes, "rows of a sparse array")?);
    }
    bytes.skip(padding, "rows of a sparse array")?;
    let (of_offsets, padding) = numbers(bytes, columns as u64 + 1)?;
    let mut offsets = Vec::new();
    for column in 0..=columns {
        let offset = index("offset of a column", of_offsets.read(bytes, "columns of a sparse array")?, count as usize)?;
        if offset < offsets.last().copied().unwrap_or(0) || (column == 0 && offset != 0) {
            return Err(Problem::field("offset of a column", offset, "growing from 0"));
        }
        offsets.push(offset);
    }
    bytes.skip(padding, "columns of a sparse array")?;
    let used = offsets.last().copied().unwrap_or(0);
    let Tag { kind, length, .. } = tag(bytes)?;
    let of_values = storage(kind)?;
    if length < used as u64 * of_values.size() {
        return Err(Problem::field("bytes of values", length, format!("{used} numbers or more")));
    }
    for (column, bounds) in offsets.windows(2).enumerate() {
        for &place in &places[bounds[0]..bounds[1]] {
            let row = index("row", place, rows - 1)?;
            builder.push(row, column, of_values.read(bytes, "values of a sparse array")?)?;
        }
    }
    Ok(())
}
