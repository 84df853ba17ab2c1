//! The structure of a brake as the equations of its motion take it.

use cycle::Part;
use linsys::{AffineSystem, SecondOrder};

/// Terms of a structure at coefficients, each a part of its family.
pub(crate) fn parts(system: &AffineSystem, coefficients: &[f64]) -> Vec<Part> {
    let part = |(term, &coefficient): (&linsys::Term, &f64)| {
        let SecondOrder { m, c, k, internal } = term.matrices().clone();
        let matrices = SecondOrder { m: m * coefficient, c: c * coefficient, k: k * coefficient, internal };
        Part { family: term.family.clone(), matrices }
    };
    system.terms().iter().zip(coefficients).map(part).collect()
}
