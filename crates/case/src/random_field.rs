//! Random fields over points: modes of Karhunen and Loeve, each with a standard normal coefficient.

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use serde::Deserialize;

/// Rounding by which the variance of all modes together may fall short of the whole; chosen, far below any share that is asked for.
const ROUNDING: f64 = 1e-10;
/// Variance that is kept at each point at least, as a fraction of the share that is kept in the mean over the face; chosen: without it a small, remote part of
/// a face would have no field.
const AT_EACH: f64 = 0.5;

/// Kernel of a correlation: the correlation of two points as a function of their distance d in units of the correlation length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Kernel {
    /// `exp(-d)`.
    Exponential,
    /// `exp(-d^2)`.
    Gaussian,
}

impl Kernel {
    /// The correlation at a distance over the correlation length.
    pub fn at(self, distance: f64) -> f64 {
        match self {
            Self::Exponential => (-distance).exp(),
            Self::Gaussian => (-distance * distance).exp(),
        }
    }

    /// The name in a case file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exponential => "exponential",
            Self::Gaussian => "gaussian",
        }
    }
}

/// Largest relative distance of the variances of two modes that are kept or left out together; chosen, far more than rounding: which of two equal modes comes
/// first is rounding.
const EQUAL: f64 = 1e-6;

/// Modes of a standard normal field over points that share one face. Another thing is the table `[correlation]` of a case: it correlates parameters that are there,
/// by the same kernels, and cuts nothing off; a length of 0 is allowed there alone, `inf` here alone.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FieldModes {
    /// Shapes, a row for each point and a column for each mode: the score of a point is its row times the coefficients. Rows have unit length, so that
    /// each score is standard normal however many modes are kept.
    pub shapes: DMatrix<f64>,
    /// Variance of each mode over the variance of the whole field, in the mean over the face, largest first, before the points are scaled.
    pub variances: Vec<f64>,
    /// Variance of the mean over the face, over that which the whole field has.
    pub of_mean: f64,
}

impl FieldModes {
    /// The modes that hold a share of the variance, the largest first: so many that the variance kept is `share` in the mean over the points by their `weights`,
    /// and [`AT_EACH`] of it at each point. Modes of equal variance are kept together. `None` where a weight is below 0, or a point has no field: it has no weight, and
    /// no other point near it.
    ///
    /// With the correlation C of the points and their weights W, of sum 1, modes are the eigenvectors of `W^1/2 C W^1/2 v = l v`, the integral operator
    /// of the kernel over the face by the quadrature of its points; at the points they are `C W^1/2 v / l` (Nystroem). Each point is scaled back to
    /// variance 1: its own distribution is exact. What is left out are short waves, which means over the face hardly have, so that correlations and the variance
    /// of means are too large; [`of_mean`](Self::of_mean) says by how much.
    pub fn new(points: &[[f64; 3]], weights: &[f64], (kernel, length): (Kernel, f64), share: f64) -> Option<Self> {
        if weights.iter().any(|weight| *weight < 0.0) {
            return None;
        }
        let count = points.len();
        let distance = |i: usize, j: usize| (0..3).map(|d| (points[i][d] - points[j][d]).powi(2)).sum::<f64>().sqrt();
        let correlation = DMatrix::from_fn(count, count, |i, j| kernel.at(distance(i, j) / length));
        let sum: f64 = weights.iter().sum();
        let roots = DVector::from_iterator(count, weights.iter().map(|weight| (weight / sum).sqrt()));
        let scaled = DMatrix::from_fn(count, count, |i, j| roots[i] * correlation[(i, j)] * roots[j]);
        let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(scaled);
        let mut order: Vec<usize> = (0..count).filter(|&at| eigenvalues[at] > 0.0).collect();
        order.sort_by(|&a, &b| eigenvalues[b].total_cmp(&eigenvalues[a]));
        let (mut columns, mut variances) = (Vec::new(), Vec::new());
        let (mut kept, mut at_points) = (0.0, DVector::<f64>::zeros(count));
        for at in order {
            let value = eigenvalues[at];
            let is_equal = variances.last().is_some_and(|last| value > (1.0 - EQUAL) * last);
            if kept >= share - ROUNDING && at_points.min() >= AT_EACH * share && !is_equal {
                break;
            }
            let mut shape = &correlation * eigenvectors.column(at).component_mul(&roots) / value.sqrt();
            // The sign of a mode is free: chosen such that the first entry of more than half the largest is positive.
            let first = shape.iter().find(|entry| entry.abs() > 0.5 * shape.amax());
            if first.is_some_and(|entry| *entry < 0.0) {
                shape.neg_mut();
            }
            kept += value;
            at_points += shape.component_mul(&shape);
            columns.push(shape);
            variances.push(value);
        }
        if at_points.min() <= 0.0 {
            return None;
        }
        let mut shapes = DMatrix::from_columns(&columns);
        for (mut row, variance) in shapes.row_iter_mut().zip(at_points.iter()) {
            row /= variance.sqrt();
        }
        let areas = roots.component_mul(&roots);
        let of_mean = shapes.tr_mul(&areas).norm_squared() / areas.dot(&(&correlation * &areas));
        Some(Self { shapes, variances, of_mean })
    }

