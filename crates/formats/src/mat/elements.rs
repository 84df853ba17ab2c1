//! Numbers as they are stored in a `.mat` file of any version.

use crate::builder::Builder;
use crate::bytes::Bytes;
use crate::problem::Problem;

/// Type of a stored number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Storage {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
    I64,
    U64,
}

impl Storage {
    /// Size of a number, bytes.
    pub fn size(self) -> u64 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 | Self::I64 | Self::U64 => 8,
        }
    }

    /// The next number, as f64: 64-bit integers beyond 2^53 are rounded. `what` names the part of the file in the error of one that ends too early.
    pub fn read(self, bytes: &mut Bytes<'_>, what: &'static str) -> Result<f64, Problem> {
        let endian = bytes.endian;
        Ok(match self {
            Self::I8 => f64::from(i8::from_le_bytes(bytes.array(what)?)),
            Self::U8 => f64::from(u8::from_le_bytes(bytes.array(what)?)),
            Self::I16 => f64::from(endian.u16(bytes.array(what)?) as i16),
            Self::U16 => f64::from(endian.u16(bytes.array(what)?)),
            Self::I32 => f64::from(bytes.i32(what)?),
            Self::U32 => f64::from(bytes.u32(what)?),
            Self::F32 => bytes.f32(what)?,
            Self::F64 => bytes.f64(what)?,
            Self::I64 => endian.u64(bytes.array(what)?) as i64 as f64,
            Self::U64 => endian.u64(bytes.array(what)?) as f64,
        })
    }
}

/// Reads a full array by columns and keeps what is not zero.
pub(crate) fn fill(
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

/// The number `found` as an index from 0 to `largest`, both included; refused where it is not whole. Whether the file counts from 0 or 1 is the
/// caller's affair. `what` names the number in the error.
pub(crate) fn index(what: &'static str, found: f64, largest: usize) -> Result<usize, Problem> {
    if found >= 0.0 && found <= largest as f64 && found.fract() == 0.0 {
        return Ok(found as usize);
    }
    Err(Problem::field(what, found, format!("a whole number from 0 to {largest}")))
}
