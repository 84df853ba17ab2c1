//! Versions 5 to 7: a header of 128 bytes, then elements of a tag and data, each an array or a compressed array.

use flate2::read::ZlibDecoder;
use std::io::Read;

use super::elements::{Storage, fill, index};
use crate::builder::{Builder, Found, Head, Stated};
use crate::bytes::{Bytes, Endian};
use crate::limits::Limits;
use crate::numbers::order;
use crate::problem::Problem;

/// Bytes of the header of a file.
const HEADER: u64 = 128;
/// Type of an element that is an array.
const MATRIX: u32 = 14;
/// Type of an element that is compressed.
const COMPRESSED: u32 = 15;
/// Flags of an array.
const COMPLEX: u32 = 0x800;
/// Longest name; MATLAB's own limit is 63.
const LONGEST_NAME: u64 = 255;
/// Most structures within each other; chosen.
const DEEPEST: usize = 8;

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
                array(&mut inner, length, limits, (None, 0), &mut found)?;
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
                array(&mut inner, size, limits, (None, 0), &mut found)?;
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
    /// Number of bytes between the data and the next part.
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

/// The storage and padding of the numbers of a part, of which there must be `expected`.
fn numbers(bytes: &mut Bytes<'_>, expected: u64) -> Result<(Storage, u64), Problem> {
    let Tag { kind, length, padding } = tag(bytes)?;
    let storage = storage(kind)?;
    if expected.checked_mul(storage.size()) != Some(length) {
        return Err(Problem::field("bytes of an array's part", length, format!("{expected} numbers")));
    }
    Ok((storage, padding))
}

/// Reads an array; a member of a structure has its name from there, and how deep it is within others.
fn array(
    bytes: &mut Bytes<'_>,
    size: u64,
    limits: &Limits,
    (given, depth): (Option<&str>, usize),
    found: &mut Found,
) -> Result<(), Problem> {
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
    let (flags, room) = (bytes.u32("flags")?, bytes.u32("flags")?);
    let class = flags & 0xff;
    if matches!(class, 16..) {
        // Functions and opaque objects have parts of another order, and no name that could be found.
        let name = given.map_or_else(|| format!("an object of class {class}"), str::to_owned);
        found.leave_out(&name, "no array of numbers");
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
    let name = given.map_or(name, str::to_owned);
    if class == 2 && depth < DEEPEST {
        return structure(bytes, &name, &shape, limits, depth, found);
    }
    let reason = match (class, shape.as_slice()) {
        (1, _) => "a cell array",
        (2, _) => "a structure within too many others",
        (3, _) => "an object",
        (4, _) => "text",
        (5..=15, [0, _] | [_, 0]) => "empty",
        (5..=15, [_, _]) => "",
        (5..=15, _) => "not of two dimensions",
        _ => return Err(Problem::field("class of an array", class, "1 to 15")),
    };
    if !reason.is_empty() {
        found.leave_out(&name, reason);
        return Ok(());
    }
    let size = (order("number of rows", shape[0], limits.order)?, order("number of columns", shape[1], limits.order)?);
    let mut builder = Builder::new(limits);
    if class == 5 {
        let (used, left) = sparse(bytes, size, u64::from(room), limits, &mut builder)?;
        if flags & COMPLEX != 0 {
            bytes.skip(left, "values of a sparse array")?;
            imaginary(bytes, used, &mut builder)?;
        }
    } else {
        let count = size.0 as u64 * size.1 as u64;
        let (storage, padding) = numbers(bytes, count)?;
        fill(bytes, storage, size, &mut builder)?;
        if flags & COMPLEX != 0 {
            bytes.skip(padding, "an array")?;
            imaginary(bytes, count, &mut builder)?;
        }
    }
    found.keep(&name, builder.finish(Stated::Array, Head::unlabelled(name.clone(), None, size)))
}

/// Takes note of the imaginary parts of `count` numbers.
fn imaginary(bytes: &mut Bytes<'_>, count: u64, builder: &mut Builder) -> Result<(), Problem> {
    let Tag { kind, length, .. } = tag(bytes)?;
    let storage = storage(kind)?;
    if count.checked_mul(storage.size()).is_none_or(|needed| needed > length) {
        return Err(Problem::field("bytes of imaginary parts", length, format!("{count} numbers or more")));
    }
    for _ in 0..count {
        builder.note_imaginary(storage.read(bytes, "imaginary parts")?)?;
    }
    Ok(())
}

/// Reads the members of a structure, or of each of an array of structures, as `name.member` or `name(1).member`.
fn structure(
    bytes: &mut Bytes<'_>,
    name: &str,
    shape: &[usize],
    limits: &Limits,
    depth: usize,
    found: &mut Found,
) -> Result<(), Problem> {
    let what = "the members of a structure";
    let longest = tag(bytes)?;
    if (longest.kind, longest.length) != (5, 4) {
        return Err(Problem::field("the length of names of members", longest.length, "4 bytes, type 5"));
    }
    let longest_name = u64::from(bytes.u32(what)?);
    bytes.skip(longest.padding, what)?;
    let names = tag(bytes)?;
    let fits = longest_name > 0 && longest_name <= LONGEST_NAME && names.length % longest_name == 0;
    if names.kind != 1 && names.kind != 2 || !(fits || names.length == 0) {
        return Err(Problem::field("bytes of the names of members", names.length, "a multiple of the longest name"));
    }
    let mut members = Vec::new();
    for _ in 0..names.length.checked_div(longest_name).unwrap_or(0) {
        members.push(bytes.text(longest_name as usize, what)?);
    }
    bytes.skip(names.padding, what)?;
    let count = shape.iter().fold(1_usize, |product, &size| product.saturating_mul(size));
    if members.is_empty() || count == 0 {
        return Ok(());
    }
    for at in 1..=count {
        for member in &members {
            let kind = bytes.u32(what)?;
            let length = u64::from(bytes.u32(what)?);
            if kind != MATRIX {
                return Err(Problem::field("type of a member of a structure", kind, "14, an array"));
            }
            let whole = if count == 1 { format!("{name}.{member}") } else { format!("{name}({at}).{member}") };
            let start = bytes.position;
            array(bytes, length, limits, (Some(&whole), depth + 1), found)?;
            let left = length.checked_sub(bytes.position - start);
            let left = left.ok_or_else(|| Problem::field("bytes of a member of a structure", length, "all of it"))?;
            bytes.skip(left + length.wrapping_neg() % 8, what)?;
        }
    }
    Ok(())
}

/// Reads compressed columns: rows, the offsets of the columns, values. There is `room` for more of them than may be used: how many are used, and how many
/// bytes follow.
fn sparse(
    bytes: &mut Bytes<'_>,
    (rows, columns): (usize, usize),
    room: u64,
    limits: &Limits,
    builder: &mut Builder,
) -> Result<(u64, u64), Problem> {
    let Tag { kind, length, padding } = tag(bytes)?;
    let of_rows = storage(kind)?;
    let count = length / of_rows.size();
    if length % of_rows.size() != 0 || count > room.max(1) {
        return Err(Problem::field("rows of a sparse array", count, format!("at most {room}, as its flags say")));
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
    let Tag { kind, length, padding } = tag(bytes)?;
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
    let used = used as u64;
    Ok((used, length - used * of_values.size() + padding))
}
