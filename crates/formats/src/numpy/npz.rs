//! An archive of arrays. With a member `format` it is a sparse matrix of SciPy: `csr`, `csc` or `coo`.

use std::io::{Cursor, Read};

use zip::ZipArchive;

use super::npy::{self, Header};
use crate::builder::{Builder, Head, Stated};
use crate::bytes::{Bytes, Endian};
use crate::dmig::Found;
use crate::error::{FormatsError, Place};
use crate::limits::Limits;
use crate::matrix::Matrix;
use crate::problem::Problem;
use crate::shortened::cut;

type Archive = ZipArchive<Cursor<Vec<u8>>>;

/// Reads all matrices of an archive.
pub(crate) fn parse(bytes: Vec<u8>, limits: &Limits) -> Result<Found, FormatsError> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|e| unreadable(Place::Byte(0), &e.to_string()))?;
    let names = archive.file_names().map(|name| name.map(|name| name.into_owned())).collect::<Result<Vec<_>, _>>();
    let names = names.map_err(|e| unreadable(Place::Byte(0), &e.to_string()))?;
    if names.iter().any(|name| name == "format.npy") {
        return Ok((vec![sparse(&mut archive, limits)?], Vec::new()));
    }
    let mut found = Found::default();
    for member in names {
        let Some(name) = member.strip_suffix(".npy") else {
            found.1.push((member, "no array of NumPy".to_owned()));
            continue;
        };
        let read = with(&mut archive, &member, limits, |header, bytes| {
            if let Some(reason) = header.reason() {
                return Ok(Err(reason));
            }
            let (builder, size) = header.fill(bytes, limits)?;
            Ok(Ok(builder.finish(Stated::Nothing, Head::unlabelled(name, None, size))?))
        })?;
        match read {
            Ok(matrix) => found.0.push(matrix),
            Err(reason) => found.1.push((name.to_owned(), reason)),
        }
    }
    Ok(found)
}

fn at(place: Place, problem: Problem) -> FormatsError {
    FormatsError::At { place, problem: Box::new(problem) }
}

fn unreadable(place: Place, what: &str) -> FormatsError {
    at(place, Problem::Read { what: cut(what) })
}

/// Opens a member, reads its header, and hands both on.
fn with<T>(
    archive: &mut Archive,
    member: &str,
    limits: &Limits,
    read: impl FnOnce(&Header, &mut Bytes<'_>) -> Result<T, Problem>,
) -> Result<T, FormatsError> {
    let place = |byte| Place::Member { name: member.to_owned(), byte };
    let file = archive.by_name(member).map_err(|e| unreadable(place(0), &e.to_string()))?;
    let mut bytes = Bytes::new(Box::new(std::io::BufReader::new(file.take(limits.bytes))), Endian::Little);
    let done = npy::header(&mut bytes).and_then(|header| read(&header, &mut bytes));
    done.map_err(|problem| at(place(bytes.position), problem))
}

/// The compressed form of a sparse matrix.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    Rows,
    Columns,
    Entries,
}

fn sparse(archive: &mut Archive, limits: &Limits) -> Result<Matrix, FormatsError> {
    let form = with(archive, "format.npy", limits, |_, bytes| {
        let [a, b, c] = bytes.array("the format")?;
        match &[a, b, c] {
            b"csr" => Ok(Form::Rows),
            b"csc" => Ok(Form::Columns),
            b"coo" => Ok(Form::Entries),
            other => {
                let (what, found) = ("sparse format", cut(&String::from_utf8_lossy(other)));
                Err(Problem::Keyword { what, found, allowed: "csr, csc, coo; convert with .tocsr()" })
            }
        }
    })?;
    let shape =
        with(archive, "shape.npy", limits, |h, b| h.indices(b, ("number of rows or columns", limits.order), limits))?;
    let place = |name: &str| Place::Member { name: name.to_owned(), byte: 0 };
    let &[rows, columns] = shape.as_slice() else {
        let problem = Problem::field("the shape", format!("{} numbers", shape.len()), "2");
        return Err(at(place("shape.npy"), problem));
    };
    for (what, found) in [("number of rows", rows), ("number of columns", columns)] {
        crate::numbers::order(what, found, limits.order).map_err(|problem| at(place("shape.npy"), problem))?;
    }
    let mut list = |member: &str, what, largest: usize| {
        with(archive, member, limits, |h, b| h.indices(b, (what, largest), limits))
    };
    let (row, column) = match form {
        Form::Entries => (list("row.npy", "row", rows - 1)?, list("col.npy", "column", columns - 1)?),
        Form::Rows => {
            let column = list("indices.npy", "column", columns - 1)?;
            (spread(&list("indptr.npy", "offset of a row", column.len())?, (rows, column.len()))?, column)
        }
        Form::Columns => {
            let row = list("indices.npy", "row", rows - 1)?;
            let column = spread(&list("indptr.npy", "offset of a column", row.len())?, (columns, row.len()))?;
            (row, column)
        }
    };
    let builder = with(archive, "data.npy", limits, |header, bytes| {
        if let Some(reason) = header.reason().filter(|_| header.storage.is_err()) {
            return Err(Problem::field("the matrix", reason, "real numbers"));
        }
        let length = header.length("the values")?;
        if length != row.len() || length != column.len() {
            let allowed = "as many rows as columns as values";
            return Err(Problem::field(
                "the numbers of entries",
                format!("{}, {}, {length}", row.len(), column.len()),
                allowed,
            ));
        }
        let mut builder = Builder::new(limits);
        builder.reserve(length);
        for (&i, &j) in row.iter().zip(&column) {
            builder.push(i, j, header.next(bytes)?)?;
        }
        Ok(builder)
    })?;
    builder
        .finish(Stated::Nothing, Head::unlabelled("matrix", None, (rows, columns)))
        .map_err(|problem| at(place("data.npy"), problem))
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