    /// The share of the variance that the modes have, in the mean over the face, before points are scaled to a variance of 1.
    pub fn kept(&self) -> f64 {
        self.variances.iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::{FieldModes, Kernel};

    /// Equal points of a line from -1 to 1, by the middle of each.
    fn line(count: usize) -> (Vec<[f64; 3]>, Vec<f64>) {
        let at = |i: usize| [(2.0 * i as f64 + 1.0) / count as f64 - 1.0, 0.0, 0.0];
        ((0..count).map(at).collect(), vec![1.0; count])
    }

    /// The eigenvalues of `exp(-|x - y| / L)` over -1 to 1, over the length 2: `L / (1 + (omega L)^2)` with the roots of `omega tan omega = 1 / L` and
    /// `omega = -tan(omega) / L`, alternately one in each interval of pi / 2 (Ghanem and Spanos, Stochastic Finite Elements, 1991, section 2.3.3).
    fn closed_form(length: f64, number: usize) -> f64 {
        let (mut low, mut high) = [number, number + 1].map(|k| k as f64 * std::f64::consts::FRAC_PI_2).into();
        let residual = |omega: f64| match number % 2 {
            0 => omega * omega.sin() - omega.cos() / length,
            _ => omega * omega.cos() + omega.sin() / length,
        };
        let sign = residual(low + 1e-12);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if residual(middle) * sign > 0.0 { low = middle } else { high = middle }
        }
        length / (1.0 + (low * length).powi(2))
    }

    #[test]
    fn variances_are_those_of_the_integral_operator() {
        let mut last = f64::INFINITY;
        for count in [50, 100, 200] {
            let (points, weights) = line(count);
            let modes = FieldModes::new(&points, &weights, (Kernel::Exponential, 0.7), 0.97).unwrap();
            let off = |k: usize| (modes.variances[k] - closed_form(0.7, k)).abs() / closed_form(0.7, 0);
            let worst = (0..modes.variances.len()).map(off).fold(0.0, f64::max);
            let expected: f64 = (0..modes.variances.len()).map(|k| closed_form(0.7, k)).sum();
            println!(
                "{count} points: {} modes, off by {worst:.1e}; kept {:.6}, {expected:.6}",
                modes.variances.len(),
                modes.kept()
            );
            // The rule of middles is of second order.
            assert!(worst < 0.3 * last, "{worst:e} after {last:e}");
            assert!(modes.kept() >= 0.97 && modes.kept() - modes.variances.last().unwrap() < 0.97);
            assert!((modes.kept() - expected).abs() < 20.0 * worst);
            last = worst;
        }
        assert!(last < 1e-4, "{last:e}");
    }

    #[test]
    fn every_point_has_unit_variance_and_all_modes_the_kernel() {
        let (points, weights) = line(40);
        for (kernel, share) in [(Kernel::Exponential, 1.0), (Kernel::Gaussian, 1.0), (Kernel::Exponential, 0.8)] {
            let modes = FieldModes::new(&points, &weights, (kernel, 0.5), share).unwrap();
            let covariance = &modes.shapes * modes.shapes.transpose();
            for i in 0..40 {
                assert!((covariance[(i, i)] - 1.0).abs() < 1e-12);
                for j in 0..40 {
                    let exact = kernel.at((points[i][0] - points[j][0]).abs() / 0.5);
                    assert!(share < 1.0 || (covariance[(i, j)] - exact).abs() < 1e-8, "{i} {j}");
                }
            }
        }
    }

