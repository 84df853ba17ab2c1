//! A sparse matrix in an archive: SciPy's `csr`, `csc`, `coo`, `bsr` and `dia`, and `COO` and `GCXS` of the package `sparse`.

use super::archive::{Archive, at, with};
use super::npy::Header;
use crate::builder::{Builder, Found, Head, Stated};
use crate::bytes::Bytes;
use crate::error::{FormatsError, Place};
use crate::limits::Limits;
use crate::problem::Problem;
use crate::shortened::cut;

/// The form of a sparse matrix.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    Rows,
    Columns,
    Entries,
    /// Entries as two rows of indices.
    Coordinates,
    Blocks,
    Diagonals,
}

/// Reads the one matrix of an archive, of which `has` tells the members.
pub(super) fn parse(archive: &mut Archive, has: impl Fn(&str) -> bool, limits: &Limits) -> Result<Found, FormatsError> {
    let form = form(archive, has, limits)?;
    let size = shape(archive, limits)?;
    if form.1 {
        with(archive, "fill_value.npy", limits, |header, bytes| {
            let value = header.storage()?.read(bytes, "the value of what is not listed")?;
            let allowed = || Problem::field("the value of what is not listed", value, "0");
            if value == 0.0 { Ok(()) } else { Err(allowed()) }
        })?;
    }
    let builder = match form.0 {
        Form::Diagonals => diagonals(archive, size, limits)?,
        Form::Blocks => blocks(archive, size, limits)?,
        form => entries(archive, form, size, limits)?,
    };
    let mut found = Found::default();
    found
        .keep("matrix", builder.finish(Stated::Array, Head::unlabelled("matrix", None, size)))
        .map_err(|problem| at(Place::Member { name: "data.npy".to_owned(), byte: 0 }, problem))?;
    Ok(found)
}

/// The form, and whether the archive says what all entries are that it does not list.
fn form(archive: &mut Archive, has: impl Fn(&str) -> bool, limits: &Limits) -> Result<(Form, bool), FormatsError> {
    if has("fill_value.npy") {
        if !has("compressed_axes.npy") {
            return Ok((Form::Coordinates, true));
        }
        let axes = with(archive, "compressed_axes.npy", limits, |h, b| h.indices(b, ("compressed axis", 1), limits))?;
        let problem = || Problem::field("compressed axes", format!("{} of them", axes.len()), "one");
        let refused = || at(Place::Member { name: "compressed_axes.npy".to_owned(), byte: 0 }, problem());
        return match axes.as_slice() {
            [0] => Ok((Form::Rows, true)),
            [1] => Ok((Form::Columns, true)),
            _ => Err(refused()),
        };
    }
    let form = with(archive, "format.npy", limits, |_, bytes| {
        let [a, b, c] = bytes.array("the format")?;
        match &[a, b, c] {
            b"csr" => Ok(Form::Rows),
            b"csc" => Ok(Form::Columns),
            b"coo" => Ok(Form::Entries),
            b"bsr" => Ok(Form::Blocks),
            b"dia" => Ok(Form::Diagonals),
            other => {
                let (what, found) = ("sparse format", cut(&String::from_utf8_lossy(other)));
                Err(Problem::Keyword { what, found, allowed: "csr, csc, coo, bsr, dia; convert with .tocsr()" })
            }
        }
    })?;
    let is_list = form == Form::Entries && !has("row.npy");
    Ok((if is_list { Form::Coordinates } else { form }, false))
}

fn shape(archive: &mut Archive, limits: &Limits) -> Result<(usize, usize), FormatsError> {
    let shape =
        with(archive, "shape.npy", limits, |h, b| h.indices(b, ("number of rows or columns", limits.order), limits))?;
    let refused = |problem| at(Place::Member { name: "shape.npy".to_owned(), byte: 0 }, problem);
    let &[rows, columns] = shape.as_slice() else {
        return Err(refused(Problem::field("the shape", format!("{} numbers", shape.len()), "2")));
    };
    for (what, found) in [("number of rows", rows), ("number of columns", columns)] {
        crate::numbers::order(what, found, limits.order).map_err(refused)?;
    }
    Ok((rows, columns))
}

