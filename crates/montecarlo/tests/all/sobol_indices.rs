//! Sobol' indices against closed forms: values, and how often the intervals cover them.

#![allow(clippy::unwrap_used)] // Test code, which the lints do not recognise outside test functions.

use std::f64::consts::PI;

use montecarlo::rand::RngExt;
use montecarlo::{Confidence, PickFreeze, SobolIndex, StreamRng, first_order_by_ranks, stream};

/// A function of independent inputs, uniform in 0..1, with its first-order and total indices.
struct Known {
    name: &'static str,
    of: fn(&[f64]) -> f64,
    first: Vec<f64>,
    total: Vec<f64>,
}

/// Ishigami and Homma, ISUMA 1990: sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1, x uniform in -pi..pi.
fn ishigami() -> Known {
    let (a, b) = (7.0, 0.1);
    let [of_1, of_2, of_13] =
        [0.5 * (1.0 + b * PI.powi(4) / 5.0).powi(2), a * a / 8.0, b * b * PI.powi(8) * (1.0 / 18.0 - 1.0 / 50.0)];
    let all = of_1 + of_2 + of_13;
    let of = |u: &[f64]| {
        let x = |at: usize| PI * (2.0 * u[at] - 1.0);
        x(0).sin() + 7.0 * x(1).sin().powi(2) + 0.1 * x(2).powi(4) * x(0).sin()
    };
    Known {
        name: "Ishigami",
        of,
        first: vec![of_1 / all, of_2 / all, 0.0],
        total: vec![(of_1 + of_13) / all, of_2 / all, of_13 / all],
    }
}

/// Whether u1 + u2 / 2 is above 1, and u3 above 0.2: an indicator with an interaction, and an input that does nothing.
fn indicator() -> Known {
    // P(u1 + u2 / 2 > 1) = 1 / 4. Given u1 it is max(0, 2 u1 - 1) at u1 > 1/2; given u2 it is u2 / 2.
    let (p, q) = (0.25, 0.8);
    let all = p * q * (1.0 - p * q);
    // E over u1 of P^2: integral of (2 u - 1)^2 over 1/2..1 = 1/6; over u2: 1/12.
    let first = [q * q * (1.0 / 6.0 - p * p), q * q * (1.0 / 12.0 - p * p), p * p * q * (1.0 - q), 0.0];
    // 1 - Var E[Y | others] / Var: the mean of the variance given the others.
    let given = [q * (p - 1.0 / 12.0), q * (p - 1.0 / 6.0), p * q * (1.0 - q), 0.0];
    let of = |u: &[f64]| f64::from(u[0] + 0.5 * u[1] > 1.0 && u[2] > 0.2);
    Known { name: "indicator", of, first: first.map(|v| v / all).to_vec(), total: given.map(|v| v / all).to_vec() }
}

fn draw(known: &Known, rng: &mut StreamRng) -> Vec<f64> {
    known.first.iter().map(|_| rng.random()).collect()
}

fn by_ranks(known: &Known, n: usize, replicate: u64) -> Vec<SobolIndex> {
    let mut rng = stream(11, replicate);
    let rows: Vec<Vec<f64>> = (0..n).map(|_| draw(known, &mut rng)).collect();
    let y: Vec<f64> = rows.iter().map(|row| (known.of)(row)).collect();
    let input = |i: usize| rows.iter().map(|row| row[i]).collect::<Vec<_>>();
    (0..known.first.len()).map(|i| first_order_by_ranks(&input(i), &y).unwrap()).collect()
}

/// First-order and total index of each input.
fn by_design(known: &Known, n: usize, replicate: u64) -> Vec<[SobolIndex; 2]> {
    let mut rng = stream(12, replicate);
    let rows: Vec<[Vec<f64>; 2]> = (0..n).map(|_| [draw(known, &mut rng), draw(known, &mut rng)]).collect();
    let [a, b] = [0, 1].map(|side| rows.iter().map(|row| (known.of)(&row[side])).collect::<Vec<f64>>());
    let of_input = |i: usize| {
        let mixed = |[a, b]: &[Vec<f64>; 2]| {
            let mut point = a.clone();
            point[i] = b[i];
            (known.of)(&point)
        };
        let mixed: Vec<f64> = rows.iter().map(mixed).collect();
        let rows = PickFreeze { a: &a, b: &b, mixed: &mixed };
        [rows.first_order().unwrap(), rows.total().unwrap()]
    };
    (0..known.first.len()).map(of_input).collect()
}

