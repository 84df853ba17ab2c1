//! Eigenvalues of one system beside those of another.

use num_complex::Complex;

/// Largest distance, relative to |lambda|, of two eigenvalues of the same mode; chosen: with less, a mode that a reduction has with an
/// error counts as missing; with more, a missing one is taken for its neighbour.
const SAME_MODE: f64 = 1e-3;

/// Eigenvalues of one system and their counterparts in another.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// The largest distance of an eigenvalue from its counterpart, relative to its size.
    pub distance: f64,
    /// Eigenvalues without a counterpart within a thousandth of their size.
    pub missed: Vec<Complex<f64>>,
    /// Eigenvalues of the other system that are no counterpart.
    pub left: Vec<Complex<f64>>,
    /// Pairs of counterparts.
    pub pairs: Vec<[Complex<f64>; 2]>,
}

/// Counterparts of the eigenvalues `of`: each gets the nearest of `others` that is still free.
#[must_use]
pub fn compared(of: &[Complex<f64>], mut others: Vec<Complex<f64>>) -> Compared {
    let mut found = Compared { distance: 0.0, missed: Vec::new(), left: Vec::new(), pairs: Vec::new() };
    for &lambda in of {
        let distance = |other: &Complex<f64>| (other - lambda).norm() / lambda.norm();
        let nearest = (0..others.len()).min_by(|&a, &b| distance(&others[a]).total_cmp(&distance(&others[b])));
        match nearest.filter(|&at| distance(&others[at]) <= SAME_MODE) {
            Some(at) => {
                let other = others.swap_remove(at);
                found.distance = found.distance.max(distance(&other));
                found.pairs.push([lambda, other]);
            }
            None => found.missed.push(lambda),
        }
    }
    Compared { left: others, ..found }
}
