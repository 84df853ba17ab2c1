//! Power series of time: how many terms they have, their sums, and the times at which they are 0.

/// Most terms of a series after the first; chosen: with more a piece costs less than it gains, until their alternating signs cost digits.
pub(crate) const MOST_TERMS: usize = 30;

/// Values of a function that are looked at for a root, at most; more than its place has bits.
const MOST_LOOKS: usize = 60;

/// A polynomial, its coefficients from the last on, and its derivative.
pub(crate) fn value_and_slope(coefficients: impl Iterator<Item = f64>, at: f64) -> [f64; 2] {
    coefficients.fold([0.0; 2], |[value, slope], coefficient| [value * at + coefficient, slope * at + value])
}

/// Place at which a function goes from above 0 to below, by its value and its derivative, between one before and one after it, to a part of itself: Newton's method, with a
/// halving where that leaves them.
pub(crate) fn root(function: impl Fn(f64) -> [f64; 2], [mut low, mut high]: [f64; 2], error: f64) -> f64 {
    let mut at = 0.5 * (low + high);
    for _ in 0..MOST_LOOKS {
        let [value, slope] = function(at);
        if value > 0.0 {
            low = at
        } else {
            high = at
        }
        let newton = at - value / slope;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - at).abs() <= error * next {
            return next;
        }
        at = next;
    }
    at
}
