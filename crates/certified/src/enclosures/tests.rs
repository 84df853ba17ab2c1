//! Theorems, each against the spectrum of a dense matrix: counts in unions of discs, and counts in circles.

use nalgebra::Schur;
use proptest::collection::vec;
use proptest::prelude::*;

use super::*;

type Matrix = DMatrix<Complex<f64>>;

fn complex(largest: f64) -> impl Strategy<Value = Complex<f64>> {
    (-largest..largest, -largest..largest).prop_map(|(re, im)| Complex::new(re, im))
}

fn matrix(n: usize, largest: f64) -> impl Strategy<Value = Matrix> {
    vec(complex(largest), n * n).prop_map(move |entries| Matrix::from_vec(n, n, entries))
}

fn spectrum(a: &Matrix) -> Vec<Complex<f64>> {
    Schur::try_new(a.clone(), f64::EPSILON, 10_000).unwrap().eigenvalues().unwrap().iter().copied().collect()
}

/// Zeros of det (S_0 + d S_1 + ...) with a regular last matrix, as eigenvalues of the companion matrix.
fn zeros(series: &[Matrix]) -> Vec<Complex<f64>> {
    let (q, last) = (series[0].nrows(), series.len() - 1);
    let inverse = series[last].clone().try_inverse().unwrap();
    let companion = Matrix::from_fn(q * last, q * last, |i, j| match (i / q, j / q) {
        (row, block) if row + 1 == last => -(&inverse * &series[block])[(i % q, j % q)],
        (row, block) if row + 1 == block && i % q == j % q => Complex::from(1.0),
        _ => Complex::default(),
    });
    spectrum(&companion)
}

/// Every union of these discs holds as many of the eigenvalues as it has discs, and none is outside of all.
fn unions_hold_their_number(discs: &[(Complex<f64>, f64)], eigenvalues: &[Complex<f64>]) {
    let meet = |a: usize, b: usize| (discs[a].0 - discs[b].0).norm() <= discs[a].1 + discs[b].1;
    for union in unions(discs.len(), |_| true, meet) {
        let is_in = |lambda: &&Complex<f64>| union.iter().any(|&i| (**lambda - discs[i].0).norm() <= discs[i].1 + 1e-9);
        assert_eq!(eigenvalues.iter().filter(is_in).count(), union.len(), "{discs:?} {eigenvalues:?}");
    }
}

fn corrections(guesses: &[Complex<f64>], a: &Matrix) -> Vec<f64> {
    let n = guesses.len();
    let value = |z: Complex<f64>| (Matrix::identity(n, n) * z - a).determinant();
    let others = |z: Complex<f64>| guesses.iter().filter(move |other| **other != z).map(move |other| z - other);
    let correction = |&z: &Complex<f64>| (value(z) / others(z).product::<Complex<f64>>()).norm();
    guesses.iter().map(correction).collect()
}

proptest! {
    #[test]
    fn discs_with_shares_below_one_hold_all_zeros(
        a in matrix(5, 1.0), moved in vec(complex(0.02), 5), radii in vec(0.01..0.3, 5),
    ) {
        let eigenvalues = spectrum(&a);
        let guesses: Vec<_> = eigenvalues.iter().zip(moved).map(|(lambda, by)| lambda + by).collect();
        let sizes = corrections(&guesses, &a);
        let total: f64 = sizes.iter().zip(&radii).map(|(w, r)| smith_share(*w, *r)).sum();
        prop_assume!(total.is_finite() && total > 1e-6);
        // Any radii, made so large that the shares sum up to a little less than 1.
        let discs: Vec<_> = guesses.into_iter().zip(radii).map(|(z, r)| (z, r * total * 1.001)).collect();
        unions_hold_their_number(&discs, &eigenvalues);
    }

    #[test]
    fn circles_around_chains_hold_the_number_of_the_power_that_wins(
        small in matrix(2, 0.02), slope in matrix(2, 1.0), second in matrix(2, 1.0), by in matrix(2, 1.0), radius in 0.01..1.0,
    ) {
        let series = [small, slope, second];
        let error = 0.01 * radius;
        let is_settled = |series: &[Matrix]| [block_rouche(series, radius, error), pellet(series, 2, radius, error)];
        let changed = [&series[0] + &by * Complex::from(error / by.norm()), series[1].clone(), series[2].clone()];
        for (is_settled, series) in [(is_settled(&series), &series), (is_settled(&series), &changed)] {
            let inside = zeros(series).iter().filter(|d| d.norm() < radius).count();
            prop_assert!(is_settled == [false; 2] || inside == 2);
        }
        for count in 0..=4 {
            let inside = zeros(&changed).iter().filter(|d| d.norm() < radius).count();
            prop_assert!(!pellet(&series, count, radius, error) || inside == count);
        }
    }
}

#[test]
fn what_holds_for_some_holds_for_enough_that_the_properties_say_something() {
    // A double zero at 0 and one far away, moved a little: both theorems count two.
    let one = |value: f64| Matrix::identity(2, 2) * Complex::from(value);
    let series = [one(1e-4), one(1.0), one(0.1)];
    assert!(block_rouche(&series, 0.1, 1e-3) && pellet(&series, 2, 0.1, 1e-3));
    assert!(!block_rouche(&series, 0.1, 0.2) && !pellet(&series, 2, 0.1, 0.2));
    assert!(!pellet(&series, 1, 0.1, 1e-3) && pellet(&series, 0, 1e-5, 1e-6));
    // A chain of neighbours is one union, and those without an asked member are left out.
    let places = [0.0, 5.0, 0.9, 1.8, 7.0, 5.5_f64];
    let meet = |a: usize, b: usize| (places[a] - places[b]).abs() <= 1.0;
    assert_eq!(unions(6, |_| true, meet), [vec![0, 2, 3], vec![1, 5], vec![4]]);
    assert_eq!(unions(6, |i| i == 5, meet), [vec![5, 1]]);
}
