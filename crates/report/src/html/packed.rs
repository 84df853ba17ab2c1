//! Numbers of pictures in few characters: rounded to 16 bits, in base 64.
//!
//! A number is a multiple of a 32767th of the largest one: much finer than a screen, in a third of the characters that its decimals
//! take. What is read as a number stands in tables, with all its digits.

use super::text::base64;

/// The largest number that is stored; numbers go from its negative to it.
const LARGEST: f64 = 32767.0;

/// Numbers as parts of `largest`, little-endian. What is beyond it or no number, of which a picture has none, becomes the nearest or 0.
pub(super) fn packed(values: impl IntoIterator<Item = f64>, largest: f64) -> String {
    let rounded = |value: f64| (value / largest * LARGEST).round().clamp(-LARGEST, LARGEST) as i16;
    base64(&values.into_iter().flat_map(|value| rounded(value).to_le_bytes()).collect::<Vec<u8>>())
}

/// Places in a list of at most 65,536, little-endian; `None` of a longer list.
pub(super) fn packed_places(places: impl IntoIterator<Item = usize>) -> Option<String> {
    let bytes: Result<Vec<[u8; 2]>, _> =
        places.into_iter().map(|place| u16::try_from(place).map(u16::to_le_bytes)).collect();
    Some(base64(bytes.ok()?.as_flattened()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes(text: &str) -> Vec<[u8; 2]> {
        let digit = |c: u8| match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            _ => 63,
        };
        let bits: Vec<u8> = text.bytes().filter(|&c| c != b'=').map(digit).collect();
        let bytes = bits.chunks(4).flat_map(|chunk| {
            let group = (0..4).fold(0_u32, |group, i| group << 6 | u32::from(chunk.get(i).copied().unwrap_or(0)));
            group.to_be_bytes()[1..chunk.len()].to_vec()
        });
        bytes.collect::<Vec<u8>>().chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
    }

    #[test]
    fn numbers_come_back_to_half_a_step() {
        let values: Vec<f64> = (0..1001).map(|i| 3e-4 * (f64::from(i) * 0.7).sin()).chain([3e-4, -3e-4, 0.0]).collect();
        let back: Vec<f64> = bytes(&packed(values.iter().copied(), 3e-4))
            .into_iter()
            .map(|pair| f64::from(i16::from_le_bytes(pair)) / LARGEST * 3e-4)
            .collect();
        assert_eq!(back.len(), values.len());
        assert!(values.iter().zip(&back).all(|(a, b)| (a - b).abs() <= 3e-4 / LARGEST * 0.5000001));
        assert_eq!(back[1001..], [3e-4, -3e-4, 0.0]);
    }

    #[test]
    fn places_come_back_or_are_too_many() {
        let places = [0, 1, 255, 256, 65535];
        let back: Vec<usize> =
            bytes(&packed_places(places).unwrap()).into_iter().map(|b| u16::from_le_bytes(b).into()).collect();
        assert_eq!(back, places);
        assert_eq!(packed_places([65536]), None);
    }

    #[test]
    fn what_is_no_number_is_drawn_at_rest() {
        assert_eq!(packed([f64::NAN, 2.0], 1.0), packed([0.0, 1.0], 1.0));
    }
}
