//! Derivatives of eigenvalues: against closed forms, against differences, and where they end.

#![allow(clippy::unwrap_used)]

use cea::{EigenSolver, Eigentriple, Expansion, Perturbation, QrSolver, Rates, Workspace};
use linsys::{Internal, SecondOrder};
use nalgebra::{DMatrix, DVector, dmatrix};
use num_complex::Complex;
use proptest::prelude::*;

/// Dashpots of Hoffmann's oscillator.
const C: f64 = 0.05;

/// Hoffmann's oscillator with dashpots: `lambda^2 + c lambda + 2 = -+ sqrt(1 - D)`, which coalesce at D = 1.
fn hoffmann(d: f64) -> SecondOrder {
    SecondOrder::new(dmatrix![1.0, 0.0; 0.0, 1.0], dmatrix![C, 0.0; 0.0, C], dmatrix![2.0, 1.0 - d; 1.0, 2.0]).unwrap()
}

/// What D does to it.
fn by_d() -> SecondOrder {
    SecondOrder::new(DMatrix::zeros(2, 2), DMatrix::zeros(2, 2), dmatrix![0.0, -1.0; 0.0, 0.0]).unwrap()
}

/// The derivatives of the eigenvalue next to `near` by D: with `r = lambda^2 + c lambda + 2` is `r^2 = 1 - D`.
fn closed_form(d: f64, near: Complex<f64>) -> Rates {
    let root = Complex::from(1.0 - d).sqrt();
    let of = |r: Complex<f64>| (C * C - 4.0 * (2.0 - r)).sqrt();
    let all = [root, -root].map(|r| [of(r), -of(r)].map(|slope| (0.5 * (slope - C), r))).concat();
    let (lambda, r) = all.into_iter().min_by(|a, b| (a.0 - near).norm().total_cmp(&(b.0 - near).norm())).unwrap();
    let slope = 2.0 * lambda + C;
    let (r_first, r_second) = (-0.5 / r, -0.25 / (r * r * r));
    let first = r_first / slope;
    Rates { first, second: (r_second - 2.0 * first * first) / slope }
}

fn distance(a: Complex<f64>, b: Complex<f64>) -> f64 {
    (a - b).norm() / b.norm()
}

#[test]
fn hoffmanns_oscillator_has_its_closed_form_and_a_square_root_at_its_coalescence() {
    let mut work = Workspace::default();
    let mut refused = Vec::new();
    for exponent in 0..16 {
        for d in [1.0 - 0.7 * 10_f64.powi(-exponent), 1.0 + 0.7 * 10_f64.powi(-exponent)] {
            let system = hoffmann(d);
            let spectrum = QrSolver.eigenvalues(&system, &mut work).unwrap();
            for lambda in spectrum.oscillatory() {
                let triple = Eigentriple::new(&system, lambda, &mut work).unwrap();
                let separation = triple.separation(&spectrum.eigenvalues);
                if !separation.is_simple() {
                    refused.push(exponent);
                    continue;
                }
                let by = Perturbation::linear(&triple, &by_d());
                let rates = Expansion::new(&system, &triple, &mut work).unwrap().rates(&by).unwrap();
                let expected = closed_form(d, lambda);
                // What is said to be rounding covers what is, but for that of the last steps.
                let [first, second] =
                    [(rates.first, expected.first), (rates.second, expected.second)].map(|(a, b)| distance(a, b));
                assert!(first <= separation.blur + 1e-13, "D = {d}: {first:e} of {:e}", separation.blur);
                assert!(second <= 4.0 * separation.blur + 1e-12, "D = {d}: {second:e} of {:e}", separation.blur);
                // Next to a square root the first order holds to two fifths of the distance.
                if exponent >= 2 {
                    let reach = rates.holds_to() / (0.4 * (d - 1.0).abs());
                    assert!((reach - 1.0).abs() < 0.03, "D = {d}: {reach}");
                }
            }
        }
    }
    // Eigenvalues 1e-5 apart are still told apart, those 1e-8 apart are not.
    assert!(refused.iter().all(|&exponent| exponent > 9) && refused.contains(&15), "{refused:?}");
}