/// Compressed rows or columns, or a list of entries.
fn entries(
    archive: &mut Archive,
    form: Form,
    (rows, columns): (usize, usize),
    limits: &Limits,
) -> Result<Builder, FormatsError> {
    let mut list = |member: &str, what, largest: usize| {
        with(archive, member, limits, |h, b| h.indices(b, (what, largest), limits))
    };
    let (row, column) = match form {
        Form::Rows => {
            let column = list("indices.npy", "column", columns - 1)?;
            (spread(&list("indptr.npy", "offset of a row", column.len())?, (rows, column.len()))?, column)
        }
        Form::Columns => {
            let row = list("indices.npy", "row", rows - 1)?;
            let column = spread(&list("indptr.npy", "offset of a column", row.len())?, (columns, row.len()))?;
            (row, column)
        }
        Form::Coordinates => with(archive, "coords.npy", limits, |header, bytes| coordinates(header, bytes, limits))?,
        _ => (list("row.npy", "row", rows - 1)?, list("col.npy", "column", columns - 1)?),
    };
    with(archive, "data.npy", limits, |header, bytes| {
        let storage = header.storage()?;
        let length = header.length("the values")?;
        if length != row.len() || length != column.len() {
            let allowed = "as many rows as columns as values";
            let found = format!("{}, {}, {length}", row.len(), column.len());
            return Err(Problem::field("the numbers of entries", found, allowed));
        }
        let mut builder = Builder::new(limits);
        builder.reserve(length);
        for (&i, &j) in row.iter().zip(&column) {
            within(i, j, (rows, columns))?;
            let value = header.next(bytes, storage, &mut builder)?;
            builder.push(i, j, value)?;
        }
        Ok(builder)
    })
}

/// The rows and columns of entries in one array of two rows.
fn coordinates(header: &Header, bytes: &mut Bytes<'_>, limits: &Limits) -> Result<(Vec<usize>, Vec<usize>), Problem> {
    let &[2, count] = header.shape.as_slice() else {
        return Err(Problem::field("the shape of coords", format!("{:?}", header.shape), "2 x the number of entries"));
    };
    let one = Header { shape: vec![count], complex: false, storage: header.storage.clone(), ..*header };
    if !header.by_columns {
        return Ok((
            one.indices(bytes, ("row", limits.order), limits)?,
            one.indices(bytes, ("column", limits.order), limits)?,
        ));
    }
    let both = Header { shape: vec![count.saturating_mul(2)], ..one };
    let both = both.indices(bytes, ("row or column", limits.order), limits)?;
    Ok((both.iter().step_by(2).copied().collect(), both.iter().skip(1).step_by(2).copied().collect()))
}

/// `bsr`: blocks of one size in compressed rows.
fn blocks(archive: &mut Archive, (rows, columns): (usize, usize), limits: &Limits) -> Result<Builder, FormatsError> {
    let across = with(archive, "indices.npy", limits, |h, b| h.indices(b, ("column of a block", columns - 1), limits))?;
    let offsets =
        with(archive, "indptr.npy", limits, |h, b| h.indices(b, ("offset of a row of blocks", across.len()), limits))?;
    let down = spread(&offsets, (offsets.len().saturating_sub(1), across.len()))?;
    with(archive, "data.npy", limits, |header, bytes| {
        let storage = header.storage()?;
        let (&[count, high, wide], false) = (header.shape.as_slice(), header.by_columns) else {
            return Err(Problem::field("the shape of data", format!("{:?}", header.shape), "blocks x rows x columns"));
        };
        if count != across.len() || high == 0 || wide == 0 {
            return Err(Problem::field("the number of blocks", count, across.len().to_string()));
        }
        let mut builder = Builder::new(limits);
        for (&block_row, &block_column) in down.iter().zip(&across) {
            for at in 0..high.saturating_mul(wide) {
                let (i, j) = (block_row.saturating_mul(high), block_column.saturating_mul(wide));
                let (i, j) = (i.saturating_add(at / wide), j.saturating_add(at % wide));
                within(i, j, (rows, columns))?;
                let value = header.next(bytes, storage, &mut builder)?;
                builder.push(i, j, value)?;
            }
        }
        Ok(builder)
    })
}

