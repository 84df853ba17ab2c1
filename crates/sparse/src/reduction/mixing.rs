//! Anderson's acceleration of a fixed-point iteration `x <- x + f(x)` on complex vectors.
//!
//! Of the last few changes of x it takes the combination for which the changes of f explain most of f, in the sense of least
//! squares (Walker and Ni, SIAM Journal on Numerical Analysis 49, 2011). For a linear f this is GMRES without its breakdowns.

use nalgebra::DVector;
use num_complex::Complex;

type Vector = DVector<Complex<f64>>;

/// Changes that are remembered before the memory starts anew; chosen.
const MOST_REMEMBERED: usize = 3;

/// The memory of one iteration.
#[derive(Debug, Default)]
pub(super) struct Mixing {
    last: Option<(Vector, Vector)>,
    /// Orthonormal changes of f with the changes of `x + f` that belong to them.
    remembered: Vec<(Vector, Vector)>,
}

impl Mixing {
    /// The next x after x with its f(x).
    pub fn next(&mut self, x: &Vector, f: &Vector) -> Vector {
        let mut next = x + f;
        if let Some((last_x, last_f)) = self.last.replace((x.clone(), f.clone())) {
            if self.remembered.len() == MOST_REMEMBERED {
                // Each direction is orthogonal to the older ones, so none can be dropped alone.
                self.remembered.clear();
            }
            let (mut change, mut step) = (f - &last_f, x - &last_x + f - &last_f);
            for (direction, image) in &self.remembered {
                let along = direction.dotc(&change);
                change.axpy(-along, direction, Complex::from(1.0));
                step.axpy(-along, image, Complex::from(1.0));
            }
            let size = change.norm();
            if size > 0.0 {
                self.remembered.push((change.unscale(size), step.unscale(size)));
            }
        }
        for (direction, image) in &self.remembered {
            next.axpy(-direction.dotc(f), image, Complex::from(1.0));
        }
        next
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    #[test]
    fn a_linear_iteration_that_diverges_alone_ends_after_as_many_steps_as_it_has_dimensions() {
        let c = |re: f64, im: f64| Complex::new(re, im);
        // x <- x + b - A x with eigenvalues of 1 - A outside of the unit circle.
        let a = DMatrix::from_row_slice(2, 2, &[c(3.0, 1.0), c(0.5, 0.0), c(0.0, -0.4), c(-1.5, 0.2)]);
        let b = DVector::from_vec(vec![c(1.0, 0.0), c(0.0, 2.0)]);
        let (mut x, mut mixing) = (DVector::zeros(2), Mixing::default());
        for _ in 0..4 {
            x = mixing.next(&x, &(&b - &a * &x));
        }
        assert!((&a * &x - &b).norm() < 1e-12);
    }
}
