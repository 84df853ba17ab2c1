//! Members of a zip archive, each an array with its header.

use std::io::{Cursor, Read};

use zip::ZipArchive;

use super::npy::{self, Header};
use crate::bytes::{Bytes, Endian};
use crate::error::{FormatsError, Place};
use crate::limits::Limits;
use crate::problem::Problem;
use crate::shortened::cut;

pub(super) type Archive = ZipArchive<Cursor<Vec<u8>>>;

pub(super) fn at(place: Place, problem: Problem) -> FormatsError {
    FormatsError::At { place, problem: Box::new(problem) }
}

pub(super) fn unreadable(place: Place, what: &str) -> FormatsError {
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
