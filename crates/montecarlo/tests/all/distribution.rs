//! Draws, distribution function and quantiles of each kind of distribution agree, and wrong parameters are named.

#![allow(clippy::unwrap_used, clippy::panic)] // Test code, which the lints do not recognise outside test functions.

use montecarlo::{Distribution, stream};
use proptest::prelude::*;
use rand::Rng;
use rand_distr::{Distribution as _, StandardNormal, StandardUniform};

fn normal(mean: f64, deviation: f64, at_least: f64, at_most: Option<f64>) -> Distribution {
    Distribution::Normal { mean, deviation, at_least, at_most }
}

fn log_normal(median: f64, sigma: f64, at_least: Option<f64>, at_most: Option<f64>) -> Distribution {
    Distribution::LogNormal { median, sigma, at_least, at_most }
}

fn table(probabilities: &[f64], values: &[f64]) -> Distribution {
    Distribution::Quantiles { probabilities: probabilities.to_vec(), values: values.to_vec() }
}

/// Every kind of distribution that has a density, with no bound, one bound and two.
fn kinds() -> Vec<Distribution> {
    vec![
        normal(0.5, 0.1, f64::NEG_INFINITY, None),
        normal(0.5, 0.1, 0.45, None),
        normal(0.5, 0.1, f64::NEG_INFINITY, Some(0.55)),
        normal(0.5, 0.1, 0.45, Some(0.7)),
        // Both bounds above the mean, where 2.1 % is kept.
        normal(0.5, 0.1, 0.7, Some(0.8)),
        log_normal(1.5, 0.25, None, None),
        log_normal(1.5, 0.25, Some(1.2), None),
        log_normal(1.5, 0.25, None, Some(2.0)),
        log_normal(1.5, 0.25, Some(1.6), Some(2.0)),
        Distribution::Uniform { from: 2.0, to: 5.0 },
        Distribution::LogUniform { from: 1e-3, to: 10.0 },
        table(&[0.0, 0.1, 0.7, 1.0], &[-3.0, 0.0, 0.5, 7.0]),
        Distribution::Triangular { from: 1.0, mode: 1.5, to: 4.0 },
        Distribution::Triangular { from: 1.0, mode: 1.0, to: 4.0 },
        Distribution::Triangular { from: -1.0, mode: 4.0, to: 4.0 },
        Distribution::Weibull { shape: 1.7, scale: 0.2, from: 0.3 },
        Distribution::Weibull { shape: 0.8, scale: 2.0, from: 0.0 },
        measured(&[0.3, 0.35, 0.5, 0.52, 0.9]),
    ]
}

fn measured(values: &[f64]) -> Distribution {
    Distribution::Empirical { values: values.to_vec(), file: None, column: None }
}

/// Means and deviations by the closed forms of the textbooks; of the discrete ones the shares of the draws.
#[test]
fn moments_are_those_of_the_textbooks() {
    let moments = |distribution: &Distribution| {
        let (n, mut rng) = (200_000, stream(11, 0));
        let draws: Vec<f64> = (0..n).map(|_| distribution.draw(&mut rng).unwrap()).collect();
        let mean = draws.iter().sum::<f64>() / f64::from(n);
        (mean, (draws.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / f64::from(n)).sqrt())
    };
    let variance = |a: f64, c: f64, b: f64| (a * a + b * b + c * c - a * b - a * c - b * c) / 18.0;
    // Gamma(1.5) and Gamma(2) of a Rayleigh distribution, shape 2.
    let rayleigh = (0.5 * std::f64::consts::PI.sqrt(), (1.0 - std::f64::consts::PI / 4.0).sqrt());
    for (distribution, mean, deviation) in [
        (Distribution::Triangular { from: 1.0, mode: 1.5, to: 4.0 }, 6.5 / 3.0, variance(1.0, 1.5, 4.0).sqrt()),
        (Distribution::Weibull { shape: 2.0, scale: 3.0, from: 1.0 }, 1.0 + 3.0 * rayleigh.0, 3.0 * rayleigh.1),
        (Distribution::Discrete { values: vec![1.0, 3.0], weights: vec![3.0, 1.0] }, 1.5, 0.75_f64.sqrt()),
        (Distribution::Discrete { values: vec![0.0, 1.0, 2.0], weights: Vec::new() }, 1.0, (2.0_f64 / 3.0).sqrt()),
    ] {
        let found = moments(&distribution);
        // Five standard errors of the mean.
        assert!((found.0 - mean).abs() < 5.0 * deviation / 200_000_f64.sqrt(), "{distribution:?}: {found:?}");
        assert!((found.1 / deviation - 1.0).abs() < 0.02, "{distribution:?}: {found:?}");
    }
}

