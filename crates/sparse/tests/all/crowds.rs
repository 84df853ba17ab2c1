//! Rectangles at a crowd: thousands of eigenvalues on one line, that are written down, next to the rectangle and in it. Seen from a shift beside the line they are
//! nearly equally far, and a Ritz value is a mean of many of them, farther from the shift than the nearest.

use sparse::nalgebra_sparse::{CooMatrix, CscMatrix};
use sparse::{Options, Rectangle, SparseError, SparseSecondOrder, eigenpairs_in};

/// Number of oscillators.
const COUNT: usize = 4000;

/// Frequencies of the oscillators, rad/s, from 0.5 to 3, ascending, without a pattern that a small space could hold.
fn frequencies() -> Vec<f64> {
    let mut all: Vec<f64> = (0..COUNT).map(|i| 0.5 + 2.5 * (i as f64 * 0.618_033_988_749_895).fract()).collect();
    all.sort_by(f64::total_cmp);
    all
}

/// Oscillators of mass 1, pairs of which are turned by 45 degrees into springs between neighbours, with C = damping I.
fn oscillators(damping: f64) -> SparseSecondOrder {
    let [mut m, mut c, mut k] = [(); 3].map(|()| CooMatrix::new(COUNT, COUNT));
    let all = frequencies();
    for at in (0..COUNT).step_by(2) {
        let stiffness = [0, 1].map(|i| all[at + i].powi(2) + 0.25 * damping * damping);
        let [mean, half] = [0.5 * (stiffness[0] + stiffness[1]), 0.5 * (stiffness[0] - stiffness[1])];
        for (i, j) in [(at, at + 1), (at + 1, at)] {
            m.push(i, i, 1.0);
            c.push(i, i, damping);
            k.push(i, i, mean);
            k.push(i, j, half);
        }
    }
    SparseSecondOrder::new(CscMatrix::from(&m), CscMatrix::from(&c), CscMatrix::from(&k)).unwrap()
}

#[test]
fn a_crowd_is_found_or_refused() {
    let (mut refused, mut found_all) = (0, 0);
    for (damping, im) in [(-2e-4, [2.0, 2.02]), (2e-3, [1.0, 1.01])] {
        let system = oscillators(damping);
        let expected: Vec<f64> = frequencies().into_iter().filter(|w| (im[0]..=im[1]).contains(w)).collect();
        assert!(expected.len() >= 10, "{}", expected.len());
        for (from, reaches) in [(-0.5 * damping - 1e-4, vec![0.3, 1.0]), (-1.0, vec![1.0])] {
            for re in reaches.into_iter().map(|to| [from, to]) {
                let case = format!("Re {re:?}, Im {im:?}");
                let found = match eigenpairs_in(&system, &Rectangle { re, im }, &Options::default(), &mut |_| ()) {
                    Ok(found) => found.pairs,
                    Err(SparseError::RectangleTooLarge { .. }) => {
                        refused += 1;
                        continue;
                    }
                    Err(other) => panic!("{case}: {other}"),
                };
                found_all += 1;
                assert_eq!(found.len(), expected.len(), "{case}");
                for (pair, im) in found.iter().zip(&expected) {
                    let off = (pair.lambda.re + 0.5 * damping).abs().max((pair.lambda.im - im).abs());
                    assert!(off < 1e-12, "{case}: {} for {im}, {off:e}", pair.lambda);
                }
            }
        }
    }
    println!("{found_all} found, {refused} refused");
    assert!(found_all > 0);
}
