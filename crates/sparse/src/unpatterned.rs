//! Numbers without a pattern, the same on every machine: starts of iterations to which no eigenvector is orthogonal.

/// The golden ratio less 1, whose multiples are spread most evenly (Weyl's sequence).
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The fractional part of k times the golden ratio, 0 to 1.
pub(crate) fn unpatterned(k: f64) -> f64 {
    (k * GOLDEN).fract()
}