#[test]
fn first_order_is_off_by_about_a_tenth_where_it_is_said_to_end() {
    let (d, mut work) = (1.3, Workspace::default());
    let system = hoffmann(d);
    let growing = |d: f64| {
        let spectrum = QrSolver.eigenvalues(&hoffmann(d), &mut Workspace::default()).unwrap();
        spectrum.oscillatory().max_by(|a, b| a.re.total_cmp(&b.re)).unwrap()
    };
    let triple = Eigentriple::new(&system, growing(d), &mut work).unwrap();
    let by = Perturbation::linear(&triple, &by_d());
    let rates = Expansion::new(&system, &triple, &mut work).unwrap().rates(&by).unwrap();
    for step in [-rates.growth_holds_to(), rates.growth_holds_to()] {
        let (predicted, change) = (rates.first.re * step, growing(d + step).re - triple.lambda.re);
        let off = (change / predicted - 1.0).abs();
        assert!((0.07..0.14).contains(&off), "{step}: {off}");
    }
}

#[test]
fn a_double_eigenvalue_is_not_simple_and_one_without_a_neighbour_is() {
    let (one, mut work) = (DMatrix::identity(2, 2), Workspace::default());
    let double = SecondOrder::new(one.clone(), DMatrix::zeros(2, 2), one * 4.0).unwrap();
    let (two_i, others) = (Complex::new(0.0, 2.0), [(0.0, 2.0), (0.0, 2.0), (0.0, -2.0), (0.0, -2.0)]);
    let spectrum = others.map(|(re, im)| Complex::new(re, im));
    let separation = Eigentriple::new(&double, two_i, &mut work).unwrap().separation(&spectrum);
    assert_eq!((separation.nearest, separation.is_simple()), (0.0, false));
    let separation = Eigentriple::new(&double, two_i, &mut work).unwrap().separation(&[two_i]);
    assert!(separation.nearest.is_infinite() && separation.is_simple());
}

#[test]
fn one_degree_of_freedom_has_derivatives_although_its_dynamic_stiffness_vanishes() {
    // M = 1, C = 0, K = 4 at lambda = 2 i: Q is exactly 0. d lambda / d K = i / (2 omega), d^2 lambda / d K^2 = -i / (4 omega^3).
    let one = |m, c, k| SecondOrder::new(dmatrix![m], dmatrix![c], dmatrix![k]).unwrap();
    let (system, spring, mut work) = (one(1.0, 0.0, 4.0), one(0.0, 0.0, 1.0), Workspace::default());
    let triple = Eigentriple::new(&system, Complex::new(0.0, 2.0), &mut work).unwrap();
    let rates =
        Expansion::new(&system, &triple, &mut work).unwrap().rates(&Perturbation::linear(&triple, &spring)).unwrap();
    assert!((rates.first - Complex::new(0.0, 0.25)).norm() < 1e-15, "{}", rates.first);
    assert!((rates.second - Complex::new(0.0, -1.0 / 32.0)).norm() < 1e-15, "{}", rates.second);
}

/// A system of `n` degrees of freedom and `s` internal states with entries from a list of numbers in -1..1.
fn made_of(n: usize, s: usize, numbers: &[f64]) -> SecondOrder {
    let mut next = numbers.iter().copied().cycle();
    let mut square = |scale: f64| DMatrix::from_fn(n, n, |_, _| scale * next.next().unwrap());
    let (root, c, k) = (square(0.4), square(0.3), square(1.0));
    let m = &root * root.transpose() + DMatrix::identity(n, n);
    let k = k + DMatrix::from_diagonal(&DVector::from_fn(n, |i, _| 4.0 + 3.0 * i as f64));
    let internal = Internal {
        decay: DVector::from_fn(s, |i, _| 1.0 + i as f64),
        drive: DMatrix::from_fn(s, n, |_, _| next.next().unwrap()),
        force: DMatrix::from_fn(n, s, |_, _| next.next().unwrap()),
    };
    SecondOrder::with_internal(m, c, k, internal).unwrap()
}

/// `a + p b` of two systems with as many internal states, of which b has none of its own decay rates.
fn sum(a: &SecondOrder, p: f64, b: &SecondOrder) -> SecondOrder {
    let mut sum = a.clone();
    sum.m += &b.m * p;
    sum.c += &b.c * p;
    sum.k += &b.k * p;
    sum.internal.force += &b.internal.force * p;
    sum
}