#[test]
fn closed_forms_with_many_samples() {
    for known in [ishigami(), indicator()] {
        for (i, found) in by_ranks(&known, 100_000, 0).into_iter().enumerate() {
            let error = (found.value - known.first[i]).abs();
            assert!(error < 4.0 * found.standard_error && error < 0.01, "{} {i}: {found:?}", known.name);
        }
        for (i, [first, total]) in by_design(&known, 50_000, 0).into_iter().enumerate() {
            for (found, expected) in [(first, known.first[i]), (total, known.total[i])] {
                let error = (found.value - expected).abs();
                assert!(error <= 4.0 * found.standard_error + 1e-12 && error < 0.02, "{} {i}: {found:?}", known.name);
            }
        }
    }
}

/// The fraction of the replicates whose 95 % interval covers the truth, before it is cut to 0..1.
fn coverage(truth: f64, found: impl Iterator<Item = SobolIndex>) -> f64 {
    let all: Vec<SobolIndex> = found.collect();
    let t = |index: &SobolIndex| Confidence::P95.t(index.samples - 1) * index.standard_error;
    let covers = |index: &&SobolIndex| (index.value - truth).abs() <= t(index);
    all.iter().filter(covers).count() as f64 / all.len() as f64
}

#[test]
fn intervals_cover_as_often_as_they_say() {
    // 1,000 replicates know a coverage of 95 % to 0.7 %.
    let replicates = 1_000;
    for known in [ishigami(), indicator()] {
        let ranks: Vec<Vec<SobolIndex>> = (0..replicates).map(|r| by_ranks(&known, 500, r)).collect();
        let designs: Vec<Vec<[SobolIndex; 2]>> = (0..replicates).map(|r| by_design(&known, 500, r)).collect();
        for i in 0..known.first.len() {
            let of_ranks = coverage(known.first[i], ranks.iter().map(|found| found[i]));
            let of_design = [known.first[i], known.total[i]];
            let of_design = [0, 1].map(|kind| coverage(of_design[kind], designs.iter().map(|found| found[i][kind])));
            println!("{} input {}: ranks {of_ranks:.3}, design {of_design:.3?}", known.name, i + 1);
            for covered in of_design.into_iter().chain([of_ranks]) {
                assert!(covered > 0.925, "{} input {}: {of_ranks} {of_design:?}", known.name, i + 1);
            }
        }
    }
}

/// An output that is zero but where u1 < q1, u2 < q2 and u3 < q3, and there a function of u4 with these means of its first and second power;
/// u5 does nothing.
struct Rare {
    q: [f64; 3],
    of: fn(f64) -> f64,
    means: [f64; 2],
}

impl Rare {
    /// Of each input.
    fn first(&self) -> Vec<f64> {
        let (p, [mean, square]) = (self.q.iter().product::<f64>(), self.means);
        let all = p * square - (p * mean).powi(2);
        let mut first: Vec<f64> = self.q.iter().map(|q| (p * mean).powi(2) * (1.0 / q - 1.0) / all).collect();
        first.extend([p * p * (square - mean * mean) / all, 0.0]);
        first
    }

    fn total(&self) -> Vec<f64> {
        let (p, [mean, square]) = (self.q.iter().product::<f64>(), self.means);
        let all = p * square - (p * mean).powi(2);
        // E Var[y | all but u_i].
        let mut total: Vec<f64> = self.q.iter().map(|q| p * square * (1.0 - q) / all).collect();
        total.extend([p * (square - mean * mean) / all, 0.0]);
        total
    }

    fn value(&self, u: &[f64; 5]) -> f64 {
        if u.iter().zip(self.q).all(|(u, q)| *u < q) { (self.of)(u[3]) } else { 0.0 }
    }
}

