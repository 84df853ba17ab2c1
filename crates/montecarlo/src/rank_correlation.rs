//! Spearman's rank correlation: whether two quantities order the same things alike.

/// Spearman's rank correlation of pairs, -1 to 1: Pearson's correlation of the ranks, equal values having the mean of theirs. `None` of fewer than three
/// pairs, which are always in the same order or in the opposite one, where all values on a side are equal, and where one is not a number.
///
/// ```
/// use montecarlo::rank_correlation;
/// // One pair of neighbours is exchanged: 1 - 6 * 2 / (4 * 15).
/// let pairs = [(1.0, 10.0), (2.0, 30.0), (3.0, 20.0), (4.0, 40.0)];
/// assert!((rank_correlation(&pairs).unwrap() - 0.8).abs() < 1e-15);
/// ```
#[must_use]
pub fn rank_correlation(pairs: &[(f64, f64)]) -> Option<f64> {
    if pairs.len() < 3 || pairs.iter().any(|(x, y)| x.is_nan() || y.is_nan()) {
        return None;
    }
    let sides = [|pair: &(f64, f64)| pair.0, |pair: &(f64, f64)| pair.1];
    let [x, y] = sides.map(|side| centred_ranks(&pairs.iter().map(side).collect::<Vec<_>>()));
    let product = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let scale = (product(&x, &x) * product(&y, &y)).sqrt();
    (scale > 0.0).then(|| (product(&x, &y) / scale).clamp(-1.0, 1.0))
}

/// Ranks less their mean; equal values have the mean of theirs.
fn centred_ranks(values: &[f64]) -> Vec<f64> {
    let mean = (values.len() as f64 - 1.0) / 2.0;
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rank = |value: &f64| {
        let below = sorted.partition_point(|other| other < value);
        let equal = sorted.partition_point(|other| other <= value) - below;
        below as f64 + (equal as f64 - 1.0) / 2.0 - mean
    };
    values.iter().map(rank).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_and_ties_are_those_of_the_ranks() {
        let of = |x: &[f64], y: &[f64]| rank_correlation(&x.iter().copied().zip(y.iter().copied()).collect::<Vec<_>>());
        assert_eq!(of(&[1.0, 2.0, 9.0], &[-3.0, 0.0, 1e9]), Some(1.0));
        assert_eq!(of(&[1.0, 2.0, 9.0], &[4.0, 3.0, 2.0]), Some(-1.0));
        // Without ties: 1 - 6 sum d^2 / (n (n^2 - 1)), the ranks 1 2 3 4 5 beside 2 1 5 3 4.
        let found = of(&[1.0, 2.0, 3.0, 4.0, 5.0], &[20.0, 10.0, 50.0, 30.0, 40.0]).unwrap();
        assert!((found - (1.0 - 6.0 * 8.0 / (5.0 * 24.0))).abs() < 1e-15, "{found}");
        // Ranks 1.5 1.5 3 4 beside 1 2 3 4: products 4.5 over sqrt(4.5 * 5).
        let found = of(&[0.0, 0.0, 1.0, 2.0], &[1.0, 2.0, 3.0, 4.0]).unwrap();
        assert!((found - 4.5 / (4.5_f64 * 5.0).sqrt()).abs() < 1e-15, "{found}");
        assert_eq!(of(&[1.0, 1.0, 1.0], &[1.0, 2.0, 3.0]), None);
        assert_eq!(of(&[1.0, 2.0], &[1.0, 2.0]), None);
        assert_eq!(of(&[1.0, f64::NAN, 2.0], &[1.0, 2.0, 3.0]), None);
    }
}