#[test]
fn one_of_a_few_values_has_its_share_and_measured_values_are_met_in_order() {
    let few = Distribution::Discrete { values: vec![0.3, 0.5, 0.6], weights: vec![1.0, 2.0, 1.0] };
    for (u, value) in [(1e-9, 0.3), (0.2499, 0.3), (0.2501, 0.5), (0.7499, 0.5), (0.7501, 0.6), (1.0 - 1e-12, 0.6)] {
        assert_eq!(few.quantile(u), value, "{u}");
    }
    assert_eq!([0.2, 0.3, 0.55, 0.6].map(|x| few.cumulative(x)), [0.0, 0.25, 0.75, 1.0]);
    assert_eq!((few.median(), few.least(), few.support()), (0.5, Some(("values", 0.3)), (0.3, 0.6)));
    let twice = measured(&[0.3, 0.5, 0.5, 0.9]);
    assert_eq!([0.0, 1.0 / 3.0, 0.5, 1.0].map(|u| twice.quantile(u)), [0.3, 0.5, 0.5, 0.9]);
    assert_eq!(
        [0.2, 0.4, 0.5, 0.7, 2.0].map(|x| (3.0 * twice.cumulative(x) * 2.0).round() / 6.0),
        [0.0, 1.0 / 6.0, 4.0 / 6.0, 5.0 / 6.0, 1.0]
    );
    let of_file =
        Distribution::Empirical { values: Vec::new(), file: Some("mu.csv".into()), column: Some("mu".into()) };
    let read = |file: &std::path::Path, column: Option<&str>| {
        assert_eq!((file.to_str(), column), (Some("mu.csv"), Some("mu")));
        Ok::<_, ()>(vec![0.9, 0.3])
    };
    let Ok(Distribution::Empirical { values, .. }) = of_file.with_file(read) else { panic!("another kind") };
    assert_eq!(values, [0.3, 0.9]);
}

proptest! {
    #[test]
    fn the_quantile_inverts_the_distribution_function(u in 1e-6..0.999_999_f64) {
        for distribution in kinds() {
            let back = distribution.cumulative(distribution.quantile(u));
            prop_assert!((back - u).abs() < 1e-10, "{:?}: {} for {}", distribution, back, u);
        }
    }

    #[test]
    fn draws_lie_within_the_bounds(index in 0..u64::MAX) {
        let mut rng = stream(5, index);
        for distribution in [
            normal(0.5, 0.1, 0.45, Some(0.55)),
            normal(0.5, 0.1, 0.7, Some(0.8)),
            log_normal(1.5, 0.25, Some(1.4), Some(1.6)),
            Distribution::LogUniform { from: 0.1, to: 0.2 },
        ] {
            let (from, to) = distribution.support();
            let value = distribution.draw(&mut rng).unwrap();
            prop_assert!(from <= value && value <= to, "{:?}: {}", distribution, value);
        }
    }
}

/// Largest distance between the distribution function and the empirical one of the draws.
fn kolmogorov_smirnov(distribution: &Distribution, mut draws: Vec<f64>) -> f64 {
    draws.sort_by(f64::total_cmp);
    let n = draws.len() as f64;
    let distance = |(rank, &value): (usize, &f64)| {
        let probability = distribution.cumulative(value);
        (probability - rank as f64 / n).abs().max((probability - (rank + 1) as f64 / n).abs())
    };
    draws.iter().enumerate().map(distance).fold(0.0, f64::max)
}

