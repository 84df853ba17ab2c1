//! Vectors of standard normal space.

pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Length, of the largest entry taken out where its square would underflow or overflow.
pub fn norm(a: &[f64]) -> f64 {
    let square = dot(a, a);
    if square > f64::MIN_POSITIVE / f64::EPSILON && square.is_finite() {
        return square.sqrt();
    }
    let largest = a.iter().map(|a| a.abs()).fold(0.0, f64::max);
    match largest > 0.0 && largest.is_finite() {
        true => largest * a.iter().map(|a| (a / largest).powi(2)).sum::<f64>().sqrt(),
        false => square.sqrt(),
    }
}

/// `a + t b`.
pub fn along(a: &[f64], t: f64, b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + t * b).collect()
}

pub fn scaled(t: f64, a: &[f64]) -> Vec<f64> {
    a.iter().map(|a| t * a).collect()
}

/// The vector of length 1 of this direction; `None` of zero and of what is no number.
pub fn unit(a: Vec<f64>) -> Option<Vec<f64>> {
    let norm = norm(&a);
    // One over a subnormal number is infinite.
    let divided = || match (1.0 / norm).is_finite() {
        true => scaled(1.0 / norm, &a),
        false => a.iter().map(|a| a / norm).collect(),
    };
    (norm.is_finite() && norm > 0.0).then(divided)
}
