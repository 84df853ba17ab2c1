//! Rotations and reflections that make entries zero (Golub and Van Loan, Matrix Computations, section 5.1).

use super::lane::{Lane, Reflection, Rotation};

/// c, s with `[c s; -s c] [a; b] = [r; 0]`.
pub(super) fn rotation<T: Lane>(a: T, b: T) -> Rotation<T> {
    let largest = a.value().abs().max(b.value().abs());
    if b.value() == 0.0 || largest.is_nan() {
        return (T::from(1.0), T::default());
    }
    let (a, b) = (a / T::from(largest), b / T::from(largest));
    let r = (a * a + b * b).root();
    (a / r, b / r)
}

/// The reflection that takes v to `[*; 0; 0]`.
pub(super) fn householder<T: Lane>(v: [T; 3]) -> Reflection<T> {
    let largest = v.iter().fold(0.0, |m: f64, x| m.max(x.value().abs()));
    if largest == 0.0 {
        return ([T::default(); 2], [T::default(); 3]);
    }
    let v = v.map(|x| x / T::from(largest));
    let norm = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).root();
    let head = if v[0].value() < 0.0 { v[0] - norm } else { v[0] + norm };
    let u = [v[1] / head, v[2] / head];
    let beta = T::from(2.0) / (T::from(1.0) + u[0] * u[0] + u[1] * u[1]);
    (u, [beta, beta * u[0], beta * u[1]])
}