/// The eigenvalue of a system next to another, to full accuracy.
fn next_to(system: &SecondOrder, lambda: Complex<f64>) -> Complex<f64> {
    let mut work = Workspace::default();
    let spectrum = QrSolver.eigenvalues(system, &mut work).unwrap().eigenvalues;
    let nearest = spectrum.into_iter().min_by(|a, b| (a - lambda).norm().total_cmp(&(b - lambda).norm())).unwrap();
    Eigentriple::new(system, nearest, &mut work).unwrap().refined(system)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn derivatives_are_limits_of_differences(
        n in 1_usize..6,
        s in 0_usize..3,
        numbers in proptest::collection::vec(-1.0..1.0, 150),
        others in proptest::collection::vec(-1.0..1.0, 150),
    ) {
        let (system, mut part) = (made_of(n, s, &numbers), made_of(n, s, &others));
        // The parameter acts on the forces of the internal states that there are.
        part.internal.decay.clone_from(&system.internal.decay);
        part.internal.drive.clone_from(&system.internal.drive);
        let mut work = Workspace::default();
        let spectrum = QrSolver.eigenvalues(&system, &mut work).unwrap();
        for lambda in spectrum.oscillatory() {
            let triple = Eigentriple::new(&system, lambda, &mut work).unwrap();
            let separation = triple.separation(&spectrum.eigenvalues);
            // Differences need an eigenvalue that is well apart.
            if separation.nearest < 0.2 || triple.condition() > 100.0 {
                continue;
            }
            let expansion = Expansion::new(&system, &triple, &mut work).unwrap();
            let rates = expansion.rates(&Perturbation::linear(&triple, &part)).unwrap();
            let size = rates.first.norm().max(1.0);
            let step = 2e-4 * separation.nearest.min(1.0) / size;
            let [below, above] = [-step, step].map(|p| next_to(&sum(&system, p, &part), triple.lambda));
            let here = triple.refined(&system);
            let first = (above - below) / (2.0 * step);
            let second = (above + below - 2.0 * here) / (step * step);
            let scale = rates.second.norm() + size * size;
            prop_assert!((rates.first - first).norm() < 1e-4 * scale, "{:?} {first}", rates.first);
            prop_assert!((rates.second - second).norm() < 1e-2 * scale, "{:?} {second}", rates.second);
            prop_assert!(distance(triple.rate(&part.dynamic_stiffness(lambda)), rates.first) < 1e-10);

            // The same from three systems; and by q with p = (1 + q)^2 - 1, where p_q = 2 and p_qq = 2.
            let half = 1e-3;
            let three = [-half, 0.0, half].map(|p| sum(&system, p, &part));
            let again = expansion.rates(&Perturbation::between(&triple, [&three[0], &three[1], &three[2]], half)).unwrap();
            prop_assert!(distance(again.first, rates.first) < 1e-9 * (1.0 + scale / rates.first.norm()));
            prop_assert!((again.second - rates.second).norm() < 1e-6 * scale);
            let three = [-half, 0.0, half].map(|p| sum(&system, (1.0 + p) * (1.0 + p) - 1.0, &part));
            let square = expansion.rates(&Perturbation::between(&triple, [&three[0], &three[1], &three[2]], half)).unwrap();
            prop_assert!((square.first - 2.0 * rates.first).norm() < 1e-9 * scale);
            prop_assert!((square.second - (4.0 * rates.second + 2.0 * rates.first)).norm() < 1e-5 * scale);
        }
    }

    #[test]
    fn a_product_is_the_matrix_that_it_stands_for(
        numbers in proptest::collection::vec(-1.0..1.0, 150),
        (i, j) in (0_usize..4, 0_usize..4),
        (mu, slope) in (-1.0..1.0, -1.0..1.0),
    ) {
        let (system, mut work) = (made_of(4, 1, &numbers), Workspace::default());
        let (b, r) = ([(i, 1.0), (j, -0.5)], [(j, 2.0), (3, 0.25)]);
        let mut part = SecondOrder::zeros(4, 0);
        for (row, x) in b {
            for (column, y) in r {
                part.k[(row, column)] += mu * x * y;
                part.c[(row, column)] += slope * x * y;
            }
        }
        for lambda in QrSolver.eigenvalues(&system, &mut work).unwrap().oscillatory() {
            let triple = Eigentriple::new(&system, lambda, &mut work).unwrap();
            let expansion = Expansion::new(&system, &triple, &mut work).unwrap();
            let matrix = expansion.rates(&Perturbation::linear(&triple, &part)).unwrap();
            let gain = [mu + lambda * slope, Complex::from(slope)];
            let product = expansion.rates(&Perturbation::product(&triple, gain, &b, &r)).unwrap();
            prop_assert!((matrix.first - product.first).norm() < 1e-12 * (1.0 + matrix.first.norm()));
            prop_assert!((matrix.second - product.second).norm() < 1e-9 * (1.0 + matrix.second.norm()));
        }
    }
}
