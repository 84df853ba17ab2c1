//! Vectors of standard normal space.

pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
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
    (norm.is_finite() && norm > 0.0).then(|| scaled(1.0 / norm, &a))
}
