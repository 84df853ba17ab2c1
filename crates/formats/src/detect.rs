//! Format of contents, by their beginning.

use crate::bytes::Endian;
use crate::error::FormatsError;
use crate::lines::plain_text;
use crate::shortened::cut;
use crate::{harwell_boeing, mat, numpy, op4};

/// A file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Matrix Market.
    MatrixMarket,
    /// `row column value` without a header: CalculiX, or Abaqus's coordinates.
    Coordinates,
    /// Abaqus's `MATRIX INPUT`.
    AbaqusMatrixInput,
    /// Abaqus's `USER ELEMENT`, a substructure.
    AbaqusSubstructure,
    /// Harwell-Boeing or Rutherford-Boeing.
    HarwellBoeing,
    /// Nastran's `DMIG`.
    Dmig,
    /// Nastran's `OUTPUT4` as text.
    Op4Text,
    /// Nastran's `OUTPUT4` as binary records.
    Op4Binary,
    /// MATLAB, version 4.
    MatlabV4,
    /// MATLAB, versions 5 to 7.
    MatlabV5,
    /// A single NumPy array.
    Npy,
    /// An archive of NumPy arrays, or a sparse matrix of SciPy.
    Npz,
}

/// The format and the byte order of binary ones.
pub(crate) fn detect(head: &[u8]) -> Result<(Format, Endian), FormatsError> {
    let refused = |what, advice| Err(FormatsError::Refused { what, advice });
    if head.is_empty() {
        return Err(FormatsError::Unknown { found: "an empty file".to_owned() });
    }
    if head.starts_with(&[0x1f, 0x8b]) {
        return refused("a file compressed twice", "decompress it once");
    }
    if head.starts_with(b"\x89HDF\r\n\x1a\n") || head.starts_with(b"MATLAB 7.3 MAT-file") {
        return refused("HDF5 (MATLAB 7.3)", "save it with save('file.mat', 'K', 'M', '-v7')");
    }
    if head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06") {
        return Ok((Format::Npz, Endian::Little));
    }
    if head.starts_with(numpy::npy::MAGIC) {
        return Ok((Format::Npy, Endian::Little));
    }
    if head.starts_with(&[0xff, 0xfe]) || head.starts_with(&[0xfe, 0xff]) {
        return refused("text in UTF-16", "save it as UTF-8");
    }
    let binary = [
        (Format::MatlabV5, mat::v5::detect(head)),
        (Format::Op4Binary, op4::binary::detect(head)),
        (Format::MatlabV4, mat::v4::detect(head)),
    ];
    if let Some((format, Some(endian))) = binary.into_iter().find(|(_, endian)| endian.is_some()) {
        return Ok((format, endian));
    }
    Ok((text(head)?, Endian::Little))
}

/// True for the first line of a file of Matrix Market.
pub(crate) fn is_banner(line: &str) -> bool {
    line.to_uppercase().trim_start_matches('%').trim_start().starts_with("MATRIXMARKET")
}

/// The format of a text file.
fn text(head: &[u8]) -> Result<Format, FormatsError> {
    let text = plain_text(&String::from_utf8_lossy(head));
    let mut lines = text.lines().filter(|line| !line.trim().is_empty());
    let first = lines.next().unwrap_or_default();
    let trimmed = first.trim();
    let upper = text.to_uppercase();
    let starts =
        |words: &[&str]| upper.lines().any(|line| words.iter().any(|word| line.trim_start().starts_with(word)));
    // With any number of percent signs: as a comment it would make the line of sizes an entry of a list without a header.
    // Other comments may stand above it.
    let mut comments = text.lines().map(str::trim).take_while(|line| line.is_empty() || line.starts_with('%'));
    if is_banner(trimmed) || comments.any(is_banner) {
        return Ok(Format::MatrixMarket);
    }
    if harwell_boeing::is_header(&text) {
        return Ok(Format::HarwellBoeing);
    }
    if op4::text::is_header(first) {
        return Ok(Format::Op4Text);
    }
    if trimmed.starts_with('*') && starts(&["*USER ELEMENT"]) {
        return Ok(Format::AbaqusSubstructure);
    }
    if starts(&["DMIG", "BEGIN BULK", "BEGIN,BULK"]) {
        return Ok(Format::Dmig);
    }
    let data = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with(['*', '%']));
    if let Some(data) = data {
        let fields: Vec<&str> = data.split([',', ' ', '\t']).filter(|field| !field.is_empty()).collect();
        let numbers = fields.iter().all(|field| crate::numbers::fortran(field).is_ok());
        let whole = |count: usize| fields.iter().take(count).all(|field| field.parse::<i64>().is_ok());
        match fields.len() {
            5 if numbers && whole(4) && data.matches(',').count() == 4 => return Ok(Format::AbaqusMatrixInput),
            3 if numbers && whole(2) && !trimmed.starts_with('*') => return Ok(Format::Coordinates),
            1 if fields[0].parse::<crate::Dof>().is_ok() && fields[0].contains('.') => {
                let advice = "it is read with the matrix beside it";
                return Err(FormatsError::Refused { what: "a list of rows (.dof of CalculiX)", advice });
            }
            _ => {}
        }
    }
    let found = if head.contains(&0) { "a binary file".to_owned() } else { format!("{:?}", cut(trimmed)) };
    Err(FormatsError::Unknown { found })
}
