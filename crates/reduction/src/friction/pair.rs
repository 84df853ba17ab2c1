//! Two modes that are near each other, as the pair that they make.

use num_complex::Complex;

use cea::certified::lanes::Precision;

/// Product of two couplings, as a part of the square of half of what is between two eigenvalues, up to which the first order moves these;
/// chosen: what is left out is an eighth of its square.
const WEAK: f64 = 1e-4;

/// What moves an eigenvalue of a matrix of two rows from its diagonal entry: given half of the difference from the other diagonal entry, and
/// the product of the two entries off the diagonal.
pub(super) fn moved<T: Precision>(half: Complex<T>, product: Complex<T>) -> Complex<T> {
    let square = half * half;
    if product.norm_sqr() <= T::of(WEAK * WEAK) * square.norm_sqr() {
        return product / half * T::of(0.5);
    }
    let root = square_root(square + product);
    if (root * half.conj()).re >= T::default() { root - half } else { -root - half }
}

/// A square root, without the angles that `Complex::sqrt` goes through.
fn square_root<T: Precision>(z: Complex<T>) -> Complex<T> {
    let (zero, size) = (T::default(), z.norm_sqr().sqrt());
    let large = (T::of(0.5) * (size + z.re.abs())).sqrt();
    let small = if large > zero { T::of(0.5) * z.im / large } else { zero };
    if z.re >= zero { Complex::new(large, small) } else { Complex::new(small.abs(), large.copysign(z.im)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn square_roots_are_those_of_the_right_half_plane() {
        for z in [Complex::new(3.0, -4.0), Complex::new(-3.0, 4.0), Complex::new(-2.0, -1e-3), Complex::default()] {
            assert!((square_root(z) - z.sqrt()).norm() < 1e-15 * (1.0 + z.norm()));
        }
    }
}
