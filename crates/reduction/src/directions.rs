//! In which directions operating points of one brake differ.
//!
//! A brake may have many terms and channels whose coefficients hang on few parameters. What the other modes of an anchor do to second order
//! is kept for each direction in which known points differ, and not for each coefficient.

use linsys::OperatingPoint;
use nalgebra::DVector;
use num_complex::Complex;

/// Most directions: what an anchor holds grows with their number, and an evaluation with its square. Chosen.
const MOST: usize = 6;
/// Part of the largest difference below which points do not differ, with each coefficient relative to its largest change.
const SAME: f64 = 1e-6;

/// Orthonormal directions of the coefficients, each coefficient divided by its largest change.
#[derive(Debug, Clone, Default)]
pub(super) struct Directions {
    /// i omega at which internal states are slopes.
    middle: Complex<f64>,
    /// One for each coefficient in the order of [`values`]; 0 where it never changes.
    scales: Vec<f64>,
    vectors: Vec<DVector<f64>>,
}

impl Directions {
    /// Those in which points differ from the first of them, the largest differences first.
    pub fn new(points: &[OperatingPoint], middle: Complex<f64>) -> Self {
        let Some(first) = points.first() else { return Self::default() };
        let first = values(first, middle);
        let mut differences: Vec<_> = points[1..].iter().map(|point| values(point, middle) - &first).collect();
        let largest = |at: usize| differences.iter().map(|difference| difference[at].abs()).fold(0.0, f64::max);
        let scales: Vec<f64> = (0..first.len()).map(largest).collect();
        differences.iter_mut().for_each(|difference| scale(difference, &scales));
        let (mut vectors, mut limit) = (Vec::<DVector<f64>>::new(), 0.0);
        while vectors.len() < MOST {
            let Some(next) = differences.iter().max_by(|a, b| a.norm().total_cmp(&b.norm())) else { break };
            let size = next.norm();
            if vectors.is_empty() {
                limit = SAME * size;
            }
            if size <= limit {
                break;
            }
            let next = next / size;
            differences.iter_mut().for_each(|difference| difference.axpy(-next.dot(difference), &next, 1.0));
            vectors.push(next);
        }
        Self { middle, scales, vectors }
    }

    /// The change of all coefficients along each direction, in the order of [`values`].
    pub fn changes(&self) -> Vec<Vec<f64>> {
        let unscaled =
            |vector: &DVector<f64>| vector.iter().zip(&self.scales).map(|(value, scale)| value * scale).collect();
        self.vectors.iter().map(unscaled).collect()
    }

    /// How far along each direction one point is from another; `None` where they differ in others too.
    pub fn between(&self, [from, to]: [&OperatingPoint; 2]) -> Option<Vec<f64>> {
        let mut change = values(to, self.middle) - values(from, self.middle);
        let is_fixed = |(change, scale): (&f64, &f64)| *scale == 0.0 && *change != 0.0;
        if change.len() != self.scales.len() || change.iter().zip(&self.scales).any(is_fixed) {
            return None;
        }
        scale(&mut change, &self.scales);
        let size = change.norm();
        let along = self.vectors.iter().map(|vector| {
            let along = vector.dot(&change);
            change.axpy(-along, vector, 1.0);
            along
        });
        let along = along.collect();
        (change.norm() <= SAME * size).then_some(along)
    }
}

/// What a system is linear in: the coefficients of the terms, then mu, and real and imaginary part of the slope, of each channel.
pub(super) fn values(point: &OperatingPoint, middle: Complex<f64>) -> DVector<f64> {
    let channels = point.channels.iter().flat_map(|gain| {
        let slope = gain.complex_slope(middle);
        [gain.mu, slope.re, slope.im]
    });
    DVector::from_vec(point.coefficients.iter().copied().chain(channels).collect())
}

fn scale(change: &mut DVector<f64>, scales: &[f64]) {
    change.iter_mut().zip(scales).filter(|(_, scale)| **scale > 0.0).for_each(|(change, scale)| *change /= scale);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_two_parameters_differ_in_as_many_directions_as_their_coefficients_have() {
        let point =
            |a: f64, b: f64| OperatingPoint { coefficients: vec![1.0, a, 1e3 * a, a * b, 7.0 * b], channels: vec![] };
        let points: Vec<_> = (0..9).map(|at| point(at as f64, ((5 * at) % 7) as f64)).collect();
        let directions = Directions::new(&points, Complex::default());
        assert_eq!(directions.changes().len(), 3);
        let [from, to] = [point(1.5, 0.5), point(3.0, 8.0)];
        let along = directions.between([&from, &to]).unwrap();
        for at in 0..5 {
            let change: f64 = directions.changes().iter().zip(&along).map(|(change, along)| change[at] * along).sum();
            assert!((change - (to.coefficients[at] - from.coefficients[at])).abs() < 1e-9);
        }
        let mut other = to.clone();
        other.coefficients[0] = 2.0;
        assert!(directions.between([&from, &other]).is_none());
        other = to.clone();
        other.coefficients[1] += 1.0;
        assert!(directions.between([&from, &other]).is_none());
        assert_eq!(Directions::new(&points[..1], Complex::default()).changes().len(), 0);
    }
}
