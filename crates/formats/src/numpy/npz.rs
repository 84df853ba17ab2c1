//! An archive of arrays. With a member `format` or `fill_value` it is one sparse matrix.

use std::io::{Cursor, Read};

use zip::ZipArchive;

use super::npy::{self, Header};
use crate::builder::{Found, Head, Stated};
use crate::bytes::{Bytes, Endian};
use crate::error::{FormatsError, Place};
use crate::limits::Limits;
use crate::problem::Problem;
use crate::shortened::cut;

pub(super) type Archive = ZipArchive<Cursor<Vec<u8>>>;

/// Reads all matrices of an archive.
pub(crate) fn parse(bytes: Vec<u8>, limits: &Limits) -> Result<Found, FormatsError> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|e| unreadable(Place::Byte(0), &e.to_string()))?;
    let names = archive.file_names().map(|name| name.map(|name| name.into_owned())).collect::<Result<Vec<_>, _>>();
    let names = names.map_err(|e| unreadable(Place::Byte(0), &e.to_string()))?;
    let has = |member: &str| names.iter().any(|name| name == member);
    if ["format.npy", "fill_value.npy"].into_iter().any(has) && has("data.npy") && has("shape.npy") {
        return super::sparse::parse(&mut archive, has, limits);
    }
    let mut found = Found::default();
    for member in names {
        let Some(name) = member.strip_suffix(".npy") else {
            found.leave_out(&member, "no array of NumPy");
            continue;
        };
        with(&mut archive, &member, limits, |header, bytes| {
            if let Some(reason) = header.reason() {
                found.leave_out(name, reason);
                return Ok(());
            }
            let (builder, size) = header.fill(bytes, limits)?;
            found.keep(name, builder.finish(Stated::Array, Head::unlabelled(name, None, size)))
        })?;
    }
    Ok(found)
}

pub(super) fn at(place: Place, problem: Problem) -> FormatsError {
    FormatsError::At { place, problem: Box::new(problem) }
}

fn unreadable(place: Place, what: &str) -> FormatsError {
    at(place, Problem::Read { what: cut(what) })
}

/// Opens a member, reads its header, and hands both on.
pub(super) fn with<T>(
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
