//! Eigenvalues of undamped systems, which are on the imaginary axis until two of them meet, however little their bounds tell.

use sparse::nalgebra_sparse::{CooMatrix, CscMatrix};
use sparse::{Found, Options, Rectangle, SparseSecondOrder, eigenpairs_in};

const MASSES: usize = 60;

/// A chain held at each mass, in which a link as stiff as `penalty` makes every other eigenvalue badly conditioned, and friction couples two masses.
fn chain(penalty: f64, friction: f64, damping: f64) -> SparseSecondOrder {
    let [mut m, mut c, mut k] = [(); 3].map(|()| CooMatrix::new(MASSES, MASSES));
    for mass in 0..MASSES {
        m.push(mass, mass, 1.0 + 0.37 * (mass as f64).sin());
        c.push(mass, mass, damping);
        k.push(mass, mass, 1e4 * (1.0 + mass as f64 / 7.0));
    }
    for mass in 1..MASSES {
        let spring = if mass == MASSES / 2 { penalty } else { 2e3 };
        for (row, column, sign) in
            [(mass, mass, 1.0), (mass - 1, mass - 1, 1.0), (mass, mass - 1, -1.0), (mass - 1, mass, -1.0)]
        {
            k.push(row, column, sign * spring);
        }
    }
    k.push(4, 5, friction);
    k.push(5, 4, -friction);
    let [m, c, k] = [m, c, k].map(|matrix| CscMatrix::from(&matrix));
    SparseSecondOrder::new(m, c, k).unwrap()
}

/// Eigenvalues up to `top` rad/s by the search of large systems.
fn found(system: &SparseSecondOrder, top: f64) -> Found {
    let rectangle = Rectangle { re: [-200.0, 200.0], im: [10.0, top] };
    eigenpairs_in(system, &rectangle, &Options { certified: 0, ..Options::default() }, &mut |_| ()).unwrap()
}

fn count(found: &Found, wanted: &str) -> usize {
    found.pairs.iter().filter(|pair| pair.verdict.to_string() == wanted).count()
}

#[test]
fn what_is_alone_in_an_undamped_system_is_marginal() {
    for penalty in [1e4, 1e12, 1e14] {
        for friction in [0.0, 1e3, 4e4] {
            let found = found(&chain(penalty, friction, 0.0), 250.0);
            let [unstable, stable, marginal] = ["unstable", "stable", "marginal"].map(|wanted| count(&found, wanted));
            assert_eq!(unstable + stable + marginal, found.pairs.len(), "{penalty:e}, {friction}: some are undecided");
            assert_eq!((unstable, stable), if friction > 1e4 { (1, 1) } else { (0, 0) }, "{penalty:e}, {friction}");
        }
    }
}

#[test]
fn what_is_damped_is_not_taken_for_marginal() {
    // The chain whose eigenvalues are all marginal without damping, and one that the bounds do not see.
    let [damped, undamped] = [1e-9, 0.0].map(|damping| count(&found(&chain(1e14, 0.0, damping), 250.0), "undecided"));
    assert!(damped > 0 && undamped == 0, "{damped} {undamped}");
}