#[test]
fn draws_are_distributed_as_the_distribution_function_says() {
    let n = 20_000;
    for distribution in kinds() {
        let mut rng = stream(2026, 0);
        let draws = (0..n).map(|_| distribution.draw(&mut rng).unwrap()).collect();
        // sqrt(n) D is above 1.95 with a probability of 0.1 % (Kolmogorov's distribution).
        let distance = kolmogorov_smirnov(&distribution, draws);
        assert!(distance < 1.95 / f64::from(n).sqrt(), "{distribution:?}: {distance}");
    }
}

#[test]
fn bounds_on_one_side_of_the_mean_hold_even_where_u_is_next_to_0_or_1() {
    for distribution in kinds() {
        let (from, to) = distribution.support();
        for u in [f64::MIN_POSITIVE, f64::EPSILON, 1.0 - f64::EPSILON / 2.0] {
            let value = distribution.quantile(u);
            assert!(value.is_finite(), "{distribution:?} at {u}: {value}");
        }
        assert!(distribution.cumulative(from) < 2e-12 && 1.0 - distribution.cumulative(to) < 2e-12, "{distribution:?}");
        assert_eq!((distribution.cumulative(from - 1e9), distribution.cumulative(to + 1e9)), (0.0, 1.0));
    }
}

#[test]
fn a_draw_takes_the_same_random_numbers_in_every_version() {
    // The results of studies keep their bytes only while these draws stay the same.
    let drawn = |distribution: &Distribution| {
        let mut rng = stream(7, 3);
        let value = distribution.draw(&mut rng).unwrap();
        (value, rng.next_u64())
    };
    fn z(rng: &mut montecarlo::StreamRng) -> f64 {
        StandardNormal.sample(rng)
    }
    fn u(rng: &mut montecarlo::StreamRng) -> f64 {
        StandardUniform.sample(rng)
    }
    let expected = |value: fn(&mut montecarlo::StreamRng) -> f64| {
        let mut rng = stream(7, 3);
        let value = value(&mut rng);
        (value, rng.next_u64())
    };
    assert_eq!(drawn(&normal(0.5, 0.1, 0.02, None)), expected(|rng| 0.5 + 0.1 * z(rng)));
    assert_eq!(drawn(&log_normal(1.5, 0.25, None, None)), expected(|rng| 1.5 * (0.25 * z(rng)).exp()));
    assert_eq!(drawn(&Distribution::Uniform { from: 2.0, to: 5.0 }), expected(|rng| 2.0 + 3.0 * u(rng)));
    assert_eq!(drawn(&Distribution::Constant { value: 4.0 }), expected(|_| 4.0));
}

#[test]
fn medians_are_the_quantiles_at_one_half() {
    for distribution in kinds() {
        let expected = distribution.quantile(0.5);
        assert!((distribution.median() - expected).abs() <= 1e-6 * expected.abs(), "{distribution:?}");
    }
    // A bound at the mean leaves its upper half, whose median is the upper quartile.
    let quartile = 0.674_489_750_196_081_7;
    assert!((normal(0.5, 0.1, 0.5, None).median() - (0.5 + 0.1 * quartile)).abs() < 1e-12);
    // A bound that hardly cuts off anything leaves the digits of the mean as they are.
    assert_eq!(normal(0.5, 0.1, 0.02, None).median(), 0.5);
    assert_eq!(normal(0.0, 2.0, f64::NEG_INFINITY, None).median(), 0.0);
}

