//! Files that say in their first line what they are, and by a length and a checksum whether they are whole.

use crate::error::Damage;

/// A kind of file with the version of its format. Its first line is
///
/// ```text
/// <kind> <version> <bytes below> <their CRC-32, hexadecimal>
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sealed {
    /// The kind, without spaces.
    pub kind: &'static str,
    /// The version of the format.
    pub version: u32,
}

impl Sealed {
    /// The first line of a file with this body.
    #[must_use]
    pub fn header(&self, body: &[u8]) -> String {
        format!("{} {} {} {:08x}\n", self.kind, self.version, body.len(), crc32fast::hash(body))
    }

    /// The body of a file, if it has the length and the checksum that its first line announces.
    ///
    /// # Errors
    /// [`Damage`]: the part of the file that is wrong.
    pub fn open<'a>(&self, bytes: &'a [u8]) -> Result<&'a [u8], Damage> {
        let cut = bytes.iter().position(|&byte| byte == b'\n').ok_or(Damage::Header)?;
        let header = str::from_utf8(&bytes[..cut]).map_err(|_| Damage::Header)?;
        let [kind, version, length, checksum] = header.split(' ').collect::<Vec<_>>()[..] else {
            return Err(Damage::Header);
        };
        if kind != self.kind {
            return Err(Damage::Header);
        }
        let found = version.parse().map_err(|_| Damage::Header)?;
        if found != self.version {
            return Err(Damage::Version { found, expected: self.version });
        }
        let expected = length.parse().map_err(|_| Damage::Header)?;
        let body = &bytes[cut + 1..];
        if body.len() != expected {
            return Err(Damage::Length { expected, found: body.len() });
        }
        let expected = u32::from_str_radix(checksum, 16).map_err(|_| Damage::Header)?;
        let found = crc32fast::hash(body);
        // Of the several texts of a number one is the header's own: no other file is the same.
        if found != expected || header != self.header(body).trim_end() {
            return Err(Damage::Checksum { expected, found });
        }
        Ok(body)
    }
}