/// `dia`: diagonals, each as long as the matrix is wide; entries outside of the matrix do not count.
fn diagonals(archive: &mut Archive, (rows, columns): (usize, usize), limits: &Limits) -> Result<Builder, FormatsError> {
    let offsets = with(archive, "offsets.npy", limits, |header, bytes| {
        let (length, storage) = (header.length("the offsets")?, header.storage()?);
        let mut offsets = Vec::new();
        for _ in 0..length {
            let offset = storage.read(bytes, "the offsets")?;
            if offset.fract() != 0.0 || offset.abs() > limits.order as f64 {
                return Err(Problem::field("the offset of a diagonal", offset, "a whole number within the matrix"));
            }
            offsets.push(offset as i64);
        }
        Ok(offsets)
    })?;
    with(archive, "data.npy", limits, |header, bytes| {
        let storage = header.storage()?;
        let &[count, length] = header.shape.as_slice() else {
            return Err(Problem::field("the shape of data", format!("{:?}", header.shape), "diagonals x columns"));
        };
        if count != offsets.len() {
            return Err(Problem::field("the number of diagonals", count, offsets.len().to_string()));
        }
        let Some(entries) = count.checked_mul(length) else {
            return Err(Problem::field(
                "the shape of data",
                format!("{:?}", header.shape),
                "a number of entries that fits",
            ));
        };
        let mut builder = Builder::new(limits);
        for at in 0..entries {
            // Diagonal after diagonal, or of all of them column after column.
            let (diagonal, column) =
                if header.by_columns { (at % count, at / count) } else { (at / length, at % length) };
            // What is beyond the matrix is no entry, whatever stands there.
            let row = column as i64 - offsets[diagonal];
            let mut beyond = Builder::new(limits);
            let is_within = (0..rows as i64).contains(&row) && column < columns;
            let value = header.next(bytes, storage, if is_within { &mut builder } else { &mut beyond })?;
            if is_within && value != 0.0 {
                builder.push(row as usize, column, value)?;
            }
        }
        Ok(builder)
    })
}

fn within(row: usize, column: usize, (rows, columns): (usize, usize)) -> Result<(), Problem> {
    for (what, found, largest) in [("row", row, rows), ("column", column, columns)] {
        if found >= largest {
            return Err(Problem::Index { what, found: found + 1, largest });
        }
    }
    Ok(())
}

/// The row (or column) of each entry, from the offsets of rows (or columns).
fn spread(offsets: &[usize], (order, entries): (usize, usize)) -> Result<Vec<usize>, FormatsError> {
    let growing = offsets.windows(2).all(|pair| pair[0] <= pair[1]);
    if offsets.len() != order + 1 || !growing || offsets.first() != Some(&0) || offsets.last() != Some(&entries) {
        let found = format!("{} offsets up to {}", offsets.len(), offsets.last().copied().unwrap_or(0));
        let problem = Problem::field("indptr", found, format!("{} offsets, growing from 0 to {entries}", order + 1));
        return Err(at(Place::Member { name: "indptr.npy".to_owned(), byte: 0 }, problem));
    }
    let mut spread = Vec::with_capacity(entries);
    for (at, pair) in offsets.windows(2).enumerate() {
        spread.extend(std::iter::repeat_n(at, pair[1] - pair[0]));
    }
    Ok(spread)
}