/// An output as a function of one number.
type Output = fn(f64) -> f64;

/// Rare outputs of several kinds: which input decides, and how the output is distributed where it is not zero.
fn rare_outputs(parts: &[[f64; 3]]) -> Vec<Rare> {
    let kinds: [(Output, [f64; 2]); 3] =
        [(|_| 1.0, [1.0, 1.0]), (|u| u, [0.5, 1.0 / 3.0]), (|u| u * u, [1.0 / 3.0, 0.2])];
    parts.iter().flat_map(|&q| kinds.map(|(of, means)| Rare { q, of, means })).collect()
}

/// The fraction of the replicates whose intervals cover the index, of each input: by ranks, and total ones by design. An output that is not zero in fewer
/// than 30 samples has no index.
fn rare_coverage(rare: &Rare, n: usize, replicates: u64) -> [Vec<f64>; 2] {
    let (first, total) = (rare.first(), rare.total());
    let mut covered = [vec![0.0; 5], vec![0.0; 5]];
    let mut counted = 0.0;
    for replicate in 0..replicates {
        let mut rng = stream(21, replicate);
        let mut points = || (0..n).map(|_| std::array::from_fn(|_| rng.random())).collect::<Vec<[f64; 5]>>();
        let (a, b) = (points(), points());
        let of_a: Vec<f64> = a.iter().map(|u| rare.value(u)).collect();
        let of_b: Vec<f64> = b.iter().map(|u| rare.value(u)).collect();
        if of_a.iter().filter(|y| **y > 0.0).count() < 30 {
            continue;
        }
        counted += 1.0;
        for i in 0..5 {
            let x: Vec<f64> = a.iter().map(|u| u[i]).collect();
            let index = first_order_by_ranks(&x, &of_a).unwrap();
            let interval = index.interval(Confidence::P95);
            assert!((0.0..=1.0).contains(&index.part()) && interval.contains(index.part()), "{index:?}");
            covered[0][i] += f64::from(u8::from(interval.contains(first[i])));
            let mixed = |(a, b): (&[f64; 5], &[f64; 5])| {
                let mut u = *a;
                u[i] = b[i];
                rare.value(&u)
            };
            let mixed: Vec<f64> = a.iter().zip(&b).map(mixed).collect();
            let index = PickFreeze { a: &of_a, b: &of_b, mixed: &mixed }.total().unwrap();
            covered[1][i] += f64::from(u8::from(index.interval(Confidence::P95).contains(total[i])));
        }
    }
    assert!(counted > 0.5 * replicates as f64, "{counted}");
    covered.map(|of| of.into_iter().map(|covered: f64| covered / counted).collect())
}

fn check_rare(parts: &[[f64; 3]], n: usize, replicates: u64) {
    for rare in rare_outputs(parts) {
        let covered = rare_coverage(&rare, n, replicates);
        println!("{:?}, mean {:.2}: ranks {:.3?}, total {:.3?}", rare.q, rare.means[0], covered[0], covered[1]);
        // Three standard errors of a fraction of so many replicates.
        let least = 0.95 - 3.0 * (0.95 * 0.05 / replicates as f64).sqrt();
        assert!(covered.iter().flatten().all(|covered| *covered >= least), "{:?}: {covered:?}", rare.q);
    }
}

#[test]
fn intervals_of_rare_outputs_cover() {
    check_rare(&[[0.05, 0.5, 0.6]], 3_000, 100);
}

/// With 20,000 samples, of which 0.3 % and more are not zero: `cargo test --release -p brake-squeal-montecarlo --test all sobol_indices:: -- --ignored --nocapture`.
#[test]
#[ignore = "20,000 samples in 400 replicates of 21 outputs"]
fn intervals_of_rare_outputs_cover_with_many_samples() {
    let parts = [
        [0.05, 0.3, 0.2],
        [0.003, 0.99, 0.99],
        [0.01, 0.6, 0.5],
        [0.3, 0.3, 0.3],
        [0.02, 0.9, 0.9],
        [0.9, 0.05, 0.9],
        [0.3, 0.6, 0.4],
    ];
    check_rare(&parts, 20_000, 400);
}
