//! A single array: a magic number, a header that is a Python dictionary, then the numbers.

use crate::builder::Builder;
use crate::bytes::{Bytes, Endian};
use crate::limits::Limits;
use crate::mat::elements::{Storage, index};
use crate::numbers::order;
use crate::problem::Problem;
use crate::shortened::cut;

/// The first bytes of a file.
pub(crate) const MAGIC: &[u8] = b"\x93NUMPY";
/// Longest header, bytes; NumPy's own limit against headers that take long to parse.
const LONGEST: usize = 10_000;

/// Most numbers for which there is room before they are read, whatever a header promises. Chosen: room for more is made as
/// numbers come, so that a false header costs little.
const MADE_ROOM_FOR: usize = 1 << 20;

/// Contents of the header of an array.
pub(crate) struct Header {
    /// The kind of numbers, or the letter of a kind that is no kind of real numbers.
    pub storage: Result<Storage, String>,
    /// An imaginary part follows each number.
    pub complex: bool,
    pub by_columns: bool,
    pub shape: Vec<usize>,
}

/// Reads the header and sets the byte order.
pub(crate) fn header(bytes: &mut Bytes<'_>) -> Result<Header, Problem> {
    let what = "the header of an array";
    let magic: [u8; 6] = bytes.array(what)?;
    let [version, _] = bytes.array(what)?;
    if magic != *MAGIC || !(1..=3).contains(&version) {
        return Err(Problem::field(
            "the beginning of an array",
            cut(&String::from_utf8_lossy(&magic)),
            "\\x93NUMPY, version 1 to 3",
        ));
    }
    bytes.endian = Endian::Little;
    let length =
        if version == 1 { usize::from(u16::from_le_bytes(bytes.array(what)?)) } else { bytes.u32(what)? as usize };
    if length > LONGEST {
        return Err(Problem::field("bytes of the header", length, format!("at most {LONGEST}")));
    }
    let text = bytes.text(length, what)?;
    let bad = || Problem::field("the header of an array", &text, "descr, fortran_order and shape");
    let after = |key: &str| {
        let at = text.find(&format!("'{key}'"))? + key.len() + 2;
        Some(text[at..].trim_start().strip_prefix(':')?.trim_start())
    };
    let kind = after("descr").ok_or_else(bad)?;
    let kind = kind.strip_prefix('\'').and_then(|kind| kind.split_once('\'')).ok_or_else(bad)?.0;
    let by_columns = after("fortran_order").ok_or_else(bad)?;
    let by_columns = match (by_columns.starts_with("True"), by_columns.starts_with("False")) {
        (true, _) => true,
        (_, true) => false,
        _ => return Err(bad()),
    };
    let shape = after("shape").and_then(|shape| shape.strip_prefix('(')?.split_once(')')).ok_or_else(bad)?.0;
    let sizes = shape.split(',').map(str::trim).filter(|size| !size.is_empty());
    let shape = sizes.map(|size| size.parse().map_err(|_| bad())).collect::<Result<Vec<usize>, _>>()?;
    let plain = kind.trim_start_matches(['<', '>', '|', '=']);
    let storage = match plain {
        "f8" | "c16" => Ok(Storage::F64),
        "f4" | "c8" => Ok(Storage::F32),
        "i8" => Ok(Storage::I64),
        "i4" => Ok(Storage::I32),
        "i2" => Ok(Storage::I16),
        "i1" => Ok(Storage::I8),
        "u8" => Ok(Storage::U64),
        "u4" => Ok(Storage::U32),
        "u2" => Ok(Storage::U16),
        "u1" | "b1" => Ok(Storage::U8),
        other => Err(other.to_owned()),
    };
    bytes.endian = if kind.starts_with('>') { Endian::Big } else { Endian::Little };
    Ok(Header { storage, complex: plain.starts_with('c'), by_columns, shape })
}

impl Header {
    /// Reason why the array is no matrix of real numbers; `None` if it is such a matrix.
    pub fn reason(&self) -> Option<String> {
        match (&self.storage, self.shape.as_slice()) {
            (Err(kind), _) => Some(format!("no real numbers but {}", cut(kind))),
            (Ok(_), [0, _] | [_, 0]) => Some("empty".to_owned()),
            (Ok(_), [_, _]) => None,
            (Ok(_), shape) => Some(format!("{} dimensions; read are arrays of two", shape.len())),
        }
    }

    /// The storage, where there is one.
    pub fn storage(&self) -> Result<Storage, Problem> {
        self.storage
            .as_ref()
            .map(|storage| *storage)
            .map_err(|kind| Problem::field("numbers of an array", kind, "real ones"))
    }

    /// Reads a full array and keeps what is not zero.
    pub fn fill(&self, bytes: &mut Bytes<'_>, limits: &Limits) -> Result<(Builder, (usize, usize)), Problem> {
        let size = (
            order("number of rows", self.shape.first().copied().unwrap_or(0), limits.order)?,
            order("number of columns", self.shape.get(1).copied().unwrap_or(0), limits.order)?,
        );
        let storage = self.storage()?;
        let mut builder = Builder::new(limits);
        let (outer, inner) = if self.by_columns { (size.1, size.0) } else { size };
        for a in 0..outer {
            for b in 0..inner {
                let value = self.next(bytes, storage, &mut builder)?;
                if value != 0.0 {
                    let (row, column) = if self.by_columns { (b, a) } else { (a, b) };
                    builder.push(row, column, value)?;
                }
            }
        }
        Ok((builder, size))
    }

    /// The length of an array of one dimension.
    pub fn length(&self, what: &'static str) -> Result<usize, Problem> {
        match self.shape.as_slice() {
            [length] => Ok(*length),
            shape => Err(Problem::field(what, format!("of {} dimensions", shape.len()), "of one")),
        }
    }

    /// Reads an array of one dimension of whole numbers from 0 to `largest`.
    pub fn indices(
        &self,
        bytes: &mut Bytes<'_>,
        (what, largest): (&'static str, usize),
        limits: &Limits,
    ) -> Result<Vec<usize>, Problem> {
        let (length, storage) = (self.length(what)?, self.storage()?);
        if length > limits.entries {
            return Err(Problem::Limit { what: "entries of a matrix", most: limits.entries as u64 });
        }
        let mut indices = Vec::with_capacity(length.min(MADE_ROOM_FOR));
        for _ in 0..length {
            indices.push(index(what, storage.read(bytes, what)?, largest)?);
            if self.complex {
                return Err(Problem::field(what, "complex", "whole numbers"));
            }
        }
        Ok(indices)
    }

    /// The next number of an array that becomes a matrix; of a complex one its real part.
    pub fn next(&self, bytes: &mut Bytes<'_>, storage: Storage, builder: &mut Builder) -> Result<f64, Problem> {
        let value = storage.read(bytes, "an array")?;
        if self.complex {
            builder.note_imaginary(storage.read(bytes, "an array")?)?;
        }
        Ok(value)
    }
}
