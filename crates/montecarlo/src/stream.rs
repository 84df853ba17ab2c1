//! Random streams, one per sample.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// The random number generator of one sample.
pub type StreamRng = ChaCha8Rng;

/// The stream of the sample with a global index: ChaCha8 (Bernstein 2008) with the seed as the first eight bytes of its
/// key (little endian, the rest zero) and the index as its 64-bit stream number.
///
/// Streams of different indices are independent, so that a sample can be drawn without the samples before it.
///
/// ```
/// use rand::Rng;
/// let mut thousandth = montecarlo::stream(42, 1_000);
/// assert_eq!(thousandth.next_u64(), montecarlo::stream(42, 1_000).next_u64());
/// assert_ne!(thousandth.next_u64(), montecarlo::stream(42, 1_001).next_u64());
/// ```
#[must_use]
pub fn stream(seed: u64, index: u64) -> StreamRng {
    let mut key = [0; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    let mut rng = ChaCha8Rng::from_seed(key);
    rng.set_stream(index);
    rng
}

/// The global index of the sample whose stream this is.
///
/// ```
/// assert_eq!(montecarlo::index_of(&montecarlo::stream(42, 1_000)), 1_000);
/// ```
#[must_use]
pub fn index_of(stream: &StreamRng) -> u64 {
    stream.get_stream()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;

    #[test]
    fn seed_and_index_zero_give_the_published_key_stream_of_zero_key_and_nonce() {
        // Strombergson, "Test Vectors for the Stream Cipher ChaCha", draft 00, TC1: 256-bit key, 8 rounds.
        let published = [
            0x3e, 0x00, 0xef, 0x2f, 0x89, 0x5f, 0x40, 0xd6, 0x7f, 0x5b, 0xb8, 0xe8, 0x1f, 0x09, 0xa5, 0xa1, 0x2c, 0x84,
            0x0e, 0xc3, 0xce, 0x9a, 0x7f, 0x3b, 0x18, 0x1b, 0xe1, 0x88, 0xef, 0x71, 0x1a, 0x1e,
        ];
        let mut bytes = [0u8; 32];
        stream(0, 0).fill_bytes(&mut bytes);
        assert_eq!(bytes, published);
    }

    #[test]
    fn seed_and_index_both_matter() {
        let first = |seed, index| stream(seed, index).next_u64();
        assert_ne!(first(1, 2), first(2, 1));
        assert_ne!(first(1, 2), first(1, 3));
        assert_ne!(first(1, 2), first(1 << 63 | 1, 2));
    }
}
