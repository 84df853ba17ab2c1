//! An archive of arrays. With a member `format` or `fill_value` it is one sparse matrix.

use std::io::Cursor;

use zip::ZipArchive;

use super::archive::{unreadable, with};
use crate::builder::{Found, Head, Stated};
use crate::error::{FormatsError, Place};
use crate::limits::Limits;

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
