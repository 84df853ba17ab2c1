//! Hash that tells one text from another.

use sha2::{Digest, Sha256};

/// SHA-256 of a text, hexadecimal.
pub fn fingerprint(text: &str) -> String {
    hexadecimal(&Sha256::digest(text.as_bytes()))
}

/// Bytes of a digest, two hexadecimal digits each.
#[must_use]
pub fn hexadecimal(digest: &[u8]) -> String {
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}
