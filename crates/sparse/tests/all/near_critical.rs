//! Equal oscillators next to critical damping: copies of an eigenvalue that is not told apart from its conjugate, or hardly.

use nalgebra::DMatrix;
use num_complex::Complex;
use sparse::nalgebra_sparse::{CooMatrix, CscMatrix};
use sparse::{Options, Rectangle, SparseError, SparseSecondOrder, eigenpairs_in};

/// Number of equal oscillators, and of others.
const EQUAL: usize = 3;
const OTHERS: usize = 60;

/// Oscillators of mass 1, the equal ones with the eigenvalues `-1 +- i b`, turned into each other by a reflection; all others vibrate farther away.
fn oscillators(b: f64) -> SparseSecondOrder {
    let order = EQUAL + OTHERS;
    let mut pairs = vec![(2.0, 1.0 + b * b); EQUAL];
    pairs.extend((0..OTHERS).map(|i| (0.1, (4.0 + i as f64 * 0.37).powi(2))));
    let v = nalgebra::DVector::from_fn(order, |i, _| 1.0 + (i as f64 * 0.7).sin()).normalize();
    let turned = |of: &dyn Fn(usize) -> f64| {
        let diagonal = DMatrix::from_fn(order, order, |i, j| if i == j { of(i) } else { 0.0 });
        let reflection = DMatrix::identity(order, order) - 2.0 * &v * v.transpose();
        let full = &reflection * diagonal * &reflection;
        let full = 0.5 * (&full + full.transpose());
        let mut out = CooMatrix::new(order, order);
        (0..order).for_each(|i| (0..order).for_each(|j| out.push(i, j, full[(i, j)])));
        CscMatrix::from(&out)
    };
    let mut m = CooMatrix::new(order, order);
    (0..order).for_each(|i| m.push(i, i, 1.0));
    SparseSecondOrder::new(CscMatrix::from(&m), turned(&|i| pairs[i].0), turned(&|i| pairs[i].1)).unwrap()
}

#[test]
fn copies_next_to_the_real_axis_are_all_listed_with_vectors_of_their_own() {
    let mut found_all = 0;
    for step in 0..40 {
        let b = 2e-8 * 1.35_f64.powi(step);
        let rectangle = Rectangle { re: [-1.5, -0.5], im: [-1.0, 1.0] };
        let found = match eigenpairs_in(&oscillators(b), &rectangle, &Options::default(), &mut |_| ()) {
            Ok(found) => found.pairs,
            Err(SparseError::GroupLost { .. } | SparseError::Multiplicity { .. }) => continue,
            Err(other) => panic!("{b:e}: {other}"),
        };
        found_all += 1;
        assert_eq!(found.len(), 2 * EQUAL, "{b:e}");
        let vectors: Vec<_> = found.iter().map(|pair| pair.right.clone()).collect();
        let singular = DMatrix::<Complex<f64>>::from_columns(&vectors).singular_values();
        let rank = singular.iter().filter(|s| **s > 1e-4 * singular[0]).count();
        assert_eq!(rank, EQUAL, "{b:e}: {singular}");
        let im: Vec<f64> = found.iter().map(|pair| pair.lambda.im).collect();
        for pair in &found {
            let mirrored = found.iter().filter(|other| other.lambda == pair.lambda.conj()).count();
            let own = found.iter().filter(|other| other.lambda == pair.lambda).count();
            assert_eq!(mirrored, own, "{b:e}: {im:?}");
            assert!((pair.lambda.re + 1.0).hypot(pair.lambda.im.abs() - b) < 3e-7, "{b:e}: {}", pair.lambda);
        }
    }
    assert!(found_all > 20, "{found_all}");
}
