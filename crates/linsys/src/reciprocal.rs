//! Reciprocals of complex numbers of any size.

use num_complex::Complex;

/// The reciprocal `1 / z`. [`Complex::inv`] divides by `|z|^2`, which has no digits left where |z| is below 1e-154 and is infinite above 1e154; here the squares
/// are those of z in a unit of its size. In between both have the same bits.
#[must_use]
pub fn reciprocal(z: Complex<f64>) -> Complex<f64> {
    let largest = z.re.abs().max(z.im.abs());
    if (1e-140..1e140).contains(&largest) || largest == 0.0 || !largest.is_finite() {
        return z.inv();
    }
    // A power of two, and so exact; two steps of half of it, as the whole one may itself be beyond the range.
    let half = (-0.5 * largest.log2()).round().exp2();
    (z * half * half).inv() * half * half
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_any_size_have_their_reciprocal() {
        for exponent in -307..=307i32 {
            let unit: f64 = format!("1e{exponent}").parse().unwrap();
            for z in [Complex::new(unit, 0.0), Complex::new(0.6 * unit, -0.8 * unit), Complex::new(0.0, unit)] {
                let expected = z.conj() / unit / unit;
                assert!((reciprocal(z) - expected).norm() <= 4.0 * f64::EPSILON * expected.norm(), "{z}");
                if exponent.abs() < 140 {
                    assert_eq!(reciprocal(z), z.inv());
                }
            }
        }
        assert!(reciprocal(Complex::default()).re.is_nan());
    }
}
