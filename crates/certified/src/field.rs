//! Integers modulo the prime 2^61 - 1: what is exactly zero for doubles is exactly zero here.
//!
//! A finite double is an integer times a power of two, and two has an inverse modulo an odd prime: a matrix of
//! doubles maps to a matrix of residues without rounding. A determinant that vanishes maps to zero; one that does
//! not maps to zero only if the prime divides it, a chance of about 1e-18.

/// The Mersenne prime.
pub(crate) const PRIME: u64 = (1 << 61) - 1;

pub(crate) fn add(a: u64, b: u64) -> u64 {
    let sum = a + b;
    if sum >= PRIME { sum - PRIME } else { sum }
}

pub(crate) fn sub(a: u64, b: u64) -> u64 {
    if a >= b { a - b } else { a + PRIME - b }
}

pub(crate) fn mul(a: u64, b: u64) -> u64 {
    let wide = u128::from(a) * u128::from(b);
    let low = (wide & u128::from(PRIME)) as u64;
    add(low, (wide >> 61) as u64)
}

fn power(mut base: u64, mut exponent: u64) -> u64 {
    let mut result = 1;
    while exponent > 0 {
        if exponent & 1 == 1 {
            result = mul(result, base);
        }
        base = mul(base, base);
        exponent >>= 1;
    }
    result
}

/// The inverse of a nonzero residue (Fermat).
pub(crate) fn inverse(a: u64) -> u64 {
    power(a, PRIME - 2)
}

/// The residue of a finite double.
pub(crate) fn residue(x: f64) -> u64 {
    let bits = x.to_bits();
    let biased = ((bits >> 52) & 0x7ff) as i64;
    let fraction = bits & ((1 << 52) - 1);
    let (mantissa, exponent) = if biased == 0 { (fraction, -1074) } else { (fraction | (1 << 52), biased - 1075) };
    // The order of two modulo 2^61 - 1 is 61.
    let shifted = mul(mantissa, 1 << exponent.rem_euclid(61));
    if x.is_sign_negative() { sub(0, shifted) } else { shifted }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn doubles_keep_their_sums_and_products() {
        assert_eq!(residue(0.0), 0);
        assert_eq!(residue(-3.0), PRIME - 3);
        assert_eq!(add(residue(0.5), residue(0.5)), 1);
        assert_eq!(mul(residue(f64::MIN_POSITIVE / 4.0), residue(2f64.powi(1000))), residue(2f64.powi(-24)));
    }

    proptest! {
        #[test]
        fn integers_are_themselves(a in -1_000_000i64..1_000_000, b in -1_000_000i64..1_000_000) {
            let (x, y) = (residue(a as f64), residue(b as f64));
            prop_assert_eq!(add(x, y), residue((a + b) as f64));
            prop_assert_eq!(sub(x, y), residue((a - b) as f64));
            prop_assert_eq!(mul(x, y), residue((a * b) as f64));
            if a != 0 { prop_assert_eq!(mul(x, inverse(x)), 1); }
        }
    }
}