#[test]
fn the_fields_of_a_file_are_those_of_the_kinds() {
    let read = |text: &str| serde_json::from_str::<Distribution>(text).map_err(|error| error.to_string());
    assert_eq!(read(r#"{"distribution": "normal", "mean": 0.5, "deviation": 0.1}"#), Ok(normal(0.5, 0.1, 0.0, None)));
    assert_eq!(
        read(r#"{"distribution": "log-normal", "median": 2, "sigma": 1, "at_most": 4}"#),
        Ok(log_normal(2.0, 1.0, None, Some(4.0)))
    );
    assert_eq!(
        read(r#"{"distribution": "log-uniform", "from": 1, "to": 2}"#),
        Ok(Distribution::LogUniform { from: 1.0, to: 2.0 })
    );
    assert_eq!(
        read(r#"{"distribution": "quantiles", "probabilities": [0, 1], "values": [3, 4]}"#),
        Ok(table(&[0.0, 1.0], &[3.0, 4.0]))
    );
    let error = read(r#"{"distribution": "uniform", "from": 1, "to": 2, "at_most": 4}"#).unwrap_err();
    assert!(error.contains("at_most"), "{error}");
}

#[test]
fn every_slip_is_named_with_its_key_and_what_is_allowed() {
    let infinite = f64::NEG_INFINITY;
    for (distribution, expected) in [
        (Distribution::Constant { value: f64::NAN }, "value = NaN; allowed: a finite number"),
        (normal(0.5, 0.0, 0.0, None), "deviation = 0; allowed: a number > 0"),
        (normal(0.5, 0.1, 3.0, None), "at_least = 3; allowed: at most the mean, 0.5"),
        (normal(0.5, 0.1, f64::NAN, None), "at_least = NaN; allowed: a finite number"),
        (normal(0.5, 0.1, 0.6, Some(0.5)), "at_most = 0.5; allowed: more than at_least = 0.6"),
        (
            normal(0.5, 0.1, 0.8, Some(2.0)),
            "at_least = 0.8; allowed: bounds that keep 1 % of the distribution or more, not 1.3e-1 %",
        ),
        (
            normal(0.5, 0.1, infinite, Some(-0.5)),
            "at_most = -0.5; allowed: bounds that keep 1 % of the distribution or more, not 7.6e-22 %",
        ),
        (log_normal(-1.0, 0.1, None, None), "median = -1; allowed: a number > 0"),
        (log_normal(1.0, f64::INFINITY, None, None), "sigma = inf; allowed: a number > 0"),
        (log_normal(1.0, 0.1, Some(0.0), None), "at_least = 0; allowed: a number > 0"),
        (
            log_normal(1.0, 0.1, Some(2.0), None),
            "at_least = 2; allowed: bounds that keep 1 % of the distribution or more, not 2.1e-10 %",
        ),
        (Distribution::Uniform { from: 2.0, to: 1.0 }, "to = 1; allowed: at least from = 2"),
        (Distribution::LogUniform { from: 0.0, to: 1.0 }, "from = 0; allowed: a number > 0"),
        (table(&[0.0, 1.0], &[1.0]), "values = a list of 1; allowed: one for each of the 2 probabilities"),
        (table(&[0.0], &[1.0]), "probabilities = a list of 1; allowed: two numbers or more"),
        (
            table(&[0.0, 0.5, 0.5, 1.0], &[1.0, 2.0, 3.0, 4.0]),
            "probabilities = [.., 0.5, 0.5, ..]; allowed: numbers \
                                                             that ascend, each once",
        ),
        (table(&[0.0, 1.0], &[2.0, 1.0]), "values = [.., 2, 1, ..]; allowed: numbers that ascend, each once"),
        (table(&[0.1, 1.0], &[1.0, 2.0]), "probabilities = [0.1, ..]; allowed: 0 as the first"),
        (table(&[0.0, 0.9], &[1.0, 2.0]), "probabilities = [.., 0.9]; allowed: 1 as the last"),
        (Distribution::Triangular { from: 2.0, mode: 2.0, to: 2.0 }, "to = 2; allowed: more than from = 2"),
        (Distribution::Triangular { from: 1.0, mode: 3.0, to: 2.0 }, "mode = 3; allowed: from = 1 to to = 2"),
        (Distribution::Weibull { shape: 0.0, scale: 1.0, from: 0.0 }, "shape = 0; allowed: a number > 0"),
        (Distribution::Weibull { shape: 1.0, scale: -1.0, from: 0.0 }, "scale = -1; allowed: a number > 0"),
        (
            Distribution::Discrete { values: vec![1.0], weights: vec![] },
            "values = a list of 1; allowed: two numbers or more",
        ),
        (
            Distribution::Discrete { values: vec![1.0, 2.0], weights: vec![1.0] },
            "weights = a list of 1; allowed: one for each of the 2 values",
        ),
        (
            Distribution::Discrete { values: vec![1.0, 2.0], weights: vec![1.0, 0.0] },
            "weights = 0; allowed: a number > 0",
        ),
        (measured(&[]), "values = a list of 0; allowed: two different numbers or more"),
        (measured(&[1.0, 1.0]), "values = a list of 2; allowed: two different numbers or more"),
        (measured(&[2.0, 1.0]), "values = [.., 2, 1, ..]; allowed: numbers that ascend"),
    ] {
        assert_eq!(distribution.check().unwrap_err().to_string(), expected, "{distribution:?}");
    }
    // Numbers with which quantiles overflow, or underflow to 0.
    let (high, low) = (1e308, 1e-308);
    for (distribution, field) in [
        (Distribution::Weibull { shape: 1e-3, scale: 1.0, from: 0.0 }, "shape = 0.001"),
        (Distribution::Weibull { shape: 1e-3, scale: 1.0, from: 0.5 }, "shape = 0.001"),
        (Distribution::Weibull { shape: 0.03, scale: 1.0, from: 0.0 }, "shape = 0.03"),
        (Distribution::Weibull { shape: 1.0, scale: high, from: high }, "shape = 1"),
        (Distribution::LogNormal { median: 1.0, sigma: 200.0, at_least: None, at_most: None }, "sigma = 200"),
        (Distribution::LogNormal { median: low, sigma: 10.0, at_least: None, at_most: None }, "sigma = 10"),
        (Distribution::LogUniform { from: low, to: high }, "to = 1"),
        (
            Distribution::Normal { mean: 1.0, deviation: high, at_least: f64::NEG_INFINITY, at_most: None },
            "deviation = 1",
        ),
        (Distribution::Uniform { from: -high, to: high }, "to = 1"),
        (Distribution::Triangular { from: -high, mode: 0.0, to: high }, "to = 1"),
        (measured(&[-high, high]), "values = ["),
        (table(&[0.0, 1.0], &[-high, high]), "values = ["),
    ] {
        let refused = distribution.check().unwrap_err().to_string();
        assert!(refused.starts_with(field) && refused.contains("finite"), "{refused}");
    }
    for distribution in kinds() {
        assert_eq!(distribution.check(), Ok(()), "{distribution:?}");
    }
}

/// A value has a probability of its own where the quantile function is flat.
#[test]
fn atoms_are_where_the_quantile_function_is_flat() {
    let discrete = Distribution::Discrete { values: vec![1.0, 2.0], weights: Vec::new() };
    let point = Distribution::Uniform { from: 1.0, to: 1.0 };
    let all = [
        measured(&[1.0, 2.0, 2.0, 3.0]),
        measured(&[2.0, 2.0]),
        measured(&[1.0, 2.0, 3.0]),
        discrete,
        point,
        Distribution::Uniform { from: 1.0, to: 2.0 },
        Distribution::Normal { mean: 0.0, deviation: 1.0, at_least: -1.0, at_most: Some(1.0) },
    ];
    for distribution in all {
        let steps: Vec<f64> = (1..1000).map(|at| distribution.quantile(f64::from(at) / 1000.0)).collect();
        let is_flat = steps.windows(2).any(|pair| pair[0] == pair[1]);
        assert_eq!(distribution.has_atoms(), is_flat, "{distribution:?}");
        // A step of a continuous one is a small part of all of them.
        let range = steps[998] - steps[0];
        let jumps = range == 0.0 || steps.windows(2).any(|pair| pair[1] - pair[0] > 0.1 * range);
        assert_eq!(distribution.jumps(), jumps, "{distribution:?}");
    }
}