    /// A length without end is one number for all points; a point of no area has the field of the points beside it.
    #[test]
    fn an_infinite_length_is_one_mode_of_ones() {
        let (points, mut weights) = line(30);
        weights[7] = 0.0;
        let modes = FieldModes::new(&points, &weights, (Kernel::Gaussian, f64::INFINITY), 1.0).unwrap();
        assert_eq!(modes.shapes.shape(), (30, 1));
        assert!(modes.shapes.iter().all(|entry| *entry == 1.0), "{}", modes.shapes);
        let near = FieldModes::new(&points, &weights, (Kernel::Gaussian, 0.8), 0.99).unwrap();
        let between = 0.5 * (near.shapes.row(6) + near.shapes.row(8));
        assert!((near.shapes.row(7) - between).amax() < 0.02);
    }

    /// The modes of a square come in pairs, of which rounding says which is first: both are kept, so that the field is the same along both edges.
    #[test]
    fn a_field_over_a_square_is_alike_along_both_edges() {
        let points: Vec<[f64; 3]> = (0..36).map(|at| [f64::from(at / 6) / 5.0, f64::from(at % 6) / 5.0, 0.0]).collect();
        for kernel in [Kernel::Exponential, Kernel::Gaussian] {
            for (length, share) in [(0.2, 0.95), (0.5, 0.95), (0.5, 0.8), (1.0, 0.8), (2.0, 0.8), (2.0, 0.95)] {
                let shapes = FieldModes::new(&points, &[1.0; 36], (kernel, length), share).unwrap().shapes;
                let correlation = |i: usize, j: usize| shapes.row(i).dot(&shapes.row(j));
                // The corner at the origin with the ends of its two edges.
                let [x, y] = [correlation(0, 30), correlation(0, 5)];
                assert!((x - y).abs() < 1e-9, "{kernel:?} {length} {share}: {x} {y}");
            }
        }
    }

    /// Against the sums of both covariances.
    #[test]
    fn the_variance_of_the_mean_is_said() {
        let (points, weights) = line(30);
        let correlation = |i: usize, j: usize| Kernel::Exponential.at((points[i][0] - points[j][0]).abs() / 0.4);
        let whole = DMatrix::from_fn(30, 30, correlation).sum() / 900.0;
        for (share, most) in [(0.6, 1.7), (0.8, 1.3), (0.95, 1.08), (1.0, 1.0 + 1e-9)] {
            let modes = FieldModes::new(&points, &weights, (Kernel::Exponential, 0.4), share).unwrap();
            let made = (&modes.shapes * modes.shapes.transpose()).sum() / 900.0;
            assert!((modes.of_mean - made / whole).abs() < 1e-9);
            assert!(modes.of_mean >= 1.0 - 1e-9 && modes.of_mean < most, "{share}: {}", modes.of_mean);
        }
    }

    #[test]
    fn a_point_without_weight_and_far_from_all_or_of_negative_weight_has_no_field() {
        let (mut points, mut weights) = line(5);
        points.push([1e4, 0.0, 0.0]);
        weights.push(0.0);
        assert_eq!(FieldModes::new(&points, &weights, (Kernel::Gaussian, 1.0), 0.9), None);
        let (points, mut weights) = line(5);
        weights[2] = -0.1;
        assert_eq!(FieldModes::new(&points, &weights, (Kernel::Gaussian, 1.0), 0.9), None);
    }

    /// A part of a face that is small and far from the rest is kept all the same.
    #[test]
    fn no_point_is_without_a_field() {
        let (mut points, mut weights) = line(30);
        points.push([100.0, 0.0, 0.0]);
        weights.push(1e-6);
        let modes = FieldModes::new(&points, &weights, (Kernel::Exponential, 1.0), 0.6).unwrap();
        assert!(modes.shapes.row(30).iter().any(|entry| entry.abs() > 0.999));
    }
}
