//! The quantile sketch against exact quantiles.

use montecarlo::{Confidence, Interval, Merge, MonteCarloError, QuantileSketch, quantile, stream};
use proptest::prelude::*;
use rand::RngExt;
use rand_distr::{Distribution, Normal};

fn of(values: &[f64]) -> QuantileSketch {
    let mut sketch = QuantileSketch::default();
    values.iter().for_each(|&value| sketch.record(value));
    sketch
}

/// Values of both signs over many decades, and zeros.
fn values() -> impl Strategy<Value = Vec<f64>> {
    let signed = (-30.0f64..30.0, any::<bool>()).prop_map(|(decades, negative)| {
        let magnitude = 10f64.powf(decades);
        if negative { -magnitude } else { magnitude }
    });
    prop::collection::vec(prop_oneof![8 => signed, 1 => Just(0.0), 1 => Just(-0.0)], 1..200)
}

proptest! {
    #[test]
    fn quantiles_have_the_stated_accuracy(values in values(), p in 0.0f64..=1.0) {
        let mut sorted = values.clone();
        sorted.sort_by(f64::total_cmp);
        let exact = quantile(&sorted, p).unwrap();
        // Interpolation between order statistics of opposite sign can cancel, so the error is relative to the larger of the two.
        let position = (sorted.len() - 1) as f64 * p;
        let scale = sorted[position.floor() as usize].abs().max(sorted[position.ceil() as usize].abs());
        let error = (of(&values).quantile(p).unwrap() - exact).abs();
        prop_assert!(error <= QuantileSketch::RELATIVE_ACCURACY * scale * (1.0 + 1e-12), "{error:e} of {exact:e}");
    }

    #[test]
    fn order_and_grouping_do_not_matter(values in values(), cut in 0usize..200) {
        let (early, late) = values.split_at(cut.min(values.len()));
        let mut merged = of(late);
        merged.merge(of(early));
        let bytes = |sketch| serde_json::to_string(&sketch).unwrap();
        prop_assert_eq!(bytes(merged), bytes(of(&values)));
    }
}

#[test]
fn extremes_are_exact_and_stored_exactly() {
    let sketch = of(&[f64::MAX, -f64::MAX, 0.1, 1e-310, f64::MIN_POSITIVE]);
    assert_eq!(sketch.range(), Some(Interval { lower: -f64::MAX, upper: f64::MAX }));
    assert_eq!((sketch.quantile(0.0).unwrap(), sketch.quantile(1.0).unwrap()), (-f64::MAX, f64::MAX));
    let read: QuantileSketch = serde_json::from_str(&serde_json::to_string(&sketch).unwrap()).unwrap();
    assert_eq!(read, sketch);
    assert_eq!(of(&[0.1; 5]).median().unwrap(), 0.1);
}

#[test]
fn what_is_not_finite_is_counted_apart() {
    let sketch = of(&[1.0, f64::NAN, f64::INFINITY, 3.0, f64::NEG_INFINITY]);
    assert_eq!((sketch.count(), sketch.not_finite()), (2, 3));
    assert!((sketch.median().unwrap() - 2.0).abs() < 1e-3);
    assert!(matches!(of(&[f64::NAN]).median(), Err(MonteCarloError::Empty { .. })));
    assert!(matches!(sketch.quantile(2.0), Err(MonteCarloError::Probability { .. })));
}

#[test]
fn memory_is_bounded_by_the_range_of_the_values_not_by_their_number() {
    let mut rng = stream(5, 0);
    let mut sketch = QuantileSketch::default();
    for _ in 0..200_000 {
        sketch.record(rng.random_range(1.0..10.0));
    }
    // One decade from 1 to 10: three full octaves and a quarter of the fourth, 1,024 buckets each.
    let stored = serde_json::to_value(&sketch).unwrap()["buckets"].as_object().unwrap().len();
    assert_eq!(stored, 3 * 1_024 + 256);
}

#[test]
fn median_intervals_are_the_tabulated_order_statistics() {
    // H. A. David, Order Statistics: at 95 % the median of n values lies between ranks (1, 6), (2, 9), (6, 15), (40, 61).
    for (n, ranks) in [(6u32, (1.0, 6.0)), (10, (2.0, 9.0)), (20, (6.0, 15.0)), (100, (40.0, 61.0))] {
        let values: Vec<f64> = (1..=n).map(f64::from).collect();
        let interval = of(&values).quantile_interval(0.5, Confidence::P95).unwrap().unwrap();
        assert_eq!((interval.lower.round(), interval.upper.round()), ranks, "{n}");
    }
    let five = of(&[1.0, 2.0, 3.0, 4.0, 5.0]);
    assert_eq!(five.quantile_interval(0.5, Confidence::P95).unwrap(), None);
    assert!(matches!(five.quantile_interval(1.0, Confidence::P95), Err(MonteCarloError::Probability { .. })));
    assert_eq!(QuantileSketch::default().quantile_interval(0.5, Confidence::P95).unwrap(), None);
}

#[test]
fn median_intervals_cover_as_often_as_they_say() {
    let normal = Normal::new(3.0, 1.0).unwrap();
    let covered = (0..2_000)
        .filter(|&experiment| {
            let mut rng = stream(11, experiment);
            let values: Vec<f64> = (0..50).map(|_| normal.sample(&mut rng)).collect();
            of(&values).quantile_interval(0.5, Confidence::P95).unwrap().unwrap().contains(3.0)
        })
        .count();
    // Ranks 18 and 33 of 50 cover with probability 0.967 (binomial sum).
    assert!((covered as f64 / 2_000.0 - 0.967).abs() < 0.015, "{covered}");
}
