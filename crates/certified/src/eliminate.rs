//! Rotations and reflections that make entries zero (Golub and Van Loan, Matrix Computations, section 5.1).

use super::lane::{Lane, Reflection, Rotation};

/// c, s with `[c s; -s c] [a; b] = [r; 0]`.
pub(super) fn rotation<T: Lane>(a: T, b: T) -> Rotation<T> {
    let largest = a.value().abs().max(b.value().abs());
    if b.value() == 0.0 || largest.is_nan() {
        return (T::from(1.0), T::default());
    }
    let scale = T::from(reciprocal_power(largest));
    let (a, b) = (a * scale, b * scale);
    let inverse = T::from(1.0) / (a * a + b * b).root();
    (a * inverse, b * inverse)
}

/// The reflection that takes v to `[*; 0; 0]`.
pub(super) fn householder<T: Lane>(v: [T; 3]) -> Reflection<T> {
    let largest = v.iter().fold(0.0, |m: f64, x| m.max(x.value().abs()));
    if largest == 0.0 {
        return ([T::default(); 2], [T::default(); 3]);
    }
    let scale = T::from(reciprocal_power(largest));
    let v = v.map(|x| x * scale);
    let norm = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).root();
    let head = if v[0].value() < 0.0 { v[0] - norm } else { v[0] + norm };
    let inverse = T::from(1.0) / head;
    let u = [v[1] * inverse, v[2] * inverse];
    let beta = T::from(2.0) / (T::from(1.0) + u[0] * u[0] + u[1] * u[1]);
    (u, [beta, beta * u[0], beta * u[1]])
}

/// The power of two that takes a positive number to between 1 and 2: a product with it is exact. Of numbers near the ends of a
/// double's range one.
fn reciprocal_power(x: f64) -> f64 {
    const MANTISSA: u64 = (1 << 52) - 1;
    let power = f64::from_bits(x.to_bits() & !MANTISSA);
    if (1e-290..1e290).contains(&x) { 1.0 / power } else { 1.0 }
}
