//! Hash that tells one text from another.

use sha2::{Digest, Sha256};

/// SHA-256 of a text, hexadecimal.
pub fn fingerprint(text: &str) -> String {
    Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
}
