//! Anderson's acceleration of a fixed-point iteration `x <- x + f(x)` on complex vectors.
//!
//! Of the last few changes of x it takes the combination for which the changes of f explain most of f, in the sense of least
//! squares (Walker and Ni, SIAM Journal on Numerical Analysis 49, 2011). For a linear f this is GMRES without its breakdowns.

/// Changes that are remembered before the memory starts anew; chosen.
const MOST_REMEMBERED: usize = 3;

/// A complex vector as its real parts and its imaginary parts, in single precision: a change needs no more digits.
#[derive(Debug, Clone, Default)]
pub(super) struct Parts {
    pub re: Vec<f32>,
    pub im: Vec<f32>,
}

/// The memory of one iteration.
#[derive(Debug, Default)]
pub(super) struct Mixing {
    /// The last f(x), and the change of x that followed.
    last: Option<(Parts, Parts)>,
    /// Orthonormal changes of f with the changes of `x + f` that belong to them.
    remembered: Vec<(Parts, Parts)>,
}

impl Mixing {
    /// The change of x after f(x).
    pub fn next(&mut self, f: Parts) -> Parts {
        if let Some((last_f, mut step)) = self.last.take() {
            if self.remembered.len() == MOST_REMEMBERED {
                // Each direction is orthogonal to the older ones, so none can be dropped alone.
                self.remembered.clear();
            }
            let mut change = f.clone();
            change.add([-1.0, 0.0], &last_f);
            step.add([1.0, 0.0], &change);
            for (direction, image) in &self.remembered {
                let [re, im] = direction.dot(&change);
                change.add([-re, -im], direction);
                step.add([-re, -im], image);
            }
            let size = change.dot(&change)[0].sqrt();
            if size > 0.0 {
                self.remembered.push((change.scaled(1.0 / size), step.scaled(1.0 / size)));
            }
        }
        let mut next = f.clone();
        for (direction, image) in &self.remembered {
            let [re, im] = direction.dot(&f);
            next.add([-re, -im], image);
        }
        self.last = Some((f, next.clone()));
        next
    }
}

impl Parts {
    /// Real and imaginary part of `self^H other`.
    fn dot(&self, other: &Self) -> [f32; 2] {
        [dot(&self.re, &other.re) + dot(&self.im, &other.im), dot(&self.re, &other.im) - dot(&self.im, &other.re)]
    }

    /// Adds `(re + i im) other`.
    fn add(&mut self, [re, im]: [f32; 2], other: &Self) {
        let to = self.re.iter_mut().zip(&mut self.im);
        for ((to_re, to_im), (&a, &b)) in to.zip(other.re.iter().zip(&other.im)) {
            *to_re += re * a - im * b;
            *to_im += re * b + im * a;
        }
    }

    fn scaled(mut self, factor: f32) -> Self {
        self.re.iter_mut().chain(&mut self.im).for_each(|value| *value *= factor);
        self
    }
}

/// `sum_i a_i b_i` in eight sums.
fn dot(a: &[f32], b: &[f32]) -> f32 {
    let (mut sums, (a, b)) = ([0.0; 8], (a.chunks_exact(8), b.chunks_exact(8)));
    let rest: f32 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        sums.iter_mut().zip(a.iter().zip(b)).for_each(|(sum, (a, b))| *sum += a * b);
    }
    rest + sums.iter().sum::<f32>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use num_complex::Complex;

    #[test]
    fn a_linear_iteration_that_diverges_alone_ends_after_as_many_steps_as_it_has_dimensions() {
        let c = |re: f64, im: f64| Complex::new(re, im);
        // x <- x + b - A x with eigenvalues of 1 - A outside of the unit circle.
        let a = DMatrix::from_row_slice(2, 2, &[c(3.0, 1.0), c(0.5, 0.0), c(0.0, -0.4), c(-1.5, 0.2)]);
        let b = DVector::from_vec(vec![c(1.0, 0.0), c(0.0, 2.0)]);
        let (mut x, mut mixing) = (DVector::zeros(2), Mixing::default());
        for _ in 0..4 {
            let f = &b - &a * &x;
            let part = |of: fn(&Complex<f64>) -> f64| f.iter().map(|value| of(value) as f32).collect();
            let next = mixing.next(Parts { re: part(|value| value.re), im: part(|value| value.im) });
            let next = next.re.iter().zip(&next.im).map(|(&re, &im)| c(f64::from(re), f64::from(im)));
            x += DVector::from_iterator(2, next);
        }
        assert!((&a * &x - &b).norm() < 1e-5);
    }
}
