//! Against the matrices: a chain of masses that loses springs.

use super::*;
use cea::{EigenSolver, QrSolver, Workspace};

const ORDER: usize = 12;

/// A chain of masses, and the same with two springs less, which friction couples to other masses, and a dashpot more.
fn ends() -> [SecondOrder; 2] {
    let spring = |i: usize| 3.0 + (i * i % 7) as f64;
    let k = DMatrix::from_fn(ORDER, ORDER, |i, j| match i.abs_diff(j) {
        0 => spring(i) + spring(i + 1),
        1 => -spring(i.max(j)),
        _ => 0.0,
    });
    let m = DMatrix::from_fn(ORDER, ORDER, |i, j| if i == j { 1.0 + (i % 3) as f64 * 0.2 } else { 0.0 });
    let c = &k * 0.002 + &m * 0.005;
    let (mut to_k, mut to_c) = (k.clone(), c.clone());
    for (at, size) in [(2, 1.5), (7, 0.8)] {
        to_k[(at, at)] -= size;
        to_k[(at + 1, at)] -= 0.4 * size;
    }
    to_c[(4, 4)] += 0.05;
    [SecondOrder::new(m.clone(), c, k).unwrap(), SecondOrder::new(m, to_c, to_k).unwrap()]
}

fn system([from, to]: &[SecondOrder; 2], t: f64) -> SecondOrder {
    let mix = |a: &DMatrix<f64>, b: &DMatrix<f64>| a * (1.0 - t) + b * t;
    SecondOrder::new(mix(&from.m, &to.m), mix(&from.c, &to.c), mix(&from.k, &to.k)).unwrap()
}

fn eigenvalues(system: &SecondOrder) -> Vec<Complex<f64>> {
    QrSolver.eigenvalues(system, &mut Workspace::default()).unwrap().oscillatory().collect()
}

#[test]
fn eigenvalues_rates_and_shapes_are_those_of_the_matrices() {
    let ends = ends();
    let path = ContactPath::new([&ends[0], &ends[1]], 3.0).unwrap().unwrap();
    assert_eq!(path.powers, [0, 0, 1]);
    for t in [0.0, 0.31, 1.0] {
        let [here, ahead] = [t, t + 1e-6].map(|t| system(&ends, t));
        let lambdas = eigenvalues(&here);
        for lambda in lambdas.iter().filter(|lambda| lambda.im < 3.0) {
            let found = path.next_to(t, lambda * 1.0005).unwrap();
            assert!((found.lambda - lambda).norm() < 1e-8 * lambda.norm(), "{t} {lambda} {found:?}");
            let q = here.dynamic_stiffness(*lambda);
            assert!((&q * &found.shape).norm() < 1e-6 * q.norm() * found.shape.norm());
            let moved = eigenvalues(&ahead).into_iter().map(|other| other - lambda);
            let moved = moved.min_by(|a, b| a.norm().total_cmp(&b.norm())).unwrap();
            assert!((moved / 1e-6 - found.rate).norm() < 1e-3 * (found.rate.norm() + 0.1));
        }
    }
}

#[test]
fn the_nearest_eigenvalues_are_found_without_a_spectrum() {
    let ends = ends();
    let path = ContactPath::new([&ends[0], &ends[1]], 3.0).unwrap().unwrap();
    let mut expected = eigenvalues(&system(&ends, 0.6));
    let [low, high] = [Complex::new(0.0, 1.0), Complex::new(0.0, 2.0)];
    let found = path.nearest(0.6, &[low, high], 2).unwrap();
    let distance = |lambda: &Complex<f64>| (lambda - low).norm().min((lambda - high).norm());
    expected.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    assert!((3..=4).contains(&found.len()));
    for OnContactPath { lambda, .. } in found {
        assert!(expected.iter().any(|other| (other - lambda).norm() < 1e-9 * lambda.norm()));
    }
    let alone = path.nearest(0.6, &[expected[0]], 1).unwrap();
    assert!((alone[0].lambda - expected[0]).norm() < 1e-9 * expected[0].norm());
}

#[test]
fn the_characteristic_function_is_the_determinant_up_to_a_factor() {
    let ends = ends();
    let path = ContactPath::new([&ends[0], &ends[1]], 3.0).unwrap().unwrap();
    let at: Vec<_> = (0..5).map(|i| (0.2 * i as f64, Complex::new(0.1, 1.0 + 0.3 * i as f64))).collect();
    let others = |lambda: Complex<f64>| path.others.lambdas.iter().map(|own| lambda - own).product::<Complex<f64>>();
    let whole =
        |&(t, lambda): &(f64, Complex<f64>)| system(&ends, t).dynamic_stiffness(lambda).determinant() / others(lambda);
    let ratios: Vec<_> = path.characteristic(&at).into_iter().zip(at.iter().map(whole)).map(|(a, b)| a / b).collect();
    assert!(ratios.iter().all(|ratio| (ratio / ratios[0] - 1.0).norm() < 1e-9), "{ratios:?}");
}

#[test]
fn systems_that_differ_everywhere_or_nowhere_have_no_such_path() {
    let [from, to] = ends();
    let mut other = from.clone();
    other.k *= 1.1;
    assert!(ContactPath::new([&from, &other], 3.0).unwrap().is_none());
    assert!(ContactPath::new([&from, &from], 3.0).unwrap().is_none());
    assert!(ContactPath::new([&from, &SecondOrder::zeros(ORDER, 1)], 3.0).unwrap().is_none());
    assert!(ContactPath::new([&from, &to], 3.0).unwrap().is_some());
}
